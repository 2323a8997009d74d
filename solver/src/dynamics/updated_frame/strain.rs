//! How a step strains the points, with the gradient A of its displacement at the positions before it: small
//! kinematics `e ← e + sym A`, finite ones `F ← (I + A) F`, in [`hencky`](crate::material::hencky).

use crate::material::hencky::{Gradient, advance, gradient_at_end, hencky_strain, symmetric};

/// Strains the points of a strip.
pub trait StrainUpdate {
    /// Brings the strain `[xx, yy, xy]` of point `at` of the strip up to date with the displacement of a
    /// step, whose gradient at the positions before it is `step`. Returns the strain of the step that the new
    /// stress works on.
    fn strain(&mut self, at: usize, strain: &mut [f64; 3], step: &Gradient) -> [f64; 3];
}

/// Linear strain, the sum of `dt sym(grad v)`.
#[derive(Debug, Clone, Copy)]
pub struct SmallStrain;

impl StrainUpdate for SmallStrain {
    #[inline(always)]
    fn strain(&mut self, _at: usize, strain: &mut [f64; 3], step: &Gradient) -> [f64; 3] {
        let increment = symmetric(*step);
        for i in 0..3 {
            strain[i] += increment[i];
        }
        increment
    }
}

/// Hencky strain, from the displacement gradients `F − I` of the points of the strip.
#[derive(Debug)]
pub struct FiniteStrain<'a>(pub &'a mut [Gradient]);

impl StrainUpdate for FiniteStrain<'_> {
    #[inline(always)]
    fn strain(&mut self, at: usize, strain: &mut [f64; 3], step: &Gradient) -> [f64; 3] {
        self.0[at] = advance(&self.0[at], step);
        *strain = hencky_strain(&self.0[at]);
        symmetric(gradient_at_end(step))
    }
}
