//! What an error of the impact-loaded plate costs: whole runs to 80 µs, from the scene in memory to the last
//! row of the history, in processor time of one thread. Errors are those of the kinetic, elastic and fracture
//! energy, the work and the tip against the reference of the plate, as the cases of the suite measure
//! them. The finite elements themselves run in the same rounds ([`elements`]).
//!
//! Besides equal spans and the tolerance of the suite there is what someone in a hurry would run: longer
//! spans where no crack runs and nearly the critical step (`plate_scene`), a loose tolerance of the phase
//! field, and Gc/kappa ([`fisura::material::mesh_toughness`]). What a tolerance does to the energies is a
//! diagram of its own, against a run with 2e-8.

use std::sync::Arc;

use fisura::Simulation;
use fisura::scene::PhaseFieldInterval;

use super::plate_error::{References, TIGHT_TOLERANCE, difference_of_energies};
use super::plate_scene::{graded, half, refined, with_toughness_of_mesh};
use super::plate_share::share;
use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, pool, round_robin, whole_run};
use super::{BenchError, Settings, elements};
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::scene_run::run_scene;

/// The suite asks for the same closure of the ledger.
const CLOSURE: f64 = 1e-3;

/// Tolerances of the phase field whose effect is shown.
const TOLERANCES: [f64; 5] = [1e-2, 1e-3, 1e-4, 1e-5, 2e-6];
/// Finest mesh for p = 4, length scales: a finer one would take as long as all others together.
const FINEST_QUARTIC: f64 = 1.0;
/// Tolerance of the phase field for someone in a hurry.
const LOOSE_TOLERANCE: f64 = 1e-3;
/// Graded meshes: spans where a crack runs over l0, and how many of them a quick run has.
const GRADED: [f64; 8] = [4.0, 2.8, 2.0, 1.4, 1.0, 0.7, 0.5, 0.4];
const QUICK: usize = 5;
/// Finest graded mesh for p = 3.
const FINEST_CUBIC: f64 = 0.5;

/// A way to run the plate with short spans only where a crack runs: on graded meshes or refined so many times
/// along the crack, with the loose tolerance or that of the suite, with Gc or Gc/kappa, and with a solve of
/// the phase field in every step, or in every second or third one.
#[derive(Debug, Clone, Copy)]
struct Way {
    degree: usize,
    refined: usize,
    loose: bool,
    corrected: bool,
    interval: usize,
}

const WAYS: [Way; 11] = [
    Way { degree: 2, refined: 0, loose: true, corrected: false, interval: 2 },
    Way { degree: 2, refined: 0, loose: true, corrected: true, interval: 1 },
    Way { degree: 2, refined: 0, loose: true, corrected: true, interval: 2 },
    Way { degree: 2, refined: 0, loose: true, corrected: true, interval: 3 },
    Way { degree: 2, refined: 0, loose: false, corrected: true, interval: 2 },
    Way { degree: 3, refined: 0, loose: true, corrected: true, interval: 2 },
    Way { degree: 3, refined: 0, loose: false, corrected: true, interval: 2 },
    Way { degree: 2, refined: 1, loose: true, corrected: true, interval: 1 },
    Way { degree: 2, refined: 1, loose: true, corrected: true, interval: 2 },
    Way { degree: 2, refined: 2, loose: true, corrected: true, interval: 1 },
    Way { degree: 2, refined: 2, loose: true, corrected: true, interval: 2 },
];

impl Way {
    fn scene(self, settings: &Settings, h: f64) -> Result<CaseScene, BenchError> {
        let mut case = match self.refined {
            0 => graded(settings, self.degree, h)?,
            halvings => refined(settings, self.degree, h, halvings)?,
        };
        case.scene.solver.phase_field_interval = PhaseFieldInterval::Steps(self.interval);
        if self.loose {
            case.scene.solver.phase_field_tolerance = LOOSE_TOLERANCE;
        }
        if self.corrected {
            with_toughness_of_mesh(&mut case)?;
        }
        Ok(case)
    }

    /// Id and label of its run of a scene.
    fn names(self, case: &CaseScene, h: f64) -> (String, String) {
        let [name, toughness] = if self.corrected { ["kappa", "Gc/κ"] } else { ["gc", "Gc"] };
        let Self { degree, interval, refined, .. } = self;
        let [mark, mesh] = if refined > 0 {
            [format!("-r{refined}"), format!("refined {refined}×")]
        } else {
            ["", "graded"].map(String::from)
        };
        let tolerance = case.scene.solver.phase_field_tolerance;
        let id = format!("plate/graded/p{degree}-{name}-{tolerance:e}-m{interval}{mark}/h{h}");
        (id, format!("fisura, p = {degree}, {mesh}, {toughness}, {tolerance:e}, m = {interval}"))
    }

    fn meshes(self, quick: bool) -> impl Iterator<Item = f64> {
        let all = if quick { &GRADED[..QUICK] } else { &GRADED[..] };
        all.iter().copied().filter(move |h| self.degree < 3 || *h >= FINEST_CUBIC)
    }
}

/// Runs the half plate on its meshes.
///
/// # Errors
/// If a case or the reference is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let library = settings.library()?;
    let references = Arc::new(References::of(&library)?);
    let elements = settings.elements.get_or_init(|| elements::build(&settings.workspace));
    pool(1)?.install(|| {
        let mut contestants = equal_spans(settings, &references)?;
        for way in WAYS {
            for h in way.meshes(settings.quick) {
                let case = way.scene(settings, h)?;
                let names = way.names(&case, h);
                contestants.push(plate(case, names, h, against(&references))?);
            }
        }
        if let Ok(built) = elements {
            contestants.extend(elements::contestants(settings, built, &references));
        }
        contestants.extend(tolerances(settings, if settings.quick { 2.0 } else { 1.0 })?);
        let mut records = round_robin(contestants, if settings.quick { 1 } else { 3 }, settings.budget())?;
        records.extend(share(settings)?);
        Ok(records)
    })
}

/// Errors of a history against the reference of the plate.
fn against<'a>(references: &Arc<References<'a>>) -> impl Fn(&Table, f64) -> Option<Vec<AnswerError>> + use<'a> {
    let references = Arc::clone(references);
    move |history, factor| references.errors_of_history(history, factor)
}

/// Equal spans and the tolerance of the suite: what a degree does.
fn equal_spans<'a>(settings: &Settings, references: &Arc<References<'a>>) -> Result<Vec<Contestant<'a>>, BenchError> {
    let meshes: &[f64] = if settings.quick { &[2.0, 1.0] } else { &[2.0, 1.0, 0.5] };
    let degrees = if settings.quick { 2..=3 } else { 1..=4 };
    let runs = degrees.flat_map(|degree| meshes.iter().map(move |&h| (degree, h)));
    let runs = runs.filter(|&(degree, h)| degree < 4 || h >= FINEST_QUARTIC);
    let contestant = |(degree, h): (usize, f64)| {
        let names = (format!("plate/equal/p{degree}/h{h}"), format!("fisura, p = {degree}, equal spans"));
        plate(half(settings, degree, h)?, names, h, against(references))
    };
    runs.map(contestant).collect()
}

/// The half plate with looser and looser tolerances of the phase field, p = 2.
fn tolerances<'a>(settings: &Settings, h: f64) -> Result<Vec<Contestant<'a>>, BenchError> {
    let with = |tolerance: f64| {
        let mut case = half(settings, 2, h)?;
        case.scene.solver.phase_field_tolerance = tolerance;
        Ok::<_, BenchError>(case)
    };
    let tight = run_scene(&with(TIGHT_TOLERANCE)?.scene, &mut |_| {}, &mut |_, _| {});
    if let Some(breakdown) = tight.breakdown {
        return Err(breakdown.into());
    }
    let tight = Arc::new(tight.history);
    let contestant = |tolerance: f64| {
        let tight = Arc::clone(&tight);
        let name = (format!("plate/tolerance/{tolerance:e}"), format!("p = 2, h = {h} l0"));
        plate(with(tolerance)?, name, h, move |history, _| Some(vec![difference_of_energies(history, &tight)?]))
    };
    TOLERANCES.into_iter().map(contestant).collect()
}

fn plate<'a>(
    case: CaseScene,
    (id, label): (String, String),
    h: f64,
    errors: impl Fn(&Table, f64) -> Option<Vec<AnswerError>> + 'a,
) -> Result<Contestant<'a>, BenchError> {
    let prepared = Simulation::new(&case.scene)?;
    let (extent, steps) = (prepared.extent(), prepared.plan().steps());
    drop(prepared);
    let record = BenchRecord::of_steps(id, label, &extent, steps)
        .with("degree", case.scene.mesh.degree[0])
        .with("h_over_l0", h)
        .with("tolerance", case.scene.solver.phase_field_tolerance);
    let factor = case.energy_factor;
    let answer = move |record: &mut BenchRecord, history: &Table| record.note_errors(errors(history, factor));
    Ok(whole_run(record, case.scene, CLOSURE, answer))
}
