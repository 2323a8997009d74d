//! Checks that are written once: `set` takes the checks of a table of `check-sets.toml`, beside the folders
//! of the suites, and `variants` lists what differs between runs.

use std::collections::BTreeMap;
use std::path::Path;

use crate::scene::document::{Document, Node, Value};
use crate::scene::suggest::nearest;
use crate::scene::{Problem, SceneFileError};

/// File of the sets, in the folder of all cases.
pub const SETS: &str = "check-sets.toml";

type Table = BTreeMap<String, Node>;

/// Writes out the checks of a case at `path` one by one. An entry of `variants`, and what stands beside
/// `set`, goes before what it is added to; `with` of a set says by id what changes in one of its checks.
///
/// # Errors
/// The file of the sets, if a set is named and the file cannot be read; an unknown set or id; lists that
/// are none.
pub(super) fn expand(document: &mut Document, path: &Path) -> Result<(), SceneFileError> {
    let Some(Value::Array(checks)) = document.root.get("check").map(|node| node.value.clone()) else { return Ok(()) };
    let folder = path.parent().and_then(Path::parent);
    let sets = match folder.filter(|_| checks.iter().any(|check| check.get("set").is_some())) {
        Some(folder) => Some(document.include(&folder.join(SETS))?),
        None => None,
    };
    let mut expansion = Expansion { sets, problems: Vec::new() };
    let written: Vec<Node> = checks.iter().enumerate().flat_map(|(i, check)| expansion.check(i, check)).collect();
    if !expansion.problems.is_empty() {
        return Err(document.error(&expansion.problems));
    }
    if let Value::Table(root) = &mut document.root.value
        && let Some(check) = root.get_mut("check")
    {
        check.value = Value::Array(written);
    }
    Ok(())
}

struct Expansion {
    /// Root of the file of the sets.
    sets: Option<Node>,
    problems: Vec<Problem>,
}

impl Expansion {
    fn note(&mut self, index: usize, key: &str, node: &Node, message: String, remedy: String) {
        let key = format!("check.{index}.{key}");
        self.problems.push(Problem { key, location: node.location.clone(), message, remedy });
    }

    /// The checks that an entry stands for; itself, if it is none of a set.
    fn check(&mut self, index: usize, check: &Node) -> Vec<Node> {
        let Some(table) = check.as_table() else { return vec![check.clone()] };
        let mut beside = table.clone();
        let (Some(set), with) = (beside.remove("set"), beside.remove("with")) else {
            return self.variants(index, check);
        };
        let Some(mut checks) = self.set(index, &set) else { return Vec::new() };
        for check in &mut checks {
            put(check, &beside);
        }
        let changes = with.iter().filter_map(Node::as_table).flatten();
        for (id, change) in changes {
            let is_meant = |check: &&mut Node| check.get("id").and_then(Node::as_str) == Some(id);
            match (checks.iter_mut().find(is_meant), change.as_table()) {
                (Some(check), Some(change)) => put(check, change),
                (_, None) => self.note(index, "with", change, "expected a table".into(), "write { max = 1 }".into()),
                (None, _) => {
                    let ids: Vec<&str> = checks.iter().filter_map(|check| check.get("id")?.as_str()).collect();
                    let remedy = format!("ids of this set: {}", ids.join(", "));
                    self.note(index, "with", change, format!("the set has no check {id:?}"), remedy);
                }
            }
        }
        checks.iter().flat_map(|check| self.variants(index, check)).collect()
    }

    /// The checks of a set.
    fn set(&mut self, index: usize, name: &Node) -> Option<Vec<Node>> {
        let sets = self.sets.as_ref().and_then(Node::as_table)?;
        let found = name.as_str().and_then(|name| sets.get(name)).and_then(|set| set.get("check")?.as_array());
        if found.is_none() {
            let known: Vec<&str> = sets.keys().map(String::as_str).collect();
            let meant = name.as_str().and_then(|name| nearest(name, &known));
            let meant = meant.map_or(String::new(), |near| format!("did you mean {near:?}? "));
            let remedy = format!("{meant}{SETS} has {}", known.join(", "));
            self.note(index, "set", name, "there is no such set of checks".into(), remedy);
            return None;
        }
        found.map(<[Node]>::to_vec)
    }

    /// A check for each entry of its `variants`, or the check itself.
    fn variants(&mut self, index: usize, check: &Node) -> Vec<Node> {
        let Some(variants) = check.get("variants").cloned() else { return vec![check.clone()] };
        let entries = variants.as_array().filter(|entries| !entries.is_empty());
        let tables = entries.and_then(|all| all.iter().map(Node::as_table).collect::<Option<Vec<_>>>());
        let Some(tables) = tables else {
            let remedy = "write variants = [ { variant = \"…\", max = 1 }, … ]".to_string();
            self.note(index, "variants", &variants, "expected a list of tables".into(), remedy);
            return Vec::new();
        };
        let one = |entry: &Table| {
            let mut one = check.clone();
            if let Value::Table(table) = &mut one.value {
                table.remove("variants");
            }
            put(&mut one, entry);
            one
        };
        tables.into_iter().map(one).collect()
    }
}

/// Puts entries into a table, in place of those of the same key.
fn put(node: &mut Node, entries: &Table) {
    if let Value::Table(table) = &mut node.value {
        table.extend(entries.iter().map(|(key, entry)| (key.clone(), entry.clone())));
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::Case;

    const HEAD: &str = "claim = \"c\"\nseconds = 1\nstudy = \"basis\"\n";
    const SETS: &str = "[ends]\n[[ends.check]]\nid = \"a\"\nquantity = \"first\"\n[[ends.check]]\nid = \"b\"\nquantity = \"second\"\nmax = 2\nwhy = \"w\"\n";

    /// A case with these checks, beside a file of sets.
    fn read(checks: &str, sets: &str) -> Result<Case, String> {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("trial")).unwrap();
        fs::write(folder.path().join(super::SETS), sets).unwrap();
        let path = folder.path().join("trial/case.toml");
        Case::parse(&path, &format!("{HEAD}{checks}"), &[]).map_err(|e| e.to_string())
    }

    #[test]
    fn checks_of_a_set_stand_in_the_case_with_what_it_changes() {
        let text = "[[check]]\nset = \"ends\"\nvariant = \"p=2\"\n[check.with]\nb = { max = 3, why = \"v\" }\n";
        let case = read(text, SETS).unwrap();
        let found: Vec<_> = case.checks.iter().map(|c| (c.id.as_str(), c.variant.as_deref(), c.accept.max)).collect();
        assert_eq!(found, [("a", Some("p=2"), None), ("b", Some("p=2"), Some(3.0))]);
    }

    #[test]
    fn a_check_with_a_list_of_variants_is_one_of_each_in_this_order() {
        let text = "[[check]]\nid = \"a\"\nquantity = \"first\"\nwhy = \"w\"\nvariants = [\n\
                    { variant = \"q\", min = 1 },\n{ variant = \"p\", max = 2, why = \"v\" },\n]\n";
        let case = read(text, SETS).unwrap();
        let found: Vec<_> =
            case.checks.iter().map(|c| (c.variant.as_deref().unwrap(), c.accept.why.as_str())).collect();
        assert_eq!(found, [("q", "w"), ("p", "v")]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let place = |checks: &str, sets: &str| read(checks, sets).unwrap_err();
        let message = place("[[check]]\nset = \"end\"\n", SETS);
        assert!(
            message.contains("case.toml:5:7: check.0.set") && message.contains("did you mean \"ends\"?"),
            "{message}"
        );
        let message = place("[[check]]\nset = \"ends\"\nwith = { c = { max = 1 } }\n", SETS);
        assert!(message.contains("no check \"c\"") && message.contains("ids of this set: a, b"), "{message}");
        let message = place("[[check]]\nid = \"a\"\nquantity = \"q\"\nvariants = { p = 1 }\n", SETS);
        assert!(message.contains("expected a list of tables"), "{message}");
        let message = place("[[check]]\nset = \"ends\"\n", &SETS.replace("max = 2", "mox = 2"));
        assert!(message.contains("check-sets.toml:8:1") && message.contains("mox"), "{message}");
        let message = place("[[check]]\nset = \"ends\"\n", "[ends\n");
        assert!(message.contains("check-sets.toml:1"), "{message}");
    }
}
