//! What a run modelled and what it cost: `summary.json`.

use std::collections::BTreeMap;

use fisura::phase_field::PhaseFieldCounts;
use fisura::simulation::Simulation;
use fisura::simulation::breakdown::Breakdown;
use serde::{Deserialize, Serialize};

use crate::output::history::Table;

/// Content of `summary.json`. Counts are zero and the step is absent if the run broke down before it started.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Title of the scene.
    pub title: String,
    /// Models of the scene, such as `momentum` and `phase field`.
    pub models: Vec<String>,
    /// Number of material points.
    pub particles: usize,
    /// Control points with mass.
    pub control_points: usize,
    /// Number of time steps taken.
    pub steps: usize,
    /// Steps the run was to take.
    pub planned_steps: usize,
    /// Time step that the run was planned with, s.
    pub time_step_s: Option<f64>,
    /// Critical step of the undamaged body, s; absent if nothing can move.
    pub critical_step_s: Option<f64>,
    /// Systems of the phase field and their iterations; absent without a phase field.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub phase_field: Option<PhaseFieldCounts>,
    /// Wall time in all, s.
    pub wall_s: f64,
    /// Wall time per stage, s.
    pub stages_s: Stages,
    /// Wall time of the steps per particle and step, ns; absent without a step.
    pub ns_per_particle_step: Option<f64>,
    /// Largest memory the process held until the end of the run, 10⁶ bytes; absent where the system does not
    /// tell.
    pub peak_memory_mb: Option<f64>,
    /// Energies of the last row of the history by column, J; those that are no number are left out.
    pub final_energies_j: BTreeMap<String, f64>,
    /// Largest magnitude of the closure over the largest energy, over all rows.
    pub largest_closure_over_largest_energy: f64,
    /// Warnings for people.
    pub warnings: Vec<String>,
    /// How the run ended, if not as planned.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub breakdown: Option<BreakdownSummary>,
}

/// Wall time per stage, s.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Stages {
    /// Points, shape functions, critical step, initial phase field.
    pub preparation: f64,
    /// All time steps, without the samples and pictures between them.
    pub steps: f64,
    /// Rows of the history.
    pub samples: f64,
    /// Pictures of the frames, and files for ParaView.
    pub pictures: f64,
}

/// A [`Breakdown`] as it stands in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BreakdownSummary {
    /// Step at which it was found.
    pub step: usize,
    /// Simulated time at which it was found, s.
    pub time_s: f64,
    /// Position `[x, y]` at which the run broke down, m.
    pub place_m: [f64; 2],
    /// Number of the point there, in its body, where a point stands for the place.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub point: Option<usize>,
    /// Description of the failure in words.
    pub what: String,
    /// Likely cause and remedy.
    pub likely_cause: String,
}

impl Summary {
    /// What is modelled, how large it is, how far it came, and what the solver warned of.
    pub(super) fn describe(&mut self, simulation: &Simulation) {
        let (extent, plan) = (simulation.extent(), simulation.plan());
        self.models = extent.models;
        self.particles = extent.particles;
        self.control_points = extent.control_points;
        self.steps = simulation.steps();
        self.planned_steps = plan.steps();
        self.phase_field = Some(simulation.phase_field_counts()).filter(|counts| counts.solves > 0);
        self.time_step_s = Some(plan.step);
        self.critical_step_s = Some(plan.critical).filter(|c| c.is_finite());
        self.warnings.extend(simulation.warnings().iter().cloned());
    }
}

impl From<&Breakdown> for BreakdownSummary {
    fn from(breakdown: &Breakdown) -> Self {
        Self {
            step: breakdown.step,
            time_s: breakdown.time,
            place_m: breakdown.place,
            point: breakdown.point,
            what: breakdown.what.clone(),
            likely_cause: breakdown.cause.clone(),
        }
    }
}

/// Energies (columns `*_j`) of the last row.
pub(super) fn final_energies(history: &Table) -> BTreeMap<String, f64> {
    let columns = history.names.iter().zip(&history.columns).filter(|(name, _)| name.ends_with("_j"));
    let last = columns.filter_map(|(name, column)| Some((name.clone(), *column.last()?)));
    last.filter(|(_, value)| value.is_finite()).collect()
}

/// High-water mark of the resident memory of this process, 10⁶ bytes, where `/proc` tells it.
pub fn peak_memory_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}
