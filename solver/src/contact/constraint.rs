//! Places where bodies are near each other, and the impulses there.

use serde::{Deserialize, Serialize};

use super::boundary_functions::BoundaryFunctions;

/// A place, as large as a span, where the boundaries of two bodies are near each other.
#[derive(Debug, Clone)]
pub struct ContactConstraint {
    /// Gap, m; negative where the boundaries overlap.
    pub gap: f64,
    /// Numbers of the bodies a and b; rigid ones are counted after the others, so only b may be rigid.
    pub(super) bodies: [usize; 2],
    /// Column and row of the square it stands for.
    pub(super) square: [usize; 2],
    /// Position, m.
    pub(super) position: [f64; 2],
    /// Unit normal from a to b.
    pub(super) normal: [f64; 2],
    /// The control points that stand for the position in a and b; a rigid b has none.
    pub(super) on_a: BoundaryFunctions,
    pub(super) on_b: Option<BoundaryFunctions>,
}

/// Impulse at a constraint along normal and tangent, kg/s per unit thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Impulse {
    pub(super) normal: f64,
    pub(super) tangent: f64,
}

impl Impulse {
    pub(super) fn times(self, factor: f64) -> Self {
        Self { normal: factor * self.normal, tangent: factor * self.tangent }
    }
}
