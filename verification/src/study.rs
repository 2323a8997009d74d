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
mod offers;
pub mod orders;
mod patches;
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

use fisura::dynamics::projection::Projection;
use fisura::dynamics::total_frame::TotalFrame;
pub use offers::{Offer, Offers};
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
    /// Quantity in words.
    pub quantity: String,
    /// Unit.
    pub unit: String,
    /// Value.
    pub value: Option<f64>,
    /// What it is held against.
    pub reference: Option<Reference>,
}

/// Everything a study found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Findings {
    /// Numbers, for the checks.
    pub measurements: Vec<Measurement>,
    /// Tables behind the figures: file name without ending.
    pub series: Vec<(String, Table)>,
    /// Figures.
    pub figures: Vec<Figure>,
}

impl Findings {
    /// Adds a dimensionless number held against an exact value of zero or against nothing.
    pub fn add(&mut self, variant: &str, quantity: &str, value: f64, reference: Option<Reference>) {
        self.measurements.push(Measurement {
            variant: variant.to_string(),
            quantity: quantity.to_string(),
            unit: "1".to_string(),
            value: Some(value),
            reference,
        });
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
    let component = |c: usize| -> Result<Vec<f64>, StudyError> {
        let projection = Projection::new(frame.lattice(), &frame.constraints().held(c));
        let projection = projection.ok_or_else(|| other("the points do not determine a projection"))?;
        Ok(projection.project(|x| field(x)[c]))
    };
    Ok([component(0)?, component(1)?])
}

/// A study that could not be carried out.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum StudyError {
    /// A run broke down.
    #[error(transparent)]
    Breakdown(#[from] fisura::simulation::breakdown::Breakdown),
    /// The case is over its time.
    #[error(transparent)]
    Stopped(#[from] crate::watch::Stopped),
    /// Something else.
    #[error("{0}")]
    Other(String),
}

/// An error in these words.
fn other(message: impl ToString) -> StudyError {
    StudyError::Other(message.to_string())
}

/// What a study offers for a case, or why it cannot be carried out.
pub type Offered = Result<Offers, StudyError>;

/// A way to run a case and to measure.
#[derive(Debug, Clone, Copy)]
pub struct Study {
    /// Name in case files.
    pub name: &'static str,
    /// Tables of a case that it reads, of [`INPUTS`]; the first has to be there.
    pub reads: &'static [&'static str],
    /// What it will measure.
    pub offers: fn(&Case, &[CaseScene]) -> Offered,
    /// Runs it.
    pub run: fn(&Case, &[CaseScene]) -> Result<Findings, StudyError>,
}

/// Tables and keys of a case file that not every study reads.
pub const INPUTS: [&str; 7] = ["scene", "values", "variant", "energy_factor", "convergence", "rings", "chart"];

const NOTHING: &[&str] = &[];
const SCENES: &[&str] = &["scene", "variant"];

const fn study(
    name: &'static str,
    reads: &'static [&'static str],
    offers: fn(&Case, &[CaseScene]) -> Offered,
    run: fn(&Case, &[CaseScene]) -> Result<Findings, StudyError>,
) -> Study {
    Study { name, reads, offers, run }
}

/// Studies other than `scene`.
pub static STUDIES: [Study; 28] = [
    study("basis", NOTHING, basis::offers, basis::study),
    study("constant-stress", SCENES, constant_stress::offers, constant_stress::study),
    study("homogeneous-state", SCENES, homogeneous_state::offers, homogeneous_state::study),
    study("softening-bar", SCENES, softening_bar::offers, softening_bar::study),
    study("compressive-step", SCENES, compressive_step::offers, compressive_step::study),
    study("nurbs", NOTHING, nurbs::offers, nurbs::study),
    study("convergence", &["convergence"], convergence::offers, convergence::study),
    study("vibration", NOTHING, vibration::offers, vibration::study),
    study("pulse", NOTHING, pulse::offers, pulse::study),
    study("crack-cost", NOTHING, crack_cost::offers, crack_cost::study),
    study("crack-profile", NOTHING, crack_profile::offers, crack_profile::study),
    study("rotation", SCENES, rotation::offers, rotation::study),
    study("eigenfrequencies", NOTHING, eigenfrequencies::offers, eigenfrequencies::study),
    study("linear-field", NOTHING, linear_field::offers, linear_field::study),
    study("contact-impact", SCENES, contact::impact::offers, contact::impact::study),
    study("contact-onset", SCENES, contact::onset::offers, contact::onset::study),
    study("contact-hertz", SCENES, contact::hertz::offers, contact::hertz::study),
    study("rings", &["scene", "variant", "energy_factor"], rings::offers, rings::study),
    study("rings-sweep", &["rings", "scene"], rings::sweep_offers, rings::sweep),
    study("critical-step", NOTHING, critical_step::offers, critical_step::study),
    study("step-growth", NOTHING, growth::offers, growth::study),
    study("incompressible", NOTHING, incompressible::offers, incompressible::study),
    study("split-families", NOTHING, split_families::offers, split_families::study),
    study("boundary-points", NOTHING, boundary_points::offers, boundary_points::study),
    study("unit-systems", NOTHING, units::offers, units::study),
    study("repeatability", NOTHING, repeatability::offers, repeatability::study),
    study("unloading", NOTHING, unloading::offers, unloading::study),
    study("judging", NOTHING, judging::offers, judging::study),
];

/// The study of that name.
pub fn find(name: &str) -> Option<&'static Study> {
    STUDIES.iter().find(|study| study.name == name)
}
