//! Sweeps with the strain measure of a scene, the nodal forces of an elastic body, and their change along a
//! direction of displacements, by central differences of the stress at each point.
//!
//! With finite kinematics any kernel of small strains runs on Hencky strains. It sees the Hencky strain of
//! `F = I + grad u` in place of the linear one and gives Kirchhoff's stress tau; the nodal forces take the
//! first Piola–Kirchhoff stress `P = tau F⁻ᵀ`, which works on the gradient in reference positions.

use super::kernels::ElasticStress;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{LANES, Lane, each};
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::hencky_strain;
use crate::particles::lattice::Lattice;
use crate::scene::Kinematics;
use crate::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};
use crate::transfer::sweep::{StripForces, sweep};

/// Change of the displacement gradient between the two stresses, halved: small against strains that matter,
/// large against round-off. It is the same at every point, whatever the direction is elsewhere.
const PROBE: f64 = 1e-8;

/// A kernel on Hencky strains; its logarithms take longer than loops whose length is not known.
pub(super) struct OnHenckyStrain<'a, K>(pub(super) &'a mut K);

impl<K: PointKernel> PointKernel for OnHenckyStrain<'_, K> {
    const DISPLACEMENT: bool = K::DISPLACEMENT;
    const PHASE: bool = K::PHASE;
    const PHASE_GRADIENT: bool = K::PHASE_GRADIENT;
    const STRESS: bool = K::STRESS;

    #[inline(always)]
    fn skips(&self, cell: usize) -> bool {
        self.0.skips(cell)
    }

    fn adds(&self) -> bool {
        self.0.adds()
    }

    #[inline(always)]
    fn prefetch(&self, at: usize) {
        self.0.prefetch(at);
    }

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        // Where there is no point, control points without mass may fly anywhere: no strain there.
        let [xx, xy, yx, yy] =
            each!(i in [0, 1, 2, 3] => values.gradient[i].zip(weight, |g, w| if w > 0.0 { g } else { 0.0 }));
        let (mut exx, mut eyy, mut exy) = (Lane::ZERO, Lane::ZERO, Lane::ZERO);
        for lane in 0..LANES {
            [exx[lane], eyy[lane], exy[lane]] = hencky_strain(&[[xx[lane], xy[lane]], [yx[lane], yy[lane]]]);
        }
        let strained = PointValues { gradient: [exx, exy, exy, eyy], ..*values };
        let tau = self.0.points::<FMA>(at, weight, &strained);
        let one = Lane::splat(1.0);
        let (fxx, fyy) = (one + xx, one + yy);
        let inverse = (fxx * fyy - xy * yx).map(|determinant| 1.0 / determinant);
        Stress {
            xx: (tau.xx * fyy - tau.xy * xy) * inverse,
            xy: (tau.xy * fxx - tau.xx * yx) * inverse,
            yx: (tau.yx * fyy - tau.yy * xy) * inverse,
            yy: (tau.yy * fxx - tau.yx * yx) * inverse,
        }
    }
}

/// What the elastic stress of a body follows from, beside the displacement.
#[derive(Debug, Clone, Copy)]
pub struct Elastic<'a> {
    /// Material points of the body.
    pub lattice: &'a Lattice,
    /// Elastic moduli of the intact body, Pa.
    pub moduli: ElasticModuli,
    /// Strain measure.
    pub kinematics: Kinematics,
}

/// [`sweep`] with the strain measure of a scene.
pub(crate) fn sweep_with<K: PointKernel>(
    body: Elastic,
    fields: Fields,
    kernels: &mut [K],
    forces: Option<&mut StripForces>,
) {
    match body.kinematics {
        Kinematics::Small => sweep(body.lattice, fields, kernels, forces),
        Kinematics::Finite => {
            let mut kernels: Vec<_> = kernels.iter_mut().map(OnHenckyStrain).collect();
            sweep(body.lattice, fields, &mut kernels, forces);
        }
    }
}

/// Nodal forces (N/m) of the elastic stress under a displacement (m); returns the elastic energy, J/m.
pub(crate) fn elastic_forces(body: Elastic, u: &VectorField, strips: &mut StripForces, out: &mut VectorField) -> f64 {
    let fields = Fields { displacement: [&u[0], &u[1]], phase: &[] };
    let energy = elastic_sweep(body, fields, strips);
    strips.assemble(body.lattice.grid.stride, out);
    energy
}

/// Forces (N/m) of the elastic stress, strip by strip; returns the elastic energy, J/m.
pub(crate) fn elastic_sweep(body: Elastic, fields: Fields, strips: &mut StripForces) -> f64 {
    let Elastic { lattice, moduli, .. } = body;
    let mut kernels: Vec<_> = (0..lattice.strips()).map(|_| ElasticStress { moduli, energy: Lane::ZERO }).collect();
    sweep_with(body, fields, &mut kernels, Some(strips));
    kernels.iter().map(|k| k.energy.sum()).sum()
}

/// Displacement gradients at the points of a strip.
struct Gradients<'a>(&'a mut [[Lane; 4]]);

impl PointKernel for Gradients<'_> {
    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, _weight: Lane, values: &PointValues) -> Stress {
        self.0[at] = values.gradient;
        Stress::ZERO
    }
}

/// Displacement gradients [u_x,x, u_x,y, u_y,x, u_y,y] at all points: one entry for each batch of each strip.
pub(crate) fn gradients(lattice: &Lattice, displacement: &VectorField) -> Vec<[Lane; 4]> {
    let mut gradients = vec![[Lane::ZERO; 4]; lattice.strips() * lattice.strip_batches()];
    let mut kernels: Vec<_> = gradients.chunks_mut(lattice.strip_batches()).map(Gradients).collect();
    let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
    sweep(lattice, fields, &mut kernels, None);
    gradients
}

/// The change of the stress of a kernel along the gradient that the sweep gives.
struct StressAlong<'a, K> {
    kernel: K,
    gradients: &'a [[Lane; 4]],
}

impl<K: PointKernel> PointKernel for StressAlong<'_, K> {
    const STRESS: bool = true;

    #[inline(always)]
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        let direction = values.gradient;
        let largest = direction.iter().fold(Lane::ZERO, |largest, d| largest.zip(*d, |a, b| larger(a, b.abs())));
        let probe = largest.map(|largest| PROBE / larger(largest, f64::MIN_POSITIVE));
        let here = self.gradients[at];
        let ahead = each!(i in [0, 1, 2, 3] => here[i] + direction[i] * probe);
        let back = each!(i in [0, 1, 2, 3] => here[i] - direction[i] * probe);
        let mut stress = |gradient| self.kernel.points::<FMA>(at, weight, &PointValues { gradient, ..*values });
        let (ahead, back) = (stress(ahead), stress(back));
        let rate = largest * Lane::splat(0.5 / PROBE);
        Stress {
            xx: (ahead.xx - back.xx) * rate,
            xy: (ahead.xy - back.xy) * rate,
            yx: (ahead.yx - back.yx) * rate,
            yy: (ahead.yy - back.yy) * rate,
        }
    }
}

/// Change of the nodal forces of the kernels (N/m per m of the direction) along a direction of displacements
/// (m), from a body with these [`gradients`]; the strips are not assembled yet.
pub(crate) fn sweep_along<K: PointKernel>(
    kinematics: Kinematics,
    lattice: &Lattice,
    gradients: &[[Lane; 4]],
    direction: &VectorField,
    kernels: impl Iterator<Item = K>,
    forces: &mut StripForces,
) {
    let fields = Fields { displacement: [&direction[0], &direction[1]], phase: &[] };
    let strips = gradients.chunks(lattice.strip_batches());
    match kinematics {
        Kinematics::Small => {
            let mut along: Vec<_> =
                kernels.zip(strips).map(|(kernel, gradients)| StressAlong { kernel, gradients }).collect();
            sweep(lattice, fields, &mut along, Some(forces));
        }
        Kinematics::Finite => {
            let mut kernels: Vec<_> = kernels.collect();
            let finite = kernels.iter_mut().map(OnHenckyStrain).zip(strips);
            let mut along: Vec<_> = finite.map(|(kernel, gradients)| StressAlong { kernel, gradients }).collect();
            sweep(lattice, fields, &mut along, Some(forces));
        }
    }
}
