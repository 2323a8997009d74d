//! Columns of `history.csv`: time series of a run, read and written.

use std::path::Path;

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Most columns of a file.
const MOST_COLUMNS: usize = 10_000;

/// A table of named columns of equal length, as it stands in a series file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Column names, in order.
    pub names: Vec<String>,
    /// Columns, in the same order.
    pub columns: Vec<Vec<f64>>,
}

/// A series file that cannot be read or written.
#[derive(Debug, Error)]
#[error("{path}: {message}")]
pub struct TableError {
    /// Path of the file, or the name that stands for it.
    pub path: String,
    /// What is wrong, with the line where there is one.
    pub message: String,
}

impl Table {
    /// An empty table with these columns.
    pub fn new(names: &[impl AsRef<str>]) -> Self {
        Self { names: names.iter().map(|n| n.as_ref().to_string()).collect(), columns: vec![Vec::new(); names.len()] }
    }

    /// A table of these rows.
    pub fn of_rows<const N: usize>(names: &[&str; N], rows: impl IntoIterator<Item = [f64; N]>) -> Self {
        let mut table = Self::new(names);
        rows.into_iter().for_each(|row| table.push(&row));
        table
    }

    /// Appends a row; `row` has one value per column.
    pub fn push(&mut self, row: &[f64]) {
        assert_eq!(row.len(), self.columns.len(), "a row has one value per column");
        for (column, value) in self.columns.iter_mut().zip(row) {
            column.push(*value);
        }
    }

    /// Number of rows; 0 if there are no columns.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<&[f64]> {
        let index = self.names.iter().position(|n| n == name)?;
        Some(&self.columns[index])
    }

    /// Reads a CSV file with a header line; lines that start with `#` are comments.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let name = path.display().to_string();
        let file = std::fs::File::open(path).map_err(|e| TableError { path: name.clone(), message: e.to_string() })?;
        Self::parse(&name, file)
    }

    /// [`Self::read`] from anything that gives bytes; `name` stands for it in messages.
    pub fn parse(name: &str, bytes: impl std::io::Read) -> Result<Self, TableError> {
        let fail = |message: String| TableError { path: name.to_string(), message };
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).from_reader(bytes);
        let header = reader.headers().map_err(|e| fail(e.to_string()))?.clone();
        if header.len() > MOST_COLUMNS {
            return Err(fail(format!("it has {} columns; at most {MOST_COLUMNS} are read", header.len())));
        }
        let mut table = Self::new(&header.iter().collect::<Vec<_>>());
        for record in reader.records() {
            let record = record.map_err(|e| fail(e.to_string()))?;
            let line = record.position().map_or(0, csv::Position::line);
            let row = record
                .iter()
                .map(|field| field.parse::<f64>().map_err(|_| fail(format!("line {line}: {field:?} is not a number"))))
                .collect::<Result<Vec<_>, _>>()?;
            table.push(&row);
        }
        Ok(table)
    }

    /// The bytes of a CSV file: shortest digits that read back to the same number.
    ///
    /// # Errors
    /// Columns of different length.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        self.csv_from(0)
    }

    /// The bytes from a row on, with the names if that is the first one.
    ///
    /// # Errors
    /// Columns of different length.
    pub fn csv_from(&self, first: usize) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        if first == 0 {
            writer.write_record(&self.names)?;
        }
        for row in first..self.rows() {
            writer.write_record(self.columns.iter().map(|c| format_number(c[row])))?;
        }
        writer.into_inner().map_err(|e| e.into_error().into())
    }
}

/// Shortest digits that read back to the same number; `nan` where there is none.
pub fn format_number(value: f64) -> String {
    if value.is_nan() {
        return "nan".to_string();
    }
    let magnitude = value.abs();
    if value != 0.0 && !(1e-4..1e15).contains(&magnitude) { format!("{value:e}") } else { format!("{value}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_survives_the_round_trip_bit_for_bit() {
        let mut table = Table::new(&["time_s", "value"]);
        for i in 0..50 {
            table.push(&[i as f64 * 0.1e-6, (i as f64).exp() * 1e-20]);
        }
        assert_eq!(Table::parse("t.csv", &table.to_csv().unwrap()[..]).unwrap(), table);
    }

    #[test]
    fn a_word_among_numbers_is_named_with_its_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        std::fs::write(&path, "# comment\na,b\n1,2\n3,four\n").unwrap();
        let error = Table::read(&path).unwrap_err().to_string();
        assert!(error.contains("line 4") && error.contains("four"), "{error}");
    }
}
