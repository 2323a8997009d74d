//! Places where bodies are near each other, and the impulses there.

use serde::{Deserialize, Serialize};

use super::handle::Handle;

/// A place, as large as a span, where the boundaries of two bodies are near each other.
#[derive(Debug, Clone)]
pub struct Touch {
    /// Gap, m; negative where the boundaries overlap.
    pub gap: f64,
    /// Numbers of the bodies a and b; rigid ones are counted after the others, so only b may be rigid.
    pub(super) bodies: [usize; 2],
    /// Column and row of the square it stands for.
    pub(super) square: [i32; 2],
    /// Position, m.
    pub(super) position: [f64; 2],
    /// Unit normal from a to b.
    pub(super) normal: [f64; 2],
    /// Where the bodies are taken hold of; a rigid b is not.
    pub(super) on_a: Handle,
    pub(super) on_b: Option<Handle>,
}

/// Impulse at a touch along normal and tangent, kg/s per unit thickness.
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
