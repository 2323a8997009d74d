//! The watch over a case: how far it has come, whether it should stop, and what it panicked of.
//!
//! A case runs in a pool of threads of its own, and every thread of that pool knows the watch. A loop over
//! time steps calls [`check`] in every round; without a watch, as in `run`, that never stops anything.

use std::cell::RefCell;
use std::panic::PanicHookInfo;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Once, OnceLock, PoisonError};

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use thiserror::Error;

thread_local! {
    static WATCH: RefCell<Option<Arc<Watch>>> = const { RefCell::new(None) };
}

/// The case is to stop; why.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct Stopped(String);

/// Shared by the threads of a case and the one that waits for it.
#[derive(Debug, Default)]
pub struct Watch {
    /// Finished fraction, as bits.
    fraction: AtomicU64,
    stop: OnceLock<Stopped>,
    panic: OnceLock<String>,
    /// Whether nobody waits for the case any more.
    left: Mutex<bool>,
}

impl Watch {
    /// The present thread works for the case under this watch from now on.
    pub fn enter(self: Arc<Self>) {
        WATCH.set(Some(self));
    }

    /// Asks the case to stop; the first reason counts.
    pub fn stop(&self, why: String) {
        self.stop.get_or_init(|| Stopped(why));
    }

    /// The case is left behind: what it finds from now on is not written.
    pub fn leave(&self) {
        *self.left.lock().unwrap_or_else(PoisonError::into_inner) = true;
    }

    /// A pool of threads that work under this watch.
    ///
    /// # Errors
    /// If they cannot be started.
    pub fn pool(self: &Arc<Self>, threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
        let entered = Arc::clone(self);
        let builder = ThreadPoolBuilder::new().num_threads(threads);
        builder.start_handler(move |_| Arc::clone(&entered).enter()).build()
    }

    /// The finished fraction.
    pub fn fraction(&self) -> f64 {
        f64::from_bits(self.fraction.load(Ordering::Relaxed))
    }

    /// Message and place of the first panic.
    pub fn panic(&self) -> Option<&str> {
        self.panic.get().map(String::as_str)
    }

    fn note(&self, info: &PanicHookInfo<'_>) {
        let words = info.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        self.panic.get_or_init(|| words);
    }
}

fn with<T>(ask: impl FnOnce(&Watch) -> T) -> Option<T> {
    WATCH.try_with(|watch| watch.try_borrow().ok()?.as_deref().map(ask)).ok().flatten()
}

/// Whether the case may go on.
///
/// # Errors
/// If it is to stop.
pub fn check() -> Result<(), Stopped> {
    with(|watch| watch.stop.get().cloned()).flatten().map_or(Ok(()), Err)
}

/// A pool of threads of its own for a part of the case, under the same watch.
///
/// # Errors
/// If they cannot be started.
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    match WATCH.with_borrow(Option::clone) {
        Some(watch) => watch.pool(threads),
        None => ThreadPoolBuilder::new().num_threads(threads).build(),
    }
}

/// Writes what the case found, unless it was left behind: then what it is said to have found is written
/// already.
pub fn unless_left<E>(write: impl FnOnce() -> Result<(), E>) -> Result<(), E> {
    let Some(watch) = WATCH.with_borrow(Option::clone) else { return write() };
    // And is not left before it is written.
    let left = watch.left.lock().unwrap_or_else(PoisonError::into_inner);
    if *left { Ok(()) } else { write() }
}

/// Says how far the case has come, 0 to 1.
pub fn advanced(fraction: f64) {
    with(|watch| watch.fraction.store(fraction.to_bits(), Ordering::Relaxed));
}

/// From now on a panic in a case is noted by its watch, and shown as it was before.
pub fn note_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let shown = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            with(|watch| watch.note(info));
            shown(info);
        }));
    });
}
