//! What can go wrong: a scene that cannot be modelled, or a run that breaks down.

use thiserror::Error;

use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::contact::impulse::Unsettled;
use crate::contact::motion::TooFast;
use crate::dynamics::loads::LostTraction;
use crate::dynamics::updated_frame::points::OutsidePatch;

/// One thing wrong with a scene, found before anything runs.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{key}: {message}")]
pub struct SceneError {
    /// Path of the key, as in the scene file: `material.glass.poisson_ratio`, `body.0.crack.0.from`.
    pub key: String,
    /// What is wrong.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

/// Something in a scene that is legal but probably not meant.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneWarning {
    /// Path of the key.
    pub key: String,
    /// What is suspicious, and what to do about it.
    pub message: String,
}

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
    /// Impulses of contact did not settle.
    Unsettled(Unsettled),
    /// Bodies meet that approach each other too far in a step.
    TooFast(TooFast),
}

impl From<SolveFailure> for Failure {
    fn from(failure: SolveFailure) -> Self {
        Self::PhaseField(failure)
    }
}

impl From<Unsettled> for Failure {
    fn from(failure: Unsettled) -> Self {
        Self::Unsettled(failure)
    }
}

impl From<TooFast> for Failure {
    fn from(failure: TooFast) -> Self {
        Self::TooFast(failure)
    }
}

impl From<OutsidePatch> for Failure {
    fn from(OutsidePatch(position): OutsidePatch) -> Self {
        Self::Left(position)
    }
}

/// A run that broke down.
#[derive(Debug, Clone, PartialEq, Error)]
#[error(
    "the run broke down at step {step}, t = {time:.6e} s, near {}({:.6e}, {:.6e}) m: {what}; likely cause: {cause}",
    point.map_or_else(String::new, |point| format!("point {point} at ")), place[0], place[1]
)]
pub struct Breakdown {
    /// Step at which it was found.
    pub step: usize,
    /// Time, s.
    pub time: f64,
    /// Place, m.
    pub place: [f64; 2],
    /// Number of the point there, in its body, where a point stands for the place.
    pub point: Option<usize>,
    /// What happened.
    pub what: String,
    /// Likely cause and remedy.
    pub cause: String,
    /// What is wrong with the scene, if that keeps it from starting: bad input, and no run that broke down.
    pub scene: Option<Box<SceneError>>,
}
