//! Planted errors: proof that the checks of the verification can fail.
//!
//! With the feature `faults`, which no release has, one of `FAULTS` can be planted in a process with `plant`, once and
//! before anything is simulated; `cargo xtask faults` does so and looks for checks that turn red. Each has its site in the
//! code, `fault!("gradient-sign", right => wrong)`. Without the feature that is `right` and nothing else.

/// `right`, or `wrong` while the fault of that name is planted.
#[cfg(feature = "faults")]
macro_rules! fault {
    ($name:literal, $right:expr => $wrong:expr) => {{
        const NUMBER: usize = $crate::faults::number($name);
        if $crate::faults::is_planted(NUMBER) { $wrong } else { $right }
    }};
}

/// `right`: nothing can be planted without the feature `faults`.
#[cfg(not(feature = "faults"))]
macro_rules! fault {
    ($name:literal, $right:expr => $wrong:expr) => {
        $right
    };
}

#[cfg(feature = "faults")]
pub use planted::{FAULTS, is_planted, number, plant};

#[cfg(feature = "faults")]
mod planted {
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Names of the errors that can be planted.
    pub const FAULTS: [&str; 34] = [
        "affine-transposed",
        "critical-step-too-long",
        "degradation-linear",
        "driven-work-left-out",
        "friction-twice",
        "gradient-sign",
        "gravity-upwards",
        "half-step-velocity",
        "held-side-let-go",
        "hencky-without-half",
        "history-forgets",
        "history-left-behind",
        "history-work-halved",
        "impulse-one-sided",
        "jacobian-missing",
        "knot-span-off-by-one",
        "length-scale-doubled",
        "loss-forgotten",
        "mass-lumped",
        "normal-not-normalised",
        "one-minus-k-missing",
        "phase-gradient-halved",
        "phase-load-without-volumes",
        "plane-stress-lambda",
        "rational-weights-ignored",
        "shear-halved",
        "split-swapped",
        "stable-fraction-of-musl",
        "surface-energy-doubled",
        "thickness-forgotten",
        "traction-on-wrong-edge",
        "transfer-keeps-less",
        "volumes-off-by-a-layer",
        "whole-kick",
    ];

    /// Number of the planted fault; beyond the last if there is none.
    static PLANTED: AtomicUsize = AtomicUsize::new(FAULTS.len());

    /// Plants a fault in this process.
    ///
    /// # Errors
    /// If none has that name.
    pub fn plant(name: &str) -> Result<(), String> {
        let found = FAULTS.iter().position(|known| *known == name);
        let number = found.ok_or_else(|| format!("unknown fault {name:?}; known: {}", FAULTS.join(", ")))?;
        PLANTED.store(number, Ordering::Relaxed);
        Ok(())
    }

    /// Whether the fault of that number is planted.
    #[inline(always)]
    pub fn is_planted(number: usize) -> bool {
        PLANTED.load(Ordering::Relaxed) == number
    }

    /// Number of a fault; a name that is not listed does not compile.
    pub const fn number(name: &str) -> usize {
        let mut number = 0;
        while !same(FAULTS[number].as_bytes(), name.as_bytes()) {
            number += 1;
        }
        number
    }

    const fn same(a: &[u8], b: &[u8]) -> bool {
        let mut at = 0;
        while at < a.len() && at < b.len() && a[at] == b[at] {
            at += 1;
        }
        at == a.len() && at == b.len()
    }
}
