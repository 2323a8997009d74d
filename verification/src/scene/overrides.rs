//! `--set key.path=value`: values that replace or add to those of a file.

use std::collections::BTreeMap;

use toml::de::DeValue;

use super::diagnostic::{Location, Problem, SceneFileError};
use super::document::{Document, Node, Value};

/// Name of the source in messages about an override.
const NAME: &str = "--set";

/// Most keys in a path; the tree is walked by recursion.
const DEEPEST: usize = 64;

fn too_deep(keys: usize) -> String {
    format!("the path has {keys} keys; the paths of a scene have at most {DEEPEST}")
}

impl Node {
    /// Puts `value` at a path such as `body.0.crack.0.half_width`, in place of what stands there; keys of
    /// tables that are not there are created.
    ///
    /// # Errors
    /// What is wrong with the path, if it is empty, leads through a value that is no table, or beyond an
    /// array.
    pub fn set(&mut self, path: &str, value: Node) -> Result<(), String> {
        let keys: Vec<&str> = path.split('.').collect();
        if keys.contains(&"") {
            return Err(format!("{path:?} has an empty key"));
        }
        if keys.len() > DEEPEST {
            return Err(too_deep(keys.len()));
        }
        set(self, &keys, 0, value).map_err(|(message, remedy)| format!("{message}; {remedy}"))
    }
}

impl Document {
    /// Applies overrides in order, each `key.path=value`; array entries count from 0.
    ///
    /// The value is read as TOML, or if it is none, as a bare string: `body.0.crack.0.half_width=0.25 mm`
    /// needs no quotes. What starts like an array, a table or a quoted string is never a bare one. A key that
    /// the file does not have is created.
    ///
    /// # Errors
    /// Every override without `=`, with an array, table or quoted string that is not TOML, with an empty key,
    /// or whose path leads through a value that is no table or beyond the end of an array.
    pub fn apply(&mut self, overrides: &[String]) -> Result<(), SceneFileError> {
        let problems: Vec<Problem> = overrides.iter().filter_map(|text| self.apply_one(text).err()).collect();
        if problems.is_empty() { Ok(()) } else { Err(self.error(&problems)) }
    }

    fn apply_one(&mut self, text: &str) -> Result<(), Problem> {
        let source = self.sources.push(NAME, text);
        let problem = |key: &str, message: String, remedy: String| Problem {
            key: key.to_string(),
            location: Some(Location::new(source, 0..text.find('=').unwrap_or(text.len()))),
            message,
            remedy,
        };
        let form = || "write --set key.path=value, such as --set mesh.degree=3".to_string();
        let Some((path, value)) = text.split_once('=') else {
            return Err(problem("", format!("{text:?} has no '='"), form()));
        };
        let keys: Vec<&str> = path.split('.').map(str::trim).collect();
        if keys.iter().any(|k| k.is_empty()) {
            return Err(problem(path.trim(), "an empty key".to_string(), form()));
        }
        if keys.len() > DEEPEST {
            return Err(problem("", too_deep(keys.len()), form()));
        }
        let mut node = parse_value(value, source, path.len() + 1).map_err(|(location, message)| Problem {
            key: path.trim().to_string(),
            location: Some(location),
            message: format!("not valid TOML: {message}"),
            remedy: "close every bracket and quote, as in --set 'mesh.size=[0.1, 0.04]'".to_string(),
        })?;
        node.key_location = Some(Location::new(source, 0..path.len()));
        set(&mut self.root, &keys, 0, node).map_err(|(message, remedy)| problem(path.trim(), message, remedy))
    }
}

/// A TOML value, or the text itself unless it starts like an array, a table or a quoted string; place and
/// message of the syntax error if it does.
fn parse_value(text: &str, source: usize, offset: usize) -> Result<Node, (Location, String)> {
    let trimmed = text.trim();
    let start = offset + text.len() - text.trim_start().len();
    let end = start + trimmed.len();
    match DeValue::parse(trimmed) {
        Ok(value) => Ok(Node::from_toml(&value, source, start)),
        Err(error) if trimmed.starts_with(['[', '{', '"', '\'']) => {
            let span = error.span().map_or(end..end, |s| (start + s.start).min(end)..(start + s.end).min(end));
            Err((Location::new(source, span), error.message().to_string()))
        }
        Err(_) => Ok(Node::new(Value::String(trimmed.to_string()), Some(Location::new(source, start..end)))),
    }
}

/// Puts `new` at `keys[at..]` below `node`; message and remedy if the path does not lead there.
fn set(node: &mut Node, keys: &[&str], at: usize, new: Node) -> Result<(), (String, String)> {
    let Some(&key) = keys.get(at) else {
        *node = new;
        return Ok(());
    };
    let (here, kind) = (keys[..at].join("."), node.kind());
    match &mut node.value {
        Value::Table(table) => {
            let next = keys.get(at + 1).filter(|_| !table.contains_key(key));
            if let Some(next) = next.filter(|next| next.parse::<usize>().is_ok()) {
                let path = keys[..=at].join(".");
                return Err((format!("{path} is not in the file, so it has no entry {next}"), entry_remedy(0)));
            }
            let place = &new.key_location;
            let empty =
                || Node { value: Value::Table(BTreeMap::new()), location: place.clone(), key_location: place.clone() };
            set(table.entry(key.to_string()).or_insert_with(empty), keys, at + 1, new)
        }
        Value::Array(array) => {
            let count = array.len();
            match key.parse::<usize>().ok().and_then(|i| array.get_mut(i)) {
                Some(child) => set(child, keys, at + 1, new),
                None => {
                    let message = format!("{here} is an array with {count} entries and has no entry {key:?}");
                    Err((message, entry_remedy(count)))
                }
            }
        }
        _ => Err((format!("{here} is {kind}, so it has no key {key:?}"), format!("set {here} itself"))),
    }
}

fn entry_remedy(count: usize) -> String {
    match count {
        0 => "entries can be changed, not added: add it to the file".to_string(),
        1 => "entries count from 0: the only one is 0".to_string(),
        _ => format!("entries count from 0: 0 to {}", count - 1),
    }
}
