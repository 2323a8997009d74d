//! A parsed TOML document whose every value knows where it stands.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::diagnostic::{Location, Problem, SceneDiagnostic, SceneFileError, Severity, Sources};

/// Largest number of syntax errors reported for one file.
const MOST_SYNTAX_ERRORS: usize = 10;

/// A value and its place; without it for serde.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Node {
    /// Value at this node; an array or a table holds nodes of its own.
    pub value: Value,
    /// Where the value stands; the header for a table with one, `None` for the document itself.
    #[serde(skip)]
    pub location: Option<Location>,
    /// Where its key stands; `None` for array entries.
    #[serde(skip)]
    pub key_location: Option<Location>,
}

/// A TOML value; arrays and tables consist of nodes, which know their places.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Text of a string, without its quotes and with its escapes resolved.
    String(String),
    /// Number without a fraction.
    Integer(i64),
    /// Float; may be infinite or not a number, as TOML allows.
    Float(f64),
    /// Either true or false.
    Boolean(bool),
    /// Date or time, as written.
    Datetime(String),
    /// Entries of an array, in the order of the file.
    Array(Vec<Node>),
    /// Entries of a table, by key.
    Table(BTreeMap<String, Node>),
}

impl Node {
    /// A node without a key.
    pub fn new(value: Value, location: Option<Location>) -> Self {
        Self { value, location, key_location: None }
    }

    /// Copies a value parsed from `source`, whose text starts `offset` bytes into that source.
    pub(super) fn from_toml(value: &Spanned<DeValue<'_>>, source: usize, offset: usize) -> Self {
        let span = value.span();
        let location = Location::new(source, span.start + offset..span.end + offset);
        let value = match value.get_ref() {
            DeValue::String(s) => Value::String(s.to_string()),
            DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix())
                .map_or_else(|_| Value::Float(i.as_str().parse().unwrap_or(f64::NAN)), Value::Integer),
            DeValue::Float(x) => Value::Float(x.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(b) => Value::Boolean(*b),
            DeValue::Datetime(d) => Value::Datetime(d.to_string()),
            DeValue::Array(a) => Value::Array(a.iter().map(|v| Self::from_toml(v, source, offset)).collect()),
            DeValue::Table(t) => Value::Table(entries(t, source, offset)),
        };
        Self::new(value, Some(location))
    }

    /// The value in one form, wherever it stands and however it was written.
    pub fn canonical(&self) -> String {
        let joined = |items: Vec<String>| items.join(", ");
        match &self.value {
            Value::Array(array) => format!("[{}]", joined(array.iter().map(Self::canonical).collect())),
            Value::Table(table) => {
                let entries = table.iter().map(|(key, node)| format!("{key} = {}", node.canonical()));
                format!("{{{}}}", joined(entries.collect()))
            }
            scalar => format!("{scalar:?}"),
        }
    }

    /// As JSON, where a number that is not finite is its word.
    pub fn to_json(&self) -> serde_json::Value {
        match &self.value {
            Value::String(text) | Value::Datetime(text) => text.clone().into(),
            Value::Integer(i) => (*i).into(),
            Value::Float(x) if x.is_finite() => (*x).into(),
            Value::Float(x) => x.to_string().into(),
            Value::Boolean(flag) => (*flag).into(),
            Value::Array(entries) => entries.iter().map(Self::to_json).collect(),
            Value::Table(table) => table.iter().map(|(key, node)| (key.clone(), node.to_json())).collect(),
        }
    }

    /// Kind of value, with an article: `a string`.
    pub fn kind(&self) -> &'static str {
        match &self.value {
            Value::String(_) => "a string",
            Value::Integer(_) => "an integer",
            Value::Float(_) => "a float",
            Value::Boolean(_) => "a boolean",
            Value::Datetime(_) => "a date",
            Value::Array(_) => "an array",
            Value::Table(_) => "a table",
        }
    }

    /// Entries, if it is a table.
    pub fn as_table(&self) -> Option<&BTreeMap<String, Node>> {
        if let Value::Table(table) = &self.value { Some(table) } else { None }
    }

    /// Entries, if it is an array.
    pub fn as_array(&self) -> Option<&[Node]> {
        if let Value::Array(array) = &self.value { Some(array) } else { None }
    }

    /// Text, if it is a string.
    pub fn as_str(&self) -> Option<&str> {
        if let Value::String(text) = &self.value { Some(text) } else { None }
    }

    /// The entry of that key, or of that number in an array.
    pub fn get(&self, key: &str) -> Option<&Node> {
        match &self.value {
            Value::Table(table) => table.get(key),
            Value::Array(array) => array.get(key.parse::<usize>().ok()?),
            _ => None,
        }
    }

    /// The value at a path such as `body.0.crack.0.half_width`; the node itself for an empty path.
    pub fn at(&self, path: &str) -> Option<&Node> {
        path.split('.').filter(|s| !s.is_empty()).try_fold(self, |node, key| node.get(key))
    }

    /// Path of the innermost table below `path` whose text contains byte `at` of the file.
    fn path_around(&self, path: &str, at: usize) -> String {
        let contains = |n: &Node| n.location.as_ref().is_some_and(|l| l.start <= at && at < l.end);
        let inner = self.at(path).and_then(|node| match &node.value {
            Value::Table(table) => table.iter().find(|(_, n)| contains(n)).map(|(key, _)| join(path, key)),
            Value::Array(array) => array.iter().position(contains).map(|i| join(path, &i.to_string())),
            _ => None,
        });
        inner.map_or_else(|| path.to_string(), |inner| self.path_around(&inner, at))
    }

    /// The texts that a key has anywhere below.
    pub(crate) fn texts_of<'a>(&'a self, key: &str, texts: &mut Vec<&'a str>) {
        match &self.value {
            Value::Table(table) => {
                texts.extend(table.get(key).and_then(Self::as_str));
                table.values().for_each(|node| node.texts_of(key, texts));
            }
            Value::Array(array) => array.iter().for_each(|node| node.texts_of(key, texts)),
            _ => {}
        }
    }

    /// Place of the value at `path`, or of the innermost table or array around it that exists.
    pub fn locate(&self, path: &str) -> Option<Location> {
        let mut node = self;
        let mut place = self.location.clone();
        for key in path.split('.').filter(|s| !s.is_empty()) {
            let Some(next) = node.get(key) else { break };
            node = next;
            place = node.location.clone().or(place);
        }
        place
    }
}

pub(super) fn entries(table: &DeTable<'_>, source: usize, offset: usize) -> BTreeMap<String, Node> {
    let entry = |(key, value): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        let mut node = Node::from_toml(value, source, offset);
        let span = key.span();
        node.key_location = Some(Location::new(source, span.start + offset..span.end + offset));
        (key.get_ref().to_string(), node)
    };
    table.iter().map(entry).collect()
}

/// `prefix.key`, with the key in quotes where TOML needs them.
pub fn join(prefix: &str, key: &str) -> String {
    let bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    let key = if bare { key.to_string() } else { format!("{key:?}") };
    if prefix.is_empty() { key } else { format!("{prefix}.{key}") }
}

/// A parsed file with its text, for messages.
#[derive(Debug, Clone)]
pub struct Document {
    /// Root of the tree of values: the table of the whole file.
    pub root: Node,
    pub(super) sources: Sources,
}

impl Document {
    /// The folder of the file; that of the process if the text has none.
    pub(crate) fn folder(&self) -> &Path {
        Path::new(self.sources.name()).parent().unwrap_or(Path::new(""))
    }

    /// Reads and parses a file.
    ///
    /// # Errors
    /// A file that cannot be read or is not UTF-8, and those of [`Document::parse`].
    pub fn load(path: &Path) -> Result<Self, SceneFileError> {
        let name = path.display().to_string();
        let fail = |text: &str, at: usize, message: String, remedy: &str| {
            let location = Some(Location::new(0, at..at));
            let problem = Problem { key: String::new(), location, message, remedy: remedy.to_string() };
            Sources::new(&name, text).error(&[problem])
        };
        let bytes = std::fs::read(path)
            .map_err(|e| fail("", 0, format!("cannot be read: {e}"), "check the path and the permissions"))?;
        let text = std::str::from_utf8(&bytes).map_err(|e| {
            let text = String::from_utf8_lossy(&bytes);
            fail(&text, e.valid_up_to(), "not UTF-8 text".to_string(), "save the file in the encoding UTF-8")
        })?;
        Self::parse(&name, text)
    }

    /// Parses `text`; `name` stands for it in messages.
    ///
    /// # Errors
    /// An empty text, or one that is not TOML: every syntax error, at most ten, with its place.
    pub fn parse(name: &str, text: &str) -> Result<Self, SceneFileError> {
        let sources = Sources::new(name, text);
        let (table, errors) = DeTable::parse_recoverable(text);
        if !errors.is_empty() {
            return Err(sources.error(&syntax_problems(text, table.get_ref(), &errors)));
        }
        if table.get_ref().is_empty() {
            let what = if text.trim().is_empty() { "the file is empty" } else { "the file declares nothing" };
            let remedy = "a scene needs the tables [mesh], [analysis], [material.NAME] and [[body]]".to_string();
            let problem = Problem { key: String::new(), location: None, message: what.to_string(), remedy };
            return Err(sources.error(&[problem]));
        }
        let root = Node::new(Value::Table(entries(table.get_ref(), 0, 0)), None);
        Ok(Self { root, sources })
    }

    /// Reads another file, whose places are told with its own name.
    ///
    /// # Errors
    /// Those of [`Document::load`].
    pub fn include(&mut self, path: &Path) -> Result<Node, SceneFileError> {
        let other = Self::load(path)?;
        let source = self.sources.push(&path.display().to_string(), other.text());
        let (table, _) = DeTable::parse_recoverable(other.text());
        Ok(Node::new(Value::Table(entries(table.get_ref(), source, 0)), None))
    }

    /// Text of the file, as it was read.
    pub fn text(&self) -> &str {
        self.sources.text()
    }

    /// An error made of `problems` found in this document.
    pub fn error(&self, problems: &[Problem]) -> SceneFileError {
        self.sources.error(problems)
    }

    /// A warning made of a problem found in this document.
    pub fn warning(&self, problem: &Problem) -> SceneDiagnostic {
        self.sources.diagnose(problem, Severity::Warning)
    }
}

/// One problem per line with a syntax error.
fn syntax_problems(text: &str, recovered: &DeTable<'_>, errors: &[toml::de::Error]) -> Vec<Problem> {
    let mut problems = Vec::new();
    let mut lines = Vec::new();
    for error in errors {
        if lines.len() == MOST_SYNTAX_ERRORS {
            break;
        }
        let span = error.span().unwrap_or(text.len()..text.len());
        let line = text.as_bytes()[..span.start.min(text.len())].iter().filter(|b| **b == b'\n').count();
        if lines.contains(&line) {
            continue;
        }
        lines.push(line);
        let duplicate = error.message().starts_with("duplicate key");
        let (key, message, remedy) = if duplicate {
            let root = Node::new(Value::Table(entries(recovered, 0, 0)), None);
            let around = root.path_around(&enclosing_table(text, span.start), span.start);
            let key = join_written(&around, text.get(span.clone()).unwrap_or(""));
            (key, error.message().to_string(), "remove one of the two")
        } else {
            (String::new(), format!("not valid TOML: {}", error.message()), "correct the syntax (key = value, [table])")
        };
        let remedy = remedy.to_string();
        problems.push(Problem { key, location: Some(Location::new(0, span)), message, remedy });
    }
    problems
}

/// Path of the table header above byte `at`, with the numbers of entries of arrays of tables.
fn enclosing_table(text: &str, at: usize) -> String {
    let before = text.get(..at).unwrap_or("");
    let done = before.rfind('\n').map_or("", |end| &before[..end]);
    let is_array = |line: &str| line.starts_with("[[");
    let name = |line: &str| line.trim_start_matches('[').split(']').next().unwrap_or("").trim().to_string();
    let headers: Vec<(bool, String)> =
        done.lines().map(str::trim).filter(|l| l.starts_with('[')).map(|l| (is_array(l), name(l))).collect();
    let Some((_, last)) = headers.last() else { return String::new() };
    let mut path = String::new();
    let (mut since, mut prefix) = (0, String::new());
    for key in last.split('.') {
        prefix = join_written(&prefix, key);
        path = join_written(&path, key);
        let entries: Vec<usize> = (since..headers.len()).filter(|i| headers[*i] == (true, prefix.clone())).collect();
        if let Some(start) = entries.last() {
            path = format!("{path}.{}", entries.len() - 1);
            since = *start;
        }
    }
    path
}

fn join_written(prefix: &str, key: &str) -> String {
    if prefix.is_empty() { key.to_string() } else { format!("{prefix}.{key}") }
}
