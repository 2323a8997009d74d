//! Columns of numbers in files of any layout, with the place of what cannot be read.

use std::collections::BTreeMap;
use std::path::Path;

use super::mapping::{ColumnName, Mapping};
use super::submission::Submission;
use crate::output::foreign;
use crate::scene::diagnostic::Sources;
use crate::scene::suggest::hint;
use crate::scene::{Location, Problem, SceneFileError};

/// Most rows of a file.
pub const MOST_ROWS: usize = 2_000_000;

/// A curve of a submission in SI units.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Curve {
    /// Times, s, increasing.
    pub t: Vec<f64>,
    /// Values; not a number where there is none.
    pub y: Vec<f64>,
}

/// The curves of a submission by quantity.
///
/// # Errors
/// A file that cannot be read, a column that is not there, rows with more or fewer fields than the header or
/// the first row, a word among numbers, energies that are not finite, times that do not increase: each with
/// file, line, column and remedy.
pub fn curves(folder: &Path, submission: &Submission) -> Result<[Option<Curve>; 6], SceneFileError> {
    let mut files: BTreeMap<&str, File> = BTreeMap::new();
    let mut out: [Option<Curve>; 6] = Default::default();
    for (index, mapping) in submission.curves.iter().enumerate() {
        let (Some(mapping), Some(time)) = (mapping, &submission.time) else { continue };
        if !files.contains_key(mapping.file.as_str()) {
            files.insert(&mapping.file, File::open(folder, mapping, submission)?);
        }
        let file = &files[mapping.file.as_str()];
        if let ColumnName::AnyOf(names) = mapping.column
            && !names.iter().any(|name| file.has(name))
        {
            continue;
        }
        let t = file.column(time, submission, true, true)?;
        let y = file.column(mapping, submission, false, index < 4)?;
        out[index] = Some(Curve { t, y });
    }
    if let Some(Mapping { column: ColumnName::AnyOf(_), .. }) = submission.time
        && let Some((mapping, file)) =
            submission.curves.iter().flatten().find_map(|m| Some((m, files.get(m.file.as_str())?)))
        && out.iter().all(Option::is_none)
    {
        let message = format!("{} has none of the columns kinetic_energy, strain_energy, external_work", file.name);
        let remedy = format!("give curves by the names that it has: {}", file.names.join(", "));
        return Err(submission.error(mapping, message, remedy));
    }
    Ok(out)
}

/// A text file with its lines of numbers.
struct File {
    name: String,
    text: String,
    names: Vec<String>,
    /// Whether a line names the columns that is no comment.
    headed: bool,
    separator: char,
    /// Start of each line of numbers.
    rows: Vec<usize>,
}

impl File {
    fn open(folder: &Path, mapping: &Mapping, submission: &Submission) -> Result<Self, SceneFileError> {
        let bytes = foreign::read(folder, &mapping.file, foreign::SERIES_BYTES).map_err(|e| {
            let message = format!("{:?} cannot be read: {e}", mapping.file);
            submission.error(mapping, message, "name a regular file in the folder; thin out one that is too long")
        })?;
        let name = folder.join(&mapping.file).display().to_string();
        if bytes.starts_with(&[0xff, 0xfe])
            || bytes.starts_with(&[0xfe, 0xff])
            || bytes.iter().take(400).any(|b| *b == 0)
        {
            let message = format!("{:?} is UTF-16 or binary", mapping.file);
            return Err(submission.error(mapping, message, "save it as plain text in UTF-8"));
        }
        let text =
            String::from_utf8_lossy(&bytes).trim_start_matches('\u{feff}').replace("\r\n", "\n").replace('\r', "\n");
        let mut file = Self { name, text, names: Vec::new(), headed: false, separator: ',', rows: Vec::new() };
        file.find_rows(submission)?;
        let of_file = submission.curves.iter().flatten().filter(|m| m.file == mapping.file);
        let mut names = of_file.chain(&submission.time).filter_map(|m| match &m.column {
            ColumnName::Named(name) => Some(name),
            ColumnName::Numbered(_) | ColumnName::AnyOf(_) => None,
        });
        let by_name = names.any(|name| file.names.contains(name));
        file.check_rows(submission, by_name)?;
        Ok(file)
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n == name)
    }

    fn has(&self, name: &str) -> bool {
        self.position(name).is_some()
    }

    /// Header, separator and lines of numbers. Without a header, the last comment before the numbers names
    /// the columns.
    fn find_rows(&mut self, submission: &Submission) -> Result<(), SceneFileError> {
        let (mut start, mut comment, mut header) = (0, String::new(), None);
        let mut rows = Vec::new();
        for line in self.text.split('\n') {
            let (at, trimmed) = (start, line.trim());
            start += line.len() + 1;
            if trimmed.is_empty() {
                continue;
            }
            let mark = submission.comment.chars().find(|c| !c.is_whitespace() && trimmed.starts_with(*c));
            if let Some(mark) = mark {
                if rows.is_empty() && header.is_none() {
                    comment = trimmed.trim_start_matches(mark).trim().to_string();
                }
                continue;
            }
            if rows.is_empty() && header.is_none() {
                self.separator = submission.separator.unwrap_or_else(|| separator_of(trimmed));
                let words = fields(line, self.separator);
                let with_commas = |w: &(usize, &str)| number(&w.1.replace(',', ".")).is_some();
                if words.iter().any(|w| number(w.1).is_none()) && !words.iter().all(with_commas) {
                    header = Some(words.iter().map(|w| w.1.trim_matches('"').to_string()).collect::<Vec<_>>());
                    continue;
                }
            }
            rows.push(at);
            if rows.len() > MOST_ROWS {
                let message = format!("more than {MOST_ROWS} rows");
                return Err(self.error(at, 0, message, "thin it out: 1000 rows over the run are plenty"));
            }
        }
        if rows.len() < 2 {
            let message = format!("{} rows of numbers", rows.len());
            return Err(self.error(0, 0, message, "give at least two rows; is the comment character right?"));
        }
        let separator = separator_of(&comment);
        let of_comment = || fields(&comment, separator).iter().map(|w| w.1.trim_matches('"').to_string()).collect();
        self.headed = header.is_some();
        self.names = header.unwrap_or_else(of_comment);
        self.rows = rows;
        Ok(())
    }

    fn line(&self, at: usize) -> &str {
        self.text[at..].split('\n').next().unwrap_or("")
    }

    /// Every row has as many fields as the first, and as many as there are names: a field too many shifts
    /// all that follow. Names in a comment may be none, and count only where a column is wanted `by_name`.
    fn check_rows(&self, submission: &Submission, by_name: bool) -> Result<(), SceneFileError> {
        let names = self.names.len();
        let mut first = None;
        for &at in &self.rows {
            let row = fields(self.line(at), self.separator);
            let (found, first) = (row.len(), *first.get_or_insert(row.len()));
            let message = if (found > names && (self.headed || by_name)) || (found < names && by_name) {
                format!("{} under {}", count(found, "field"), count(names, "name"))
            } else if found != first {
                format!("{} where the first row has {first}", count(found, "field"))
            } else if !self.headed && self.is_cut_at_commas(at, &row) {
                "numbers that are cut at their decimal commas".to_string()
            } else {
                continue;
            };
            let expected = if self.headed || by_name { names } else { first };
            let place = row.get(expected).map_or(0, |field| field.0);
            return Err(self.error(at, place, message, &self.remedy_for_row(&row, expected, submission)));
        }
        Ok(())
    }

    /// Whether every second field of a row without points reads like what stands behind a decimal comma:
    /// digits, with a zero in front in one of them.
    fn is_cut_at_commas(&self, at: usize, row: &[(usize, &str)]) -> bool {
        let behind = || row.iter().skip(1).step_by(2).map(|field| field.1.as_bytes());
        let digits = |word: &[u8]| word.first().is_some_and(u8::is_ascii_digit);
        let padded = |word: &[u8]| word.len() > 1 && word[0] == b'0' && word[1].is_ascii_digit();
        let pairs = self.separator == ',' && row.len().is_multiple_of(2) && !self.line(at).contains('.');
        pairs && behind().all(digits) && behind().any(padded)
    }

    /// What is likely wrong with a row of another length than expected, and what would be right.
    fn remedy_for_row(&self, row: &[(usize, &str)], expected: usize, submission: &Submission) -> String {
        let surplus = row.get(expected..).unwrap_or_default();
        let mark = submission.comment.chars().next().unwrap_or('#');
        if surplus.iter().any(|field| number(field.1).is_none()) {
            return format!("put words on lines of their own that start with {mark}, a line that is no header as well");
        }
        let one = surplus.len() == 1;
        let index = "if the first column counts the rows, give it a name in the header";
        if self.separator == ',' && !self.rows.iter().any(|at| self.line(*at).contains('.')) {
            let likely = "no number has a point: write decimal commas as points, as commas separate the columns";
            return if one { format!("{likely}; {index}") } else { likely.to_string() };
        }
        match surplus {
            [(_, "")] => "if the rows end with a separator, end the header with one, too".into(),
            [_] => format!("{index}; pandas writes an empty one"),
            [] => "every row has as many numbers as the header has names; write nan for a tip that is missing, and no \
                   spaces in names where spaces separate"
                .into(),
            _ => format!("give every column a name; start a line that is no header with {mark}"),
        }
    }

    /// The numbers of a column, SI.
    fn column(
        &self,
        mapping: &Mapping,
        submission: &Submission,
        increasing: bool,
        finite: bool,
    ) -> Result<Vec<f64>, SceneFileError> {
        let index = match &mapping.column {
            ColumnName::Numbered(number) => number - 1,
            ColumnName::AnyOf(names) => names.iter().find_map(|name| self.position(name)).ok_or_else(|| {
                let (message, remedy) = (format!("{} has no column {:?}", self.name, names[0]), "name it in the file");
                submission.error(mapping, message, remedy)
            })?,
            ColumnName::Named(name) if self.names.iter().filter(|known| *known == name).count() > 1 => {
                let message = format!("{} has several columns {name:?}", self.name);
                return Err(submission.error(mapping, message, "give the number of one instead, counted from 1"));
            }
            ColumnName::Named(name) => self.position(name).ok_or_else(|| {
                let known: Vec<&str> = self.names.iter().map(String::as_str).collect();
                let remedy = format!("{}its columns are {}", hint(name, &known), known.join(", "));
                submission.error(mapping, format!("{} has no column {name:?}", self.name), remedy)
            })?,
        };
        let mut out = Vec::with_capacity(self.rows.len());
        let mut last = f64::NEG_INFINITY;
        for &at in &self.rows {
            let Some((column, word)) = fields(self.line(at), self.separator).into_iter().nth(index) else {
                let message = format!("no column {}, wanted by {}", index + 1, mapping.key);
                return Err(self.error(at, 0, message, "every row has as many numbers as the header has names"));
            };
            let Some(value) = number(word) else {
                let remedy = remedy_for_word(word.trim_matches('"'), self.separator);
                return Err(self.error(at, column, format!("{word:?} is not a number"), remedy));
            };
            let none = value.is_nan() || mapping.missing.is_some_and(|m| (value - m).abs() <= 1e-9 * m.abs());
            let value = if none { f64::NAN } else { value * mapping.scale + mapping.offset };
            if !(value.is_finite() || (value.is_nan() && !finite)) {
                let message = format!("{word} is no finite number, in the column of {}", mapping.key);
                let remedy = "only a tip may be missing; end the curve where the run ended";
                return Err(self.error(at, column, message, remedy));
            }
            if increasing && value <= last {
                let message = format!("the time {word} does not increase");
                return Err(self.error(at, column, message, "sort the rows by time and keep one row for each time"));
            }
            last = value;
            out.push(value);
        }
        Ok(out)
    }

    fn error(&self, at: usize, column: usize, message: impl Into<String>, remedy: &str) -> SceneFileError {
        let place = at + column;
        let end = self.text[place..].find('\n').map_or(self.text.len(), |n| place + n);
        let location = Some(Location::new(0, place..end));
        let problem = Problem { key: String::new(), location, message: message.into(), remedy: remedy.into() };
        Sources::new(&self.name, &self.text[..end]).error(&[problem])
    }
}

fn separator_of(line: &str) -> char {
    [';', '\t', ','].into_iter().find(|c| line.contains(*c)).unwrap_or(' ')
}

/// Fields of a line with the bytes at which they start; spaces around them do not count, text in quotes
/// stays together.
fn fields(line: &str, separator: char) -> Vec<(usize, &str)> {
    let (mut out, mut start, mut quoted) = (Vec::new(), 0, false);
    for (at, c) in line.char_indices().chain(std::iter::once((line.len(), separator))) {
        quoted ^= c == '"';
        let end = at == line.len();
        if end || (!quoted && (c == separator || (separator == ' ' && c.is_whitespace()))) {
            let word = &line[start..at];
            let trimmed = word.trim();
            if separator != ' ' || !trimmed.is_empty() {
                out.push((start + word.len() - word.trim_start().len(), trimmed));
            }
            start = at + if end { 0 } else { c.len_utf8() };
        }
    }
    out
}

/// A number, also with the exponent letter of Fortran.
fn number(word: &str) -> Option<f64> {
    let word = word.trim_matches('"');
    if word.is_empty() {
        return Some(f64::NAN);
    }
    word.parse().ok().or_else(|| word.replace(['D', 'd'], "e").parse().ok())
}

/// What would be right in place of a word that is no number.
fn remedy_for_word(word: &str, separator: char) -> &'static str {
    let commas = word.contains(',');
    let mut parts = word.split_whitespace();
    if commas && number(&word.replace(',', ".")).is_some() {
        "write the decimal point as a point"
    } else if commas && number(&word.replace([',', '.'], "")).is_some() {
        "write the decimal point as a point, and nothing between thousands"
    } else if separator == ',' && word.contains(char::is_whitespace) && parts.all(|part| number(part).is_some()) {
        "if spaces separate the columns, write decimal commas as points"
    } else {
        "comment the line out"
    }
}

/// `1 field`, `2 fields`.
fn count(number: usize, what: &str) -> String {
    format!("{number} {what}{}", if number == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_found_in_any_layout() {
        let words = |line, separator| fields(line, separator).into_iter().map(|f| f.1).collect::<Vec<_>>();
        assert_eq!(words(" a ,\"b,c\", 1", ','), ["a", "\"b,c\"", "1"]);
        assert_eq!(words("  1.0\t 2D-3  ", ' '), ["1.0", "2D-3"]);
        assert_eq!(words("1;;3", ';'), ["1", "", "3"]);
        assert_eq!(number("2D-3"), Some(2e-3));
        assert!(number("").is_some_and(f64::is_nan) && number("x").is_none());
    }
}
