//! Loads that a scene cannot say: forces, tractions and phase-field sources that vary in space and time.
//!
//! They serve manufactured solutions. A *strong* load is the body force and the traction that the exact
//! solution needs. A *weak* load is the exact stress and the exact inertia, integrated by the same point sums
//! as the code's own: it verifies the code and is blind to the quadrature, where a strong load measures the
//! method.

use std::fmt::Debug;

/// What acts on a unit of reference volume.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct VolumeLoad {
    /// Force density, N/m³, on the shape functions.
    pub force: [f64; 2],
    /// Stress, Pa, on their gradients: `stress[i][j]` on `∂N/∂x_j` gives a force in direction i.
    pub stress: [[f64; 2]; 2],
}

/// External loads as functions of place and time. Positions are those of the reference configuration, m.
pub trait Forcing: Debug + Send + Sync {
    /// Whether there are loads on the material points at all.
    fn acts_inside(&self) -> bool {
        true
    }

    /// Load on the material points at `time` (s).
    fn volume(&self, position: [f64; 2], time: f64) -> VolumeLoad;

    /// Traction (Pa) on the boundary of the patch with outward `normal`.
    fn traction(&self, _position: [f64; 2], _normal: [f64; 2], _time: f64) -> [f64; 2] {
        [0.0; 2]
    }

    /// Right-hand side of the phase-field equation, that of intact material where nothing is manufactured: 1
    /// with AT2, 3/8 with AT1. With PF-CZM it is 2/π, and `2/π (1 − c)` is on the left.
    fn phase_source(&self, _position: [f64; 2], _time: f64) -> f64 {
        1.0
    }

    /// `D grad c · n` (m) on the boundary of the patch with outward `normal`; D is the coefficient of the
    /// gradient term.
    fn phase_flux(&self, _position: [f64; 2], _normal: [f64; 2], _time: f64) -> f64 {
        0.0
    }
}
