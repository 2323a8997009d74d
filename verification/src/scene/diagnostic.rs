//! What is wrong with a file, where, and what would be right.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use crate::output::foreign::{line, steers};

/// Most problems that are told one by one.
const MOST_PROBLEMS: usize = 100;

/// A place in the file, in one of the overrides, or in a file that it includes.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Location {
    /// 0 for the file; the others in the order in which they were read.
    pub source: usize,
    /// First byte of the place in the text of its source.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl Location {
    /// Bytes `span` of the source of that number.
    pub fn new(source: usize, span: Range<usize>) -> Self {
        Self { source, start: span.start, end: span.end }
    }
}

/// One thing wrong with a document, not yet attached to its text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Full key path, such as `body.0.crack.0.half_width`; empty if no key is involved.
    pub key: String,
    /// Where; `None` means the whole file.
    pub location: Option<Location>,
    /// What is wrong, in words and without the place.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

/// Whether a finding keeps a file from being used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used all the same.
    Warning,
}

/// A text and what it is called.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Source {
    name: String,
    text: String,
}

impl Source {
    fn new(name: &str, text: &str) -> Arc<Self> {
        Arc::new(Self { name: name.to_string(), text: text.to_string() })
    }
}

/// The texts that locations point into: the file first, then one per override or included file.
#[derive(Debug, Clone)]
pub struct Sources(Vec<Arc<Source>>);

impl Sources {
    /// Holds the text of one file, which messages call `name`.
    pub fn new(name: &str, text: &str) -> Self {
        Self(vec![Source::new(name, text)])
    }

    /// Adds a text; returns its number for [`Location::source`].
    pub fn push(&mut self, name: &str, text: &str) -> usize {
        self.0.push(Source::new(name, text));
        self.0.len() - 1
    }

    /// Name of the first file, as messages show it.
    pub fn name(&self) -> &str {
        &self.0[0].name
    }

    /// Text of the first file, without overrides and included files.
    pub fn text(&self) -> &str {
        &self.0[0].text
    }

    /// Attaches a problem to its text.
    pub fn diagnose(&self, problem: &Problem, severity: Severity) -> SceneDiagnostic {
        let location = problem.location.clone().unwrap_or(Location::new(0, 0..0));
        let source = self.0[location.source.min(self.0.len() - 1)].clone();
        let text = &source.text;
        let start = text.floor_char_boundary(location.start);
        let end = text.floor_char_boundary(location.end).max(start);
        let line_start = text[..start].rfind('\n').map_or(0, |i| i + 1);
        SceneDiagnostic {
            file: source.name.clone(),
            line: text[..start].matches('\n').count() + 1,
            column: text[line_start..start].chars().count() + 1,
            key: problem.key.clone(),
            message: problem.message.clone(),
            remedy: problem.remedy.clone(),
            span: start..end,
            severity,
            source,
        }
    }

    /// An error of all `problems`, in the order of their places.
    pub fn error(&self, problems: &[Problem]) -> SceneFileError {
        let mut sorted: Vec<&Problem> = problems.iter().collect();
        sorted.sort_by(|a, b| a.location.cmp(&b.location));
        let mut diagnostics: Vec<_> =
            sorted.iter().take(MOST_PROBLEMS).map(|p| self.diagnose(p, Severity::Error)).collect();
        if let Some(first) = sorted.get(MOST_PROBLEMS) {
            let message = format!("here and below: {} more errors", sorted.len() - MOST_PROBLEMS);
            let rest = Problem { message, remedy: "correct those above first".into(), ..(*first).clone() };
            diagnostics.push(self.diagnose(&rest, Severity::Error));
        }
        SceneFileError { diagnostics }
    }
}

/// One error or warning with its place.
///
/// `Display` is one plain line, `file:line:column: key: message; remedy`.
#[derive(Debug, Clone)]
pub struct SceneDiagnostic {
    /// File name, or `--set` for an override.
    pub file: String,
    /// Number of the line in the file, counted from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Full key path; empty if no key is involved.
    pub key: String,
    /// What is wrong, in words and without the place.
    pub message: String,
    /// What would be right; empty where the message says it.
    pub remedy: String,
    /// Range of bytes that is wrong, in the text that [`Self::text`] gives.
    pub span: Range<usize>,
    /// Whether it is an error or a warning.
    pub severity: Severity,
    source: Arc<Source>,
}

impl SceneDiagnostic {
    /// The text that `span` is in.
    pub fn text(&self) -> &str {
        &self.source.text
    }

    /// The same without characters that steer a terminal; in the text of the file as many bytes stand in
    /// their place.
    pub fn for_terminal(&self) -> Self {
        let steers = |c: char| steers(c) && !matches!(c, '\n' | '\t');
        let seen = |c: char| if steers(c) { "?".repeat(c.len_utf8()) } else { c.to_string() };
        let text: String = self.source.text.replace("\r\n", " \n").chars().map(seen).collect();
        let [file, key, message, remedy] =
            [&self.file, &self.key, &self.message, &self.remedy].map(|text| line(text).into_owned());
        let source = Source::new(&file, &text);
        Self { file, key, message, remedy, source, span: self.span.clone(), ..*self }
    }
}

impl fmt::Display for SceneDiagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}: ", line(&self.file), self.line, self.column)?;
        if !self.key.is_empty() {
            write!(f, "{}: ", line(&self.key))?;
        }
        f.write_str(&line(&self.message))?;
        if self.remedy.is_empty() { Ok(()) } else { write!(f, "; {}", line(&self.remedy)) }
    }
}

impl std::error::Error for SceneDiagnostic {}

/// A file that is no valid scene: everything found wrong with it.
///
/// `Display` is one plain line per problem. For a rendering with source excerpts, render each of
/// `diagnostics`.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}", lines(diagnostics))]
pub struct SceneFileError {
    /// At least one, in the order of their places.
    pub diagnostics: Vec<SceneDiagnostic>,
}

fn lines(diagnostics: &[SceneDiagnostic]) -> String {
    diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}
