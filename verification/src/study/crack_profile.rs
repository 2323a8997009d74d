//! The phase field of one crack, c = 0 on a line, against its closed form `c = 1 − exp(−|x|/(2 l0))` of
//! energy Gc.
//!
//! The line lies on knots repeated p times, where splines are continuous and no more, as the profile is. With
//! `e = 1 − c` the surface energy is `Gc/(4 l0) eᵀ (M + 4 l0² D) e` on the matrices of the phase field.

use fisura::particles::lattice::Lattice;
use fisura::scene::{Mass, Mesh};
use fisura::splines::patch::Patch;

use super::crack_cost::cracked;
use super::patches::open;
use super::{Case, CaseScene, Findings, StudyError, exact};
use crate::extremes::largest;
use crate::scene::plain::PlainScene;

/// Half width and height of the body, in l0: exp(−12) of the profile is cut off.
const HALF_WIDTH: usize = 24;
const HEIGHT: f64 = 2.0;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in [2, 3] {
        for per_length in [1, 2] {
            let quantities = [
                ("surface energy of the crack over Gc", exact(1.0, "AT2 in one dimension")),
                ("phase field, largest error at a control line of its knots", None),
            ];
            let variant = format!("p={degree}, h=l0/{per_length}");
            findings.measure(&variant, quantities, || crack(degree, per_length))?;
        }
    }
    Ok(())
}

/// Energy per unit of length over Gc, and the largest error of c at a knot.
fn crack(degree: usize, per_length: usize) -> Result<[f64; 2], StudyError> {
    let half = HALF_WIDTH * per_length;
    let at = |i: usize| (i as f64 - half as f64) / per_length as f64;
    let knots = (0..=2 * half).flat_map(|i| vec![at(i); if i == half { degree } else { 1 }]);
    let x = open(degree, &knots.collect::<Vec<_>>());
    let rows = Mesh::uniform([degree; 2], [0.0; 2], [1.0, HEIGHT], [1, 2]).knots[1].clone();
    let mesh = Mesh::of_knots([degree; 2], [x, rows]);
    let scene = PlainScene { held: vec![], ..PlainScene::unit_bar(mesh, Mass::Lumped) }.scene();
    let patch = Patch::new(&scene.mesh);
    let lattice = Lattice::new(&patch, &scene.bodies[0]);
    let grid = lattice.grid;
    // The one column of control points that decides the field on x = 0.
    let middle = (grid.columns - 1) / 2;
    let held: Vec<usize> = (0..grid.rows).map(|row| grid.index(middle, row)).collect();
    let (phase, energy) = cracked(&lattice, &held, None)?;
    let exact = |x: f64| 1.0 - (-x.abs() / 2.0).exp();
    let error = |i: usize| {
        let value = patch.evaluate(&phase, [at(i), 0.5 * HEIGHT]).map_or(f64::NAN, |v| v.value);
        (value - exact(at(i))).abs()
    };
    Ok([energy / HEIGHT, largest((0..=2 * half).map(error))])
}
