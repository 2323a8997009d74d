//! Tables of a document as types that derive `Deserialize` and `JsonSchema`.
//!
//! What is wrong with a key is noted with its place and a remedy, and the rest is read without that key, so
//! that one pass finds nearly everything. Remedies are the words of the type: the list of its keys, and the
//! description of a missing one in its JSON schema.

use schemars::JsonSchema;
use serde::Deserialize;
use serde::de::{DeserializeOwned, Deserializer, Error as _};
use serde_path_to_error::Segment;

use super::diagnostic::Problem;
use super::document::{Node, join};
use super::fields::{Item, Problems};
use super::suggest::hint;

/// Most problems that one pass notes.
const MOST_PROBLEMS: usize = 20;
/// Between message, remedy and key in the text of an error.
const BREAK: char = '\u{1f}';

/// The document as a `T`; problems go to those of `item`.
pub fn read<T: DeserializeOwned + JsonSchema>(item: &Item<'_>) -> Option<T> {
    let mut value = plain(item.node);
    let mut left_out: Vec<String> = Vec::new();
    loop {
        let error = match serde_path_to_error::deserialize(value.clone()) {
            Ok(found) if left_out.is_empty() => return Some(found),
            Ok(_) => return None,
            Err(error) => error,
        };
        let path: Vec<String> = error.path().iter().filter_map(segment).collect();
        let problem = Wrong { item, path: &path, text: error.inner().message() }.problem::<T>();
        if !left_out.contains(&problem.key) {
            item.note(problem);
        }
        let left = leave_out(&mut value, path).filter(|_| left_out.len() < MOST_PROBLEMS)?;
        left_out.push(left.iter().fold(item.path.clone(), |path, key| join(&path, key)));
    }
}

/// What `read` makes of a value: for types whose values are quantities, words or formulas.
///
/// # Errors
/// The first problem that `read` notes.
pub fn through<'de, D: Deserializer<'de>, T>(
    deserializer: D,
    read: impl FnOnce(&Item<'_>) -> Option<T>,
) -> Result<T, D::Error> {
    let node = Node::deserialize(deserializer)?;
    let problems = Problems::default();
    let found = read(&Item::new(&node, "", &problems));
    match (problems.into_inner().into_iter().next(), found) {
        (None, Some(found)) => Ok(found),
        (problem, _) => {
            let Problem { key, message, remedy, .. } = problem.expect("what was not read is wrong");
            Err(D::Error::custom(format!("{message}{BREAK}{remedy}{BREAK}{key}")))
        }
    }
}

/// A value without its place.
pub fn plain(node: &Node) -> toml::Value {
    toml::Value::try_from(node).expect("a tree of TOML values is one")
}

fn segment(segment: &Segment) -> Option<String> {
    match segment {
        Segment::Seq { index } => Some(index.to_string()),
        Segment::Map { key } => Some(key.clone()),
        Segment::Enum { .. } | Segment::Unknown => None,
    }
}

/// Removes the innermost key of a table on `path`; the path of that key.
fn leave_out(value: &mut toml::Value, mut path: Vec<String>) -> Option<Vec<String>> {
    while let Some(last) = path.pop() {
        let around = path.iter().try_fold(&mut *value, |value, key| match value {
            toml::Value::Array(entries) => entries.get_mut(key.parse::<usize>().ok()?),
            toml::Value::Table(table) => table.get_mut(key),
            _ => None,
        });
        if let Some(toml::Value::Table(table)) = around
            && table.remove(&last).is_some()
        {
            path.push(last);
            return Some(path);
        }
    }
    None
}

/// An error of the deserializer.
struct Wrong<'a> {
    item: &'a Item<'a>,
    path: &'a [String],
    text: &'a str,
}

impl Wrong<'_> {
    fn problem<T: JsonSchema>(&self) -> Problem {
        let names: Vec<&str> = self.text.split('`').skip(1).step_by(2).collect();
        let (found, known) = names.split_first().map_or(("", &[][..]), |(found, known)| (*found, known));
        let meant = || hint(found, known);
        if let Some((message, rest)) = self.text.split_once(BREAK) {
            let (remedy, key) = rest.split_once(BREAK).unwrap_or((rest, ""));
            self.at(key, message.into(), remedy.into())
        } else if self.text.starts_with("unknown field") {
            let mut problem =
                self.at("", format!("unknown key {found:?}"), format!("{}known keys: {}", meant(), known.join(", ")));
            problem.location = self.node().and_then(|node| node.key_location.clone()).or(problem.location);
            problem
        } else if self.text.starts_with("unknown variant") {
            let list = known.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
            self.at("", format!("unknown value {found:?}"), format!("{}known: {list}", meant()))
        } else if self.text.starts_with("missing field") {
            let meaning = description(&schemars::schema_for!(T).to_value(), self.path, found);
            self.at(found, "missing".into(), format!("add {found}: {meaning}"))
        } else {
            self.wrong_kind()
        }
    }

    fn wrong_kind(&self) -> Problem {
        let expected = self.text.rsplit_once("expected ").map_or(self.text, |(_, expected)| expected);
        let expected = match expected {
            "a sequence" => "an array",
            "a boolean" => "true or false",
            text if text.starts_with("struct ") || text == "a map" => "a table",
            text => text,
        };
        let Some(node) = self.node() else { return self.at("", self.text.into(), format!("give {expected}")) };
        if expected == "an array" && node.as_table().is_some() {
            let names = self.path.iter().filter(|key| key.parse::<usize>().is_err());
            let name = names.map(String::as_str).collect::<Vec<_>>().join(".");
            let message = "expected an array of tables, found one table".to_string();
            return self.at("", message, format!("write [[{name}]] instead of [{name}]"));
        }
        self.at("", format!("expected {expected}, found {}", node.kind()), format!("give {expected}"))
    }

    fn node(&self) -> Option<&Node> {
        self.path.iter().try_fold(self.item.node, |node, key| node.get(key))
    }

    /// A problem at the path, or at a key below it.
    fn at(&self, below: &str, message: String, remedy: String) -> Problem {
        let path = self.path.iter().fold(self.item.path.clone(), |path, key| join(&path, key));
        let around = self.path.iter().scan(self.item.node, |node, key| {
            *node = node.get(key)?;
            Some(*node)
        });
        let outermost = self.item.node.location.clone();
        let location = around.filter_map(|node| node.location.clone()).last().or(outermost);
        let inner = self.node().and_then(|node| node.at(below)).and_then(|node| node.location.clone());
        let key =
            if below.is_empty() { path } else { format!("{path}{}{below}", if path.is_empty() { "" } else { "." }) };
        Problem { key, location: inner.or(location), message, remedy }
    }
}

/// What a JSON schema says of the key `field` of the table at `path`.
fn description(schema: &serde_json::Value, path: &[String], field: &str) -> String {
    let resolve = |node: &serde_json::Value| -> Option<serde_json::Value> {
        let mut node = node.clone();
        while let Some(name) = node.get("$ref").and_then(|name| name.as_str()) {
            node = schema.pointer(name.trim_start_matches('#'))?.clone();
        }
        Some(node)
    };
    let step = |node: serde_json::Value, key: &String| {
        let node = node.get("anyOf").and_then(|all| all.get(0)).cloned().unwrap_or(node);
        let node = resolve(&node)?;
        let inner = if key.parse::<usize>().is_ok() { node.get("items") } else { node.get("properties")?.get(key) };
        resolve(inner?)
    };
    let table = path.iter().try_fold(schema.clone(), step);
    let text =
        table.and_then(|table| Some(table.get("properties")?.get(field)?.get("description")?.as_str()?.to_string()));
    text.unwrap_or_default()
}
