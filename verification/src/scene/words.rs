//! The words that scene and case files have for the choices of a scene.

use fisura::scene::{Frame, Kinematics, Layout, Mass, PhaseFieldSolver, Plane, Side, Softening, Split};

use super::fields::Words;

impl Words for Plane {
    const WORDS: &'static [(&'static str, Self)] = &[("strain", Self::Strain), ("stress", Self::Stress)];
}

impl Words for Frame {
    const WORDS: &'static [(&'static str, Self)] = &[("total", Self::Total), ("updated", Self::Updated)];
}

impl Words for Kinematics {
    const WORDS: &'static [(&'static str, Self)] = &[("small", Self::Small), ("finite", Self::Finite)];
}

impl Words for Mass {
    const WORDS: &'static [(&'static str, Self)] = &[("lumped", Self::Lumped), ("consistent", Self::Consistent)];
}

impl Words for Layout {
    const WORDS: &'static [(&'static str, Self)] =
        &[("gauss", Self::Gauss), ("uniform", Self::Uniform), ("maclaurin", Self::Maclaurin)];
}

impl Words for Softening {
    const WORDS: &'static [(&'static str, Self)] = &[
        (Self::Linear.word(), Self::Linear),
        (Self::Exponential.word(), Self::Exponential),
        (Self::Cornelissen.word(), Self::Cornelissen),
    ];
}

impl Words for Split {
    const WORDS: &'static [(&'static str, Self)] = &[
        ("spectral", Self::Spectral),
        ("volumetric-deviatoric", Self::VolumetricDeviatoric),
        ("rankine", Self::Rankine),
        ("none", Self::None),
    ];
}

impl Words for PhaseFieldSolver {
    const WORDS: &'static [(&'static str, Self)] =
        &[("conjugate-gradients", Self::ConjugateGradients), ("cholesky", Self::Cholesky)];
}

impl Words for Side {
    const WORDS: &'static [(&'static str, Self)] =
        &[("left", Self::Left), ("right", Self::Right), ("bottom", Self::Bottom), ("top", Self::Top)];
}
