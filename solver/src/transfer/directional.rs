//! Change of the nodal forces along a direction of displacements, by central differences of the stress at
//! each point.

use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{Lane, each};
use crate::particles::lattice::Lattice;
use crate::scene::Kinematics;
use crate::transfer::finite::OnHenckyStrain;
use crate::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};
use crate::transfer::sweep::{StripForces, sweep};

/// Change of the displacement gradient between the two stresses, halved: small against strains that matter,
/// large against round-off. It is the same at every point, whatever the direction is elsewhere.
const PROBE: f64 = 1e-8;

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
