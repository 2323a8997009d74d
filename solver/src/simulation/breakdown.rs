//! A run that broke down, or a scene that does not start: when, where and why.

use thiserror::Error;

use crate::contact::motion::NotFollowed;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::LostTraction;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::larger;
use crate::output::inspection::PointState;
use crate::scene::error::SceneError;

/// An error within this factor of the tolerance when iterations ended is held up by round-off.
const NEAR_TOLERANCE: f64 = 1e3;

/// A run that broke down.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "the run broke down at step {step}, t = {time:.6e} s, near {}({:.6e}, {:.6e}) m: {what}; likely cause: {cause}",
    point.map_or_else(String::new, |point| format!("point {point} at ")), place[0], place[1]
)]
pub struct Breakdown {
    /// Step at which it was found.
    pub step: usize,
    /// Time at the end of that step, s.
    pub time: f64,
    /// Position at which or near which it was found, m.
    pub place: [f64; 2],
    /// Number of the point there, in its body, where a point stands for the place.
    pub point: Option<usize>,
    /// Description of what happened, for people.
    pub what: String,
    /// Likely cause and remedy.
    pub cause: String,
    /// What is wrong with the scene, if that keeps it from starting: bad input, and no run that broke down.
    pub scene: Option<Box<SceneError>>,
}

/// What keeps a scene from starting, near `place` (m) if it is at no place of its own.
pub(super) fn not_started(place: [f64; 2], tolerance: f64, failure: Failure) -> Breakdown {
    let (what, cause) = (failure.to_string(), cause(failure, tolerance).to_string());
    let key = match failure {
        Failure::BareBoundary { body, .. } | Failure::NoPoints(body) => Some(format!("body.{body}.shape")),
        Failure::LostTraction { body, traction, .. } => Some(format!("body.{body}.traction.{traction}")),
        Failure::LostCondition { body, condition, .. } => Some(format!("body.{body}.condition.{condition}")),
        Failure::HeldTwice { body, condition } => Some(format!("body.{body}.condition.{condition}.fix")),
        Failure::Contradiction([_, number]) | Failure::HoldsNothing(number) => Some(format!("boundary.{number}.from")),
        Failure::NoEquilibrium(_) | Failure::Unbalanced(_) => Some("start.equilibrium".to_string()),
        _ => None,
    };
    let scene = key.map(|key| Box::new(SceneError { key, message: what.clone(), remedy: cause.clone() }));
    Breakdown { step: 0, time: 0.0, place: failure.place().unwrap_or(place), point: None, what, cause, scene }
}

/// The likely cause, with a remedy.
pub(super) fn cause(failure: Failure, tolerance: f64) -> &'static str {
    match failure {
        Failure::Left(_) => {
            "the body moves out of the mesh; enlarge mesh.size or move mesh.origin so that it holds the whole motion, or \
             end earlier"
        }
        Failure::PhaseField(SolveFailure::NotConverged { error, .. }) if error <= NEAR_TOLERANCE * tolerance => {
            "solver.phase_field_tolerance is tighter than round-off allows for this length scale and mesh; raise it, or \
             try phase_field_solver = \"cholesky\""
        }
        Failure::PhaseField(SolveFailure::NotConverged { .. }) => {
            "history energies so different that iterations do not converge; look for extreme loads or seeds, or try \
             phase_field_solver = \"cholesky\""
        }
        Failure::PhaseField(SolveFailure::NotPositiveDefinite) => {
            "spans with fewer points than the phase field has unknowns there, or history energies many orders of \
             magnitude apart; use more particles_per_cell or a lower degree"
        }
        Failure::PhaseField(SolveFailure::NotFinite) | Failure::NoStep => {
            "material constants, lengths or seeds so extreme that their products overflow"
        }
        Failure::Unconverged(_) => {
            "bodies wedged between others, or friction too large for one solution; lower contact.friction or \
             analysis.safety, or use larger cells where they meet"
        }
        Failure::NotFollowed(NotFollowed::TooFast { .. }) => {
            "bodies faster than contact can follow at this time step: give analysis.time_step as much less, or lower \
             analysis.safety"
        }
        Failure::NotFollowed(NotFollowed::TooDeep { .. }) => {
            "contact too soft for what presses, or bodies faster than waves; raise contact.stiffness, or use smaller cells"
        }
        Failure::BareBoundary { .. } | Failure::NoPoints(_) => {
            "use smaller cells or more particles_per_cell, so that a point lies inside the body, or cut less out of it"
        }
        Failure::Contradiction(_) => {
            "parts of a side that meet in a control point: leave a span between them, or give both the same motion"
        }
        Failure::LostTraction { lost: LostTraction::NotFinite(_), .. } => "give a field that is finite along the edge",
        Failure::LostCondition { .. } | Failure::LostTraction { .. } => {
            "use smaller cells or more particles_per_cell there, or let the edge follow the body"
        }
        Failure::HeldTwice { .. } => {
            "conditions on parts shorter than two cells, which join into one, or a side of the mesh that prescribes the \
             same motion: join the parts, or remove one of the two"
        }
        Failure::HoldsNothing(_) => {
            "a part shorter than the support of a function, or one that no body reaches: widen or move it, or use smaller \
             cells"
        }
        Failure::NoEquilibrium(_) => {
            "a load beyond the strength of the body, a motion that nothing holds, as about a hinge, a seed or slit that \
             cuts a part off, or functions of degree 4 beside edges that cut the mesh: lower the load, hold the body, \
             shorten the crack, use degree 2 or 3, or leave start.equilibrium out"
        }
        Failure::Unbalanced(_) => {
            "a body that is not held: add a [[boundary]], balance the loads, or leave start.equilibrium out"
        }
        Failure::SingularMass => {
            "weights or sizes of cells too different for the mass matrix; use mass = \"lumped\", or a mesh with weights \
             and cells more alike"
        }
    }
}

/// The numbers of a point in words.
pub(super) fn numbers(point: &PointState) -> String {
    let largest = |values: &[f64; 3]| {
        let magnitudes = values.iter().map(|value| if value.is_nan() { f64::INFINITY } else { value.abs() });
        let largest = magnitudes.fold(0.0, larger);
        if largest.is_finite() { format!("{largest:.3e}") } else { "not finite".to_string() }
    };
    let mut text = format!("the strain is {}", largest(&point.strain));
    if let Some(fracture) = point.fracture {
        text += &format!(", the history energy {} J/m³", largest(&[fracture.history; 3]));
    }
    text
}
