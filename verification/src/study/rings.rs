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
pub(super) use sweep::{offers as sweep_offers, study as sweep};

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
        let rings: Vec<Watch> = (0..scene.bodies.len()).filter_map(|body| Watch::new(scene, body)).collect();
        if rings.is_empty() {
            return Err(no_ring());
        }
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

pub(super) fn offers(_case: &Case, scenes: &[CaseScene]) -> super::Offered {
    let bare = &[
        "largest closure over the initial kinetic energy",
        "largest fall of the fracture energy over its end",
        "largest fall of the friction work over the initial kinetic energy",
        "contact loss over the initial kinetic energy",
        "broken material aside the diameter at the end",
        "fracture energy at the end, J",
    ];
    let both = [
        "drift of the momentum over that of a ring",
        "asymmetry of the elastic energies before the first crack",
        "asymmetry of the damage at the end",
        "event times of the rings apart",
    ];
    let mut offers = super::Offers::of_scenes(scenes, &[], bare);
    for CaseScene { name, scene, .. } in scenes {
        let rings = (0..scene.bodies.len()).filter_map(|body| Watch::new(scene, body)).count();
        if rings == 0 {
            return Err(no_ring());
        }
        for (quantity, paper) in EVENTS.iter().zip(PAPER) {
            offers.push(name, quantity, "us", paper.is_some());
        }
        if rings == 2 {
            offers.bare(name, both);
        }
    }
    Ok(offers)
}

fn no_ring() -> StudyError {
    other("no body is a brittle ring")
}

/// Events and invariants of every scene of a case.
pub(super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    for (index, case_scene) in scenes.iter().enumerate() {
        let CaseScene { name, scene, .. } = case_scene;
        let watched = Watched::run(scene)?;
        add_events(&mut findings, name, &watched.rings[0]);
        add_invariants(&mut findings, name, scene, &watched);
        if index == 0 {
            figures::add(&mut findings, case, case_scene, &watched);
        }
        findings.series.push((series_stem(case, name), watched.rings[0].table.clone()));
    }
    Ok(findings)
}

fn in_microseconds(variant: &str, quantity: &str, time: Option<f64>, reference: Option<Reference>) -> Measurement {
    Measurement {
        variant: variant.to_string(),
        quantity: quantity.to_string(),
        unit: "us".to_string(),
        value: Some(1e6 * time.unwrap_or(f64::NAN)),
        reference,
    }
}

fn add_events(findings: &mut Findings, variant: &str, watch: &Watch) {
    for ((quantity, found), paper) in EVENTS.iter().zip(watch.events()).zip(PAPER) {
        let source = "the words of the paper, section 5.2; the geometry is assumed";
        let reference = paper.map(|time| Reference::new(Some(1e6 * time), ReferenceKind::Literature, source));
        findings.measurements.push(in_microseconds(variant, quantity, found, reference));
    }
}

fn add_invariants(findings: &mut Findings, variant: &str, scene: &Scene, watched: &Watched) {
    let table = &watched.rings[0].table;
    let column = |name: &str| table.column(name).unwrap_or_default();
    let last = |name: &str| column(name).last().copied().unwrap_or(f64::NAN);
    let initial = column("kinetic_j")[0];
    let size = |name: &str| largest(column(name).iter().map(|value| value.abs()));
    let fall = |name: &str| largest(column(name).windows(2).map(|pair| pair[0] - pair[1]));
    let mut add = |quantity: &str, value: f64| findings.add(variant, quantity, value, None);
    add("largest closure over the initial kinetic energy", size("closure_j") / initial);
    add("largest fall of the fracture energy over its end", fall("fracture_j") / last("fracture_j"));
    add("largest fall of the friction work over the initial kinetic energy", fall("friction_j") / initial);
    add("contact loss over the initial kinetic energy", last("contact_loss_j") / initial);
    add("broken material aside the diameter at the end", last("broken_aside"));
    add("fracture energy at the end, J", last("fracture_j"));
    if let [left, right] = &watched.rings[..] {
        let [x, y] = scene.bodies[0].velocity;
        let of_one = initial / x.hypot(y); // m v, and all kinetic energy is 2 · ½ m v²
        let drift = |name: &str| largest(column(name).iter().map(|p| (p - column(name)[0]).abs()));
        add("drift of the momentum over that of a ring", larger(drift("momentum_x"), drift("momentum_y")) / of_one);
        let intact = column("elastic_asymmetry").iter().zip(column("min_phase_field")).filter(|(_, c)| **c > CRACKED);
        add("asymmetry of the elastic energies before the first crack", largest(intact.map(|(a, _)| a.abs())));
        add("asymmetry of the damage at the end", last("fracture_asymmetry").abs());
        let apart = left.events().into_iter().zip(right.events()).map(|(a, b)| match (a, b) {
            (Some(a), Some(b)) => (a - b).abs() / a,
            (None, None) => 0.0,
            _ => f64::NAN,
        });
        add("event times of the rings apart", largest(apart));
    }
}
