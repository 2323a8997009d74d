//! Ratios that are asked for, and some that are good to know.

use super::ratios::Target;

/// A ratio of sums of times per unit of work: terms are `(sign, id)`.
pub(super) struct Ratio {
    /// In words.
    pub what: &'static str,
    /// What is divided.
    pub above: &'static [(f64, &'static str)],
    /// By what.
    pub below: &'static [(f64, &'static str)],
    /// What is asked for.
    pub target: Target,
    /// Times are those of a step of all points, not per point: where the numbers of points differ.
    pub whole: bool,
}

const fn ratio(
    what: &'static str,
    above: &'static [(f64, &'static str)],
    below: &'static [(f64, &'static str)],
    target: Target,
) -> Ratio {
    Ratio { what, above, below, target, whole: false }
}

const KERNEL: Target = Target::AtMost(1.4);

/// What is asked for, and what is good to know beside it.
pub(super) const RATIOS: [Ratio; 25] = [
    ratio(
        "elastic step over the minimal kernel, updated frame, p = 2",
        &[(1.0, "stages/p2/elastic-step-updated")],
        &[(1.0, "stages/p2/minimal-step")],
        KERNEL,
    ),
    ratio(
        "elastic step over the minimal kernel, updated frame, p = 3",
        &[(1.0, "stages/p3/elastic-step-updated")],
        &[(1.0, "stages/p3/minimal-step")],
        KERNEL,
    ),
    ratio(
        "p = 3 over p = 2 per particle-step, total frame",
        &[(1.0, "stages/p3/elastic-step")],
        &[(1.0, "stages/p2/elastic-step")],
        KERNEL,
    ),
    ratio(
        "p = 3 over p = 2 per particle-step, updated frame",
        &[(1.0, "stages/p3/elastic-step-updated")],
        &[(1.0, "stages/p2/elastic-step-updated")],
        KERNEL,
    ),
    ratio(
        "spectral split: share of a step of the plate",
        &[
            (1.0, "stages/p2/history-sweep"),
            (-1.0, "stages/p2/history-sweep-no-split"),
            (1.0, "stages/p2/stress-sweep"),
            (-1.0, "stages/p2/stress-sweep-no-split"),
        ],
        &[(1.0, "plate/share/step")],
        Target::AtMost(0.1),
    ),
    ratio(
        "split and history, with the second interpolation: share of a step of the plate",
        &[(1.0, "stages/p2/history-sweep"), (1.0, "stages/p2/stress-sweep"), (-1.0, "stages/p2/elastic-sweep")],
        &[(1.0, "plate/share/step")],
        Target::None,
    ),
    ratio(
        "phase field: share of a step of the plate",
        &[(1.0, "plate/share/phase-field")],
        &[(1.0, "plate/share/step")],
        Target::AtMost(0.6),
    ),
    ratio(
        "Jacobi over incomplete Cholesky, cold crack, h = l0/2, p = 2",
        &[(1.0, "solves/p2/l2/jacobi")],
        &[(1.0, "solves/p2/l2/incomplete-cholesky")],
        Target::AtLeast(3.0),
    ),
    ratio(
        "Jacobi over incomplete Cholesky, cold crack, h = l0/2, p = 3",
        &[(1.0, "solves/p3/l2/jacobi")],
        &[(1.0, "solves/p3/l2/incomplete-cholesky")],
        Target::AtLeast(9.0),
    ),
    ratio(
        "sparse Cholesky over incomplete Cholesky, h = l0/2, p = 2",
        &[(1.0, "solves/p2/l2/cholesky")],
        &[(1.0, "solves/p2/l2/incomplete-cholesky")],
        Target::None,
    ),
    ratio(
        "sparse Cholesky over incomplete Cholesky, h = l0/2, p = 3",
        &[(1.0, "solves/p3/l2/cholesky")],
        &[(1.0, "solves/p3/l2/incomplete-cholesky")],
        Target::None,
    ),
    ratio(
        "two threads against one, elastic block",
        &[(1.0, "threads/elastic/1")],
        &[(1.0, "threads/elastic/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "two threads against one, plate",
        &[(1.0, "threads/plate/1")],
        &[(1.0, "threads/plate/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "two threads against one, moving points",
        &[(1.0, "threads/moving/1")],
        &[(1.0, "threads/moving/2")],
        Target::AtLeast(1.7),
    ),
    ratio(
        "time per point, 1.6e7 points over 2.6e6, elastic block",
        &[(1.0, "scale/elastic/2000")],
        &[(1.0, "scale/elastic/800")],
        Target::AtMost(1.25),
    ),
    ratio(
        "time per point, 1.6e7 points over 2.6e6, growing cracks",
        &[(1.0, "scale/cracking/2000")],
        &[(1.0, "scale/cracking/800")],
        Target::AtMost(1.25),
    ),
    ratio(
        "time per point, 1.6e7 points over 2.6e6, moving points",
        &[(1.0, "scale/moving/2000")],
        &[(1.0, "scale/moving/800")],
        Target::AtMost(1.25),
    ),
    ratio(
        "time per point, 1.6e7 points over 1.6e5, elastic block",
        &[(1.0, "scale/elastic/2000")],
        &[(1.0, "scale/elastic/200")],
        Target::None,
    ),
    ratio(
        "time per point, 1.6e7 points over 1.6e5, growing cracks",
        &[(1.0, "scale/cracking/2000")],
        &[(1.0, "scale/cracking/200")],
        Target::None,
    ),
    ratio(
        "time per point, 1.6e7 points over 1.6e5, moving points",
        &[(1.0, "scale/moving/2000")],
        &[(1.0, "scale/moving/200")],
        Target::None,
    ),
    ratio(
        "fracture with a frozen crack over elastic, total frame",
        &[(1.0, "scenes/total/elastic-with-a-frozen-crack")],
        &[(1.0, "scenes/total/elastic")],
        Target::None,
    ),
    ratio(
        "fracture with a frozen crack over elastic, updated frame",
        &[(1.0, "scenes/updated/elastic-with-a-frozen-crack")],
        &[(1.0, "scenes/updated/elastic")],
        Target::AtMost(1.5),
    ),
    Ratio {
        what: "the whole plate over half of it, time per step",
        above: &[(1.0, "scenes/total/the-whole-plate")],
        below: &[(1.0, "scenes/total/half-of-the-plate")],
        target: Target::None,
        whole: true,
    },
    Ratio {
        what: "spans that integrate over points, time per step: discs with 16 spans per radius, p = 2",
        above: &[(1.0, "contact/discs/p2-spans/16/loss")],
        below: &[(1.0, "contact/discs/p2-flip/16/loss")],
        target: Target::AtMost(2.0),
        whole: true,
    },
    Ratio {
        what: "spans that integrate over points, time per step: discs with 16 spans per radius, p = 3",
        above: &[(1.0, "contact/discs/p3-spans/16/loss")],
        below: &[(1.0, "contact/discs/p3-flip/16/loss")],
        target: Target::AtMost(2.0),
        whole: true,
    },
];
