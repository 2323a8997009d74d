//! Studies of bodies that meet. Each takes the scenes of its case, knows the closed form that belongs to
//! them, and looks at the bodies after every step.

pub(super) mod collision;
pub(super) mod hertz;
pub(super) mod impact;
pub(super) mod incline;
pub(super) mod onset;
pub(super) mod stack;

use fisura::Simulation;
use fisura::contact::impulse::ContactForce;
use fisura::dynamics::energy::{ContactSample, Sample};
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::dynamics::updated_frame::field::DiscreteField;
use fisura::scene::Scene;

use super::StudyError;
use super::scene::series_stem;
use crate::case::Case;
use crate::extremes::{self, larger};
use crate::record::{Axis, Curve, CurveStyle, Figure, FigureBody, Reference, ReferenceKind};

/// Runs a scene to its end; `seen` looks at it at the start and after every step.
pub(super) fn run(scene: &Scene, seen: &mut dyn FnMut(&Simulation, &UpdatedFrame)) -> Result<(), StudyError> {
    let mut simulation = Simulation::new(scene)?;
    loop {
        crate::watch::check()?;
        let Some(frame) = simulation.updated_frame() else {
            return Err(StudyError::Other("contact needs frame = \"updated\"".into()));
        };
        seen(&simulation, frame);
        if simulation.finished() {
            return Ok(());
        }
        simulation.step()?;
    }
}

/// Samples of a run: enough to see what a ledger does, few enough to cost little.
const SAMPLES: usize = 400;

/// Whether a sample is to be taken now.
fn sample_is_due(simulation: &Simulation) -> bool {
    simulation.steps().is_multiple_of(simulation.plan().steps().div_ceil(SAMPLES)) || simulation.finished()
}

/// Sum of forces, N/m.
fn sum<'a>(forces: impl IntoIterator<Item = &'a ContactForce>) -> [f64; 2] {
    forces.into_iter().fold([0.0; 2], |[x, y], f| [x + f.force[0], y + f.force[1]])
}

/// Centre of mass of a body, m.
pub(super) fn center(field: &DiscreteField) -> [f64; 2] {
    let volume: f64 = field.points().iter().map(|p| p.volume).sum();
    [0, 1].map(|d| field.points().iter().map(|p| p.volume * p.position[d]).sum::<f64>() / volume)
}

/// The largest magnitude, or not-a-number if one is.
fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    extremes::largest(values.into_iter().map(f64::abs))
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn exact(value: f64, source: &str) -> Option<Reference> {
    Some(Reference::new(Some(value), ReferenceKind::Exact, source))
}

/// What the ledger of a run has to show, gathered sample by sample.
#[derive(Debug, Clone, Copy, Default)]
struct Books {
    start: Option<[f64; 4]>,
    /// Largest closure, J.
    closure: f64,
    /// Largest energy, J.
    energy: f64,
    /// Largest departure of the momentum from the first one, kg m/s, and of the angular momentum, kg m²/s.
    momentum: f64,
    angular_momentum: f64,
    /// Losses in contact so far, J, the part of friction, and losses of the transfers.
    loss: f64,
    friction: f64,
    transfer: f64,
    /// What friction took up to the last step, and its largest decrease in a step, J per metre of thickness.
    taken: f64,
    friction_decrease: f64,
}

impl Books {
    fn enter(&mut self, sample: &Sample) {
        let contact = sample.contact.unwrap_or(ContactSample { loss: f64::NAN, friction: f64::NAN });
        let [x, y] = sample.momentum;
        let first = *self.start.get_or_insert([x, y, sample.angular_momentum, sample.kinetic + sample.elastic]);
        self.closure = larger(self.closure, sample.closure.abs());
        self.energy = larger(self.energy, sample.largest_term());
        self.momentum = larger(self.momentum, (x - first[0]).hypot(y - first[1]));
        self.angular_momentum = larger(self.angular_momentum, (sample.angular_momentum - first[2]).abs());
        (self.loss, self.friction) = (contact.loss, contact.friction);
        self.transfer = sample.transfer_loss.unwrap_or(f64::NAN);
    }

    /// Looks at the friction after a step; cheaper than a sample.
    fn step(&mut self, frame: &UpdatedFrame) {
        let friction = frame.contact().map_or(f64::NAN, |contact| contact.ledger().friction);
        self.take(friction);
    }

    fn take(&mut self, friction: f64) {
        self.friction_decrease = larger(self.friction_decrease, self.taken - friction);
        self.taken = friction;
    }

    /// Energy at t = 0, J.
    fn initial(&self) -> f64 {
        self.start.map_or(f64::NAN, |start| start[3])
    }
}

/// What a curve shows, with its scene where that has a name.
fn label(scene: &str, what: &str) -> String {
    if scene.is_empty() { what.to_string() } else { format!("{scene}: {what}") }
}

/// A curve of two columns of a series.
pub(super) fn curve(label: &str, stem: &str, columns: [&str; 2], style: CurveStyle) -> Curve {
    Curve { style, ..Curve::line(label, &format!("series/{stem}.csv"), columns) }
}

/// A chart of all scenes of a case.
pub(super) fn chart(
    case: &Case,
    name: &str,
    title: &str,
    caption: &str,
    axes: [&str; 2],
    curves: Vec<Curve>,
) -> Figure {
    Figure {
        id: series_stem(case, name),
        suite: case.suite.clone(),
        title: format!("{title}, {}", case.label),
        caption: caption.into(),
        deviations: Vec::new(),
        body: FigureBody::chart(axes.map(Axis::linear), curves, Vec::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_value_does_not_hide_among_others() {
        assert_eq!(largest([1.0, -3.0, 2.0]), 3.0);
        assert!(largest([1.0, f64::NAN, 2.0]).is_nan());
        assert_eq!(largest([]), 0.0);
    }

    #[test]
    fn the_books_keep_the_worst_of_all_samples() {
        let sample = |momentum: f64, friction: f64, closure: f64| Sample {
            kinetic: 2.0,
            elastic: 1.0,
            contact: Some(ContactSample { loss: 2.0 * friction, friction }),
            closure,
            momentum: [momentum, 0.0],
            ..Sample::default()
        };
        let mut books = Books::default();
        for (momentum, friction, closure) in [(1.0, 0.0, 0.0), (1.5, 0.3, -0.2), (1.1, 0.1, 0.1)] {
            books.enter(&sample(momentum, friction, closure));
            books.take(friction);
        }
        assert_eq!((books.momentum, books.closure, books.initial()), (0.5, 0.2, 3.0));
        assert!((books.friction_decrease - 0.2).abs() < 1e-15 && books.loss == 0.2);
    }
}
