//! Where the crack is: its tip, its end on the axis, the number of its branches.

use crate::mesh::{CRACK, Mesh};
use crate::stencil::row;

/// Below this phase field the material counts as broken.
pub const BROKEN: f64 = 0.05;

/// The crack at one time; lengths in m, absent where nothing is broken.
#[derive(Debug, Clone, Copy, Default)]
pub struct Crack {
    /// Farthest point to the right with c < 0.05, in the upper half; the ordinate from the crack line.
    pub tip: Option<[f64; 2]>,
    /// End of the broken stretch of the crack line.
    pub axis_end: Option<f64>,
    /// First column beyond the seeded crack with two branches.
    pub first_two: Option<f64>,
}

/// Looks at the phase field `c`; in the `whole` plate the crack line is the middle row.
pub fn find(mesh: &Mesh, c: &[f64], whole: bool) -> Crack {
    let axis = if whole { mesh.rows() / 2 } else { 0 };
    let of_row = |j: usize| &row(c, j, mesh.stride())[1..=mesh.x.len()];
    let crossing = |values: &[f64], i: usize| match values.get(i + 1) {
        Some(next) if *next >= BROKEN => {
            mesh.x[i] + (mesh.x[i + 1] - mesh.x[i]) * (BROKEN - values[i]) / (next - values[i])
        }
        _ => mesh.x[i],
    };
    let mut tip: Option<[f64; 2]> = None;
    for j in axis..mesh.y.len() {
        if let Some(i) = of_row(j).iter().rposition(|c| *c < BROKEN) {
            let x = crossing(of_row(j), i);
            if tip.is_none_or(|[farthest, _]| x > farthest + 1e-12) {
                tip = Some([x, mesh.y[j]]);
            }
        }
    }
    let on_axis = of_row(axis);
    let intact = on_axis.iter().position(|c| *c >= BROKEN).unwrap_or(on_axis.len());
    let axis_end = intact.checked_sub(1).map(|i| crossing(on_axis, i));
    let columns = (0..mesh.x.len()).filter(|i| mesh.x[*i] > CRACK + 0.5e-3);
    let first_two = columns.map(|i| (i, branches(mesh, c, i, whole))).find(|(_, n)| *n >= 2).map(|(i, _)| mesh.x[i]);
    Crack { tip, axis_end, first_two }
}

/// Broken stretches of column `i`; those off the crack line of a half plate count twice.
pub fn branches(mesh: &Mesh, c: &[f64], i: usize, whole: bool) -> usize {
    let mut count = 0;
    let mut inside = false;
    for j in 0..mesh.y.len() {
        let broken = row(c, j, mesh.stride())[i + 1] < BROKEN;
        if broken && !inside {
            count += if whole || j == 0 { 1 } else { 2 };
        }
        inside = broken;
    }
    count
}

/// The place farthest from `start` where c is 0.05: on the sides of elements that it passes. m.
pub fn farthest(mesh: &Mesh, c: &[f64], start: [f64; 2]) -> Option<[f64; 2]> {
    let distance = |p: &[f64; 2]| (p[0] - start[0]).hypot(p[1] - start[1]);
    let at = |i: usize, j: usize| (row(c, j, mesh.stride())[i + 1], [mesh.x[i], mesh.y[j]]);
    let crossing = |(inner, p): (f64, [f64; 2]), (outer, q): (f64, [f64; 2])| {
        let part = (BROKEN - inner) / (outer - inner);
        [0, 1].map(|d| p[d] + part * (q[d] - p[d]))
    };
    let mut found = Vec::new();
    for (j, i) in (0..mesh.y.len()).flat_map(|j| (0..mesh.x.len()).map(move |i| (j, i))) {
        let here = at(i, j);
        let next = [(i + 1 < mesh.x.len()).then(|| at(i + 1, j)), (j + 1 < mesh.y.len()).then(|| at(i, j + 1))];
        for next in next.into_iter().flatten() {
            match [here.0 < BROKEN, next.0 < BROKEN] {
                [true, false] => found.push(crossing(here, next)),
                [false, true] => found.push(crossing(next, here)),
                [true, true] => found.extend([here.1, next.1]),
                [false, false] => {}
            }
        }
    }
    found.into_iter().max_by(|a, b| distance(a).total_cmp(&distance(b)))
}
