//! Interrupts: a run stores where it is and stops; the second one ends the process at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::exit::Exit;
use crate::failure::Failure;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on an interrupt (Ctrl-C, SIGINT, SIGTERM, SIGHUP) sets the flag that is returned.
///
/// # Errors
/// If the system does not let interrupts be handled.
pub fn watch() -> Result<&'static AtomicBool, Failure> {
    let handle = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(Exit::Interrupted as i32);
        }
    };
    ctrlc::set_handler(handle).map_err(|error| {
        Failure::new(Exit::BadInput, format!("interrupts cannot be handled: {error}")).help("give --checkpoint none")
    })?;
    Ok(&INTERRUPTED)
}
