//! Events of a growing crack, from its tip against time and from the last picture.
//!
//! The axis is the height of the initial crack. The tip *branches* when it first leaves the axis by
//! [`OFF_AXIS`].

use fisura::material::degradation::BROKEN;

use super::{Run, position};
use crate::case::Check;
use crate::extremes::larger;

/// Distance from the axis that counts as having left it, m.
const OFF_AXIS: f64 = 0.25e-3;
/// Phase field of a pixel beyond which a crack along its row has ended. The centre of a pixel stands up to
/// half a pixel off the crack, where c need not fall below [`BROKEN`] on a mesh that resolves the crack.
const INTACT: f64 = 0.5;
/// Half width of the window in which a speed is fitted, s.
const SPEED_WINDOW: f64 = 2e-6;

/// The tip against time: t (s), x and y (m), only where there is one.
fn tips(run: &Run) -> Result<Vec<[f64; 3]>, String> {
    let (x, y) = (run.column("crack_tip_x_m")?, run.column("crack_tip_y_m")?);
    let rows = run.times()?.iter().zip(x).zip(y);
    Ok(rows.map(|((&t, x), y)| [t, x, y]).filter(|row| row[1].is_finite()).collect())
}

/// Height of the first crack, m.
fn axis(run: &Run) -> f64 {
    last_segment(run).map_or(0.0, |[_, end]| end[1])
}

/// First time at which the tip has passed x = `at`, s.
pub(super) fn passes(check: &Check, run: &Run) -> Result<Option<f64>, String> {
    let goal = position(check)?;
    let tips = tips(run)?;
    let Some(after) = tips.iter().position(|row| row[1] >= goal) else { return Ok(None) };
    if after == 0 {
        return Ok(Some(tips[0][0]));
    }
    let ([t0, x0, _], [t1, x1, _]) = (tips[after - 1], tips[after]);
    Ok(Some(t0 + (goal - x0) / (x1 - x0) * (t1 - t0)))
}

/// Where and when the crack branched.
pub(super) struct Branching {
    /// Time of the first sample at which the tip is off the axis, s.
    pub(super) time: f64,
    /// Coordinate x of the tip at that time, m.
    pub(super) x: f64,
}

pub(super) fn branching(run: &Run) -> Result<Option<Branching>, String> {
    let axis = axis(run);
    let first = tips(run)?.into_iter().find(|row| (row[2] - axis).abs() > OFF_AXIS);
    Ok(first.map(|[time, x, _]| Branching { time, x }))
}

/// Largest slope of a straight line fitted to x over ±2 µs, before branching, over the speed `at`.
pub(super) fn largest_speed_before_branching(check: &Check, run: &Run) -> Result<Option<f64>, String> {
    let unit = position(check)?;
    let end = branching(run)?.map_or(f64::INFINITY, |b| b.time);
    let tips = tips(run)?;
    let (times, x): (Vec<f64>, Vec<f64>) = tips.iter().map(|row| (row[0], row[1])).unzip();
    let last = tips.last().map_or(0.0, |row| row[0]);
    let centers = tips.iter().map(|row| row[0]).filter(|t| *t >= SPEED_WINDOW && *t <= (end.min(last) - SPEED_WINDOW));
    Ok(centers.map(|t| fitted_speed(&times, &x, t)).filter(|v| v.is_finite()).reduce(larger).map(|v| v / unit))
}

/// Slope of a straight line fitted to positions x (m) within ±2 µs of `center` (s), m/s; NaN without two of
/// them.
pub fn fitted_speed(times: &[f64], x: &[f64], center: f64) -> f64 {
    let near = |row: &(&f64, &f64)| (row.0 - center).abs() <= SPEED_WINDOW * (1.0 + 1e-9) && row.1.is_finite();
    let points = times.iter().zip(x).filter(near).map(|(t, x)| (*t, *x));
    fitted_slope(points).unwrap_or(f64::NAN)
}

/// Least-squares slope of points (t, x).
pub(super) fn fitted_slope(points: impl Iterator<Item = (f64, f64)> + Clone) -> Option<f64> {
    let n = points.clone().count() as f64;
    let (t, x) = points.clone().fold((0.0, 0.0), |(t, x), p| (t + p.0 / n, x + p.1 / n));
    let (top, bottom) =
        points.fold((0.0, 0.0), |(top, bottom), p| (top + (p.0 - t) * (p.1 - x), bottom + (p.0 - t) * (p.0 - t)));
    (bottom > 0.0).then(|| top / bottom)
}

/// Time (s) and place (m) at which a tip, given by rows of these, is first at the distance `goal` from the
/// end of the last straight part of the initial crack and ahead of it. Before it grows, a seed is broken
/// behind its end.
pub fn grown(tips: &[[f64; 3]], [from, to]: [[f64; 2]; 2], goal: f64) -> Option<[f64; 3]> {
    let ahead = |[_, x, y]: [f64; 3]| (x - to[0]) * (to[0] - from[0]) + (y - to[1]) * (to[1] - from[1]) > 0.0;
    let distance = |[_, x, y]: [f64; 3]| (x - to[0]).hypot(y - to[1]);
    let after = tips.iter().position(|tip| ahead(*tip) && distance(*tip) >= goal)?;
    let Some(before) = after.checked_sub(1).map(|n| tips[n]).filter(|tip| ahead(*tip)) else {
        return Some(tips[after]);
    };
    let part = (goal - distance(before)) / (distance(tips[after]) - distance(before));
    Some([0, 1, 2].map(|i| before[i] + part * (tips[after][i] - before[i])))
}

/// Angle between the last straight part of a crack and the chord from its end to a place, degrees.
pub fn chord([from, to]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> f64 {
    let ([a, b], [c, d]) = ([to[0] - from[0], to[1] - from[1]], [x - to[0], y - to[1]]);
    (a * d - b * c).atan2(a * c + b * d).to_degrees().abs()
}

/// When (s) and where (m) the tip of a run is first at the distance `at` from the end of the initial crack.
pub(super) fn growth(check: &Check, run: &Run) -> Result<Option<[f64; 3]>, String> {
    let goal = position(check)?;
    let initial = last_segment(run).ok_or("the scene has no initial crack")?;
    Ok(grown(&tips(run)?, initial, goal))
}

/// Angle between the initial crack and the chord from its end to the tip at the distance `at`, degrees.
pub(super) fn chord_angle(check: &Check, run: &Run) -> Result<Option<f64>, String> {
    let place = growth(check, run)?.zip(last_segment(run));
    Ok(place.map(|([_, x, y], initial)| chord(initial, [x, y])))
}

/// The last straight part of the first initial crack, m.
fn last_segment(run: &Run) -> Option<[[f64; 2]; 2]> {
    run.scene.bodies.iter().flat_map(|body| &body.cracks).next()?.segments().last()
}

/// Distance from the axis at which the tip first passes x = `at`, m.
pub(super) fn exit_offset(check: &Check, run: &Run) -> Result<Option<f64>, String> {
    let (goal, axis) = (position(check)?, axis(run));
    Ok(tips(run)?.into_iter().find(|row| row[1] >= goal).map(|row| (row[2] - axis).abs()))
}

/// Where the crack along the axis ends: the last broken pixel before the first intact one, in the last
/// picture, m.
pub(super) fn end_along_axis(run: &Run) -> Option<f64> {
    let picture = run.frames.last()?;
    let phase = picture.phase.as_ref()?;
    let row = ((axis(run) - picture.origin[1]) / picture.pixel[1]).floor().max(0.0) as usize;
    let columns = picture.pixels[0];
    let row = row.min(picture.pixels[1] - 1) * columns;
    Some(picture.origin[0] + cracked(&phase[row..row + columns])? as f64 * picture.pixel[0])
}

/// Pixels of a row up to the last broken one before the first intact one.
fn cracked(row: &[f64]) -> Option<usize> {
    let damaged = row.iter().take_while(|c| **c < INTACT);
    damaged.enumerate().filter(|(_, c)| **c < BROKEN).last().map(|(last, _)| last + 1)
}

/// Separate broken stretches at or above the axis on the vertical line x = `at` of the last picture.
pub(super) fn branches(check: &Check, run: &Run) -> Result<Option<f64>, String> {
    let x = position(check)?;
    let Some(picture) = run.frames.last() else { return Ok(None) };
    let Some(phase) = &picture.phase else { return Ok(None) };
    let column = ((x - picture.origin[0]) / picture.pixel[0]) as usize;
    let axis = axis(run);
    let broken = (0..picture.pixels[1])
        .map(|row| row * picture.pixels[0] + column.min(picture.pixels[0] - 1))
        .filter(|&index| picture.center(index)[1] >= axis)
        .map(|index| phase[index] < BROKEN);
    let (mut count, mut inside) = (0, false);
    for now in broken {
        count += usize::from(now && !inside);
        inside = now;
    }
    Ok(Some(count as f64))
}

/// Largest difference of c from its mirror image about the axis, over the last picture of a whole body.
pub(super) fn asymmetry(run: &Run) -> Option<f64> {
    let picture = run.frames.last()?;
    let phase = picture.phase.as_ref()?;
    let [columns, rows] = picture.pixels;
    let mirrored = |index: usize| phase[(rows - 1 - index / columns) * columns + index % columns];
    (0..phase.len()).map(|index| (phase[index] - mirrored(index)).abs()).reduce(larger)
}

#[cfg(test)]
mod tests {
    use super::cracked;

    #[test]
    fn a_crack_thinner_than_a_pixel_goes_on_and_ends_at_the_last_broken_one() {
        assert_eq!(cracked(&[0.0, 0.01, 0.1, 0.02, 0.2, 0.6, 0.01]), Some(4));
        assert_eq!(cracked(&[0.3, 0.6, 0.0]), None);
    }
}
