//! Planted errors: proof that the checks of the verification can fail.
//!
//! With the feature `faults`, which no release has, one of `FAULTS` can be planted in a process with `plant`,
//! once and before anything is simulated; `cargo xtask faults` does so and looks for checks that turn red.
//! Each has its sites in the code, here and where results are judged:
//! `fault!("gradient-sign", right => wrong)`. Without the feature that is `right` and nothing else. With it,
//! every site also notes that it was passed, so that a case which never comes by one need not be run with
//! that error: `take_passed`.

/// `right`, or `wrong` while the fault of that name is planted.
#[cfg(feature = "faults")]
#[macro_export]
#[doc(hidden)]
macro_rules! fault {
    ($name:literal, $right:expr => $wrong:expr) => {{
        const NUMBER: usize = $crate::faults::number($name);
        if $crate::faults::is_planted(NUMBER) { $wrong } else { $right }
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
pub use planted::{FAULTS, is_planted, number, plant, take_passed};

#[cfg(feature = "faults")]
mod planted {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    /// Names of the errors that can be planted.
    pub const FAULTS: &[&str] = &[
        "affine-left-behind",
        "affine-transposed",
        "apic-spread-of-quadratics",
        "at1-gradient-of-at2",
        "at1-seed-forgotten",
        "at1-source-doubled",
        "at1-surface-unscaled",
        "band-in-other-units",
        "boundary-lags-behind",
        "boundary-undivided-at-knots",
        "bounds-both-above",
        "broken-points-hold",
        "checkpoint-without-accelerations",
        "closure-at-the-start",
        "cohesive-gradient-halved",
        "cohesive-length-doubled",
        "cohesive-slope-doubled",
        "cohesive-source-halved",
        "cohesive-surface-linear",
        "compression-degraded",
        "contact-loss-doubled",
        "contact-pulls",
        "copies-lose-their-share",
        "cornelissen-without-a3",
        "crack-faces-left-out",
        "cracks-count-as-whole",
        "critical-step-too-long",
        "curves-compared-by-their-mean",
        "cut-forces-of-one-point",
        "cut-phase-field-of-one-point",
        "cut-spans-half-way",
        "cut-spans-undivided",
        "deformation-from-the-wrong-side",
        "deformation-left-behind",
        "degradation-linear",
        "difference-upwards-only",
        "displacement-lags",
        "drift-upwards-only",
        "driven-side-lags",
        "driven-work-left-out",
        "edge-behind-its-root",
        "edge-multipliers-too-few",
        "edge-reaction-reversed",
        "edge-speed-forgotten",
        "events-seen-late",
        "extrapolation-backwards",
        "fall-from-the-last-row",
        "fictitious-material-heavy",
        "flanks-not-met",
        "friction-one-way",
        "friction-twice",
        "gap-force-one-sided",
        "gap-without-sign",
        "gaps-are-overlooked",
        "gradient-of-mean-toughness",
        "gradient-sign",
        "gravity-upwards",
        "gravity-without-mass",
        "greville-a-knot-early",
        "half-model-not-doubled",
        "half-step-velocity",
        "held-edge-impact-free",
        "held-edge-without-course",
        "held-edge-works-twice",
        "held-side-let-go",
        "hencky-without-half",
        "history-forgets",
        "history-left-behind",
        "history-work-halved",
        "impulse-beside-its-place",
        "impulse-not-mass-weighted",
        "impulse-one-sided",
        "inserted-knot-halves",
        "intact-stress-left-in",
        "inverse-map-transposed",
        "j-integral-without-energy",
        "jacobian-missing",
        "joint-force-of-one-slice",
        "judge-fails-nothing",
        "judge-ignores-lower-bounds",
        "judge-ignores-upper-bounds",
        "judge-passes-infinity",
        "judge-passes-what-is-missing",
        "judge-takes-any-bounds",
        "judge-takes-magnitudes",
        "judge-takes-wide-bounds",
        "knot-span-off-by-one",
        "last-verdict-counts",
        "length-scale-doubled",
        "load-without-end",
        "loss-forgotten",
        "mass-lumped",
        "mean-of-the-fit-kept",
        "moving-gradient-halved",
        "norm-without-root",
        "normal-not-normalised",
        "normal-of-one-body",
        "normals-to-the-right-of-an-edge",
        "one-iteration-is-enough",
        "one-minus-k-missing",
        "open-gap-counts-as-closed",
        "order-with-the-wrong-sign",
        "part-of-a-side-is-all-of-it",
        "partition-unbooked",
        "phase-field-carried-too-far",
        "phase-field-heals",
        "phase-gradient-halved",
        "phase-lag-work-left-out",
        "phase-load-without-volumes",
        "phase-motion-unbooked",
        "phase-tolerance-ignored",
        "plane-stress-lambda",
        "points-move-half-way",
        "pressure-outwards",
        "quotient-rule-forgotten",
        "ramp-forgotten",
        "rankine-modulus",
        "rankine-smallest-stress",
        "rational-weights-ignored",
        "reaction-without-inertia",
        "relaxation-unbooked",
        "rigid-body-at-rest",
        "safety-ignored",
        "seam-left-behind",
        "seed-twice-as-wide",
        "shear-energy-once",
        "shear-force-one-sided",
        "shear-halved",
        "shear-strain-doubled",
        "side-holds-across-a-gap",
        "side-holds-the-other-component",
        "slip-not-returned",
        "slit-bridged",
        "slit-without-ties",
        "small-growth-never-assembled",
        "smooth-course-linear",
        "softening-not-linear",
        "span-not-renewed",
        "spans-miss-the-jacobian",
        "split-swapped",
        "stagger-doubled",
        "star-convex-sign",
        "step-of-the-total-frame",
        "surface-energy-doubled",
        "table-of-steps",
        "tensor-turned-back",
        "tensor-without-its-mixed-term",
        "thickness-forgotten",
        "tiles-enter-late",
        "tip-from-the-end-of-the-seed",
        "trace-not-split",
        "traction-on-wrong-edge",
        "transfer-keeps-less",
        "value-of-another-variant",
        "volumes-off-by-a-layer",
        "volumetric-energy-halved",
        "volumetric-modulus-of-plane-strain",
        "whole-kick",
        "work-of-the-last-force",
        "xpic-a-power-short",
    ];

    /// Number of the planted fault; beyond the last if there is none.
    static PLANTED: AtomicUsize = AtomicUsize::new(FAULTS.len());

    /// Whether a site of each fault was passed.
    static PASSED: [AtomicBool; FAULTS.len()] = [const { AtomicBool::new(false) }; FAULTS.len()];

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

    /// Whether the fault of that number is planted; notes that a site of it was passed.
    #[inline(always)]
    pub fn is_planted(number: usize) -> bool {
        let passed = &PASSED[number];
        if !passed.load(Ordering::Relaxed) {
            passed.store(true, Ordering::Relaxed); // once: threads would fight over the line in memory
        }
        PLANTED.load(Ordering::Relaxed) == number
    }

    /// Names of the faults whose sites were passed since the last call.
    pub fn take_passed() -> Vec<&'static str> {
        FAULTS
            .iter()
            .zip(&PASSED)
            .filter(|(_, passed)| passed.swap(false, Ordering::Relaxed))
            .map(|(name, _)| *name)
            .collect()
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
