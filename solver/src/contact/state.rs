//! The state of contact: where the impulses start from, and what was booked.

use super::ContactSolver;
use crate::checkpoint::{Archive, StateError};

impl ContactSolver {
    /// Stores or takes up what steps change. Rigid bodies and constraints follow from time and bodies.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { friction: _, squares: _, reach: _, rigid: _, constraints: _, step, last, ledger } = self;
        archive.value(step)?;
        archive.value(last)?;
        archive.value(ledger)
    }
}
