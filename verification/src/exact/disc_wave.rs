//! Free vibration of a disc: its first two radial modes, without loads and without traction on the edge.
//!
//! Radius R = 1 m about the origin. With `c = sqrt((lam* + 2 mu)/rho)` and Bessel functions J0 and J1:
//!
//! ```text
//! u = [ 0.10 sin(c k1 t + 0.7) J1(k1 r) + 0.05 cos(c k2 t) J1(k2 r) ] (x, y)/r
//! (lam* + 2 mu) k R J0(k R) = 2 mu J1(k R)      for k1 and k2, its first two roots: σ_rr(R) = 0
//! ```
//!
//! The script `reference-data/derivations/disc_wave.py` shows that body force and traction vanish. E = 1
//! Pa, nu = 0.3, rho = 1 kg/m³; k1 = 2.05 and k2 = 5.39 in plane stress.

use fisura::material::elasticity::ElasticModuli;
use fisura::scene::Plane;

use super::dual::Scalar;
use super::motion::{Derived, Motion};
use super::{Solution, unit_material};

/// Between these numbers k R lies: a zero of J0 is the upper one, and a zero of J1 the lower one of the
/// second.
const BRACKETS: [[f64; 2]; 2] = [[1.0, 2.404_825_557_695_773], [3.831_705_970_207_512, 5.520_078_110_286_311]];
/// Terms of the series, enough for k r up to 6.
const TERMS: usize = 20;

/// What this file registers.
pub const SOLUTIONS: &[Solution] =
    &[Solution::of("disc-wave", |plane| Box::new(Derived { motion: DiscWave::new(plane), plane }))];

/// Free vibration of a disc in its first two radial modes; see the module for its formulas.
#[derive(Debug, Clone, Copy)]
pub struct DiscWave {
    /// Wave numbers k1 and k2 of the two modes, 1/m.
    wave_numbers: [f64; 2],
}

/// `Σ_m (−s)^m/(m! (m + n)!)` with s = z²/4: J0(z) for n = 0, and 2 J1(z)/z for n = 1.
fn series<T: Scalar>(n: usize, s: T) -> T {
    (0..TERMS).rev().fold(T::constant(0.0), |sum, m| {
        let next = T::constant(1.0 / ((m + 1) * (m + 1 + n)) as f64);
        T::constant(1.0) - s * next * sum
    })
}

impl DiscWave {
    fn new(plane: Plane) -> Self {
        let moduli = ElasticModuli::new(&unit_material(0.3), plane);
        let traction = |z: f64| {
            let s = 0.25 * z * z;
            (moduli.lambda + 2.0 * moduli.mu) * series(0, s) - moduli.mu * series(1, s)
        };
        let root = |[mut low, mut high]: [f64; 2]| {
            let rises = traction(high) > traction(low);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let below = (traction(middle) < 0.0) == rises;
                (low, high) = if below { (middle, high) } else { (low, middle) };
            }
            low
        };
        Self { wave_numbers: BRACKETS.map(root) }
    }
}

impl Motion for DiscWave {
    const FORCE_FREE: bool = true;

    fn displacement<T: Scalar>(&self, plane: Plane, [x, y, t]: [T; 3]) -> [T; 2] {
        let moduli = ElasticModuli::new(&self.material(), plane);
        let speed = moduli.dilatational_speed(self.material().density);
        let square = x * x + y * y;
        let radial = |k: f64| series(1, square * (0.25 * k * k)) * (0.5 * k); // J1(k r)/r
        let [first, second] = self.wave_numbers;
        let scale = radial(first) * (t * (speed * first) + 0.7).sin() * 0.10
            + radial(second) * (t * (speed * second)).cos() * 0.05;
        [x * scale, y * scale]
    }
}
