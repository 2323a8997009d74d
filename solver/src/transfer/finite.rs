//! Finite kinematics in the total frame: any kernel of small strains on Hencky strains.
//!
//! The kernel sees the Hencky strain of `F = I + grad u` in place of the linear one and gives Kirchhoff's
//! stress tau; the nodal forces take the first Piola–Kirchhoff stress `P = tau F⁻ᵀ`, which works on the
//! gradient in reference positions.

use crate::linear_algebra::lane::{LANES, Lane, each};
use crate::material::hencky::hencky_strain;
use crate::particles::lattice::Lattice;
use crate::scene::Kinematics;
use crate::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};
use crate::transfer::sweep::{StripForces, sweep};

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

/// [`sweep`] with the strain measure of a scene.
pub(crate) fn sweep_with<K: PointKernel>(
    kinematics: Kinematics,
    lattice: &Lattice,
    fields: Fields,
    kernels: &mut [K],
    forces: Option<&mut StripForces>,
) {
    match kinematics {
        Kinematics::Small => sweep(lattice, fields, kernels, forces),
        Kinematics::Finite => {
            let mut kernels: Vec<_> = kernels.iter_mut().map(OnHenckyStrain).collect();
            sweep(lattice, fields, &mut kernels, forces);
        }
    }
}
