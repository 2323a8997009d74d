//! The dynamic J-integral as an integral over a domain about the tip of a crack (Nakamura, Shih and Freund
//! 1985), with axis 1 along the crack:
//!
//! ```text
//! J = ∫ (sigma_ij u_j,1 − (psi + rho v·v/2) δ_1i) q,i + rho ((a − b)·u,1 − v·v,1) q dA
//! ```
//!
//! psi is the degraded elastic energy and b gravity. v is the velocity less its mean in the domain: J does
//! not depend on a constant velocity, but the error of the quadrature beside a slit would be multiplied by
//! its square. q is 1 within half of the radius about the tip, so that the process zone does not count, and
//! falls smoothly to 0 at the radius. The faces of the crack carry no load and lie along axis 1.

use super::TotalFrame;
use super::domain::Domain;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::lane::Lane;
use crate::material::split::split;

/// Part of the radius within which q is 1.
const PLATEAU: f64 = 0.5;

impl TotalFrame {
    /// Every J-integral with its column; not a number where the boundary of the body enters the domain.
    pub(super) fn j_integrals(&self) -> Vec<(String, f64)> {
        if self.domains.is_empty() {
            return Vec::new();
        }
        let mut acceleration = self.acceleration.clone();
        self.lattice.sheets.spread(&mut acceleration);
        self.domains.iter().map(|domain| (domain.column.clone(), self.j_integral(domain, &acceleration))).collect()
    }

    fn j_integral(&self, domain: &Domain, acceleration: &VectorField) -> f64 {
        let Domain { radius, axis: [ax, ay], .. } = *domain;
        let moving = self.fracture.as_ref().filter(|_| domain.moves).and_then(|fracture| self.crack_tip(fracture));
        let tip = moving.map_or(domain.tip, |tip| tip.place);
        if !domain.is_filled(tip, &self.shape) {
            return f64::NAN;
        }
        let density = self.density;
        let mean = self.mean_velocity(tip, radius);
        let mut sum = 0.0;
        self.lattice.for_each_point(|batch, lane, position, weight| {
            let from_tip = [position[0] - tip[0], position[1] - tip[1]];
            let distance = from_tip[0].hypot(from_tip[1]);
            if distance >= radius {
                return;
            }
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let [ux, uy] = self.displacement.each_ref().map(|u| functions.interpolate(u));
            let [mut vx, mut vy] = self.velocity.each_ref().map(|v| functions.interpolate(v));
            (vx.value, vy.value) = (vx.value - mean[0], vy.value - mean[1]);
            let along = |gradient: [f64; 2]| ax * gradient[0] + ay * gradient[1];
            let along_u = [along(ux.gradient), along(uy.gradient)];
            let (strain, _) = self.strain([ux.gradient, uy.gradient]);
            let strain = strain.map(Lane::splat);
            let (energy, stress) = match &self.fracture {
                None => (self.moduli.energy(strain), self.moduli.stress(strain)),
                Some(fracture) => {
                    let g = fracture.model.degradation(Lane::splat(fracture.phase[batch][lane]));
                    split(&self.moduli, fracture.model.split, strain).degraded::<false>(g)
                }
            };
            let [xx, yy, xy] = stress.map(|s| s[0]);
            let kinetic = 0.5 * density * (vx.value * vx.value + vy.value * vy.value);
            let whole = fault!("j-integral-without-energy", energy[0] => 0.0) + kinetic;
            let flux = [xx * along_u[0] + xy * along_u[1] - whole * ax, xy * along_u[0] + yy * along_u[1] - whole * ay];
            let plateau = PLATEAU * radius;
            let (q, slope) = if distance <= plateau {
                (1.0, [0.0; 2])
            } else {
                let (width, s) = (radius - plateau, (distance - plateau) / (radius - plateau));
                (1.0 - s * s * (3.0 - 2.0 * s), from_tip.map(|x| -6.0 * s * (1.0 - s) * x / (distance * width)))
            };
            let [gx, gy] = self.gravity.at(self.time);
            let [mut x, mut y] = acceleration.each_ref().map(|a| functions.interpolate(a).value);
            (x, y) = (x - gx, y - gy);
            let inertia = density
                * (x * along_u[0] + y * along_u[1] - vx.value * along(vx.gradient) - vy.value * along(vy.gradient));
            sum += weight * (flux[0] * slope[0] + flux[1] * slope[1] + inertia * q);
        });
        sum
    }

    /// Mean velocity \[m/s\] of the points within `radius` \[m\] of `tip` \[m\].
    fn mean_velocity(&self, tip: [f64; 2], radius: f64) -> [f64; 2] {
        let (mut area, mut sum) = (0.0, [0.0; 2]);
        self.lattice.for_each_point(|batch, lane, position, weight| {
            if (position[0] - tip[0]).hypot(position[1] - tip[1]) < radius {
                let functions = self.lattice.functions_at(&self.patch, batch, lane);
                let velocity = self.velocity.each_ref().map(|v| functions.interpolate(v).value);
                area += weight;
                sum = [sum[0] + weight * velocity[0], sum[1] + weight * velocity[1]];
            }
        });
        sum.map(|v| v / area)
    }
}
