//! Numbers that a scene keeps in a CSV file beside it.

use super::fields::Item;

/// Rows of two numbers; a first line without any number is a header.
pub(super) fn rows_of_file(item: &Item<'_>, remedy: &str) -> Option<Vec<[f64; 2]>> {
    let path = item.folder().join(item.words()?);
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(e) => return item.fail(format!("{} cannot be read: {e}", path.display()), remedy),
    };
    match rows(&text) {
        Ok(rows) => Some(rows),
        Err(message) => item.fail(format!("{}: {message}", path.display()), remedy),
    }
}

fn rows(text: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|e| e.to_string())?;
        let numbers: Vec<Option<f64>> = record.iter().map(|field| field.parse().ok()).collect();
        match numbers[..] {
            [Some(first), Some(second)] => rows.push([first, second]),
            _ if number == 0 && numbers.iter().all(Option::is_none) => {} // a header
            _ => {
                let line = record.position().map_or(0, csv::Position::line);
                return Err(format!(
                    "line {line} is not two numbers: {:?}",
                    record.iter().collect::<Vec<_>>().join(",")
                ));
            }
        }
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use super::rows;

    #[test]
    fn a_header_is_a_first_line_without_a_number() {
        let expected = Ok(vec![[0.0, 1.0], [1e-6, 2.5]]);
        assert_eq!(rows("0, 1\n1e-6, 2.5\n"), expected);
        assert_eq!(rows("time_s,factor\n\n0,1\n1e-6,2.5"), expected);
        assert_eq!(rows("time_s\n0,1\n1e-6,2.5"), expected, "a header of one column");
        assert!(rows("0;1\n").unwrap().is_empty(), "nothing that is a number");
        for (text, line) in [("0,1,2\n", 1), ("0,x\n", 1), ("t,f\n\n0,1\n1\n", 4), ("t,f\n0,1\n1,\n", 3)] {
            assert!(rows(text).unwrap_err().starts_with(&format!("line {line} ")), "{text:?}: {:?}", rows(text));
        }
    }
}
