//! Speeds of waves from the flight of a pulse: dilatational in a bar between rollers, Rayleigh along a free
//! surface.
//!
//! A Rayleigh wave of wave number k on the half plane y ≤ 0 is (Graff 1975, section 6.1)
//!
//! ```text
//! u_x = [k e^{q y} − 2 k q s/(s² + k²) e^{s y}] sin(k x − k c t),   q = k sqrt(1 − c²/c_d²)
//! u_y = [2 k² q/(s² + k²) e^{s y} − q e^{q y}] cos(k x − k c t),    s = k sqrt(1 − c²/c_s²)
//! ```
//!
//! and c, the same for all k, solves `(2 − c²/c_s²)² = 4 sqrt(1 − c²/c_d²) sqrt(1 − c²/c_s²)`. A packet of
//! such waves keeps its shape, so the centroid of `u_y²` along the surface travels with c.

use fisura::dynamics::total_frame::TotalFrame;
use fisura::material::elasticity::ElasticModuli;
use fisura::scene::{Layout, Mass, Material, Mesh, Plane, Side};
use fisura::splines::quadrature::Rule;

use super::{Case, CaseScene, Findings, StudyError, exact, other, projected};
use crate::scene::plain::{PlainScene, ROLLERS};

const MATERIAL: Material = Material { young_modulus: 1.0, poisson_ratio: 0.2, density: 1.0, fracture: None };
/// Fraction of the critical step.
const SAFETY: f64 = 0.4;
/// Mean wave number of the Rayleigh packet, rad/m, and waves it is summed from.
const WAVE_NUMBER: f64 = 25.0;
const WAVES: usize = 41;
/// Where the packets start, and how far they fly, m.
const START: f64 = 1.0;
const FLIGHT: f64 = 1.0;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in [2, 3] {
        for (plane, word) in [(Plane::Strain, "strain"), (Plane::Stress, "stress")] {
            let speeds = Speeds::new(plane);
            let variant = format!("p={degree}, plane {word}");
            let quantities = [
                ("speed of a dilatational pulse over c_d", exact(1.0, "sqrt((lam* + 2 mu)/rho)")),
                ("speed of a Rayleigh pulse over c_R", exact(1.0, "root of Rayleigh's equation")),
            ];
            findings.measure(&variant, quantities, || {
                Ok([dilatational(degree, plane, &speeds)?, rayleigh(degree, plane, &speeds)?])
            })?;
        }
    }
    Ok(())
}

/// Speeds of dilatational, shear and Rayleigh waves, m/s.
struct Speeds {
    dilatational: f64,
    shear: f64,
    rayleigh: f64,
}

impl Speeds {
    fn new(plane: Plane) -> Self {
        let moduli = ElasticModuli::new(&MATERIAL, plane);
        let (dilatational, shear) =
            (moduli.dilatational_speed(MATERIAL.density), (moduli.mu / MATERIAL.density).sqrt());
        let residual = |c: f64| {
            let (s, d) = ((c / shear).powi(2), (c / dilatational).powi(2));
            (2.0 - s).powi(2) - 4.0 * ((1.0 - d) * (1.0 - s)).sqrt()
        };
        let (mut low, mut high) = (0.5 * shear, shear); // negative below the root, positive above
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if residual(middle) < 0.0 { low = middle } else { high = middle }
        }
        Self { dilatational, shear, rayleigh: 0.5 * (low + high) }
    }

    /// Displacement of the packet centred at `START` at time t, with y measured from the surface, upwards.
    fn packet(&self, [x, y]: [f64; 2], t: f64) -> [f64; 2] {
        let c = self.rayleigh;
        let decay = |speed: f64| (1.0 - (c / speed).powi(2)).sqrt();
        let mut u = [0.0; 2];
        for n in 0..WAVES {
            let offset = 3.0 * (2.0 * n as f64 / (WAVES - 1) as f64 - 1.0);
            let k = WAVE_NUMBER * (1.0 + offset / 5.0);
            let amplitude = (-offset * offset).exp() / WAVES as f64;
            let (q, s) = (k * decay(self.dilatational), k * decay(self.shear));
            let (deep, shallow) = ((q * y).exp(), (s * y).exp());
            let (sin, cos) = (k * (x - START - c * t)).sin_cos();
            let whole = s * s + k * k;
            u[0] += amplitude * (deep - 2.0 * q * s / whole * shallow) * sin;
            u[1] += amplitude * (2.0 * k * q / whole * shallow - q / k * deep) * cos;
        }
        u
    }
}

/// Measured over exact speed of a plane pulse.
fn dilatational(degree: usize, plane: Plane, speeds: &Speeds) -> Result<f64, StudyError> {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [3.0, 0.06], [100, 2]);
    let shape = |x: f64| (-((x - START) / 0.15).powi(2)).exp();
    let speed = speeds.dilatational;
    // A right-going wave: v = −c du/dx.
    let slope = |x: f64| 2.0 * (x - START) / (0.15 * 0.15) * speed * shape(x);
    let mut body = Flying::new(mesh, degree, plane, ROLLERS.to_vec())?;
    body.start(|[x, _]| [shape(x), 0.0], |[x, _]| [slope(x), 0.0])?;
    body.flight(FLIGHT / speed, Side::Bottom, 0).map(|distance| distance / FLIGHT)
}

/// Measured over exact speed of a packet along the free top.
fn rayleigh(degree: usize, plane: Plane, speeds: &Speeds) -> Result<f64, StudyError> {
    let top = 0.9;
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [3.0, top], [120, 36]);
    let held = vec![(Side::Bottom, [true; 2]), (Side::Left, [true; 2]), (Side::Right, [true; 2])];
    let mut body = Flying::new(mesh, degree, plane, held)?;
    let step = 1e-4 / WAVE_NUMBER / speeds.rayleigh;
    let velocity = |[x, y]: [f64; 2]| {
        let [after, before] = [step, -step].map(|t| speeds.packet([x, y - top], t));
        [0, 1].map(|i| (after[i] - before[i]) / (2.0 * step))
    };
    body.start(|[x, y]| speeds.packet([x, y - top], 0.0), velocity)?;
    body.flight(FLIGHT / speeds.rayleigh, Side::Top, 1).map(|distance| distance / FLIGHT)
}

/// A body with an initial wave.
struct Flying {
    frame: TotalFrame,
    degree: usize,
}

fn broken<E>(_: E) -> StudyError {
    other("no phase field is expected")
}

impl Flying {
    fn new(mesh: Mesh, degree: usize, plane: Plane, held: Vec<(Side, [bool; 2])>) -> Result<Self, StudyError> {
        let (mass, layout) = (Mass::Consistent, Layout::Gauss);
        let scene = PlainScene { mesh, material: MATERIAL, plane, mass, layout, points: degree + 1, held }.scene();
        Ok(Self { frame: TotalFrame::new(&scene).map_err(broken)?, degree })
    }

    fn start(
        &mut self,
        displacement: impl Fn([f64; 2]) -> [f64; 2] + Sync,
        velocity: impl Fn([f64; 2]) -> [f64; 2] + Sync,
    ) -> Result<(), StudyError> {
        let (displacement, velocity) = (projected(&self.frame, displacement)?, projected(&self.frame, velocity)?);
        self.frame.start_with(displacement, velocity).map_err(broken)
    }

    /// Distance (m) that the centroid of the square of a component along a side flies in a time (s).
    fn flight(&mut self, time: f64, side: Side, component: usize) -> Result<f64, StudyError> {
        let start = self.centroid(side, component);
        let steps = (time / (SAFETY * self.frame.critical_step())).ceil();
        for _ in 0..steps as usize {
            crate::watch::check()?;
            self.frame.step(time / steps).map_err(broken)?;
        }
        Ok(self.centroid(side, component) - start)
    }

    fn centroid(&self, side: Side, component: usize) -> f64 {
        let field = &self.frame.displacement[component];
        let (mut moment, mut total) = (0.0, 0.0);
        for point in self.frame.patch.boundary(side, &Rule::new(Layout::Gauss, self.degree + 2)) {
            let value: f64 = point.functions.values.iter().map(|&(at, n)| n * field[at]).sum();
            moment += point.length * value * value * point.functions.position[0];
            total += point.length * value * value;
        }
        moment / total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The packet solves the equation of motion, and its surface is free of traction.
    #[test]
    fn the_packet_is_a_rayleigh_wave() {
        for plane in [Plane::Strain, Plane::Stress] {
            let speeds = Speeds::new(plane);
            let moduli = ElasticModuli::new(&MATERIAL, plane);
            let (lambda, mu, h) = (moduli.lambda, moduli.mu, 1e-4);
            for x in [0.9, 1.0, 1.07] {
                let u = |dx: f64, dy: f64, dt: f64| speeds.packet([x + dx, -0.05 + dy], 0.3 + dt);
                let second = |f: &dyn Fn(f64) -> f64| (f(h) - 2.0 * f(0.0) + f(-h)) / (h * h);
                let mixed = |i: usize| {
                    (u(h, h, 0.0)[i] - u(h, -h, 0.0)[i] - u(-h, h, 0.0)[i] + u(-h, -h, 0.0)[i]) / (4.0 * h * h)
                };
                for i in 0..2 {
                    let xx = second(&|d| u(d, 0.0, 0.0)[i]);
                    let yy = second(&|d| u(0.0, d, 0.0)[i]);
                    let own = if i == 0 { xx } else { yy };
                    let force = mu * (xx + yy) + (lambda + mu) * (own + mixed(1 - i));
                    let inertia = second(&|d| u(0.0, 0.0, d)[i]);
                    let scale = mu * WAVE_NUMBER * WAVE_NUMBER;
                    assert!((force - inertia).abs() < 1e-4 * scale, "{force} {inertia}");
                }
                let top = |dx: f64, dy: f64| speeds.packet([x + dx, dy], 0.3);
                let slope = |i: usize, d: [f64; 2]| (top(d[0], d[1])[i] - top(-d[0], -d[1])[i]) / (2.0 * h);
                let normal = lambda * slope(0, [h, 0.0]) + (lambda + 2.0 * mu) * slope(1, [0.0, h]);
                let shear = mu * (slope(0, [0.0, h]) + slope(1, [h, 0.0]));
                assert!(normal.abs() < 1e-4 * WAVE_NUMBER && shear.abs() < 1e-4 * WAVE_NUMBER, "{normal} {shear}");
            }
        }
    }
}
