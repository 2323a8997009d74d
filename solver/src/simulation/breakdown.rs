//! A run that broke down: when, where and why.

use thiserror::Error;

use crate::scene::error::SceneError;

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
