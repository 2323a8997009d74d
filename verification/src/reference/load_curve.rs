//! Curves of a `source.toml`: columns found, checked and brought to SI units.

use std::path::Path;

use toml::Spanned;

use super::load::{SOURCE, SourceReader};
use super::quantity::{self, Unit};
use super::source_file::CurveEntry;
use super::{Obtained, ReferenceCurve, ReferenceError};
use crate::output::history::Table;

impl SourceReader {
    /// In a picture-only folder a curve may be absent, so a misspelt column would be silently ignored: every
    /// column of a file that was added has to be one that some curve describes.
    pub(super) fn check_picture_columns(&self) -> Result<(), ReferenceError> {
        if self.source.obtained != Obtained::PictureOnly {
            return Ok(());
        }
        for entry in &self.source.curves {
            let path = self.folder.join(&entry.as_ref().file);
            if !path.exists() {
                continue;
            }
            let same_file = self.source.curves.iter().map(Spanned::as_ref).filter(|c| c.file == entry.as_ref().file);
            let known: Vec<&str> = same_file.flat_map(|c| [c.x.as_str(), c.y.as_str()]).collect();
            let names = self.table(&path)?.names;
            if let Some(stranger) = names.iter().find(|name| !known.contains(&name.as_str())) {
                let message = format!("no [[curve]] of {SOURCE} describes the column {stranger:?}");
                let remedy = format!("name it one of {}, or edit {SOURCE}", known.join(", "));
                return Err(ReferenceError::file(&path, message, remedy));
            }
            if names.len() < 2 {
                let remedy = format!("give the abscissa and one of {}", known.join(", "));
                return Err(ReferenceError::file(&path, "fewer than two columns", remedy));
            }
        }
        Ok(())
    }

    fn table(&self, path: &Path) -> Result<Table, ReferenceError> {
        Table::read(path).map_err(|e| ReferenceError {
            path: e.path,
            place: String::new(),
            message: e.message,
            remedy: "a reference table has one header line and rows of as many numbers, separated by commas".into(),
        })
    }

    /// The curve of an entry; `None` if it is picture-only and absent.
    pub(super) fn curve(&self, spanned: &Spanned<CurveEntry>) -> Result<Option<ReferenceCurve>, ReferenceError> {
        let entry = spanned.as_ref();
        let Some([x_dimension, y_dimension]) = quantity::dimensions(&entry.quantity) else {
            let message = format!("unknown quantity {:?}", entry.quantity);
            let remedy = format!("one of {}", quantity::quantities().collect::<Vec<_>>().join(", "));
            return Err(self.error(spanned, "[[curve]] quantity", message, remedy));
        };
        let x_unit = Unit::read(&entry.x_unit, Some(x_dimension)).map_err(self.unit_error(spanned, "x_unit"))?;
        let y_unit = Unit::read(&entry.y_unit, Some(y_dimension)).map_err(self.unit_error(spanned, "y_unit"))?;
        self.check_uncertainty(spanned)?;
        let Some([x, y]) = self.columns(spanned)? else { return Ok(None) };
        let mut points = Vec::with_capacity(x.len());
        for (x, y) in x.iter().zip(&y) {
            let x = x_unit.to_si(*x).map_err(self.unit_error(spanned, &entry.x))?;
            points.push((x, y_unit.to_si(*y).map_err(self.unit_error(spanned, &entry.y))?));
        }
        if entry.subtract_first {
            self.subtract_first(spanned, &mut points)?;
        }
        self.check_order(spanned, &mut points)?;
        let gap = entry.max_gap.map(|gap| x_unit.to_si(gap)).transpose();
        let absolute = y_unit.to_si(entry.uncertainty_absolute);
        let along = x_unit.to_si(entry.uncertainty_x);
        let (x, y) = points.into_iter().unzip();
        Ok(Some(ReferenceCurve {
            id: entry.variant.as_ref().map_or(self.source.id.clone(), |v| format!("{}/{v}", self.source.id)),
            quantity: entry.quantity.clone(),
            label: entry.label.clone(),
            citation: self.source.citation.clone(),
            kind: self.source.kind,
            obtained: self.source.obtained,
            x,
            y,
            x_unit: x_unit.si,
            y_unit: y_unit.si,
            max_gap: gap.map_err(self.unit_error(spanned, "max_gap"))?,
            uncertainty_absolute: absolute.map_err(self.unit_error(spanned, "uncertainty_absolute"))?,
            uncertainty_relative: entry.uncertainty_relative,
            uncertainty_x: along.map_err(self.unit_error(spanned, "uncertainty_x"))?,
            uncertainty_note: entry.uncertainty_note.clone(),
        }))
    }

    fn check_uncertainty(&self, spanned: &Spanned<CurveEntry>) -> Result<(), ReferenceError> {
        let entry = spanned.as_ref();
        let parts = [
            ("uncertainty_absolute", entry.uncertainty_absolute),
            ("uncertainty_relative", entry.uncertainty_relative),
            ("uncertainty_x", entry.uncertainty_x),
            ("max_gap", entry.max_gap.unwrap_or(0.0)),
        ];
        if let Some((key, value)) = parts.iter().find(|(_, v)| !v.is_finite() || *v < 0.0) {
            let message = format!("{value} is not a valid value");
            return Err(self.error(spanned, key, message, "give a finite number of at least 0"));
        }
        if entry.uncertainty_note.trim().is_empty() {
            let remedy = "state how the uncertainty was estimated, or that it is unknown";
            return Err(self.error(spanned, "uncertainty_note", "empty", remedy));
        }
        Ok(())
    }

    /// The two columns of an entry, as they stand in its file.
    fn columns(&self, spanned: &Spanned<CurveEntry>) -> Result<Option<[Vec<f64>; 2]>, ReferenceError> {
        let entry = spanned.as_ref();
        let may_be_absent = self.source.obtained == Obtained::PictureOnly;
        let path = self.folder.join(&entry.file);
        if !path.exists() {
            if may_be_absent {
                return Ok(None);
            }
            let message = format!("there is no file {:?} in this folder", entry.file);
            let remedy = "add the file, or set obtained = \"picture-only\" if its numbers are not available";
            return Err(self.error(spanned, "[[curve]] file", message, remedy));
        }
        let table = self.table(&path)?;
        let missing = |key: &str, name: &str| {
            let message = format!("{:?} has no column {name:?}", entry.file);
            self.error(spanned, key, message, format!("its columns are {}", table.names.join(", ")))
        };
        if may_be_absent && table.column(&entry.y).is_none() {
            return Ok(None);
        }
        let x = table.column(&entry.x).ok_or_else(|| missing("x", &entry.x))?;
        let y = table.column(&entry.y).ok_or_else(|| missing("y", &entry.y))?;
        if x.is_empty() {
            return Err(ReferenceError::file(&path, "no rows", "add points, or remove the file"));
        }
        Ok(Some([x.to_vec(), y.to_vec()]))
    }

    /// Raw values to increments. The first point has to lie at the start, or the increment would lack what
    /// came before.
    fn subtract_first(&self, spanned: &Spanned<CurveEntry>, points: &mut [(f64, f64)]) -> Result<(), ReferenceError> {
        let (start, first) = points[0];
        let end = points[points.len() - 1].0;
        if start.abs() > 0.01 * end.abs() {
            let message = format!("the first point of {:?} lies at {start:e} (SI), not at 0", spanned.as_ref().file);
            let remedy = "raw values become increments by subtracting the value at 0: add that point";
            return Err(self.error(spanned, "subtract_first", message, remedy));
        }
        points.iter_mut().for_each(|p| p.1 -= first);
        Ok(())
    }

    /// Brings falling abscissae into rising order; anything else is an error.
    fn check_order(&self, spanned: &Spanned<CurveEntry>, points: &mut [(f64, f64)]) -> Result<(), ReferenceError> {
        let entry = spanned.as_ref();
        if points.len() > 1 && points[0].0 > points[1].0 {
            points.reverse();
        }
        if let Some(pair) = points.windows(2).find(|pair| pair[0].0 >= pair[1].0) {
            let message = format!("{:?} does not increase at {} = {:e} (SI)", entry.file, entry.x, pair[1].0);
            return Err(self.error(spanned, "x", message, "sort the rows and keep one row per abscissa"));
        }
        Ok(())
    }
}
