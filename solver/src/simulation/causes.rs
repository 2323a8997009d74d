//! What is said of a step that fails, and of a scene that does not start.

use super::breakdown::Breakdown;
use crate::contact::gap_potential::TooDeep;
use crate::contact::impulse::Unconverged;
use crate::contact::motion::{MOST, TooFast};
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::LostTraction;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::larger;
use crate::output::inspection::PointState;
use crate::scene::error::SceneError;

/// An error within this factor of the tolerance when iterations ended is held up by round-off.
const NEAR_TOLERANCE: f64 = 1e3;

const RAISE_TOLERANCE: &str = "solver.phase_field_tolerance is tighter than round-off allows for this length scale and \
                               mesh; raise it, or try phase_field_solver = \"cholesky\"";
const ILL_CONDITIONED: &str = "history energies so different that iterations do not converge; look for extreme loads or \
                               seeds, or try phase_field_solver = \"cholesky\"";
const SINGULAR_MASS: &str = "weights or sizes of cells too different for the mass matrix; use mass = \"lumped\", or a mesh \
                             with weights and cells more alike";
const ENLARGE_MESH: &str = "the body moves out of the mesh; enlarge mesh.size or move mesh.origin so that it holds the \
                            whole motion, or end earlier";

const ADD_POINTS: &str =
    "use smaller cells or more particles_per_cell, so that a point lies inside the body, or cut less out of it";
const CARRY_TRACTION: &str = "use smaller cells or more particles_per_cell there, or let the edge follow the body";
pub(super) const INSIDE_OUT: &str = "the body is turned inside out there: look for extreme loads or velocities, refine the mesh there, \
                          or halve the safety factor";
pub(super) const LOST: &str = "the position of a point is not a number";
pub(super) const THROWN: &str = "a point was thrown out of the mesh, further than the mesh is wide, in one step";
pub(super) const NOT_FINITE: &str = "the phase-field solve ran into numbers that are not finite";
const INDEFINITE: &str = "the matrix of the phase field is not positive definite to round-off";
const TOO_FEW_POINTS: &str = "spans with fewer points than the phase field has unknowns there, or history energies many \
                              orders of magnitude apart; use more particles_per_cell or a lower degree";
const EXTREME: &str = "material constants, lengths or seeds so extreme that their products overflow";
pub(super) const CONTACT_NOT_FINITE: &str = "the impulses of contact ran into numbers that are not finite";
const UNSETTLED: &str = "bodies wedged between others, or friction too large for one solution; lower contact.friction or \
                         analysis.safety, or use larger cells where they meet";
const TOO_DEEP: &str = "contact too soft for what presses, or bodies faster than waves; raise contact.stiffness, or use \
                        smaller cells";
const TOO_FAST: &str = "bodies faster than contact can follow at this time step: give analysis.time_step as much less, or \
                        lower analysis.safety";
const WIDEN_PART: &str = "a part shorter than the support of a function, or one that no body reaches: widen or move it, or \
                          use smaller cells";
const HELD_TWICE: &str = "conditions on parts shorter than two cells, which join into one, or a side of the mesh that prescribes the same motion: \
                          join the parts, or remove one of the two";
const PART_PARTS: &str = "parts of a side that meet in a control point: leave a span between them, or give both the same \
                          motion";
const NO_EQUILIBRIUM: &str = "a load beyond the strength of the body, a motion that nothing holds, as about a hinge, a seed or \
                              slit that cuts a part off, or functions of degree 4 beside edges that cut the mesh: lower the \
                              load, hold the body, shorten the crack, use degree 2 or 3, or leave start.equilibrium out";
const UNBALANCED: &str =
    "a body that is not held: add a [[boundary]], balance the loads, or leave start.equilibrium out";
pub(super) const BARE: &str = "a load or condition acts where there is no material any more";
pub(super) const TORN: &str =
    "it has torn off or left behind the points under it; lower or ramp it, end earlier, or use frame = \"total\"";

/// What keeps a scene from starting, near `place` (m).
pub(super) fn not_started(place: [f64; 2], tolerance: f64, failure: Failure) -> Breakdown {
    let (what, cause) = what_and_cause(failure, tolerance);
    let (place, key) = match failure {
        Failure::Left(place) | Failure::TooFast(TooFast { place, .. }) | Failure::TooDeep(TooDeep { place, .. }) => {
            (place, None)
        }
        Failure::BareBoundary { body, place } => (place, Some(format!("body.{body}.shape"))),
        Failure::NoPoints(body) => (place, Some(format!("body.{body}.shape"))),
        Failure::LostTraction { body, traction, lost: LostTraction::Bare(place) | LostTraction::NotFinite(place) }
        | Failure::LostTraction { body, traction, lost: LostTraction::Unbalanced { place, .. } } => {
            (place, Some(format!("body.{body}.traction.{traction}")))
        }
        Failure::PhaseField(_) | Failure::SingularMass | Failure::NoStep | Failure::Unconverged(_) => (place, None),
        Failure::LostCondition { body, condition, place } => {
            (place, Some(format!("body.{body}.condition.{condition}")))
        }
        Failure::HeldTwice { body, condition } => (place, Some(format!("body.{body}.condition.{condition}.fix"))),
        Failure::Contradiction([_, second]) => (place, Some(format!("boundary.{second}.from"))),
        Failure::HoldsNothing(condition) => (place, Some(format!("boundary.{condition}.from"))),
        Failure::NoEquilibrium(_) | Failure::Unbalanced(_) => (place, Some("start.equilibrium".to_string())),
    };
    let scene = key.map(|key| Box::new(SceneError { key, message: what.clone(), remedy: cause.clone() }));
    Breakdown { step: 0, time: 0.0, place, point: None, what, cause, scene }
}

/// What happened, and its likely cause with a remedy.
pub(super) fn what_and_cause(failure: Failure, tolerance: f64) -> (String, String) {
    let (what, cause) = match failure {
        Failure::Left(_) => ("a point left the mesh".to_string(), ENLARGE_MESH),
        Failure::PhaseField(SolveFailure::NotConverged { iterations, error }) => (
            format!("the phase-field solve stopped after {iterations} iterations at an error of {error:.3e}"),
            if error <= NEAR_TOLERANCE * tolerance { RAISE_TOLERANCE } else { ILL_CONDITIONED },
        ),
        Failure::PhaseField(SolveFailure::NotPositiveDefinite) => (INDEFINITE.to_string(), TOO_FEW_POINTS),
        Failure::PhaseField(SolveFailure::NotFinite) => (NOT_FINITE.to_string(), EXTREME),
        Failure::Unconverged(Unconverged { iterations, residual, .. }) => (
            format!(
                "the impulses of contact did not converge in {iterations} iterations: they still change by {residual:.3e}"
            ),
            UNSETTLED,
        ),
        Failure::TooFast(TooFast { spans, .. }) => (
            format!(
                "bodies that are about to meet approach each other by {spans:.3} spans in a step, and contact follows \
                 {MOST}"
            ),
            TOO_FAST,
        ),
        Failure::TooDeep(TooDeep { spans, follows, .. }) => (
            format!("a boundary is {spans:.3} spans deep in another body, and contact follows {follows:.3} there"),
            TOO_DEEP,
        ),
        Failure::BareBoundary { place: [x, y], .. } => (
            format!("there is no material point within a cell of ({x:.6e}, {y:.6e}) m on the boundary of the body"),
            ADD_POINTS,
        ),
        Failure::Contradiction([first, second]) => (
            format!("boundary.{first} and boundary.{second} prescribe the control point between them differently"),
            PART_PARTS,
        ),
        Failure::LostCondition { place: [x, y], .. } => (
            format!("there is no material point within a cell of ({x:.6e}, {y:.6e}) m, where the condition acts"),
            CARRY_TRACTION,
        ),
        Failure::HeldTwice { .. } => (
            "what is prescribed along this edge follows from what is prescribed beside it or on it".to_string(),
            HELD_TWICE,
        ),
        Failure::HoldsNothing(_) => ("the part of the side holds no control point of a body".to_string(), WIDEN_PART),
        Failure::NoEquilibrium(residual) if residual.is_nan() => {
            ("no static state was found: the displacements are not numbers".to_string(), NO_EQUILIBRIUM)
        }
        Failure::NoEquilibrium(residual) => (
            format!("no static state was found: {residual:.1e} of the largest nodal force is out of balance"),
            NO_EQUILIBRIUM,
        ),
        Failure::Unbalanced(resultant) => (
            format!("the loads at t = 0 have a resultant of {resultant:.1e} of their size, and nothing holds the body"),
            UNBALANCED,
        ),
        Failure::NoStep => ("the critical time step is not a number".to_string(), EXTREME),
        Failure::SingularMass => ("the consistent mass matrix is singular to round-off".to_string(), SINGULAR_MASS),
        Failure::NoPoints(_) => ("the body holds no material point".to_string(), ADD_POINTS),
        Failure::LostTraction { lost: LostTraction::NotFinite([x, y]), .. } => {
            (format!("the stress field is not finite at ({x}, {y}) m"), "give a field that is finite along the edge")
        }
        Failure::LostTraction { lost: LostTraction::Bare([x, y]), .. } => (
            format!("there is no material point within a cell of ({x:.6e}, {y:.6e}) m, where the traction acts"),
            CARRY_TRACTION,
        ),
        Failure::LostTraction { lost: LostTraction::Unbalanced { force, moment, .. }, .. } => (
            format!(
                "the forces on the control points miss the traction by {force:.1e} of its force and {moment:.1e} of its \
                 moment"
            ),
            CARRY_TRACTION,
        ),
    };
    (what, cause.to_string())
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
