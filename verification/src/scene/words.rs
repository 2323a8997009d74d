//! The words that scene and case files have for the choices of a scene.

use fisura::scene::{Frame, Kinematics, Layout, Mass, PhaseFieldSolver, Plane, Side, Softening, Split};

use super::fields::Words;

macro_rules! words {
    ($($choice:ident: $($word:expr => $value:ident),+;)+) => {
        $(impl Words for $choice {
            const WORDS: &'static [(&'static str, Self)] = &[$(($word, Self::$value)),+];
        })+
    };
}

words! {
    Plane: "strain" => Strain, "stress" => Stress;
    Frame: "total" => Total, "updated" => Updated;
    Kinematics: "small" => Small, "finite" => Finite;
    Mass: "lumped" => Lumped, "consistent" => Consistent;
    Layout: "gauss" => Gauss, "uniform" => Uniform, "maclaurin" => Maclaurin;
    Softening:
        Self::Linear.word() => Linear,
        Self::Exponential.word() => Exponential,
        Self::Cornelissen.word() => Cornelissen;
    Split:
        "spectral" => Spectral,
        "volumetric-deviatoric" => VolumetricDeviatoric,
        "rankine" => Rankine,
        "none" => None;
    PhaseFieldSolver: "conjugate-gradients" => ConjugateGradients, "cholesky" => Cholesky;
    Side: "left" => Left, "right" => Right, "bottom" => Bottom, "top" => Top;
}
