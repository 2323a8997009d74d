//! The state of contact: where the impulses start from, and what was booked.

use super::Contact;
use crate::checkpoint::{Archive, StateError};

impl Contact {
    /// Stores or takes up what steps change. Rigid bodies and touches follow from time and bodies.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { friction: _, origin: _, reach: _, rigid: _, touches: _, step, last, ledger } = self;
        archive.value(step)?;
        archive.value(last)?;
        archive.value(ledger)
    }
}
