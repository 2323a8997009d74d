//! `source.toml` as people write it.

use serde::{Deserialize, Serialize};
use toml::Spanned;

use crate::record::ReferenceKind;

/// How numbers were obtained.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Obtained {
    /// Read from output that the authors publish.
    PublishedOutput,
    /// Measured from a picture.
    Digitised,
    /// Computed with another code for comparison.
    IndependentCode,
    /// Computed with this code, to recognise something in results of others.
    OwnCode,
    /// Taken from the text of a source.
    #[default]
    Text,
    /// Put together from other folders.
    Compiled,
    /// A picture that nobody has digitised yet: its file may be absent.
    PictureOnly,
}

/// A misprint in a source, and what is used instead.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Slip {
    /// Place of the misprint in the source, such as the number of an equation.
    pub place: String,
    /// What the source says there, in words or as a formula.
    pub printed: String,
    /// What this project uses.
    pub used: String,
}

/// Content of one `source.toml`: where the numbers of its folder come from, and what they are.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Folder below the library's, with `/`: `estrada-2024/figure-3a`.
    #[serde(skip)]
    pub id: String,
    /// Citation of the source, as printed.
    pub citation: String,
    /// The same as an entry of BibTeX, where there is one.
    pub bibtex: Option<String>,
    /// Address, where there is one.
    pub url: Option<String>,
    /// How the numbers were obtained.
    pub obtained: Obtained,
    /// Kind of reference that a record states when it is held against these numbers.
    pub kind: ReferenceKind,
    /// Model behind the numbers in words, such as plane state and phase-field model.
    pub model: String,
    /// Resolution of the numbers in words, such as mesh and number of points.
    pub resolution: String,
    /// What to know before comparing.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Misprints, and what is used instead.
    #[serde(default, rename = "slip")]
    pub slips: Vec<Slip>,
    #[serde(default, rename = "curve")]
    pub(super) curves: Vec<Spanned<CurveEntry>>,
    #[serde(default, rename = "value")]
    pub(super) values: Vec<Spanned<ValueEntry>>,
    #[serde(default, rename = "band")]
    pub(super) bands: Vec<Spanned<BandEntry>>,
}

/// `[[curve]]`: two columns of a CSV file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CurveEntry {
    pub(super) variant: Option<String>,
    pub(super) quantity: String,
    pub(super) label: String,
    pub(super) file: String,
    pub(super) x: String,
    pub(super) x_unit: String,
    pub(super) y: String,
    pub(super) y_unit: String,
    pub(super) max_gap: Option<f64>,
    #[serde(default)]
    pub(super) subtract_first: bool,
    pub(super) uncertainty_absolute: f64,
    pub(super) uncertainty_relative: f64,
    #[serde(default)]
    pub(super) uncertainty_x: f64,
    pub(super) uncertainty_note: String,
}

/// `[[value]]`: a number.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ValueEntry {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) value: f64,
    pub(super) uncertainty: Option<f64>,
    pub(super) note: String,
}

/// `[[band]]`: a range.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BandEntry {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) min: f64,
    pub(super) max: f64,
    #[serde(default)]
    pub(super) sources: Vec<String>,
    pub(super) note: String,
}
