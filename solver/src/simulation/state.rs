//! Checkpoints: a run stored at a whole step and taken up again.

use thiserror::Error;

use super::Simulation;
use super::frame::{Bodies, either};
use crate::checkpoint::{Archive, StateError};
use crate::scene::Scene;
use crate::simulation::breakdown::Breakdown;

/// Why a run cannot be taken up.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ResumeError {
    /// The state is damaged or of another scene.
    #[error(transparent)]
    State(#[from] StateError),
    /// The scene does not start.
    #[error(transparent)]
    Breakdown(#[from] Breakdown),
}

impl Simulation {
    /// The state at the present step: with the same scene, [`Self::resume`] goes on from it bit by bit.
    /// Storing it changes nothing in the run.
    ///
    /// # Errors
    /// If the last step failed, or loads act that only the program knows, as in verification.
    pub fn checkpoint(&mut self) -> Result<Vec<u8>, StateError> {
        if self.failed {
            return Err(StateError(format!(
                "step {} failed, and what it left is not a state to go on from",
                self.steps
            )));
        }
        let mut archive = Archive::writer();
        self.exchange(&mut archive)?;
        archive.finish()
    }

    /// Takes up a run of `scene` where [`Self::checkpoint`] stored it.
    ///
    /// # Errors
    /// If the state is damaged or of another scene, or the scene does not start.
    pub fn resume(scene: &Scene, state: &[u8]) -> Result<Self, ResumeError> {
        let mut simulation = Self::new(scene)?;
        let mut archive = Archive::reader(state);
        simulation.exchange(&mut archive)?;
        archive.finish()?;
        Ok(simulation)
    }

    fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        archive.value(&mut self.steps)?;
        archive.value(&mut self.parts)?;
        either!(&mut self.frame, body => body.exchange(archive))?;
        archive.value(&mut self.warnings)?;
        [&mut self.initial, &mut self.energy_in].into_iter().try_for_each(|energy| archive.value(energy))?;
        archive.value(&mut self.warned)
    }
}
