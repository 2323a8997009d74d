//! What is computed at the material points of a strip, from which fields.

use crate::linear_algebra::lane::Lane;

/// What the fields are at a batch of points.
#[derive(Debug, Clone, Copy, Default)]
pub struct PointValues {
    /// Displacement gradient: `[du_x/dx, du_x/dy, du_y/dx, du_y/dy]`.
    pub gradient: [Lane; 4],
    /// Phase field c, 1 where intact and 0 where broken.
    pub phase: Lane,
    /// Gradient of the phase field in x and y, 1/m.
    pub phase_gradient: [Lane; 2],
}

/// In-plane stress of a batch of points, Pa: work-conjugate to the displacement gradient, so `xy` is the
/// force in x on a face with normal y. Only a first Piola–Kirchhoff stress has `xy` and `yx` that differ.
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
    /// A stress whose components are all zero.
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
    const DISPLACEMENT: bool = true;
    /// Whether the phase field is needed.
    const PHASE: bool = false;
    /// Whether its gradient is needed.
    const PHASE_GRADIENT: bool = false;
    /// Whether the returned stress is to be integrated into nodal forces.
    const STRESS: bool = false;
    /// Whether it runs in every step, and is compiled for each of the usual degrees.
    const EVERY_STEP: bool = false;

    /// Whether a cell of the strip, or all those of its tile, need no visit.
    #[inline(always)]
    fn skips(&self, _cell: usize) -> bool {
        false
    }

    /// Whether forces are added to those of the sweep before.
    fn adds(&self) -> bool {
        false
    }

    /// Fetches what it keeps of a batch that comes soon.
    #[inline(always)]
    fn prefetch(&self, _at: usize) {}

    /// One batch: `at` counts batches from the start of the strip, `weight` is in m² and zero where there is
    /// no point.
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress;
}

/// Control fields a sweep reads; a field that its kernel does not need may be empty.
#[derive(Debug, Clone, Copy)]
pub struct Fields<'a> {
    /// Displacement components, m.
    pub displacement: [&'a [f64]; 2],
    /// Control values of the phase field c.
    pub phase: &'a [f64],
}
