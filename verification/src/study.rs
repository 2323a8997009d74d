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
mod stability;
mod vibration;

pub use offers::{Offer, Offers};
use thiserror::Error;

use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::record::{Figure, Reference};

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

/// Studies other than `scene`.
pub static STUDIES: [Study; 27] = [
    Study { name: "basis", reads: NOTHING, offers: basis::offers, run: basis::study },
    Study { name: "constant-stress", reads: SCENES, offers: constant_stress::offers, run: constant_stress::study },
    Study {
        name: "homogeneous-state",
        reads: SCENES,
        offers: homogeneous_state::offers,
        run: homogeneous_state::study,
    },
    Study { name: "compressive-step", reads: SCENES, offers: compressive_step::offers, run: compressive_step::study },
    Study { name: "nurbs", reads: NOTHING, offers: nurbs::offers, run: nurbs::study },
    Study { name: "convergence", reads: &["convergence"], offers: convergence::offers, run: convergence::study },
    Study { name: "vibration", reads: NOTHING, offers: vibration::offers, run: vibration::study },
    Study { name: "pulse", reads: NOTHING, offers: pulse::offers, run: pulse::study },
    Study { name: "crack-cost", reads: NOTHING, offers: crack_cost::offers, run: crack_cost::study },
    Study { name: "crack-profile", reads: NOTHING, offers: crack_profile::offers, run: crack_profile::study },
    Study { name: "rotation", reads: SCENES, offers: rotation::offers, run: rotation::study },
    Study { name: "eigenfrequencies", reads: NOTHING, offers: eigenfrequencies::offers, run: eigenfrequencies::study },
    Study { name: "linear-field", reads: NOTHING, offers: linear_field::offers, run: linear_field::study },
    Study { name: "contact-impact", reads: SCENES, offers: contact::impact::offers, run: contact::impact::study },
    Study { name: "contact-onset", reads: SCENES, offers: contact::onset::offers, run: contact::onset::study },
    Study { name: "contact-hertz", reads: SCENES, offers: contact::hertz::offers, run: contact::hertz::study },
    Study { name: "rings", reads: &["scene", "variant", "energy_factor"], offers: rings::offers, run: rings::study },
    Study { name: "rings-sweep", reads: &["rings", "scene"], offers: rings::sweep_offers, run: rings::sweep },
    Study {
        name: "critical-step",
        reads: NOTHING,
        offers: stability::critical_step::offers,
        run: stability::critical_step::study,
    },
    Study { name: "step-growth", reads: NOTHING, offers: stability::growth::offers, run: stability::growth::study },
    Study {
        name: "incompressible",
        reads: NOTHING,
        offers: stability::incompressible::offers,
        run: stability::incompressible::study,
    },
    Study {
        name: "split-families",
        reads: NOTHING,
        offers: stability::split_families::offers,
        run: stability::split_families::study,
    },
    Study {
        name: "boundary-points",
        reads: NOTHING,
        offers: stability::boundary_points::offers,
        run: stability::boundary_points::study,
    },
    Study { name: "unit-systems", reads: NOTHING, offers: stability::units::offers, run: stability::units::study },
    Study {
        name: "repeatability",
        reads: NOTHING,
        offers: stability::repeatability::offers,
        run: stability::repeatability::study,
    },
    Study { name: "unloading", reads: NOTHING, offers: stability::unloading::offers, run: stability::unloading::study },
    Study { name: "judging", reads: NOTHING, offers: judging::offers, run: judging::study },
];

/// The study of that name.
pub fn find(name: &str) -> Option<&'static Study> {
    STUDIES.iter().find(|study| study.name == name)
}
