//! A wave of any amplitude that a body force keeps up.

use std::f64::consts::PI;

use fisura::dynamics::forcing::{Forcing, VolumeLoad};

/// Keeps a bar of Hencky material in the standing wave `u = A sin πX sin πt` of any amplitude.
#[derive(Debug)]
pub struct StandingWave(pub f64);

impl StandingWave {
    /// Displacement, m.
    pub fn displacement(&self, x: f64, time: f64) -> f64 {
        self.0 * (PI * x).sin() * (PI * time).sin()
    }
}

impl Forcing for StandingWave {
    /// `rho a − dP/dX` with `P = E ln F/F`, E = rho = 1.
    fn volume(&self, [x, _]: [f64; 2], time: f64) -> VolumeLoad {
        let u = self.displacement(x, time);
        let stretch = 1.0 + self.0 * PI * (PI * x).cos() * (PI * time).sin();
        let stress_slope = (1.0 - stretch.ln()) / (stretch * stretch) * (-PI * PI * u);
        VolumeLoad { force: [-PI * PI * u - stress_slope, 0.0], ..Default::default() }
    }
}
