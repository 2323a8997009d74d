//! Why a body cannot begin, or take a step.

use thiserror::Error;

use super::loads::LostTraction;
use crate::contact::impulse::Unconverged;
use crate::contact::motion::NotFollowed;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::particles::points::OutsidePatch;

/// Why a body cannot begin, or take a step.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum Failure {
    /// The phase field could not be solved for.
    #[error("the phase-field solve {0}")]
    PhaseField(#[from] SolveFailure),
    /// A point left the patch, m.
    #[error("a point left the mesh")]
    Left([f64; 2]),
    /// The consistent mass matrix is singular to round-off.
    #[error("the consistent mass matrix is singular to round-off")]
    SingularMass,
    /// The critical time step is not a number.
    #[error("the critical time step is not a number")]
    NoStep,
    /// The body of that number in the scene holds no material point.
    #[error("the body holds no material point")]
    NoPoints(usize),
    /// A part of a traction would not act.
    #[error("{lost}")]
    LostTraction {
        /// Number of the body in the scene.
        body: usize,
        /// Number of its traction.
        traction: usize,
        /// What is lost, and where.
        lost: LostTraction,
    },
    /// The part of a side of that condition holds no control point with mass.
    #[error("the part of the side holds no control point of a body")]
    HoldsNothing(usize),
    /// There is no material at a place (m) on the edge of that condition of the body.
    #[error("there is no material point within a cell of ({:.6e}, {:.6e}) m, where the condition acts", place[0], place[1])]
    LostCondition {
        /// Number of the body in the scene.
        body: usize,
        /// Number of the condition.
        condition: usize,
        /// Place on the edge where there is no material, m.
        place: [f64; 2],
    },
    /// What that condition of the body prescribes follows from what others prescribe.
    #[error("what is prescribed along this edge follows from what is prescribed beside it or on it")]
    HeldTwice {
        /// Number of the body in the scene.
        body: usize,
        /// Number of the condition.
        condition: usize,
    },
    /// Two conditions whose parts of a side share a control point and prescribe it differently.
    #[error("boundary.{} and boundary.{} prescribe the control point between them differently", .0[0], .0[1])]
    Contradiction([usize; 2]),
    /// No static state was found: the largest force out of balance, of the largest nodal force.
    #[error("no static state was found: {}", out_of_balance(*.0))]
    NoEquilibrium(f64),
    /// The loads of a static start accelerate a body that nothing holds: what they do to it.
    #[error("the body is not in balance: the loads at t = 0 {0}, and nothing holds it")]
    Unbalanced(&'static str),
    /// Impulses of contact did not converge.
    #[error(transparent)]
    Unconverged(#[from] Unconverged),
    /// Contact cannot be followed.
    #[error(transparent)]
    NotFollowed(#[from] NotFollowed),
    /// There is no material at a place (m) of the boundary of the body of that number.
    #[error("there is no material point within a cell of ({:.6e}, {:.6e}) m on the boundary of the body", place[0], place[1])]
    BareBoundary {
        /// Number of the body in the scene.
        body: usize,
        /// Place on the boundary where there is no material, m.
        place: [f64; 2],
    },
}

fn out_of_balance(residual: f64) -> String {
    if residual.is_nan() {
        "the displacements are not numbers".to_string()
    } else {
        format!("{residual:.1e} of the largest nodal force is out of balance")
    }
}

impl Failure {
    /// The same of a body of this number, where it is that of the first one.
    pub(crate) fn of_body(self, number: usize) -> Self {
        match self {
            Self::NoPoints(_) => Self::NoPoints(number),
            Self::LostCondition { body: _, condition, place } => Self::LostCondition { body: number, condition, place },
            Self::HeldTwice { body: _, condition } => Self::HeldTwice { body: number, condition },
            Self::BareBoundary { body: _, place } => Self::BareBoundary { body: number, place },
            Self::LostTraction { body: _, traction, lost } => Self::LostTraction { body: number, traction, lost },
            other => other,
        }
    }

    /// Where it is, m, if it is at one place.
    pub(crate) fn place(self) -> Option<[f64; 2]> {
        match self {
            Self::Left(place)
            | Self::BareBoundary { place, .. }
            | Self::LostCondition { place, .. }
            | Self::Unconverged(Unconverged { place, .. })
            | Self::NotFollowed(NotFollowed::TooFast { place, .. } | NotFollowed::TooDeep { place, .. }) => Some(place),
            Self::LostTraction { lost, .. } => Some(lost.place()),
            _ => None,
        }
    }
}

impl From<OutsidePatch> for Failure {
    fn from(OutsidePatch(position): OutsidePatch) -> Self {
        Self::Left(position)
    }
}
