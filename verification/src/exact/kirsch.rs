//! Infinite plate with a circular hole under uniaxial tension (Kirsch 1898), static, without body force.
//!
//! Hole of radius a = 1 m about the origin, remote tension T = 1 Pa along x, E = 1 Pa, nu = 0.3. With
//! `kappa = 3 − 4 nu` in plane strain and `(3 − nu)/(1 + nu)` in plane stress, and polar coordinates r, θ:
//!
//! ```text
//! u = T a/(8 mu) [ (r/a) (kappa + 1) cos θ + (2 a/r) ((1 + kappa) cos θ + cos 3θ) − (2 a³/r³) cos 3θ ]
//! v = T a/(8 mu) [ (r/a) (kappa − 3) sin θ + (2 a/r) ((1 − kappa) sin θ + sin 3θ) − (2 a³/r³) sin 3θ ]
//! ```
//!
//! (textbook form, as in the tests of isogeometric analysis: Hughes, Cottrell & Bazilevs 2005). The stress
//! does not depend on kappa; the hoop stress at the hole is T (1 − 2 cos 2θ), 3 T at θ = ±π/2.
//!
//! Valid for r ≥ a. Boundary conditions: none on the hole, which is free of traction; on an outer boundary
//! the traction sigma n or the displacement; on the axes y = 0 and x = 0 symmetry (normal displacement and
//! shear vanish).

use fisura::material::elasticity::ElasticModuli;
use fisura::scene::Plane;

use super::dual::Scalar;
use super::motion::{Derived, Motion};
use super::{Equation, Held, Solution};

/// Radius of the hole, m.
pub const RADIUS: f64 = 1.0;

/// Remote tension along x, Pa.
pub const TENSION: f64 = 1.0;

/// What this file registers.
pub const SOLUTIONS: &[Solution] = &[Solution {
    equation: Equation::Static,
    held: Held::Axes,
    end_time: 0.0,
    radii: &[1.0, 1.7, 3.1],
    ..Solution::of("kirsch", |plane| Box::new(Derived { motion: Kirsch, plane }))
}];

/// Infinite plate with a circular hole under tension along x; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct Kirsch;

impl Motion for Kirsch {
    const FORCE_FREE: bool = true;

    fn displacement<T: Scalar>(&self, plane: Plane, [x, y, _]: [T; 3]) -> [T; 2] {
        let nu = self.material().poisson_ratio;
        let kappa = match plane {
            Plane::Strain => 3.0 - 4.0 * nu,
            Plane::Stress => (3.0 - nu) / (1.0 + nu),
        };
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = (x / r, y / r);
        let cos3 = cos * cos * cos * 4.0 - cos * 3.0;
        let sin3 = sin * 3.0 - sin * sin * sin * 4.0;
        let (near, far) = (T::constant(2.0 * RADIUS) / r, r * (1.0 / RADIUS));
        let nearest = near * near * near * 0.25;
        let scale = TENSION * RADIUS / (8.0 * ElasticModuli::new(&self.material(), plane).mu);
        [
            (far * cos * (kappa + 1.0) + near * (cos * (1.0 + kappa) + cos3) - nearest * cos3) * scale,
            (far * sin * (kappa - 3.0) + near * (sin * (1.0 - kappa) + sin3) - nearest * sin3) * scale,
        ]
    }
}
