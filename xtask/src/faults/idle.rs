//! Checks that no planted error turns red, and why they stay.

/// Pattern of checks `suite/case/quantity`, and the reason.
const REASONS: &[(&str, &str)] = &[
    (
        "patch/spline-basis/*",
        "an identity of the recursion of the basis, in which no error is planted: most other checks would fail with it, and this one \
         locates it",
    ),
    (
        "stability/boundary-points/*-1-is-yes",
        "checks validation before the computation; errors are planted in the computation",
    ),
    (
        "stability/unloading/peaks-of-the-elastic-energy",
        "checks that the load rises and falls; the other checks of the case need this",
    ),
];

/// Why a check stays though no fault turns it red, if somebody said so.
pub fn reason(check: &str) -> Option<&'static str> {
    let matches = |pattern: &str| glob::Pattern::new(pattern).is_ok_and(|pattern| pattern.matches(check));
    REASONS.iter().find(|(pattern, _)| matches(pattern)).map(|(_, reason)| *reason)
}
