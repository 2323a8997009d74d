//! Studies: how a case is run.
//!
//! A `scene` study runs the case's scenes and measures their histories. The others compute something of their
//! own; each is one file and yields measurements that the checks of the case file refer to by quantity.

mod basis;
pub mod charts;
mod compressive_step;
mod constant_stress;
pub(crate) mod contact;
pub(crate) mod convergence;
mod crack_cost;
mod crack_profile;
mod dense;
mod eigenfrequencies;
mod homogeneous_state;
mod judging;
mod linear_field;
mod nurbs;
pub mod orders;
pub(crate) mod patches;
mod pulse;
mod random;
mod rings;
mod rotation;
pub mod scene;
mod softening_bar;
mod stability;
mod vibration;

use stability::{
    boundary_points, critical_step, growth, incompressible, repeatability, split_families, units, unloading,
};

use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::dynamics::projection::Projection;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::particles::lattice::Lattice;
use thiserror::Error;

use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::record::{Figure, Reference, ReferenceKind};

/// One number a study found.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Variant it belongs to; empty if there is one only.
    pub variant: String,
    /// Name of the measured quantity in words; checks refer to it by this name.
    pub quantity: String,
    /// Unit of the value and of its reference.
    pub unit: String,
    /// Measured value; none in a plan, or if the event did not occur.
    pub value: Option<f64>,
    /// What it is held against.
    pub reference: Option<Reference>,
}

impl Measurement {
    fn new([variant, quantity, unit]: [&str; 3], value: impl Into<Option<f64>>, reference: Option<Reference>) -> Self {
        let [variant, quantity, unit] = [variant, quantity, unit].map(String::from);
        Self { variant, quantity, unit, value: value.into(), reference }
    }
}

/// Everything a study found, or what it will measure.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Numbers, for the checks; without values in a plan.
    pub measurements: Vec<Measurement>,
    /// Tables behind the figures: file name without ending.
    pub series: Vec<(String, Table)>,
    /// Figures of what was measured.
    pub figures: Vec<Figure>,
    /// Whether nothing is computed.
    plan: bool,
}

/// A dimensionless number in words, and what it is held against.
type Quantity<Words> = (Words, Option<Reference>);

impl Findings {
    /// Adds what a variant is measured by; `values` computes the numbers, unless this is a plan.
    fn measure<Words: ToString, const N: usize>(
        &mut self,
        variant: &str,
        quantities: [Quantity<Words>; N],
        values: impl FnOnce() -> Result<[f64; N], StudyError>,
    ) -> Result<(), StudyError> {
        let values = self.compute(values)?;
        self.add_all(variant, quantities, values);
        Ok(())
    }

    /// Adds what a variant is measured by, and the numbers, if there are any.
    fn add_all<Words: ToString, const N: usize>(
        &mut self,
        variant: &str,
        quantities: [Quantity<Words>; N],
        values: Option<[f64; N]>,
    ) {
        let values = values.map_or([None; N], |values| values.map(Some));
        for ((quantity, reference), value) in quantities.into_iter().zip(values) {
            self.add(variant, &quantity.to_string(), value, reference);
        }
    }

    /// What `work` finds; nothing in a plan.
    fn compute<T>(&self, work: impl FnOnce() -> Result<T, StudyError>) -> Result<Option<T>, StudyError> {
        if self.plan { Ok(None) } else { work().map(Some) }
    }

    /// Adds a dimensionless number.
    fn add(&mut self, variant: &str, quantity: &str, value: impl Into<Option<f64>>, reference: Option<Reference>) {
        self.measurements.push(Measurement::new([variant, quantity, "1"], value, reference));
    }
}

/// What a number is held against that is known exactly.
fn exact(value: f64, source: &str) -> Option<Reference> {
    Some(Reference::new(Some(value), ReferenceKind::Exact, source))
}

/// What a number is held against that a theory gives.
fn theory(value: f64, source: &str) -> Option<Reference> {
    Some(Reference::new(Some(value), ReferenceKind::Theory, source))
}

/// 1 for what holds, else 0.
fn yes(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Control values of a vector field on a body; a component is zero where conditions hold it.
pub(crate) fn projected(
    frame: &TotalFrame,
    field: impl Fn([f64; 2]) -> [f64; 2] + Sync,
) -> Result<[Vec<f64>; 2], StudyError> {
    projected_on(&frame.lattice, |c| frame.constraints.held(c), field)
}

/// As [`projected`], where a component is zero at the control points `held`.
fn projected_on(
    lattice: &Lattice,
    held: impl Fn(usize) -> Vec<usize>,
    field: impl Fn([f64; 2]) -> [f64; 2] + Sync,
) -> Result<[Vec<f64>; 2], StudyError> {
    let component = |c: usize| -> Result<Vec<f64>, StudyError> {
        let projection = Projection::new(lattice, &held(c));
        let projection = projection.ok_or_else(|| other("the points do not determine a projection"))?;
        Ok(projection.project(|x| field(x)[c]))
    };
    Ok([component(0)?, component(1)?])
}

/// A study that could not be carried out.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StudyError {
    /// A simulation that the study runs broke down.
    #[error(transparent)]
    Breakdown(#[from] fisura::simulation::breakdown::Breakdown),
    /// The case is over its time.
    #[error(transparent)]
    Stopped(#[from] crate::watch::Stopped),
    /// Another reason why the study cannot be carried out, in words.
    #[error("{0}")]
    Other(String),
}

/// An error in these words.
fn other(message: impl ToString) -> StudyError {
    StudyError::Other(message.to_string())
}

/// Adds what a study finds or, in a plan, what it will measure.
type Run = fn(&Case, &[CaseScene], &mut Findings) -> Result<(), StudyError>;

/// A way to run a case and to measure.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Name in case files.
    pub name: &'static str,
    /// Tables of a case that it reads, of [`INPUTS`]; the first has to be there.
    pub reads: &'static [&'static str],
    run: Run,
}

impl Study {
    /// Runs it.
    ///
    /// # Errors
    /// What keeps it from being carried out.
    pub fn run(&self, case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
        let mut findings = Findings::default();
        (self.run)(case, scenes, &mut findings).map(|()| findings)
    }

    /// What it will measure.
    ///
    /// # Errors
    /// What keeps it from being carried out, as far as it is known before.
    pub fn plan(&self, case: &Case, scenes: &[CaseScene]) -> Result<Vec<Measurement>, StudyError> {
        let mut plan = Findings { plan: true, ..Findings::default() };
        (self.run)(case, scenes, &mut plan).map(|()| plan.measurements)
    }
}

/// Tables and keys of a case file that not every study reads.
pub const INPUTS: [&str; 7] = ["scene", "values", "variant", "energy_factor", "convergence", "rings", "chart"];

const NOTHING: &[&str] = &[];
const SCENES: &[&str] = &["scene", "variant"];

const fn study(name: &'static str, reads: &'static [&'static str], run: Run) -> Study {
    Study { name, reads, run }
}

/// Studies other than `scene`.
pub static STUDIES: [Study; 28] = [
    study("basis", NOTHING, basis::study),
    study("constant-stress", SCENES, constant_stress::study),
    study("homogeneous-state", SCENES, homogeneous_state::study),
    study("softening-bar", SCENES, softening_bar::study),
    study("compressive-step", SCENES, compressive_step::study),
    study("nurbs", NOTHING, nurbs::study),
    study("convergence", &["convergence"], convergence::study),
    study("vibration", NOTHING, vibration::study),
    study("pulse", NOTHING, pulse::study),
    study("crack-cost", NOTHING, crack_cost::study),
    study("crack-profile", NOTHING, crack_profile::study),
    study("rotation", SCENES, rotation::study),
    study("eigenfrequencies", NOTHING, eigenfrequencies::study),
    study("linear-field", NOTHING, linear_field::study),
    study("contact-impact", SCENES, contact::impact::study),
    study("contact-onset", SCENES, contact::onset::study),
    study("contact-hertz", SCENES, contact::hertz::study),
    study("rings", &["scene", "variant", "energy_factor"], rings::study),
    study("rings-sweep", &["rings", "scene"], rings::sweep),
    study("critical-step", NOTHING, critical_step::study),
    study("step-growth", NOTHING, growth::study),
    study("incompressible", NOTHING, incompressible::study),
    study("split-families", NOTHING, split_families::study),
    study("boundary-points", NOTHING, boundary_points::study),
    study("unit-systems", NOTHING, units::study),
    study("repeatability", NOTHING, repeatability::study),
    study("unloading", NOTHING, unloading::study),
    study("judging", NOTHING, judging::study),
];

/// The study of that name.
pub fn find(name: &str) -> Option<&'static Study> {
    STUDIES.iter().find(|study| study.name == name)
}

/// The samples of a run from its start to its end.
fn samples(simulation: &mut Simulation) -> Result<Vec<Sample>, StudyError> {
    let mut samples = vec![simulation.sample()];
    while !simulation.finished() {
        crate::watch::check()?;
        samples.push(simulation.advance_to_next_sample()?);
    }
    Ok(samples)
}
