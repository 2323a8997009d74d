//! The state between two solves of the phase field, and the work done there: see [`advance`](super::advance).

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::lane::Lane;
use crate::scene::PhaseFieldInterval;

/// Largest change of c at a control point between two solves of the automatic interval: a twentieth of the
/// way to a crack.
const MOST_CHANGE: f64 = 0.05;
/// Most steps between them: in `energy/phase-field-interval` three change the fracture energy by 5e-4, and
/// six by nine times as much.
const MOST_STEPS: usize = 4;

/// State between two solves.
#[derive(Debug, Clone)]
pub(super) struct Lag {
    interval: PhaseFieldInterval,
    /// Control values of the last solve; those of the solve before are `previous` of the field.
    pub(super) solved: Vec<f64>,
    /// Those that were carried on to the present solve.
    pub(super) carried: Vec<f64>,
    /// Steps between the last two solves, zero before the second one, and steps since the last one.
    pub(super) apart: usize,
    pub(super) since: usize,
    /// Largest decrease of a control value per step between the last two solves.
    pub(super) fastest: f64,
    /// Largest increase of a control value by a solve.
    pub(super) healing: f64,
    /// Whether the coming step is to solve.
    pub(super) expected: bool,
}

impl Lag {
    /// `None` if every step solves.
    pub(super) fn new(interval: PhaseFieldInterval, phase: &[f64]) -> Option<Box<Self>> {
        (interval != PhaseFieldInterval::Steps(1)).then(|| {
            Box::new(Self {
                interval,
                solved: phase.to_vec(),
                carried: phase.to_vec(),
                apart: 0,
                since: 0,
                fastest: 0.0,
                healing: 0.0,
                expected: false,
            })
        })
    }

    /// Takes the control values of a first solve.
    pub(super) fn begin(&mut self, phase: &[f64]) {
        self.solved.copy_from_slice(phase);
    }

    /// Whether the step after `since` steps without a solve is to solve.
    pub(super) fn is_due(&self) -> bool {
        let coming = self.since + 1;
        self.expected
            || match self.interval {
                PhaseFieldInterval::Steps(steps) => coming >= steps,
                PhaseFieldInterval::Automatic => {
                    self.apart == 0 || coming >= MOST_STEPS || coming as f64 * self.fastest > MOST_CHANGE
                }
            }
    }

    /// Part of the decrease between the last two solves that the present number of steps makes up.
    pub(super) fn ahead(&self) -> f64 {
        if self.apart == 0 { 0.0 } else { self.since as f64 / self.apart as f64 }
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        // A step begins and ends with `expected` false.
        let Self { interval: _, solved, carried: _, apart, since, fastest, healing, expected: _ } = self;
        archive.list(solved)?;
        [apart, since].into_iter().try_for_each(|count| archive.value(count))?;
        [fastest, healing].into_iter().try_for_each(|value| archive.value(value))
    }
}

/// Work of the changes of c where there are steps without a solve.
#[derive(Debug, Clone)]
pub(crate) struct LagWork {
    /// `s H` at the points, J/m³.
    pub(crate) drive: Vec<Lane>,
    /// Work of the changes of c on it, J/m.
    pub(crate) on_drive: f64,
    /// Surface energy at t = 0, J/m.
    pub(crate) surface_at_start: f64,
}

impl LagWork {
    /// None yet, for a lattice with this many batches.
    pub(crate) fn new(batches: usize) -> Self {
        Self { drive: vec![Lane::ZERO; batches], on_drive: 0.0, surface_at_start: 0.0 }
    }

    /// The work so far, given the surface energy now, J/m.
    pub(crate) fn total(&self, surface_energy: f64) -> f64 {
        surface_energy - self.surface_at_start + self.on_drive
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { drive, on_drive, surface_at_start } = self;
        archive.list(drive)?;
        [on_drive, surface_at_start].into_iter().try_for_each(|energy| archive.value(energy))
    }
}
