//! What happens at the material points in the total frame, one kernel per sweep:
//!
//! ```text
//! H ← max(H, psi+(e))                                 history energy                             E 10
//! sigma = g(c) dpsi+/de + dpsi−/de                    degraded stress                            E 6
//! Σ V Gc ((1 − c)²/(4 l0) + l0 |grad c|²)             surface energy of the crack                E 3
//! ```

use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::{Lane, prefetch};
use crate::material::degradation::{BROKEN, FractureModel};
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::spectral_radius;
use crate::material::split::{driving_energy, split};
use crate::transfer::point_kernel::{PointKernel, PointValues, Stress};

/// Linear strain `[exx, eyy, exy]` of a displacement gradient.
#[inline(always)]
fn strain([xx, xy, yx, yy]: [Lane; 4]) -> [Lane; 3] {
    [xx, yy, (xy + yx) * 0.5]
}

/// Stress and energy of an intact body.
#[derive(Debug)]
pub struct ElasticStress {
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Elastic energy of the strip per unit thickness, J/m.
    pub energy: Lane,
}

impl PointKernel for ElasticStress {
    const STRESS: bool = true;
    const EVERY_STEP: bool = true;

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, _at: usize, weight: Lane, values: &PointValues) -> Stress {
        let strain = strain(values.gradient);
        self.energy = self.energy.add_product::<FMA>(weight, self.moduli.energy(strain));
        Stress::symmetric(self.moduli.stress(strain))
    }
}

/// History energy `H ← max(H, psi+)` (E 10), or the present `max(0, psi+)`.
#[derive(Debug)]
pub struct HistoryUpdate<'a> {
    /// Cells of the strip to visit; empty if it is all.
    pub cells: &'a [bool],
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Fracture constants.
    pub model: FractureModel,
    /// History energy of the strip, J/m³.
    pub history: &'a mut [Lane],
}

impl PointKernel for HistoryUpdate<'_> {
    const EVERY_STEP: bool = true;

    #[inline(always)]
    fn skips(&self, cell: usize) -> bool {
        !self.cells.is_empty() && !self.cells[cell]
    }

    #[inline(always)]
    fn prefetch(&self, at: usize) {
        prefetch(self.history, at);
    }

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, _weight: Lane, values: &PointValues) -> Stress {
        let energy = driving_energy(&self.moduli, self.model.split, strain(values.gradient));
        let least = if self.model.threshold().is_none() { self.history[at] } else { Lane::ZERO };
        self.history[at] = fault!("history-forgets", energy.at_least(least) => energy);
        Stress::ZERO
    }
}

/// Degraded stress (E 6), elastic energy, and the work of the history field over the step.
#[derive(Debug)]
pub struct DegradedStress<'a> {
    /// Cells of the strip to visit, where the stress is added to that of the intact body; empty if it is all
    /// there is.
    pub cells: &'a [bool],
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Fracture constants.
    pub model: FractureModel,
    /// History energy of the strip, J/m³.
    pub history: &'a mut [Lane],
    /// Whether the history energy is still that of the last step.
    pub updates_history: bool,
    /// Phase field at the points: at the last step, then at this one.
    pub phase: &'a mut [Lane],
    /// `s (H − psi+)` at the points: at the last step, then at this one, J/m³.
    pub excess: &'a mut [Lane],
    /// `s H` at the points: at the last step, then at this one, J/m³; empty if its work is not asked for.
    pub drive: &'a mut [Lane],
    /// Elastic energy per unit thickness, J/m.
    pub energy: Lane,
    /// Work of the history field over the step, without the factor 1 − k, J/m.
    pub history_work: Lane,
    /// Work of the change of c on the history energy over the step, without the factor 1 − k, J/m.
    pub drive_work: Lane,
}

impl PointKernel for DegradedStress<'_> {
    const PHASE: bool = true;
    const STRESS: bool = true;
    const EVERY_STEP: bool = true;

    #[inline(always)]
    fn skips(&self, cell: usize) -> bool {
        !self.cells.is_empty() && !self.cells[cell]
    }

    fn adds(&self) -> bool {
        !self.cells.is_empty()
    }

    #[inline(always)]
    fn prefetch(&self, at: usize) {
        prefetch(self.history, at);
        prefetch(self.phase, at);
        prefetch(self.excess, at);
        prefetch(self.drive, at);
    }

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let strain = strain(values.gradient);
        let state = split(&self.moduli, self.model.split, strain);
        let c = values.phase;
        if self.updates_history {
            self.history[at] = state.driving_energy(&self.moduli, self.model.split).at_least(self.history[at]);
        }
        let slope = self.model.half_slope(c);
        let excess = slope * (self.history[at] - state.energy_plus);
        let change = (excess + self.excess[at]) * (self.phase[at] - c);
        self.history_work = self.history_work.add_product::<FMA>(weight, change);
        self.excess[at] = excess;
        if !self.drive.is_empty() {
            let drive = slope * self.history[at];
            let change = (drive + self.drive[at]) * (c - self.phase[at]);
            self.drive_work = self.drive_work.add_product::<FMA>(weight, change);
            self.drive[at] = drive;
        }
        self.phase[at] = c;
        let (mut energy, mut stress) = state.degraded::<FMA>(self.model.degradation(c));
        if self.adds() {
            energy = energy - self.moduli.energy(strain);
            let intact = self.moduli.stress(fault!("intact-stress-left-in", strain => [Lane::ZERO; 3]));
            for i in 0..3 {
                stress[i] = stress[i] - intact[i];
            }
        }
        self.energy = self.energy.add_product::<FMA>(weight, energy);
        Stress::symmetric(stress)
    }
}

/// Stress and energy of an intact body, and the cells whose energy density reaches a level.
#[derive(Debug)]
pub(crate) struct ScreenedStress<'a> {
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Energy density from which on a cell is noted, J/m³.
    pub level: f64,
    /// Number of batches in a cell: as many as a span has points.
    pub span: usize,
    /// Whether a cell of the strip reaches it.
    pub reached: &'a mut [bool],
    /// Largest energy density in the present cell, J/m³.
    pub most: Lane,
    /// Elastic energy of the strip per unit thickness, J/m.
    pub energy: Lane,
}

impl PointKernel for ScreenedStress<'_> {
    const STRESS: bool = true;
    const EVERY_STEP: bool = true;

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let strain = strain(values.gradient);
        let energy = self.moduli.energy(strain);
        self.energy = self.energy.add_product::<FMA>(weight, energy);
        let here = energy.zip(weight, |energy, weight| if weight > 0.0 { energy } else { 0.0 });
        self.most = here.at_least(self.most);
        if (at + 1).is_multiple_of(self.span) {
            self.reached[at / self.span] = self.most.0.iter().any(|&energy| energy >= self.level);
            self.most = Lane::ZERO;
        }
        Stress::symmetric(self.moduli.stress(strain))
    }
}

/// Degraded stress (E 6) with the phase field held as it is at the points.
#[derive(Debug)]
pub(crate) struct HeldPhaseStress<'a> {
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Fracture constants.
    pub model: FractureModel,
    /// Phase field at the points of the strip.
    pub phase: &'a [Lane],
}

impl PointKernel for HeldPhaseStress<'_> {
    const STRESS: bool = true;

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, _weight: Lane, values: &PointValues) -> Stress {
        let state = split(&self.moduli, self.model.split, strain(values.gradient));
        Stress::symmetric(state.degraded::<FMA>(self.model.degradation(self.phase[at])).1)
    }
}

/// Smallest principal stretch, squared: the smaller eigenvalue of `F Fᵀ` (see [`crate::material::hencky`]).
#[derive(Debug)]
pub(crate) struct LeastStretch<'a> {
    /// Phase field at the points of the strip, of which those that are broken do not count; empty if all
    /// count.
    pub phase: &'a [Lane],
    /// Smallest of the strip; not a number if one is not.
    pub squared: Lane,
}

impl PointKernel for LeastStretch<'_> {
    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let [xx, xy, yx, yy] = values.gradient;
        let mean = xx + yy + (xx * xx + xy * xy + yx * yx + yy * yy) * 0.5;
        let half_difference = xx - yy + (xx * xx + xy * xy - yx * yx - yy * yy) * 0.5;
        let shear = xy + yx + (xx * yx + xy * yy);
        let radius = (half_difference * half_difference + shear * shear).map(f64::sqrt);
        let weight = of_intact(weight, self.phase, at);
        let squared = (mean - radius + Lane::splat(1.0)).zip(weight, |x, w| if w > 0.0 { x } else { f64::INFINITY });
        self.squared = self.squared.zip(squared, smaller);
        Stress::ZERO
    }
}

/// What bounds the largest [`Distortion`](crate::material::hencky::Distortion).
#[derive(Debug)]
pub(crate) struct LargestDistortion<'a> {
    /// Phase field at the points of the strip, as in [`LeastStretch`].
    pub phase: &'a [Lane],
    /// Tangent of the largest angle of the strip, infinite from a right angle on, or its largest strain where
    /// nothing can break; NaN if one is.
    pub size: Lane,
}

impl PointKernel for LargestDistortion<'_> {
    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let [xx, xy, yx, yy] = values.gradient;
        let (sine, cosine) = (yx - xy, xx + yy + Lane::splat(2.0));
        let tangent = sine.zip(cosine, |sine, cosine| if cosine <= 0.0 { f64::INFINITY } else { sine.abs() / cosine });
        let weight = of_intact(weight, self.phase, at);
        let of_points = |size: Lane| size.zip(weight, |size, w| if w > 0.0 { size } else { 0.0 });
        self.size = self.size.zip(of_points(tangent), larger);
        if self.phase.is_empty() {
            let strain = |l: usize| spectral_radius([xx.0[l], yy.0[l], 0.5 * (xy.0[l] + yx.0[l])]);
            self.size = self.size.zip(of_points(Lane(std::array::from_fn(strain))), larger);
        }
        Stress::ZERO
    }
}

/// Weights of a batch, zero for broken points; `phase` is empty if all count.
#[inline(always)]
fn of_intact(weight: Lane, phase: &[Lane], at: usize) -> Lane {
    phase.get(at).map_or(weight, |c| weight.zip(*c, |w, c| if c < BROKEN { 0.0 } else { w }))
}

/// Surface energy `Gc [(1 − c)²/(4 l0) + l0 |grad c|²]` (E 3) and the smallest c.
#[derive(Debug)]
pub(crate) struct SurfaceEnergy<'a> {
    /// Fracture constants.
    pub model: FractureModel,
    /// Gc over its mean at the points of the strip; empty if it is the same everywhere.
    pub relative: &'a [Lane],
    /// Surface energy per unit thickness, J/m.
    pub energy: Lane,
    /// Smallest c at a point.
    pub least: Lane,
}

impl PointKernel for SurfaceEnergy<'_> {
    const DISPLACEMENT: bool = false;
    const PHASE: bool = true;
    const PHASE_GRADIENT: bool = true;

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let mut density = self.model.surface_energy(values.phase, values.phase_gradient);
        if let Some(relative) = self.relative.get(at) {
            density = density * *relative;
        }
        self.energy = self.energy.add_product::<FMA>(weight, density);
        let exists = values.phase.zip(weight, |c, w| if w > 0.0 { c } else { f64::INFINITY });
        self.least = self.least.zip(exists, smaller);
        Stress::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::hencky::Distortion;

    /// The bound is the size that is told; lanes that fill up a batch (weight 0) and broken points are no
    /// material.
    #[test]
    fn only_material_is_distorted() {
        let gradients = [[[0.1, -0.3], [0.2, -0.1]], [[0.3, 0.02], [0.0, 0.1]], [[0.0, -2.0], [3.0, 0.0]]];
        let lanes = |row: usize, column: usize| Lane(std::array::from_fn(|l| gradients[l.min(2)][row][column]));
        let gradient = [lanes(0, 0), lanes(0, 1), lanes(1, 0), lanes(1, 1)];
        let values = PointValues { gradient, phase: Lane::ZERO, phase_gradient: [Lane::ZERO; 2] };
        let with_two = Lane(std::array::from_fn(|l| if l < 2 { 1.0 } else { 0.0 }));
        let sizes = |phase: &[Lane]| {
            let mut kernel = LargestDistortion { phase, size: Lane::ZERO };
            kernel.points::<false>(0, with_two, &values);
            kernel.size.0
        };
        let told = |lane: usize, strains: bool| Distortion::of(&gradients[lane], strains).size();
        let elastic = sizes(&[]);
        for (lane, expected) in [(0, told(0, false).tan()), (1, told(1, true)), (2, 0.0), (7, 0.0)] {
            approx::assert_relative_eq!(elastic[lane], expected, epsilon = 1e-14);
        }
        let first_is_broken = Lane(std::array::from_fn(|l| if l == 0 { 0.01 } else { 1.0 }));
        let cracking = sizes(&[first_is_broken]);
        assert_eq!(cracking[0], 0.0);
        approx::assert_relative_eq!(cracking[1], told(1, false).tan(), epsilon = 1e-14);
    }
}
