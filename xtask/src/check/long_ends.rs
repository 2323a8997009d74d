//! Whether steps could be longer with long ends at sides of the mesh.

use fisura::Scene;
use fisura::linear_algebra::extremes::smaller;
use fisura::scene::{Frame, Side};
use fisura::simulation::Simulation;
use fisura::validate::expected_size;
use serde::Serialize;

/// Least gain that is worth a word.
const WORTHWHILE: f64 = 1.1;
/// Points up to which it is tried: a second.
const MOST_POINTS: usize = 500_000;
/// Length of a span at a side, in shortest spans, from which on others bound the step.
const LONG: f64 = 1.9;

/// Sides, by their names and axes, and whether they are at the upper end.
const SIDES: [(&str, Side, usize, bool); 4] = [
    ("left", Side::Left, 0, false),
    ("right", Side::Right, 0, true),
    ("bottom", Side::Bottom, 1, false),
    ("top", Side::Top, 1, true),
];

/// What `mesh.long_ends` would gain.
#[derive(Debug, Serialize)]
pub(super) struct LongEnds {
    /// Names of the sides, as the key `mesh.long_ends` takes them.
    sides: Vec<&'static str>,
    /// Critical step over the present one.
    times: f64,
}

impl LongEnds {
    /// At the sides that are as fine as the mesh and that no seeded crack is near; none if it is not
    /// worthwhile. A phase field does not change the ratio of the steps.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let mut long = scene.clone();
        if scene.analysis.frame == Frame::Updated
            || scene.mesh.geometry.is_some()
            || expected_size(scene).points > MOST_POINTS
        {
            return None;
        }
        long.equilibrium = false;
        long.bodies.iter_mut().for_each(|body| body.cracks.clear());
        long.materials.values_mut().for_each(|material| material.fracture = None);
        let critical = |scene: &Scene| Some(Simulation::new(scene).ok()?.plan().critical);
        let present = critical(&long)?;
        let fine = SIDES.into_iter().filter(|(_, _, d, upper)| is_fine(scene, *d, *upper));
        let sides = fine.filter(|(_, side, ..)| long.mesh.lengthen_end(*side)).map(|(name, ..)| name).collect();
        let times = critical(&long)? / present;
        (times >= WORTHWHILE).then_some(Self { sides, times })
    }
}

/// Whether the mesh is as fine at an end of an axis as anywhere, and no seeded crack is near.
fn is_fine(scene: &Scene, d: usize, upper: bool) -> bool {
    let lengths = |d: usize| scene.mesh.knots[d].windows(2).map(|k| k[1] - k[0]).filter(|length| *length > 0.0);
    let shortest = lengths(0).chain(lengths(1)).fold(f64::INFINITY, smaller);
    let (end, side) =
        if upper { (lengths(d).next_back(), scene.mesh.end()[d]) } else { (lengths(d).next(), scene.mesh.origin()[d]) };
    let seeds = scene.bodies.iter().flat_map(|body| &body.cracks).filter(|crack| !crack.is_slit());
    let near = |point: &[f64; 2]| (point[d] - side).abs() < 2.0 * LONG * shortest;
    let mut points = seeds.flat_map(|crack| &crack.points);
    scene.mesh.degree[d] > 1 && !points.any(near) && end.is_some_and(|length| length < LONG * shortest)
}
