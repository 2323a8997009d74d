//! The span whose polynomials stand for a position on the boundary of a body.
//!
//! Such a position may lie in a span that no material point has reached, or beyond the end of the mesh by
//! round-off. The polynomials of the nearest span with material, continued beyond its end, still sum to one
//! and reproduce positions: no force and no torque is lost.

use crate::splines::spline::SplineSpace;

/// The span that is nearest to a position (m) among its own and its eight neighbours, of those that `carries`
/// says can stand for it; its own if it can.
pub(crate) fn nearest_span(
    spaces: &[SplineSpace; 2],
    position: [f64; 2],
    carries: impl Fn([usize; 2]) -> bool,
) -> Option<[usize; 2]> {
    let home = [0, 1].map(|d| clamped_span(&spaces[d], position[d]));
    if carries(home) {
        return Some(home);
    }
    let near = |d: usize| home[d].saturating_sub(1)..(home[d] + 2).min(spaces[d].spans().len());
    let distance = |span: &[usize; 2]| {
        let beyond = |d: usize| {
            let s = &spaces[d].spans()[span[d]];
            (s.left - position[d]).max(position[d] - s.right).max(0.0)
        };
        beyond(0).hypot(beyond(1))
    };
    let spans = near(1).flat_map(|j| near(0).map(move |i| [i, j]));
    spans.filter(|span| carries(*span)).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// The span of `x`, or the end span nearest to it.
fn clamped_span(space: &SplineSpace, x: f64) -> usize {
    let last = space.spans().len() - 1;
    space.find_span(x).unwrap_or(if x > space.spans()[last].right { last } else { 0 })
}
