//! The state of a body in the total frame.

use super::TotalFrame;
use crate::checkpoint::{Archive, StateError};
use crate::phase_field::fracture::LatticeFracture;

impl TotalFrame {
    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { loads, forced, edges, displacement, velocity, acceleration, internal, fracture, .. } = self;
        if forced.is_some() {
            return Err(StateError("loads that only the program knows cannot be stored".to_string()));
        }
        let stored = fault!("checkpoint-without-accelerations", 4 => 3);
        for field in [&mut *displacement, velocity, internal, acceleration].into_iter().take(stored) {
            field.iter_mut().try_for_each(|component| archive.list(component))?;
        }
        loads.iter_mut().for_each(|load| load.follow(displacement));
        if let Some(LatticeFracture { history, phase, excess, lag_work, field, iterations, .. }) = fracture {
            [history, phase, excess].into_iter().try_for_each(|values| archive.list(values))?;
            field.exchange(archive)?;
            lag_work.as_mut().map_or(Ok(()), |work| work.exchange(archive))?;
            archive.value(iterations)?;
        }
        let values = [&mut self.elastic_energy, &mut self.time, &mut self.judged_stiffening];
        values.into_iter().try_for_each(|value| archive.value(value))?;
        archive.value(&mut self.crack_start)?;
        self.reactions.exchange(archive)?;
        edges.as_mut().map_or(Ok(()), |edges| edges.exchange(archive))?;
        archive.value(&mut self.ledger)
    }
}
