//! Reference data: curves, numbers and bands from elsewhere, with their provenance.
//!
//! A library is a folder whose subfolders each hold a `source.toml` (citation, how obtained, model,
//! resolution, uncertainty) and CSV files. [`Library::load`] reads and checks all of it; what it hands out is
//! in SI units. A curve that exists only as a picture (`obtained = "picture-only"`) is absent until somebody
//! puts its CSV file there, and from then on it is drawn like any other. Nothing is extrapolated, and gaps
//! stay gaps.

mod compare;
mod curve;
mod error;
mod load;
mod load_curve;
mod quantity;
mod source_file;

use std::path::Path;

use fisura::fault;

pub use compare::{relative_rms, relative_uncertainty, rms_difference, rms_uncertainty};
pub use curve::ReferenceCurve;
pub use error::ReferenceError;
pub use quantity::quantities;
pub use source_file::{Obtained, Slip, Source};

use crate::record::{Reference, ReferenceKind};

/// A number from a source.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceValue {
    /// Folder of its source.
    pub id: String,
    /// Name of the value within its source.
    pub name: String,
    /// SI unit of the value, such as `m/s`; `1` for a plain number.
    pub unit: &'static str,
    /// The number that the source gives, in the SI unit.
    pub value: f64,
    /// Half width of its uncertainty, SI; absent where none is known.
    pub uncertainty: Option<f64>,
    /// Remark of the source file on this number, such as its meaning or how it was found.
    pub note: String,
    /// Citation of its source.
    pub citation: String,
    /// Kind of reference that a record states when it is held against this number.
    pub kind: ReferenceKind,
}

/// A range in which a result should fall.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReferenceBand {
    /// Folder of its source.
    pub id: String,
    /// Name of the band within its source.
    pub name: String,
    /// SI unit of both ends, such as `s`; `1` for plain numbers.
    pub unit: &'static str,
    /// Lower end of the range, in the SI unit.
    pub min: f64,
    /// Upper end of the range, in the SI unit.
    pub max: f64,
    /// Folders of the sources it was put together from.
    pub sources: Vec<String>,
    /// Remark of the source file on this range, such as its meaning or how it was found.
    pub note: String,
    /// Citation of its source.
    pub citation: String,
    /// Kind of reference that a record states when it is held against this range.
    pub kind: ReferenceKind,
}

impl ReferenceValue {
    /// The reference entry of a record that is held against this number times `factor`.
    pub fn reference(&self, factor: f64) -> Reference {
        let source = format!("{}: {} ({})", self.id, self.citation, self.name);
        let uncertainty = self.uncertainty.map(|u| u * factor.abs());
        Reference { uncertainty, ..Reference::new(Some(self.value * factor), self.kind, source) }
    }
}

impl ReferenceBand {
    /// Why a record is held against it.
    pub fn why(&self) -> String {
        format!("the range of the sources: {}", self.sources.join(", "))
    }

    /// The reference entry of a record that is held against this band, in the unit of a check: its middle,
    /// with half its width as the uncertainty.
    pub fn reference(&self, scale: f64) -> Reference {
        let from = if self.sources.is_empty() { self.citation.clone() } else { self.sources.join(", ") };
        let factor = fault!("band-in-other-units", scale => 1.0);
        let (middle, half) = (0.5 * (self.min + self.max), 0.5 * (self.max - self.min));
        let source = format!("{}, {}: {from}", self.id, self.name);
        Reference { uncertainty: Some(half * factor.abs()), ..Reference::new(Some(middle * factor), self.kind, source) }
    }
}

/// File of a folder that holds a result to be judged, and no reference.
pub const SUBMISSION: &str = "submission.toml";

/// All reference data of a folder, in the order of folder names.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Library {
    sources: Vec<Source>,
    curves: Vec<ReferenceCurve>,
    values: Vec<ReferenceValue>,
    bands: Vec<ReferenceBand>,
}

impl Library {
    /// Reads every `source.toml` below `folder`, at any depth, and the CSV files it names. Order and content
    /// depend on nothing but the files.
    ///
    /// # Errors
    /// A folder that cannot be read or holds no `source.toml`; a CSV file without a `source.toml` beside it;
    /// a file that is not as described; a curve whose file or column is missing, unless it is `picture-only`.
    pub fn load(folder: &Path) -> Result<Self, ReferenceError> {
        load::library(folder)
    }

    /// All sources, those without numbers included.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// The source in folder `id`.
    pub fn source(&self, id: &str) -> Option<&Source> {
        self.sources.iter().find(|s| s.id == id)
    }

    /// All curves of a quantity, such as `plate/elastic-energy`.
    pub fn curves(&self, quantity: &str) -> Vec<&ReferenceCurve> {
        self.curves.iter().filter(|c| c.quantity == quantity).collect()
    }

    /// The curve of a quantity from `id` (folder, and variant if the folder has several: `mandal-2020/at2`).
    pub fn curve(&self, id: &str, quantity: &str) -> Option<&ReferenceCurve> {
        self.curves.iter().find(|c| c.id == id && c.quantity == quantity)
    }

    /// All numbers, in the order of the files.
    pub fn values(&self) -> &[ReferenceValue] {
        &self.values
    }

    /// The number called `name` in folder `id`.
    pub fn value(&self, id: &str, name: &str) -> Option<&ReferenceValue> {
        self.values.iter().find(|v| v.id == id && v.name == name)
    }

    /// What is at the path `folder/name`, times `factor`: a number, or a curve (`folder/quantity`) at the
    /// time `at`, s.
    ///
    /// # Errors
    /// If there is neither, or the curve has no ordinate at that time.
    pub fn reference(&self, path: &str, at: Option<f64>, factor: f64) -> Result<Reference, String> {
        let (folder, name) = path.split_once('/').ok_or("write reference = \"folder/name\"")?;
        if let Some(value) = self.value(folder, name) {
            return Ok(value.reference(factor));
        }
        let curve = self.curve(folder, name).ok_or_else(|| format!("no reference value or curve {path:?}"))?;
        let at = at.ok_or_else(|| format!("{path:?} is a curve, but this measure has no time"))?;
        let outside = || format!("the curve {path:?} has no ordinate at {at:e} s");
        curve.reference_at(at, factor).ok_or_else(outside)
    }

    /// All bands, in the order of the files.
    pub fn bands(&self) -> &[ReferenceBand] {
        &self.bands
    }

    /// The band called `name` in folder `id`.
    pub fn band(&self, id: &str, name: &str) -> Option<&ReferenceBand> {
        self.bands.iter().find(|b| b.id == id && b.name == name)
    }
}

#[cfg(test)]
mod tests;
