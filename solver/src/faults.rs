//! Planted errors: proof that the checks of the verification can fail.
//!
//! With the feature `faults`, which no release has, one error can be planted in a process with `plant`, once
//! and before anything is simulated; `cargo xtask faults` does so and looks for checks that turn red. The
//! errors are listed in `xtask/src/faults/table.toml`. Each has its sites in the code, here and where results
//! are judged:
//! `fault!("gradient-sign", right => wrong)`. Without the feature that is `right` and nothing else. With it,
//! every site also notes that it was passed, so that a case which never comes by one need not be run with
//! that error: `take_passed`.

/// `right`, or `wrong` while the fault of that name is planted.
#[cfg(feature = "faults")]
#[macro_export]
#[doc(hidden)]
macro_rules! fault {
    ($name:literal, $right:expr => $wrong:expr) => {{
        static SITE: $crate::faults::Site = $crate::faults::Site::new($name);
        if SITE.is_planted() { $wrong } else { $right }
    }};
}

/// `right`: nothing can be planted without the feature `faults`.
#[cfg(not(feature = "faults"))]
#[macro_export]
#[doc(hidden)]
macro_rules! fault {
    ($name:literal, $right:expr => $wrong:expr) => {
        $right
    };
}

#[cfg(feature = "faults")]
pub use planted::{Site, plant, take_passed};

#[cfg(feature = "faults")]
mod planted {
    use std::collections::BTreeSet;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::sync::{Mutex, OnceLock, PoisonError};

    /// Name of the planted fault.
    static PLANTED: OnceLock<String> = OnceLock::new();

    /// Faults whose sites were passed since the last call of `take_passed`.
    static PASSED: Mutex<BTreeSet<&str>> = Mutex::new(BTreeSet::new());

    /// Number of the calls of `take_passed`, from 1.
    static ROUND: AtomicUsize = AtomicUsize::new(1);

    /// A place in the code at which a fault can be planted.
    pub struct Site {
        name: &'static str,
        /// Twice the round in which this site was last passed, and 1 if its fault is planted.
        passed: AtomicUsize,
    }

    impl Site {
        /// A site that was not passed yet.
        pub const fn new(name: &'static str) -> Self {
            Self { name, passed: AtomicUsize::new(0) }
        }

        /// Whether the fault of this site is planted; notes once a round that the site was passed.
        #[inline(always)]
        pub fn is_planted(&self) -> bool {
            let mut passed = self.passed.load(Ordering::Relaxed);
            let round = ROUND.load(Ordering::Relaxed);
            if passed / 2 != round {
                PASSED.lock().unwrap_or_else(PoisonError::into_inner).insert(self.name);
                let planted = PLANTED.get().is_some_and(|name| name == self.name);
                passed = 2 * round + usize::from(planted);
                self.passed.store(passed, Ordering::Relaxed);
            }
            passed % 2 == 1
        }
    }

    /// Plants a fault in this process; only the first call has an effect.
    pub fn plant(name: String) {
        let _ = PLANTED.set(name);
    }

    /// Names of the faults whose sites were passed since the last call.
    pub fn take_passed() -> BTreeSet<&'static str> {
        let mut passed = PASSED.lock().unwrap_or_else(PoisonError::into_inner);
        ROUND.fetch_add(1, Ordering::Relaxed);
        std::mem::take(&mut *passed)
    }
}
