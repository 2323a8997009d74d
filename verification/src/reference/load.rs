//! Folders of reference data, read and checked.

use std::fs;
use std::path::{Path, PathBuf};

use toml::Spanned;

use super::quantity::Unit;
use super::source_file::{BandEntry, ValueEntry};
use super::{Library, ReferenceBand, ReferenceError, ReferenceValue, Source};
use crate::scene::units::UnitError;

/// Name of the file that describes a source.
pub(super) const SOURCE: &str = "source.toml";

/// Reads everything below `folder`.
pub(super) fn library(folder: &Path) -> Result<Library, ReferenceError> {
    let mut library = Library::default();
    walk(folder, folder, &mut library)?;
    if library.sources.is_empty() {
        let remedy = "each source needs a folder with a source.toml; is this the folder of the reference data?";
        return Err(ReferenceError::file(folder, format!("no {SOURCE} in this folder or below it"), remedy));
    }
    Ok(library)
}

/// Reads `folder`, then its subfolders in the order of their names.
fn walk(root: &Path, folder: &Path, library: &mut Library) -> Result<(), ReferenceError> {
    let fail = |e: std::io::Error| ReferenceError::file(folder, e.to_string(), "give a folder that can be read");
    let mut entries = fs::read_dir(folder)
        .and_then(|entries| entries.map(|entry| entry.map(|e| e.path())).collect::<Result<Vec<_>, _>>())
        .map_err(fail)?;
    entries.sort();
    if entries.iter().any(|path| path.file_name().is_some_and(|name| name == super::SUBMISSION)) {
        return Ok(()); // a result to be judged, no reference
    }
    if entries.iter().any(|path| path.file_name().is_some_and(|name| name == SOURCE)) {
        SourceReader::open(root, folder)?.read(library)?;
    } else if let Some(table) = entries.iter().find(|path| path.extension().is_some_and(|e| e == "csv")) {
        let message = format!("provenance is missing: no {SOURCE} in the folder");
        return Err(ReferenceError::file(table, message, "add one with the source of the numbers"));
    }
    entries.iter().filter(|path| path.is_dir()).try_for_each(|path| walk(root, path, library))
}

/// One `source.toml` on its way into the library.
pub(super) struct SourceReader {
    pub(super) folder: PathBuf,
    path: PathBuf,
    text: String,
    pub(super) source: Source,
}

impl SourceReader {
    fn open(root: &Path, folder: &Path) -> Result<Self, ReferenceError> {
        let path = folder.join(SOURCE);
        let text = fs::read_to_string(&path)
            .map_err(|e| ReferenceError::file(&path, e.to_string(), "give a text file in UTF-8"))?;
        let mut source: Source = toml::from_str(&text).map_err(|e| {
            let line = line_of(&text, e.span().map_or(0, |s| s.start));
            let remedy = "see README.md of the reference data for the keys of source.toml";
            ReferenceError::at(&path, line, "TOML", e.message().trim(), remedy)
        })?;
        if source.citation.trim().is_empty() {
            let line = 1 + text.lines().take_while(|line| !line.starts_with("citation")).count();
            return Err(ReferenceError::at(&path, line, "citation", "empty", "give the source of the numbers"));
        }
        let relative = folder.strip_prefix(root).unwrap_or(folder);
        source.id = relative.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/");
        Ok(Self { folder: folder.to_path_buf(), path, text, source })
    }

    fn read(self, library: &mut Library) -> Result<(), ReferenceError> {
        self.check_picture_columns()?;
        for entry in &self.source.curves {
            let Some(curve) = self.curve(entry)? else { continue };
            if library.curve(&curve.id, &curve.quantity).is_some() {
                let message = format!("a second curve of {:?} under {:?}", curve.quantity, curve.id);
                let remedy = "give each its own `variant`, or keep one of the columns";
                return Err(self.error(entry, "[[curve]] quantity", message, remedy));
            }
            library.curves.push(curve);
        }
        for entry in &self.source.values {
            let value = self.value(entry)?;
            self.check_new(entry, "[[value]] name", &value.name, library.value(&value.id, &value.name).is_some())?;
            library.values.push(value);
        }
        for entry in &self.source.bands {
            let band = self.band(entry)?;
            self.check_new(entry, "[[band]] name", &band.name, library.band(&band.id, &band.name).is_some())?;
            library.bands.push(band);
        }
        library.sources.push(self.source);
        Ok(())
    }

    /// An error at an entry of the file.
    pub(super) fn error<T>(
        &self,
        entry: &Spanned<T>,
        key: &str,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ReferenceError {
        ReferenceError::at(&self.path, line_of(&self.text, entry.span().start), key, message, remedy)
    }

    pub(super) fn unit_error<T>(&self, entry: &Spanned<T>, key: &str) -> impl Fn(UnitError) -> ReferenceError {
        move |e| self.error(entry, key, e.message, e.remedy)
    }

    fn check_new<T>(&self, entry: &Spanned<T>, key: &str, name: &str, known: bool) -> Result<(), ReferenceError> {
        if known { Err(self.error(entry, key, format!("duplicate name {name:?}"), "rename one")) } else { Ok(()) }
    }

    fn value(&self, spanned: &Spanned<ValueEntry>) -> Result<ReferenceValue, ReferenceError> {
        let entry = spanned.as_ref();
        let unit = Unit::read(&entry.unit, None).map_err(self.unit_error(spanned, "[[value]] unit"))?;
        if let Some(uncertainty) = entry.uncertainty.filter(|u| !(u.is_finite() && *u > 0.0)) {
            let message = format!("{uncertainty} is not a valid uncertainty");
            let remedy = "give a positive number, or remove it if it is unknown";
            return Err(self.error(spanned, "[[value]] uncertainty", message, remedy));
        }
        let uncertainty = entry.uncertainty.map(|u| unit.to_si(u)).transpose();
        Ok(ReferenceValue {
            id: self.source.id.clone(),
            name: entry.name.clone(),
            unit: unit.si,
            value: unit.to_si(entry.value).map_err(self.unit_error(spanned, "[[value]] value"))?,
            uncertainty: uncertainty.map_err(self.unit_error(spanned, "[[value]] uncertainty"))?,
            note: entry.note.clone(),
            citation: self.source.citation.clone(),
            kind: self.source.kind,
        })
    }

    fn band(&self, spanned: &Spanned<BandEntry>) -> Result<ReferenceBand, ReferenceError> {
        let entry = spanned.as_ref();
        let unit = Unit::read(&entry.unit, None).map_err(self.unit_error(spanned, "[[band]] unit"))?;
        if entry.min > entry.max {
            let message = format!("{:?} runs from {} to {}", entry.name, entry.min, entry.max);
            return Err(self.error(spanned, "[[band]] min", message, "swap the two"));
        }
        Ok(ReferenceBand {
            id: self.source.id.clone(),
            name: entry.name.clone(),
            unit: unit.si,
            min: unit.to_si(entry.min).map_err(self.unit_error(spanned, "[[band]] min"))?,
            max: unit.to_si(entry.max).map_err(self.unit_error(spanned, "[[band]] max"))?,
            sources: entry.sources.clone(),
            note: entry.note.clone(),
            citation: self.source.citation.clone(),
            kind: self.source.kind,
        })
    }
}

/// Line (from 1) of a byte offset.
fn line_of(text: &str, offset: usize) -> usize {
    text.as_bytes()[..offset.min(text.len())].iter().filter(|b| **b == b'\n').count() + 1
}
