//! How a step strains the points, with the gradient A of its displacement at the positions before it: small
//! kinematics `e ← e + sym A`, finite ones `F ← (I + A) F`, in [`hencky`](crate::material::hencky).

use crate::material::hencky::{Gradient, advance, gradient_at_end, hencky_strain, symmetric};
use crate::particles::points::Point;

/// Strains the points of a strip.
pub trait StrainUpdate {
    /// Brings the strain and the domain of point `at` of the strip up to date with the displacement of a
    /// step, whose gradient at the positions before it is `step`. Returns the strain of the step that the
    /// new stress works on.
    fn strain(&mut self, at: usize, point: &mut Point, step: &Gradient) -> [f64; 3];
}

/// Linear strain, the sum of `dt sym(grad v)`.
#[derive(Debug, Clone, Copy)]
pub struct SmallStrain;

impl StrainUpdate for SmallStrain {
    #[inline(always)]
    fn strain(&mut self, _at: usize, point: &mut Point, step: &Gradient) -> [f64; 3] {
        let increment = symmetric(*step);
        for i in 0..3 {
            point.strain[i] += increment[i];
        }
        (0..2).for_each(|d| point.half_width[d] *= 1.0 + step[d][d]);
        increment
    }
}

/// Hencky strain from the deformation gradient, for finite kinematics.
#[derive(Debug)]
pub struct FiniteStrain<'a> {
    /// Displacement gradients `F − I` of the points of the strip.
    pub deformation: &'a mut [Gradient],
}

impl StrainUpdate for FiniteStrain<'_> {
    #[inline(always)]
    fn strain(&mut self, at: usize, point: &mut Point, step: &Gradient) -> [f64; 3] {
        let deformation = &mut self.deformation[at];
        *deformation = advance(deformation, step);
        point.strain = hencky_strain(deformation);
        point.deform_domain(deformation);
        symmetric(gradient_at_end(step))
    }
}
