//! Studies of bodies that meet. Each takes the scenes of its case, knows the closed form that belongs to
//! them, and looks at the bodies after every step.

pub(super) mod hertz;
pub(super) mod impact;
pub(super) mod onset;

use fisura::Simulation;
use fisura::contact::impulse::ContactForce;
use fisura::dynamics::energy::Sample;
use fisura::scene::Scene;

use super::StudyError;
use crate::extremes::{self, larger};

/// Runs a scene to its end; `seen` looks at it at the start and after every step.
pub(crate) fn run(scene: &Scene, seen: &mut dyn FnMut(&Simulation)) -> Result<(), StudyError> {
    let mut simulation = Simulation::new(scene)?;
    loop {
        crate::watch::check()?;
        seen(&simulation);
        if simulation.finished() {
            return Ok(());
        }
        simulation.step()?;
    }
}

/// Samples of a run: enough to see what a ledger does, few enough to cost little.
const SAMPLES: usize = 400;

/// Whether a sample is to be taken now.
pub(crate) fn sample_is_due(simulation: &Simulation) -> bool {
    simulation.steps().is_multiple_of(simulation.plan().steps().div_ceil(SAMPLES)) || simulation.finished()
}

/// Sum of forces, N/m.
fn sum<'a>(forces: impl IntoIterator<Item = &'a ContactForce>) -> [f64; 2] {
    forces.into_iter().fold([0.0; 2], |[x, y], f| [x + f.force[0], y + f.force[1]])
}

/// The largest magnitude, or not-a-number if one is.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    extremes::largest(values.into_iter().map(f64::abs))
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// What the ledger of a run has to show, gathered sample by sample.
#[derive(Debug, Clone, Copy, Default)]
struct Books {
    start: Option<[f64; 3]>,
    /// Largest closure, J.
    closure: f64,
    /// Largest departure of the momentum from the first one, kg m/s.
    momentum: f64,
    /// Loss in contact so far, J.
    loss: f64,
}

impl Books {
    fn enter(&mut self, sample: &Sample) {
        let [x, y] = sample.momentum;
        let first = *self.start.get_or_insert([x, y, sample.kinetic + sample.elastic]);
        self.closure = larger(self.closure, sample.closure.abs());
        self.momentum = larger(self.momentum, (x - first[0]).hypot(y - first[1]));
        self.loss = sample.contact.map_or(f64::NAN, |contact| contact.loss);
    }

    /// Energy at t = 0, J.
    fn initial(&self) -> f64 {
        self.start.map_or(f64::NAN, |[_, _, energy]| energy)
    }
}

#[cfg(test)]
mod tests {
    use fisura::dynamics::energy::ContactSample;

    use super::*;

    #[test]
    fn a_broken_value_does_not_hide_among_others() {
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert_eq!(largest([]), 0.0);
    }

    #[test]
    fn the_books_keep_the_worst_of_all_samples() {
        let sample = |momentum: f64, loss: f64, closure: f64| Sample {
            kinetic: 2.0,
            elastic: 1.0,
            contact: Some(ContactSample { loss, friction: 0.0 }),
            closure,
            momentum: [momentum, 0.0],
            ..Sample::default()
        };
        let mut books = Books::default();
        for (momentum, loss, closure) in [(1.0, 0.0, 0.0), (1.5, 0.6, -0.2), (1.1, 0.2, 0.1)] {
            books.enter(&sample(momentum, loss, closure));
        }
        assert_eq!((books.momentum, books.closure, books.loss, books.initial()), (0.5, 0.2, 0.2, 3.0));
    }
}
