//! Numbers that a scene keeps in a CSV file beside it.

use super::fields::Item;

/// Pairs of numbers, row by row; a first line that is no numbers is a header.
pub(super) fn rows_of_file(item: &Item<'_>, remedy: &str) -> Option<Vec<[f64; 2]>> {
    let path = item.folder().join(item.words()?);
    let mut reader = match csv::ReaderBuilder::new().has_headers(false).trim(csv::Trim::All).from_path(&path) {
        Ok(reader) => reader,
        Err(e) => return item.fail(format!("{} cannot be read: {e}", path.display()), remedy),
    };
    let mut rows = Vec::new();
    for (number, record) in reader.records().enumerate() {
        let numbers: Option<Vec<f64>> =
            record.as_ref().ok().and_then(|record| record.iter().map(|field| field.parse().ok()).collect());
        match numbers.as_deref() {
            Some(&[first, second]) => rows.push([first, second]),
            _ if number == 0 => {} // a header
            _ => return item.fail(format!("line {} of {} is not two numbers", number + 1, path.display()), remedy),
        }
    }
    Some(rows)
}
