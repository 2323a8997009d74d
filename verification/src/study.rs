//! Studies: how a case is run.
//!
//! A `scene` study runs the case's scenes and measures their histories. The others compute something of their own; each
//! is one file and yields measurements that the checks of the case file refer to by quantity.

mod basis;
mod compressive_step;
mod constant_stress;
mod contact;
pub(crate) mod convergence;
mod crack_profile;
mod eigenfrequencies;
mod homogeneous_state;
mod linear_field;
mod nurbs;
mod pulse;
mod rings;
mod rotation;
pub mod scene;
mod stability;
mod vibration;

use thiserror::Error;

use crate::case::Case;
use crate::expand::CaseScene;
use crate::history::Table;
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
    Breakdown(#[from] fisura::error::Breakdown),
    /// Something else.
    #[error("{0}")]
    Other(String),
}

type Study = fn(&Case, &[CaseScene]) -> Result<Findings, StudyError>;

/// Studies other than `scene`, by name.
pub const STUDIES: [(&str, Study); 29] = [
    ("basis", basis::study),
    ("constant-stress", constant_stress::study),
    ("homogeneous-state", homogeneous_state::study),
    ("compressive-step", compressive_step::study),
    ("nurbs", nurbs::study),
    ("convergence", convergence::study),
    ("vibration", vibration::study),
    ("pulse", pulse::study),
    ("crack-profile", crack_profile::study),
    ("rotation", rotation::study),
    ("eigenfrequencies", eigenfrequencies::study),
    ("linear-field", linear_field::study),
    ("contact-impact", contact::impact::study),
    ("contact-onset", contact::onset::study),
    ("contact-incline", contact::incline::study),
    ("contact-collision", contact::collision::study),
    ("contact-hertz", contact::hertz::study),
    ("contact-stack", contact::stack::study),
    ("rings", rings::study),
    ("rings-sweep", rings::sweep),
    ("critical-step", stability::critical_step::study),
    ("step-growth", stability::growth::study),
    ("incompressible", stability::incompressible::study),
    ("split-families", stability::split_families::study),
    ("boundary-points", stability::boundary_points::study),
    ("unit-systems", stability::units::study),
    ("repeatability", stability::repeatability::study),
    ("unloading", stability::unloading::study),
    ("stick-slip", stability::stick_slip::study),
];

/// The study of that name.
pub fn find(name: &str) -> Option<Study> {
    STUDIES.iter().find(|(known, _)| *known == name).map(|(_, study)| *study)
}
