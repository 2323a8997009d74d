//! Checks that no planted error turns red, and why they stay.

/// Pattern of checks `suite/case/quantity`, and the reason.
const REASONS: &[(&str, &str)] = &[
    (
        "patch/spline-basis/*",
        "an identity of the recursion of the basis, in which no error is planted: most other checks would turn red with it, and this one \
         says where to look",
    ),
    (
        "stability/boundary-points/*-1-is-yes",
        "what validation says before anything is computed; errors are planted in what computes",
    ),
    (
        "stability/unloading/peaks-of-the-elastic-energy",
        "makes sure that the load comes and goes, without which the other checks of the case say nothing",
    ),
];

/// Why a check stays though no fault turns it red, if somebody said so.
pub fn reason(check: &str) -> Option<&'static str> {
    let matches = |pattern: &str| glob::Pattern::new(pattern).is_ok_and(|pattern| pattern.matches(check));
    REASONS.iter().find(|(pattern, _)| matches(pattern)).map(|(_, reason)| *reason)
}
