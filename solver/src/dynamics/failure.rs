//! Why a body cannot begin, or take a step.

use super::loads::LostTraction;
use crate::contact::gap_potential::TooDeep;
use crate::contact::impulse::Unconverged;
use crate::contact::motion::TooFast;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::particles::points::OutsidePatch;

/// Why a body cannot begin, or take a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Failure {
    /// The phase field could not be solved for.
    PhaseField(SolveFailure),
    /// A point left the patch, m.
    Left([f64; 2]),
    /// The consistent mass matrix is singular to round-off.
    SingularMass,
    /// The critical time step is not a number.
    NoStep,
    /// The body of that number in the scene holds no material point.
    NoPoints(usize),
    /// A part of a traction would not act.
    LostTraction {
        /// Number of the body in the scene.
        body: usize,
        /// Number of its traction.
        traction: usize,
        /// What is lost, and where.
        lost: LostTraction,
    },
    /// The part of a side of that condition holds no control point with mass.
    HoldsNothing(usize),
    /// There is no material at a place (m) on the edge of that condition of the body.
    LostCondition {
        /// Number of the body in the scene.
        body: usize,
        /// Number of the condition.
        condition: usize,
        /// Place, m.
        place: [f64; 2],
    },
    /// What that condition of the body prescribes follows from what others prescribe.
    HeldTwice {
        /// Number of the body in the scene.
        body: usize,
        /// Number of the condition.
        condition: usize,
    },
    /// Two conditions whose parts of a side share a control point and prescribe it differently.
    Contradiction([usize; 2]),
    /// No static state was found: the largest force out of balance, of the largest nodal force.
    NoEquilibrium(f64),
    /// The loads of a static start accelerate a body that nothing holds: their resultant, of their
    /// magnitudes.
    Unbalanced(f64),
    /// Impulses of contact did not converge.
    Unconverged(Unconverged),
    /// Bodies meet that approach each other too far in a step.
    TooFast(TooFast),
    /// A boundary is too deep in another body.
    TooDeep(TooDeep),
    /// There is no material at a place (m) of the boundary of the body of that number.
    BareBoundary {
        /// Number of the body in the scene.
        body: usize,
        /// Place, m.
        place: [f64; 2],
    },
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
}

impl From<SolveFailure> for Failure {
    fn from(failure: SolveFailure) -> Self {
        Self::PhaseField(failure)
    }
}

impl From<OutsidePatch> for Failure {
    fn from(OutsidePatch(position): OutsidePatch) -> Self {
        Self::Left(position)
    }
}
