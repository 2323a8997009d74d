//! How a step strains the points, with the gradient A of its displacement at the positions before it: small
//! kinematics `e ← e + sym A`, finite ones `F ← (I + A) F`, in [`hencky`](crate::material::hencky).

use crate::material::hencky::{Gradient, advance, gradient_at_end, hencky_strain, symmetric};
use crate::particles::points::Point;

/// Strains the points of a strip.
pub trait StrainUpdate {
    /// Brings the strain and the domain of point `at` of the strip up to date with the displacement of a
    /// step, whose gradient at the positions before it is `step`; `spread` is what [`FiniteStrain`] needs of
    /// its cell. Returns the strain of the step that the new stress works on.
    fn strain(&mut self, at: usize, point: &mut Point, step: &Gradient, spread: [f64; 2]) -> [f64; 3];
}

/// Linear strain, the sum of `dt sym(grad v)`; domains keep their sizes.
#[derive(Debug, Clone, Copy)]
pub struct SmallStrain;

impl StrainUpdate for SmallStrain {
    #[inline(always)]
    fn strain(&mut self, _at: usize, point: &mut Point, step: &Gradient, _spread: [f64; 2]) -> [f64; 3] {
        let increment = symmetric(*step);
        for i in 0..3 {
            point.strain[i] += increment[i];
        }
        increment
    }
}

/// Hencky strain.
#[derive(Debug)]
pub struct FiniteStrain<'a> {
    /// Displacement gradients `F − I` of the points of the strip.
    pub deformation: &'a mut [Gradient],
    /// Their velocity gradients C if these are fitted with weights (APIC), else empty: the spread D of the
    /// fit grows with a domain by a third of the square of its half width, and the angular momentum of
    /// `C D` is to stay.
    pub fitted: &'a mut [Gradient],
}

impl StrainUpdate for FiniteStrain<'_> {
    #[inline(always)]
    fn strain(&mut self, at: usize, point: &mut Point, step: &Gradient, spread: [f64; 2]) -> [f64; 3] {
        let deformation = &mut self.deformation[at];
        *deformation = advance(deformation, step);
        point.strain = hencky_strain(deformation);
        let before = point.half_width;
        point.deform_domain(deformation);
        if let Some(fitted) = self.fitted.get_mut(at) {
            let with_domain = |half_width: [f64; 2], d: usize| spread[d] + half_width[d] * half_width[d] / 3.0;
            for d in 0..2 {
                let factor = with_domain(before, d) / with_domain(point.half_width, d);
                fitted.iter_mut().for_each(|row| row[d] *= fault!("affine-not-scaled", factor => 1.0));
            }
        }
        symmetric(gradient_at_end(step))
    }
}
