//! Two rings in head-on collision: the events of every scene of a case.

pub mod events;
mod figures;
mod sweep;

use fisura::Simulation;
use fisura::output::picture::Picture;
use fisura::scene::Scene;
use fisura::simulation::square_pixels;

use super::scene::series_stem;
use super::{Case, CaseScene, Findings, Measurement, StudyError, other};
use crate::extremes::{larger, largest};
use crate::record::{Reference, ReferenceKind};
use crate::scene_run::frame_steps;
use crate::study::rings::events::{EVENTS, Watch};
pub(super) use sweep::study as sweep;

/// Times (s) of the events in the paper's words; the end of the crack through the rear wall is not among
/// them.
pub const PAPER: [Option<f64>; 6] = [Some(30e-6), Some(60e-6), Some(100e-6), None, Some(150e-6), Some(400e-6)];
/// Phase field below which the first crack has formed.
const CRACKED: f64 = 0.05;
/// Pixels of a picture along its longer side.
const PIXELS: usize = 300;

/// A scene run to its end, and what was seen.
struct Watched {
    /// The rings, in the order of the bodies.
    rings: Vec<Watch>,
    pictures: Vec<Picture>,
    particles: usize,
    step: f64,
    steps: usize,
}

impl Watched {
    fn run(scene: &Scene) -> Result<Self, StudyError> {
        let rings = rings(scene)?;
        let mut simulation = Simulation::new(scene)?;
        let (particles, plan) = (simulation.extent().particles, *simulation.plan());
        let (frames, _) = frame_steps(&scene.output.frames, plan.step, plan.steps());
        let mut watched = Self { rings, pictures: Vec::new(), particles, step: plan.step, steps: plan.steps() };
        loop {
            crate::watch::check()?;
            if frames.contains(&simulation.steps()) {
                let (low, high) = (scene.mesh.origin(), scene.mesh.end());
                let pixels = square_pixels([0, 1].map(|d| high[d] - low[d]), PIXELS);
                watched.pictures.push(simulation.picture(pixels));
            }
            if simulation.steps().is_multiple_of(plan.steps_per_sample) {
                let sample = simulation.sample();
                simulation.watch_ledger(&sample)?;
                Watch::look(&mut watched.rings, &simulation, &sample);
            }
            if simulation.finished() {
                return Ok(watched);
            }
            simulation.step()?;
        }
    }
}

/// The rings of a scene.
fn rings(scene: &Scene) -> Result<Vec<Watch>, StudyError> {
    let rings: Vec<Watch> = (0..scene.bodies.len()).filter_map(|body| Watch::new(scene, body)).collect();
    if rings.is_empty() { Err(other("no body is a brittle ring")) } else { Ok(rings) }
}

/// Events and invariants of every scene of a case.
pub(super) fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for (index, case_scene) in scenes.iter().enumerate() {
        let CaseScene { name, scene, .. } = case_scene;
        let count = rings(scene)?.len();
        let watched = findings.compute(|| Watched::run(scene))?;
        let events = watched.as_ref().map(|watched| watched.rings[0].events());
        for (index, (quantity, paper)) in EVENTS.iter().zip(PAPER).enumerate() {
            let source = "the words of the paper, section 5.2; the geometry is assumed";
            let reference = paper.map(|time| Reference::new(Some(1e6 * time), ReferenceKind::Literature, source));
            let found = events.map(|events| 1e6 * events[index].unwrap_or(f64::NAN));
            findings.measurements.push(in_microseconds(name, quantity, found, reference));
        }
        findings.add_all(name, INVARIANTS.map(|quantity| (quantity, None)), watched.as_ref().map(invariants));
        if count == 2 {
            let differences = watched.as_ref().map(|watched| differences(scene, watched));
            findings.add_all(name, DIFFERENCES.map(|quantity| (quantity, None)), differences);
        }
        if let Some(watched) = &watched {
            if index == 0 {
                figures::add(findings, case, case_scene, watched);
            }
            findings.series.push((series_stem(case, name), watched.rings[0].table.clone()));
        }
    }
    Ok(())
}

fn in_microseconds(variant: &str, quantity: &str, value: Option<f64>, reference: Option<Reference>) -> Measurement {
    Measurement::new([variant, quantity, "us"], value, reference)
}

const INVARIANTS: [&str; 6] = [
    "largest closure over the initial kinetic energy",
    "largest fall of the fracture energy over its end",
    "largest fall of the friction work over the initial kinetic energy",
    "contact loss over the initial kinetic energy",
    "broken material aside the diameter at the end",
    "fracture energy at the end, J",
];

/// Numbers of the ledger, which hold whatever the geometry is.
fn invariants(watched: &Watched) -> [f64; 6] {
    let column = |name: &str| watched.rings[0].table.column(name).unwrap_or_default();
    let last = |name: &str| column(name).last().copied().unwrap_or(f64::NAN);
    let initial = column("kinetic_j")[0];
    let fall = |name: &str| largest(column(name).windows(2).map(|pair| pair[0] - pair[1]));
    [
        largest(column("closure_j").iter().map(|value| value.abs())) / initial,
        fall("fracture_j") / last("fracture_j"),
        fall("friction_j") / initial,
        last("contact_loss_j") / initial,
        last("broken_aside"),
        last("fracture_j"),
    ]
}

const DIFFERENCES: [&str; 4] = [
    "drift of the momentum over that of a ring",
    "asymmetry of the elastic energies before the first crack",
    "asymmetry of the damage at the end",
    "event times of the rings apart",
];

/// How far two rings are from each other's mirror image.
fn differences(scene: &Scene, watched: &Watched) -> [f64; 4] {
    let [left, right] = &watched.rings[..] else { return [f64::NAN; 4] };
    let column = |name: &str| left.table.column(name).unwrap_or_default();
    let [x, y] = scene.bodies[0].velocity;
    let of_one = column("kinetic_j")[0] / x.hypot(y); // m v, and all kinetic energy is 2 · ½ m v²
    let drift = |name: &str| largest(column(name).iter().map(|p| (p - column(name)[0]).abs()));
    let intact = column("elastic_asymmetry").iter().zip(column("min_phase_field")).filter(|(_, c)| **c > CRACKED);
    let apart = left.events().into_iter().zip(right.events()).map(|(a, b)| match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() / a,
        (None, None) => 0.0,
        _ => f64::NAN,
    });
    [
        larger(drift("momentum_x"), drift("momentum_y")) / of_one,
        largest(intact.map(|(a, _)| a.abs())),
        column("fracture_asymmetry").last().map_or(f64::NAN, |damage| damage.abs()),
        largest(apart),
    ]
}
