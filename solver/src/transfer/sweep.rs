//! One pass over the material points of a body: control values to points, physics at the points, points to nodes.
//!
//! In the total frame the transfers G2P and P2G (E 15–18) are interpolation from and integration onto control points
//! that never move, and both factor over the directions. A sweep walks down a column of tiles with the partial sums in x
//! of the last `q + 1` control rows at hand, so every control value is read and every nodal force written once per
//! strip. What happens at the points is a [`PointKernel`]; what it does not ask for is not interpolated.

mod strip;

use rayon::prelude::*;

use crate::linear_algebra::lane::{Lane, dispatch};
use crate::particles::lattice::Lattice;
use strip::StripSweep;

/// What the fields are at a batch of points.
#[derive(Debug, Clone, Copy)]
pub struct PointValues {
    /// Displacement gradient: `[du_x/dx, du_x/dy, du_y/dx, du_y/dy]`.
    pub gradient: [Lane; 4],
    /// Phase field.
    pub phase: Lane,
    /// Its gradient, 1/m.
    pub phase_gradient: [Lane; 2],
}

/// In-plane stress of a batch of points, Pa: work-conjugate to the displacement gradient, so `xy` is the force in x on a
/// face with normal y. Only a first Piola–Kirchhoff stress has `xy` and `yx` that differ.
#[derive(Debug, Clone, Copy)]
pub struct Stress {
    /// Normal stress in x.
    pub xx: Lane,
    /// Shear stress, force in x.
    pub xy: Lane,
    /// Shear stress, force in y.
    pub yx: Lane,
    /// Normal stress in y.
    pub yy: Lane,
}

impl Stress {
    /// No stress.
    pub const ZERO: Self = Self::symmetric([Lane::ZERO; 3]);

    /// A symmetric stress `[xx, yy, xy]`.
    #[inline(always)]
    pub const fn symmetric([xx, yy, xy]: [Lane; 3]) -> Self {
        Self { xx, xy, yx: xy, yy }
    }
}

/// Physics at the points of a strip.
pub trait PointKernel: Send {
    /// Whether the displacement gradient is needed.
    const DISPLACEMENT: bool;
    /// Whether the phase field is needed.
    const PHASE: bool;
    /// Whether its gradient is needed.
    const PHASE_GRADIENT: bool;
    /// Whether the returned stress is to be integrated into nodal forces.
    const STRESS: bool;

    /// One batch: `at` counts batches from the start of the strip, `weight` is in m² and zero where there is no point.
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress;
}

/// Control fields a sweep reads; a field that its kernel does not need may be empty.
#[derive(Debug, Clone, Copy)]
pub struct Fields<'a> {
    /// Displacement components, m.
    pub displacement: [&'a [f64]; 2],
    /// Phase field.
    pub phase: &'a [f64],
}

/// Nodal forces strip by strip; neighbouring strips share control rows and are added in a fixed order.
#[derive(Debug, Clone)]
pub struct StripForces {
    strips: Vec<StripForce>,
}

#[derive(Debug, Clone)]
struct StripForce {
    first_row: usize,
    components: [Vec<f64>; 2],
}

impl StripForces {
    /// Room for the forces on the control points of `lattice`.
    pub fn new(lattice: &Lattice) -> Self {
        let strips = (0..lattice.strips()).map(|strip| {
            let rows = lattice.strip_control_rows(strip);
            let length = rows.len() * lattice.grid.stride;
            StripForce { first_row: rows.start, components: [vec![0.0; length], vec![0.0; length]] }
        });
        Self { strips: strips.collect() }
    }

    /// Adds the strips up, per unit thickness: N/m, into fields on the control points.
    pub fn assemble(&self, stride: usize, out: &mut [Vec<f64>; 2]) {
        let [x, y] = out;
        x.par_chunks_mut(stride).zip(y.par_chunks_mut(stride)).enumerate().for_each(|(row, (x, y))| {
            x.fill(0.0);
            y.fill(0.0);
            for strip in &self.strips {
                if row < strip.first_row || (row - strip.first_row) * stride >= strip.components[0].len() {
                    continue;
                }
                let part = (row - strip.first_row) * stride..(row - strip.first_row + 1) * stride;
                for (out, component) in [&mut *x, &mut *y].into_iter().zip(&strip.components) {
                    for (value, add) in out.iter_mut().zip(&component[part.clone()]) {
                        *value += add;
                    }
                }
            }
        });
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        self.strips.iter().map(|s| 16 * s.components[0].len()).sum()
    }
}

/// Runs one kernel per strip over the points of `lattice`; `forces` receives the integrated stresses.
pub fn sweep<K: PointKernel>(lattice: &Lattice, fields: Fields, kernels: &mut [K], forces: Option<&mut StripForces>) {
    assert_eq!(kernels.len(), lattice.strips(), "one kernel per strip");
    match forces {
        Some(forces) if K::STRESS => {
            kernels.par_iter_mut().zip(&mut forces.strips).enumerate().for_each(|(strip, (kernel, force))| {
                force.components.iter_mut().for_each(|c| c.fill(0.0));
                dispatch(StripSweep { lattice, fields, strip, kernel, force: Some(force) });
            });
        }
        _ => kernels.par_iter_mut().enumerate().for_each(|(strip, kernel)| {
            dispatch(StripSweep { lattice, fields, strip, kernel, force: None });
        }),
    }
}
