//! The state of the phase-field solver.

use super::PhaseField;
use crate::checkpoint::{Archive, StateError};

impl PhaseField {
    /// Stores or takes up what steps change. A system that is assembled anew at every step is not part of it.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { model: _, tolerance: _, matrix, load: _, phase, previous, assembled, method, lag, bounds, counts } =
            self;
        if !assembled.is_empty() {
            archive.list(matrix.coefficients_mut())?;
        }
        archive.list(phase)?;
        archive.list(previous)?;
        archive.list(assembled)?;
        archive.value(counts)?;
        bounds.as_mut().map_or(Ok(()), |bounds| bounds.exchange(archive))?;
        lag.as_mut().map_or(Ok(()), |lag| lag.exchange(archive))?;
        method.preconditioner().map_or(Ok(()), |preconditioner| preconditioner.exchange(archive, matrix))
    }
}
