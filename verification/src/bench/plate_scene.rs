//! The half plate of the cases on meshes of any span.

use fisura::material::mesh_toughness::slope;
use fisura::scene::{CrackKind, CrackModel, Mesh, Side};

use super::{BenchError, Settings};
use crate::case::expand::CaseScene;
use crate::extremes::larger;
use crate::study::patches;
use crate::study::scene::length_scale;

/// Where the short spans begin in x and end in y for someone in a hurry, m: the crack starts at x = 50 mm and
/// is 14.3 mm off the axis at the right edge.
const SHORT_SPANS: [f64; 2] = [44e-3, 36e-3];
/// Where spans of four times their length end in x, m.
const LONGEST_SPANS: f64 = 36e-3;
/// Half width of the seed in spans, at least l0: the faces of a narrower one hold together.
const SEED_SPANS: f64 = 2.0;
/// Step over the critical one, and rows of the history: one every microsecond.
const SAFETY: f64 = 0.96;
const SAMPLES: usize = 80;

/// The half plate of the cases with square spans of `h` length scales, a seed that opens freely, as many
/// Gauss points per direction as the degree but at least two, without pictures.
///
/// # Errors
/// If the case is missing or wrong.
pub fn half(settings: &Settings, degree: usize, h: f64) -> Result<CaseScene, BenchError> {
    let [columns, rows] = cells(h);
    let cells = format!("mesh.cells=[{columns}, {rows}]");
    let points = degree.max(2);
    let points = format!("body.0.particles_per_cell=[{points}, {points}]");
    let overrides = [cells, points, format!("mesh.degree={degree}"), "output.frames=[]".to_string()];
    let mut case = settings.scene("plate/half-p2-h1", &overrides)?;
    let l0 = length_scale(&case.scene).unwrap_or(f64::NAN);
    for crack in case.scene.bodies.iter_mut().flat_map(|body| &mut body.cracks) {
        crack.kind = CrackKind::Seed(Some(larger(1.0, SEED_SPANS * h) * l0));
    }
    Ok(case)
}

/// Square spans of `h` length scales on the half plate.
fn cells(h: f64) -> [usize; 2] {
    [400.0, 80.0].map(|n| (n / h).round() as usize)
}

/// The same as someone in a hurry would run it: with spans of twice and four times `h` where no crack runs,
/// nearly the critical step, which the span at the right side is long enough for, and samples that leave room
/// for that.
///
/// # Errors
/// As [`half`].
pub fn graded(settings: &Settings, degree: usize, h: f64) -> Result<CaseScene, BenchError> {
    let mut case = half(settings, degree, h)?;
    let span = h * length_scale(&case.scene).unwrap_or(f64::NAN);
    let (low, high) = (case.scene.mesh.origin(), case.scene.mesh.end());
    let parts = [
        &[
            (low[0], LONGEST_SPANS, 4.0 * span),
            (LONGEST_SPANS, SHORT_SPANS[0], 2.0 * span),
            (SHORT_SPANS[0], high[0], span),
        ][..],
        &[(low[1], SHORT_SPANS[1], span), (SHORT_SPANS[1], high[1], 2.0 * span)],
    ];
    case.scene.mesh.knots = parts.map(|parts| open_knots(degree, parts));
    in_a_hurry(&mut case);
    Ok(case)
}

/// The same with equal spans that are halved so many times along the crack, to `h` length scales.
///
/// # Errors
/// As [`half`].
pub fn refined(settings: &Settings, degree: usize, h: f64, halvings: usize) -> Result<CaseScene, BenchError> {
    let mut case = half(settings, degree, h)?;
    let (low, high) = (case.scene.mesh.origin(), case.scene.mesh.end());
    let cells = cells(h * 2f64.powi(halvings as i32));
    let coarse = Mesh::uniform([degree; 2], low, [0, 1].map(|d| high[d] - low[d]), cells);
    case.scene.mesh = Mesh { halvings, ..coarse };
    in_a_hurry(&mut case);
    Ok(case)
}

fn in_a_hurry(case: &mut CaseScene) {
    case.scene.mesh.lengthen_end(Side::Right);
    (case.scene.analysis.safety, case.scene.output.samples) = (SAFETY, SAMPLES);
}

/// Gives the scene Gc over what a crack costs on its mesh ([`slope`]).
///
/// # Errors
/// If that is not known of the degree and the points of the scene.
pub fn with_toughness_of_mesh(case: &mut CaseScene) -> Result<(), BenchError> {
    let (degree, points) = (case.scene.mesh.degree[0], case.scene.bodies[0].particles_per_cell[0]);
    let unknown = || format!("the surface energy of a crack with p = {degree} and {points} points is unknown");
    slope(CrackModel::At2, degree, points).ok_or_else(|| BenchError::input(unknown()))?;
    let fractures = case.scene.materials.values_mut().filter_map(|material| material.fracture.as_mut());
    fractures.for_each(|fracture| fracture.mesh_toughness = true);
    Ok(())
}

/// Open knots with spans of about the given length in each part `(from, to, length)`.
pub fn open_knots(degree: usize, parts: &[(f64, f64, f64)]) -> Vec<f64> {
    let ends = parts.iter().flat_map(|&(from, to, length)| {
        let spans = ((to - from) / length).round();
        (0..spans as usize).map(move |i| from + (to - from) * (i as f64 / spans))
    });
    let last = parts[parts.len() - 1].1;
    patches::open(degree, &ends.chain([last]).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_half_plate_has_spans_of_the_size_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let out = crate::output::OutputFolder::open(folder.path(), "bench").unwrap();
        let settings = Settings {
            quick: true,
            threads: 1,
            workspace: crate::bench::own_workspace(),
            out: &out,
            baseline: None,
            peer: None,
            peer_timeout: std::time::Duration::ZERO,
            families: vec![],
            elements: Default::default(),
        };
        let case = half(&settings, 3, 2.0).unwrap();
        let spans = case.scene.mesh.knots.each_ref().map(|knots| knots.len() - 7);
        assert_eq!((spans, case.energy_factor, case.scene.output.frames.len()), ([200, 40], 2.0, 0));
        let coarsest = refined(&settings, 2, 4.0, 2).unwrap();
        assert!(fisura::Simulation::new(&coarsest.scene).is_ok(), "16 l0, halved twice");
        let mut case = graded(&settings, 2, 1.0).unwrap();
        with_toughness_of_mesh(&mut case).unwrap();
        assert!(case.scene.materials["glass"].fracture.as_ref().unwrap().mesh_toughness);
        case.scene.mesh.degree = [4; 2];
        assert!(with_toughness_of_mesh(&mut case).is_err());
        let knots = &case.scene.mesh.knots;
        let spans = knots.each_ref().map(|knots| knots.windows(2).map(|k| k[1] - k[0]).filter(|d| *d > 0.0));
        for ((spans, count), length) in spans.into_iter().zip([36 + 16 + 223, 64 + 8]).zip([0.1, 0.02]) {
            let spans: Vec<f64> = spans.collect();
            assert!((spans.iter().sum::<f64>() - length).abs() < 1e-15 && spans.len() == count);
            let is_length = |d: &f64| [0.25e-3, 0.5e-3, 1e-3].iter().any(|l| (d / l - 1.0).abs() < 1e-9);
            assert!(spans.iter().all(is_length));
        }
    }
}
