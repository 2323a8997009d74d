//! What is measured of a body in the total frame at a whole step.

use super::TotalFrame;
use crate::energy::{FractureSample, Sample};

impl TotalFrame {
    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at zero.
    pub fn sample(&self, dt: f64) -> Sample {
        let thickness = self.thickness;
        let greville = [0, 1].map(|d| self.patch.spaces[d].greville());
        let (mut kinetic, mut stagger, mut momentum, mut angular) = (0.0, 0.0, [0.0; 2], 0.0);
        for at in self.grid.indices() {
            let m = self.mass[at];
            let [v, a] = [&self.velocity, &self.acceleration].map(|f| [f[0][at], f[1][at]]);
            kinetic += 0.5 * m * (v[0] * v[0] + v[1] * v[1]);
            stagger += 0.125 * dt * dt * m * (a[0] * a[0] + a[1] * a[1]);
            momentum = [momentum[0] + m * v[0], momentum[1] + m * v[1]];
            let (x, y) = (greville[0][self.grid.column_of(at)], greville[1][self.grid.row_of(at)]);
            angular += m * (x * v[1] - y * v[0]);
        }
        let fracture = self.fracture.as_ref().map(|f| {
            let (energy, min_phase) = f.surface_energy(&self.lattice);
            FractureSample {
                energy: energy * thickness,
                history_work: self.ledger.history_work * thickness,
                crack_tip: f.crack_tip(&self.lattice, self.lowest_tip),
                min_phase,
                iterations: f.iterations,
            }
        });
        Sample {
            time: self.time,
            kinetic: kinetic * thickness,
            stagger: stagger * thickness,
            elastic: self.elastic_energy * thickness,
            fracture,
            external_work: self.ledger.external_work * thickness,
            transfer_loss: None,
            closure: 0.0,
            momentum: momentum.map(|p| p * thickness),
            angular_momentum: angular * thickness,
            time_step: dt,
        }
    }
}
