//! The energy ledger: every joule has a name.
//!
//! ```text
//! kinetic − stagger + elastic + fracture
//!   = initial + external work + history work + residual work + refinement − contact loss − transfer loss
//!     + closure
//! ```
//!
//! Each term is summed from its own definition; closure alone is what is left. Stagger, `dt²/8 aᵀ M a`, is
//! the part of the kinetic energy at whole steps that velocity Verlet does not conserve. History work, `∬ 2
//! (1 − k) c (H − psi+)(−dc/dt)`, is what the model adds where the crack widens on remembered energy; with a
//! driving energy other than psi+ it is the work of the difference. Residual work is what the phase field
//! takes up in steps without a solve (`phase_field/advance.rs`), or at its bounds
//! (`phase_field/minimise.rs`). The other terms are the usual ones: kinetic `½ vᵀ M v`, elastic `Σ V (g psi+
//! + psi−)`, fracture that of the surface (`material/degradation.rs`), and as work the mean force of a step
//! times its motion. What transfers lose is in `updated_frame/losses.rs`.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::body_sample::{BodySamples, column_name};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::phase_field::fracture::CrackTip;

/// Work and losses accumulated over a run, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Ledger {
    /// Work of tractions, gravity and driven sides.
    pub external_work: f64,
    /// Work of the history field.
    pub history_work: f64,
    /// Energy lost by the transfers of the updated frame between grid and points, and what conditions take
    /// (see [`losses`](crate::dynamics::updated_frame::losses)).
    pub transfer_loss: f64,
}

/// State of a run at a whole step. Energies in J for the thickness of the scene.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sample {
    /// Time since the start of the run, s.
    pub time: f64,
    /// Kinetic energy of the control points, J.
    pub kinetic: f64,
    /// Part of it that velocity Verlet does not conserve, J.
    pub stagger: f64,
    /// Elastic energy of the material, degraded where it is cracked, J.
    pub elastic: f64,
    /// What only a fracturing body has.
    pub fracture: Option<FractureSample>,
    /// Work of external forces, J.
    pub external_work: f64,
    /// Losses of contact, if the scene declares it.
    pub contact: Option<ContactSample>,
    /// Loss of the transfers in the updated frame, J.
    pub transfer_loss: Option<f64>,
    /// What local refinement added to the energies, if there is any, J.
    pub refinement: Option<f64>,
    /// Conditions with a name.
    pub conditions: Vec<ConditionSample>,
    /// Places that are recorded.
    pub probes: Vec<ProbeSample>,
    /// J-integrals by their columns, J/m².
    pub j_integrals: Vec<(String, f64)>,
    /// What is left when every named term is added up, J.
    pub closure: f64,
    /// Linear momentum in x and y, kg m/s.
    pub momentum: [f64; 2],
    /// Angular momentum about the origin, kg m²/s.
    pub angular_momentum: f64,
    /// Length of the last time step, s; at t = 0 that of the first step.
    pub time_step: f64,
    /// Area of every part that the bodies are in before any strain, m², if parts are counted.
    pub fragments: Option<Vec<f64>>,
    /// Every body for itself, if the scene records that.
    pub bodies: Option<BodySamples>,
}

/// What only a fracturing body has.
#[derive(Debug, Clone, PartialEq)]
pub struct FractureSample {
    /// Surface energy of the crack, J.
    pub energy: f64,
    /// What the phase field adds to the energy of the body, by the names of columns, J: work of the energy
    /// that drives beyond psi+; of its residual.
    pub works: Vec<(&'static str, f64)>,
    /// Crack tip, if there is a crack.
    pub crack_tip: Option<CrackTip>,
    /// Smallest phase field at a point.
    pub min_phase: f64,
    /// Iterations of the last phase-field solve.
    pub iterations: usize,
}

/// Losses of contact so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSample {
    /// Energy lost in contact, J.
    pub loss: f64,
    /// The part of it that friction took, J.
    pub friction: f64,
}

/// What a condition with a name does to the body.
#[derive(Debug, Clone, PartialEq)]
pub struct ConditionSample {
    /// Name of the condition as it stands in the names of its columns.
    name: String,
    fix: [bool; 2],
    /// Force on the body, N.
    reaction: [f64; 2],
    /// Work of the condition on the body so far, J.
    work: f64,
}

impl ConditionSample {
    /// A condition with the components that it prescribes.
    pub fn new(name: &str, fix: [bool; 2], reaction: [f64; 2], work: f64) -> Self {
        Self { name: column_name(name), fix, reaction, work }
    }

    fn for_thickness(self, thickness: f64) -> Self {
        Self { reaction: self.reaction.map(|force| force * thickness), work: self.work * thickness, ..self }
    }

    fn named_values(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        let Self { name, fix, reaction, work } = self;
        let components = ["x", "y"].into_iter().enumerate().filter(|&(d, _)| fix[d]);
        let forces = components.map(move |(d, component)| (format!("reaction_{name}_{component}_n"), reaction[d]));
        forces.chain([(format!("work_{name}_j"), *work)])
    }
}

/// Motion and stress at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeSample {
    /// Name of the probe as it stands in the names of its columns.
    name: String,
    /// Displacement (m), velocity (m/s), stress `[xx, yy, xy]` (Pa).
    values: [f64; 7],
}

impl ProbeSample {
    /// Displacement (m), velocity (m/s), and stress `[xx, yy, xy]` (Pa) at a probe.
    pub fn new(name: &str, values: [f64; 7]) -> Self {
        Self { name: column_name(name), values }
    }

    const QUANTITIES: [&str; 7] = ["ux_m", "uy_m", "vx_m_per_s", "vy_m_per_s", "sxx_pa", "syy_pa", "sxy_pa"];

    fn named_values(&self) -> impl Iterator<Item = (String, f64)> + '_ {
        Self::QUANTITIES.iter().zip(self.values).map(|(quantity, value)| (format!("{}_{quantity}", self.name), value))
    }
}

impl FractureSample {
    fn with(self, other: Self) -> Self {
        let tips = self.crack_tip.into_iter().chain(other.crack_tip);
        Self {
            energy: self.energy + other.energy,
            works: self.works.iter().zip(other.works).map(|((name, a), (_, b))| (*name, a + b)).collect(),
            crack_tip: tips.max_by(|a, b| a.distance.total_cmp(&b.distance)),
            min_phase: smaller(self.min_phase, other.min_phase),
            iterations: self.iterations + other.iterations,
        }
    }
}

impl Sample {
    /// Columns of `history.csv`, in order; a column is there only with its model.
    pub fn named_values(&self) -> Vec<(Cow<'static, str>, f64)> {
        let mut row: Vec<_> =
            self.values_of_the_whole().into_iter().map(|(name, value)| (name.into(), value)).collect();
        row.extend(
            self.conditions.iter().flat_map(ConditionSample::named_values).map(|(name, value)| (name.into(), value)),
        );
        row.extend(self.j_integrals.iter().map(|(name, value)| (name.clone().into(), *value)));
        let probes = self.probes.iter().flat_map(ProbeSample::named_values);
        row.extend(probes.map(|(name, value)| (name.into(), value)));
        row.extend(self.bodies.iter().flat_map(BodySamples::named_values).map(|(name, value)| (name.into(), value)));
        row
    }

    fn values_of_the_whole(&self) -> Vec<(&'static str, f64)> {
        let mut row = vec![
            ("time_s", self.time),
            ("kinetic_j", self.kinetic),
            ("stagger_j", self.stagger),
            ("elastic_j", self.elastic),
        ];
        let fracture = self.fracture.as_ref();
        row.extend(fracture.map(|f| ("fracture_j", f.energy)));
        row.push(("external_work_j", self.external_work));
        row.extend(fracture.iter().flat_map(|f| f.works.iter().copied()));
        row.extend(self.contact.into_iter().flat_map(|c| [("contact_loss_j", c.loss), ("friction_j", c.friction)]));
        row.extend(self.transfer_loss.map(|loss| ("transfer_loss_j", loss)));
        row.extend(self.refinement.map(|added| ("refinement_j", added)));
        row.push(("closure_j", self.closure));
        if let Some(fracture) = fracture {
            let [x, y] = fracture.crack_tip.map_or([f64::NAN; 2], |tip| tip.place);
            row.extend([("crack_tip_x_m", x), ("crack_tip_y_m", y), ("min_phase_field", fracture.min_phase)]);
        }
        row.push(("momentum_x", self.momentum[0]));
        row.push(("momentum_y", self.momentum[1]));
        row.push(("angular_momentum", self.angular_momentum));
        row.push(("time_step_s", self.time_step));
        row.extend(fracture.map(|f| ("phase_field_iterations", f.iterations as f64)));
        if let Some(areas) = &self.fragments {
            let of_all = |choose: fn(f64, f64) -> f64| areas.iter().copied().reduce(choose).unwrap_or(0.0);
            row.push(("fragments", areas.len() as f64));
            row.extend([("smallest_fragment_m2", of_all(smaller)), ("largest_fragment_m2", of_all(larger))]);
        }
        row
    }

    /// The first column of the whole that is not finite, if one is not. A body without a crack has no tip.
    pub fn not_finite(&self) -> Option<&'static str> {
        let mut columns = self.values_of_the_whole().into_iter();
        columns.find(|(name, value)| !value.is_finite() && !name.starts_with("crack_tip")).map(|(name, _)| name)
    }

    /// This sample with another body's: energies and momenta are added, the tip is that of the longer crack.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let fracture = match (self.fracture, other.fracture) {
            (Some(a), Some(b)) => Some(a.with(b)),
            (a, b) => a.or(b),
        };
        Self {
            kinetic: self.kinetic + other.kinetic,
            stagger: self.stagger + other.stagger,
            elastic: self.elastic + other.elastic,
            fracture,
            external_work: self.external_work + other.external_work,
            transfer_loss: self.transfer_loss.zip(other.transfer_loss).map(|(a, b)| a + b),
            conditions: joined(self.conditions, other.conditions),
            probes: self.probes.into_iter().chain(other.probes).collect(),
            j_integrals: self.j_integrals.into_iter().chain(other.j_integrals).collect(),
            fragments: match (self.fragments, other.fragments) {
                (Some(a), Some(b)) => Some([a, b].concat()),
                (a, b) => a.or(b),
            },
            momentum: [0, 1].map(|d| self.momentum[d] + other.momentum[d]),
            angular_momentum: self.angular_momentum + other.angular_momentum,
            ..self
        }
    }

    /// A sample of a body a metre thick for another thickness, m.
    #[must_use]
    pub(crate) fn for_thickness(self, thickness: f64) -> Self {
        Self {
            kinetic: self.kinetic * thickness,
            stagger: self.stagger * thickness,
            elastic: self.elastic * thickness,
            fracture: self.fracture.map(|f| FractureSample {
                energy: f.energy * thickness,
                works: f.works.into_iter().map(|(name, work)| (name, work * thickness)).collect(),
                ..f
            }),
            external_work: self.external_work * thickness,
            conditions: self.conditions.into_iter().map(|c| c.for_thickness(thickness)).collect(),
            contact: self.contact.map(|c| ContactSample { loss: c.loss * thickness, friction: c.friction * thickness }),
            transfer_loss: self.transfer_loss.map(|loss| loss * thickness),
            closure: self.closure * thickness,
            momentum: self.momentum.map(|p| p * thickness),
            angular_momentum: self.angular_momentum * thickness,
            ..self
        }
    }

    /// Energy a ledger closes on: kinetic without stagger, elastic, fracture, J.
    pub fn stored(&self) -> f64 {
        self.kinetic - self.stagger + self.elastic + self.fracture.as_ref().map_or(0.0, |f| f.energy)
    }

    /// Sets closure from the stored energy at t = 0, J.
    pub fn close(&mut self, initial: f64) {
        let of_model = self.fracture.as_ref().map_or(0.0, |f| f.works.iter().map(|(_, work)| work).sum::<f64>());
        let loss = self.transfer_loss.unwrap_or(0.0) + self.contact.map_or(0.0, |c| c.loss);
        let added = self.refinement.unwrap_or(0.0);
        self.closure = self.stored() - initial - self.external_work - of_model - added + loss;
    }

    /// Largest single energy of the row, J: the scale of closure.
    pub fn largest_term(&self) -> f64 {
        let fracture = self.fracture.as_ref().map_or(0.0, |f| f.energy);
        [self.kinetic, self.elastic, fracture, self.external_work].into_iter().map(f64::abs).fold(0.0, larger)
    }
}

/// What conditions do to two bodies: those with one name are one condition.
fn joined(mut one: Vec<ConditionSample>, other: Vec<ConditionSample>) -> Vec<ConditionSample> {
    for ConditionSample { name, fix, reaction, work } in other {
        match one.iter_mut().find(|sample| sample.name == name) {
            Some(sample) => {
                sample.reaction = [0, 1].map(|d| sample.reaction[d] + reaction[d]);
                sample.work += work;
            }
            None => one.push(ConditionSample { name, fix, reaction, work }),
        }
    }
    one
}
