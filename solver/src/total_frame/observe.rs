//! What is measured of a body in the total frame at a whole step.

use super::TotalFrame;
use crate::energy::{FractureSample, Sample};

impl TotalFrame {
    /// Position of the fastest control point, m.
    pub fn fastest_place(&self) -> [f64; 2] {
        let [vx, vy] = &self.velocity;
        let speed = |at: &usize| {
            let speed = vx[*at].hypot(vy[*at]);
            if speed.is_nan() { f64::INFINITY } else { speed }
        };
        let fastest = self.grid.indices().max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap_or(0);
        self.patch.control_positions().map(|x| x[fastest])
    }

    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at zero.
    pub fn sample(&self, dt: f64) -> Sample {
        let thickness = self.thickness;
        let [x, y] = self.patch.control_positions();
        let kinetic = self.mass.half_square(&self.velocity);
        let stagger = 0.25 * dt * dt * self.mass.half_square(&self.acceleration);
        let mut momenta = [self.grid.zeros(), self.grid.zeros()];
        for component in 0..2 {
            self.mass.multiply(&self.velocity[component], &mut momenta[component]);
        }
        let momentum = momenta.each_ref().map(|p| p.iter().sum::<f64>());
        let angular: f64 = self.grid.indices().map(|at| x[at] * momenta[1][at] - y[at] * momenta[0][at]).sum();
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
            contact: None,
            transfer_loss: None,
            closure: 0.0,
            momentum: momentum.map(|p| p * thickness),
            angular_momentum: angular * thickness,
            time_step: dt,
        }
    }
}
