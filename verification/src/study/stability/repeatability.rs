//! Runs that have to be the same: with any number of threads and after checkpoints bit for bit, and mirror
//! images in symmetric scenes.
//!
//! Sums are cut by data and added in a fixed order. A mirror image adds the same numbers in another order, so
//! symmetry holds to round-off, which a linear run does not amplify, and not bit for bit.

use fisura::Simulation;
use fisura::scene::{
    Boundary, Crack, Fracture, Frame, Material, Mesh, PhaseFieldSolver, Scene, Side, TimeFactor, Traction,
};

use crate::extremes::{larger, largest};
use crate::scene::plain::PlainScene;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other};
use crate::watch;

/// Numbers of threads that are compared with one.
const THREADS: [usize; 2] = [2, 5];

pub(in super::super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for (name, frame) in [("total frame", Frame::Total), ("updated frame", Frame::Updated)] {
        let scene = notched(frame);
        let one = findings.compute(|| on_threads(1, &scene))?.unwrap_or_default();
        let differing = |other: Result<Vec<u64>, StudyError>| {
            let other = other?;
            Ok([(one.iter().zip(&other).filter(|(a, b)| a != b).count() + one.len().abs_diff(other.len())) as f64])
        };
        let quantity = ("numbers that differ after a checkpoint", exact(0.0, "the whole state is stored"));
        findings.measure(name, [quantity], || differing(numbers(&scene, true)))?;
        for threads in THREADS {
            let quantity = ("numbers that differ from those of one thread", exact(0.0, "fixed sums"));
            let variant = format!("{name}, {threads} threads");
            findings.measure(&variant, [quantity], || differing(on_threads(threads, &scene)))?;
        }
    }
    for degree in 1..=3 {
        let words = "mirror images, largest difference of displacements over the largest";
        let quantity = (words, exact(0.0, "the scene is its own mirror image"));
        findings.measure(&format!("p={degree}"), [quantity], || Ok([asymmetry(&symmetric(degree))?]))?;
    }
    Ok(())
}

fn glass(cells: [usize; 2], degree: usize, fracture: Option<Fracture>) -> Scene {
    let material = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture };
    PlainScene::free(Mesh::uniform([degree; 2], [0.0; 2], [8e-3, 4e-3], cells), material, degree + 1).scene()
}

/// A plate with a crack, pulled apart.
fn notched(frame: Frame) -> Scene {
    let fracture = Fracture::at2(3.0, 0.25e-3);
    let mut scene = glass([32, 40], 2, Some(fracture));
    scene.solver.phase_field_solver = PhaseFieldSolver::ConjugateGradients;
    scene.solver.phase_field_tolerance = 1e-8;
    scene.analysis.frame = frame;
    scene.analysis.end_time = 0.5e-6;
    scene.output.samples = 4;
    let pull = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::default());
    scene.bodies[0].tractions = vec![pull(Side::Top, 6e6), pull(Side::Bottom, -6e6)];
    scene.bodies[0].cracks = vec![Crack::seed([0.0, 2e-3], [4e-3, 2e-3])];
    if frame == Frame::Updated {
        // Room to move, with the body off the edges of the mesh.
        scene.mesh = Mesh::uniform([2; 2], [-1e-3; 2], [10e-3, 6e-3], [40, 60]);
    }
    scene
}

/// Every number of every sample of a run on some threads, as bits.
fn on_threads(threads: usize, scene: &Scene) -> Result<Vec<u64>, StudyError> {
    let pool = watch::pool(threads);
    let pool = pool.map_err(|e| other(format!("{threads} threads cannot be started: {e}")))?;
    pool.install(|| numbers(scene, false))
}

/// The same numbers of a run, which may be stored at every sample and taken up again.
fn numbers(scene: &Scene, interrupted: bool) -> Result<Vec<u64>, StudyError> {
    let mut simulation = Simulation::new(scene)?;
    let mut bits = Vec::new();
    while !simulation.finished() {
        watch::check()?;
        let sample = simulation.advance_to_next_sample()?;
        bits.extend(sample.named_values().into_iter().map(|(_, value)| value.to_bits()));
        if interrupted {
            let state = simulation.checkpoint().map_err(other)?;
            simulation = Simulation::resume(scene, &state).map_err(other)?;
        }
    }
    Ok(bits)
}

/// A plate pulled at both ends.
fn symmetric(degree: usize) -> Scene {
    let mut scene = glass([16, 8], degree, None);
    scene.analysis.end_time = 2e-5;
    let pull = |side, stress| Traction::on(side, [stress, 0.0], TimeFactor::default());
    scene.bodies[0].tractions = vec![pull(Side::Left, -1e6), pull(Side::Right, 1e6)];
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [false, true])];
    scene
}

/// Largest difference of a displacement from its mirror image over the largest displacement.
fn asymmetry(scene: &Scene) -> Result<f64, StudyError> {
    let mut simulation = Simulation::new(scene)?;
    let mut worst = 0.0_f64;
    while !simulation.finished() {
        watch::check()?;
        simulation.advance_to_next_sample()?;
        let frame = simulation.total_frame().ok_or_else(|| other("not the total frame"))?;
        let ([x, y], grid) = (&frame.displacement, frame.lattice.grid);
        let mirrored = |at: usize| grid.index(grid.columns - 1 - grid.column_of(at), grid.row_of(at));
        let off = grid.indices().flat_map(|at| [(x[at] + x[mirrored(at)]).abs(), (y[at] - y[mirrored(at)]).abs()]);
        worst = larger(worst, largest(off) / largest(x.iter().chain(y).map(|u| u.abs())));
    }
    Ok(worst)
}
