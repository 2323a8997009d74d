//! The state at which a run broke down: `breakdown.json`. Numbers that are not finite are null.

use fisura::dynamics::energy::Sample;
use fisura::output::inspection::{Inspection, PointState};
use fisura::simulation::Simulation;
use fisura::simulation::breakdown::Breakdown;
use serde::{Deserialize, Serialize};

/// Content of `breakdown.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BreakdownReport {
    /// Step at which it was found.
    pub step: usize,
    /// Simulated time at which it was found, s.
    pub time_s: f64,
    /// Position `[x, y]` at which the run broke down, m.
    pub place_m: [Option<f64>; 2],
    /// Number of the point there, in its body, where a point stands for the place.
    pub point: Option<usize>,
    /// Description of the failure in words.
    pub what: String,
    /// Likely cause and remedy.
    pub likely_cause: String,
    /// Row of the history at that moment, by column: energies, momenta, closure. Absent if the run never
    /// started.
    pub row: Option<serde_json::Map<String, serde_json::Value>>,
    /// Material points, and how many carry a number that is not finite.
    pub points: Option<usize>,
    /// Number of material points that carry a number that is not finite.
    pub points_not_finite: Option<usize>,
    /// Extremes of finite numbers.
    pub extremes: Option<Extremes>,
    /// The worst points, the worst first: those with numbers that are not finite, then those of largest
    /// strain.
    pub worst_points: Vec<WorstPoint>,
    /// Time of the last checkpoint, s: the state before the numbers broke, if one was written.
    pub last_checkpoint_s: Option<f64>,
}

/// Extremes of finite numbers at the control points and material points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Extremes {
    /// Speed of the fastest control point, m/s.
    pub largest_speed_m_per_s: Option<f64>,
    /// Position `[x, y]` of the fastest control point, m.
    pub fastest_m: [Option<f64>; 2],
    /// Largest magnitude of a strain component.
    pub largest_strain: Option<f64>,
    /// Largest magnitude of a stress component, Pa.
    pub largest_stress_pa: Option<f64>,
    /// Largest history energy, J/m³.
    pub largest_history_j_per_m3: Option<f64>,
    /// Smallest and largest phase field.
    pub phase_field: Option<[Option<f64>; 2]>,
}

/// What a point carries.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct WorstPoint {
    /// Number of the body among those that deform.
    pub body: usize,
    /// Number of the point in it.
    pub point: usize,
    /// Position, m; that at t = 0 in the total frame.
    pub position_m: [Option<f64>; 2],
    /// Strain `[xx, yy, xy]`.
    pub strain: [Option<f64>; 3],
    /// Stress `[xx, yy, xy]`, Pa.
    pub stress_pa: [Option<f64>; 3],
    /// History energy, J/m³.
    pub history_j_per_m3: Option<f64>,
    /// Phase field at the point; absent if its body does not fracture or the value is not finite.
    pub phase_field: Option<f64>,
}

impl BreakdownReport {
    /// Of a run that broke down, `simulation` as it stands then, if it ever started.
    pub(super) fn new(breakdown: &Breakdown, simulation: Option<&Simulation>, last_checkpoint_s: Option<f64>) -> Self {
        let inspection = simulation.map(Simulation::inspect);
        let inspection = inspection.as_ref();
        Self {
            step: breakdown.step,
            time_s: breakdown.time,
            place_m: breakdown.place.map(finite),
            point: breakdown.point,
            what: breakdown.what.clone(),
            likely_cause: breakdown.cause.clone(),
            row: simulation.map(|simulation| row(&simulation.sample())),
            points: inspection.map(|i| i.points),
            points_not_finite: inspection.map(|i| i.not_finite),
            extremes: inspection.map(Extremes::from),
            worst_points: inspection.map_or_else(Vec::new, |i| i.worst.iter().map(WorstPoint::from).collect()),
            last_checkpoint_s,
        }
    }
}

impl From<&Inspection> for Extremes {
    fn from(found: &Inspection) -> Self {
        Self {
            largest_speed_m_per_s: finite(found.fastest.1),
            fastest_m: found.fastest.0.map(finite),
            largest_strain: finite(found.largest_strain),
            largest_stress_pa: finite(found.largest_stress),
            largest_history_j_per_m3: found.fracture.and_then(|f| finite(f.largest_history)),
            phase_field: found.fracture.map(|f| [f.least_phase, f.largest_phase].map(finite)),
        }
    }
}

impl From<&PointState> for WorstPoint {
    fn from(state: &PointState) -> Self {
        Self {
            body: state.body,
            point: state.point,
            position_m: state.position.map(finite),
            strain: state.strain.map(finite),
            stress_pa: state.stress.map(finite),
            history_j_per_m3: state.fracture.and_then(|f| finite(f.history)),
            phase_field: state.fracture.and_then(|f| finite(f.phase)),
        }
    }
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}

fn row(sample: &Sample) -> serde_json::Map<String, serde_json::Value> {
    sample.named_values().into_iter().map(|(name, value)| (name.to_string(), value.into())).collect()
}
