//! Interrupts (Ctrl-C, SIGINT, SIGTERM, SIGHUP): a run stores where it is and stops, a verification keeps
//! what is finished; the second one ends the process at once.

use std::process;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

use fisura_verification::output::Held;

use crate::exit::Exit;
use crate::failure::Failure;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Hears of the interrupt.
static LISTENER: Mutex<Option<Sender<()>>> = Mutex::new(None);

/// From now on an interrupt sets the flag that is returned.
///
/// # Errors
/// If the system does not let interrupts be handled.
pub fn watch() -> Result<&'static AtomicBool, Failure> {
    let handle = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            process::exit(Exit::Interrupted as i32);
        }
        if let Some(listener) = listener().take() {
            let _ = listener.send(()); // who no longer listens needs not know
        }
    };
    let set = ctrlc::set_handler(handle);
    set.map_err(|error| Failure::input(format!("interrupts cannot be handled: {error}")))?;
    Ok(&INTERRUPTED)
}

/// Does `work`. If it is interrupted, `stop` is called beside it, on a thread of its own, to keep what is
/// finished; then the process ends, wherever the work is, but not in the middle of a file.
///
/// # Errors
/// As [`watch`].
pub fn guard<'a, T>(work: impl FnOnce() -> T, stop: impl FnOnce() -> Held<'a> + Send) -> Result<T, Failure> {
    let (sender, receiver) = channel();
    *listener() = Some(sender); // before the handler: an interrupt in between would be heard by nobody
    let deaf = Deaf; // also if the work panics: the thread waits for an interrupt or this
    watch()?;
    Ok(thread::scope(|scope| {
        scope.spawn(move || {
            if receiver.recv().is_ok() {
                let _held = stop();
                process::exit(Exit::Interrupted as i32);
            }
        });
        let _deaf = deaf;
        work()
    }))
}

/// Nobody listens any more once it is gone.
struct Deaf;

impl Drop for Deaf {
    fn drop(&mut self) {
        listener().take();
    }
}

fn listener() -> MutexGuard<'static, Option<Sender<()>>> {
    LISTENER.lock().unwrap_or_else(PoisonError::into_inner)
}
