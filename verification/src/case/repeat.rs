//! What is written once for several cases, in files beside the folders of the suites: `base` takes the part
//! of a case in a table of `bases.toml`, `set` takes the checks of a list of `check-sets.toml`. `each` in a
//! check or a variant lists what differs between several; lists in a list are combined, and an entry may
//! have an `each`, too.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::value::identifier;
use crate::scene::document::{Document, Node, Value};
use crate::scene::suggest::hint;
use crate::scene::{Problem, SceneFileError};

/// Name of the file with the tables that the key `base` names.
const BASES: &str = "bases.toml";
/// Name of the file with the lists of checks that the key `set` names.
const SETS: &str = "check-sets.toml";
/// Most sets or bases within each other.
const DEEPEST: usize = 8;

type Table = BTreeMap<String, Node>;

/// Adds what the base of a case at `path` states, and the base of that. Tables of both become one, and any
/// other value of the case replaces that of the base; in a table over a list, keys are numbers of entries.
///
/// # Errors
/// The file of the bases, if one is named and the file cannot be read; an unknown base; a list that has no
/// such entry.
pub(super) fn add_base(document: &mut Document, path: &Path) -> Result<(), SceneFileError> {
    if document.root.get("base").is_none() {
        return Ok(());
    }
    let bases = document.include(&shared(path, BASES))?;
    let mut problems = Vec::new();
    let root = on_base(&document.root, &bases, 0, &mut problems);
    if !problems.is_empty() {
        return Err(document.error(&problems));
    }
    document.root = Node::new(root.value, None);
    Ok(())
}

/// A case or base over the one that it names.
fn on_base(over: &Node, bases: &Node, depth: usize, problems: &mut Vec<Problem>) -> Node {
    let Some(name) = over.get("base") else { return over.clone() };
    if depth == DEEPEST {
        let (message, remedy) = ("the base holds itself".into(), format!("name another base of {BASES}"));
        problems.push(Problem { key: "base".into(), location: name.location.clone(), message, remedy });
    }
    let base = named(bases, BASES, name, "base", problems).filter(|_| depth < DEEPEST);
    let Some(base) = base else { return over.clone() };
    let mut root = on_base(&base, bases, depth + 1, problems);
    put_over(&mut root, "", over, problems);
    if let Value::Table(table) = &mut root.value {
        table.remove("base");
    }
    root
}

/// Puts `over` at `path`, or its entries, if tables or lists stand at both places.
fn put_over(root: &mut Node, path: &str, over: &Node, problems: &mut Vec<Problem>) {
    let opens = root.at(path).is_some_and(|below| below.as_table().is_some() || below.as_array().is_some());
    if let Some(entries) = over.as_table().filter(|_| opens) {
        for (key, entry) in entries {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            put_over(root, &path, entry, problems);
        }
    } else if let Err(message) = root.set(path, over.clone()) {
        let remedy = format!("name a key that the base in {BASES} has, or write the case out without a base");
        problems.push(Problem { key: path.into(), location: over.location.clone(), message, remedy });
    }
}

/// A file for all suites, seen from a case at `path`.
fn shared(path: &Path, file: &str) -> PathBuf {
    path.parent().and_then(Path::parent).unwrap_or(Path::new("")).join(file)
}

/// What stands in a file for all suites under the name that `key` gives.
fn named(shared: &Node, file: &str, name: &Node, key: &str, problems: &mut Vec<Problem>) -> Option<Node> {
    let found = name.as_str().and_then(|name| shared.as_table()?.get(name));
    if found.is_none() {
        let known: Vec<&str> = shared.as_table().into_iter().flatten().map(|(key, _)| key.as_str()).collect();
        let meant = name.as_str().map_or(String::new(), |name| hint(name, &known));
        let remedy = format!("{meant}{file} has {}", known.join(", "));
        let message = "there is nothing of that name".into();
        problems.push(Problem { key: key.into(), location: name.location.clone(), message, remedy });
    }
    found.cloned()
}

/// Writes out the variants and the checks of a case at `path` one by one. An entry of `each`, and what stands
/// beside `set`, goes before what it is added to; `with` of a set says by id what changes in one of its
/// checks.
///
/// # Errors
/// The file of the sets, if a set is named and the file cannot be read; an unknown set or id; lists that
/// are none.
pub(super) fn write_lists(document: &mut Document, path: &Path) -> Result<(), SceneFileError> {
    let list = |key: &str| document.root.get(key).and_then(Node::as_array).unwrap_or_default().to_vec();
    let (variants, checks) = (list("variant"), list("check"));
    let sets = match checks.iter().any(|check| check.get("set").is_some()) {
        true => Some(document.include(&shared(path, SETS))?),
        false => None,
    };
    let mut expansion = Expansion { sets, problems: Vec::new() };
    let write = |(i, variant): (usize, &Node)| expansion.each(&format!("variant.{i}"), variant);
    let variants: Vec<Node> = variants.iter().enumerate().flat_map(write).collect();
    let write = |(i, check): (usize, &Node)| expansion.check(&format!("check.{i}"), check, 0);
    let checks: Vec<Node> = checks.iter().enumerate().flat_map(write).collect();
    if !expansion.problems.is_empty() {
        return Err(document.error(&expansion.problems));
    }
    for (key, written) in [("variant", variants), ("check", checks)] {
        if let Value::Table(root) = &mut document.root.value
            && let Some(list) = root.get_mut(key).filter(|_| !written.is_empty())
        {
            list.value = Value::Array(written);
        }
    }
    Ok(())
}

struct Expansion {
    /// Root of the file of the sets.
    sets: Option<Node>,
    problems: Vec<Problem>,
}

impl Expansion {
    fn note(&mut self, key: &str, node: &Node, message: String, remedy: String) {
        self.problems.push(Problem { key: key.into(), location: node.location.clone(), message, remedy });
    }

    /// The checks that an entry at `path` stands for; itself, if it names no set and has no list.
    fn check(&mut self, path: &str, check: &Node, depth: usize) -> Vec<Node> {
        let Some(table) = check.as_table() else { return vec![check.clone()] };
        let mut beside = table.clone();
        let (Some(set), with) = (beside.remove("set"), beside.remove("with")) else {
            return self.each(path, check);
        };
        let mut checks = self.set(path, &set, depth);
        let folder = beside.get("reference").and_then(Node::as_str).filter(|name| name.ends_with('/'));
        if let Some(folder) = folder.map(String::from)
            && let Some(given) = beside.remove("reference")
        {
            let placed = checks.iter_mut().filter_map(|check| put_reference_into(check, &folder)).count();
            if placed == 0 {
                let remedy = "name a whole reference, \"folder/name\"".into();
                self.note(&format!("{path}.reference"), &given, "no check of the set has a reference".into(), remedy);
            }
        }
        for check in &mut checks {
            put(check, &beside);
        }
        let changes = with.iter().filter_map(Node::as_table).flatten();
        for (id, change) in changes {
            let ids: Vec<String> = checks.iter().filter_map(id_of).collect();
            let Some(keys) = change.as_table() else {
                let remedy = "write { max = 1 }".into();
                self.note(&format!("{path}.with"), change, "expected a table".into(), remedy);
                continue;
            };
            if !ids.contains(id) {
                let remedy = format!("ids of this set: {}", ids.join(", "));
                self.note(&format!("{path}.with"), change, format!("the set has no check {id:?}"), remedy);
            }
            checks.iter_mut().filter(|check| id_of(check).as_ref() == Some(id)).for_each(|check| put(check, keys));
        }
        checks.iter().flat_map(|check| self.each(path, check)).collect()
    }

    /// The checks of a set, which may name further sets.
    fn set(&mut self, path: &str, name: &Node, depth: usize) -> Vec<Node> {
        let key = format!("{path}.set");
        if depth == DEEPEST {
            self.note(&key, name, "the set holds itself".into(), format!("name another set of {SETS}"));
            return Vec::new();
        }
        let sets = self.sets.take();
        let found = sets.as_ref().and_then(|sets| named(sets, SETS, name, &key, &mut self.problems));
        self.sets = sets;
        let Some(found) = found else { return Vec::new() };
        let Some(checks) = found.as_array() else {
            self.note(&key, name, format!("it is {}, no list", found.kind()), format!("write [[…]] in {SETS}"));
            return Vec::new();
        };
        checks.iter().flat_map(|check| self.check(path, check, depth + 1)).collect()
    }

    /// A check for each entry of its list, or for each way to take one entry of each of its lists, or the
    /// check itself.
    fn each(&mut self, path: &str, check: &Node) -> Vec<Node> {
        let Some(each) = check.get("each").cloned() else { return vec![check.clone()] };
        let entries = each.as_array().filter(|entries| !entries.is_empty());
        if let Some(lists) = entries.filter(|all| all.iter().all(|list| list.as_array().is_some())) {
            let mut checks = vec![check.clone()];
            for list in lists {
                let with = Table::from([("each".to_string(), list.clone())]);
                checks.iter_mut().for_each(|check| put(check, &with));
                checks = checks.iter().flat_map(|check| self.each(path, check)).collect();
            }
            return checks;
        }
        let tables = entries.and_then(|all| all.iter().map(Node::as_table).collect::<Option<Vec<_>>>());
        let Some(tables) = tables else {
            let remedy = "write each = [ { variant = \"…\", max = 1 }, … ]".to_string();
            self.note(&format!("{path}.each"), &each, "expected a list of tables".into(), remedy);
            return Vec::new();
        };
        let one = |entry: &Table| {
            let mut one = check.clone();
            if let Value::Table(table) = &mut one.value {
                table.remove("each");
            }
            put(&mut one, entry);
            one
        };
        tables.into_iter().map(one).flat_map(|one| self.each(path, &one)).collect()
    }
}

/// The id of a check as it stands in a file.
fn id_of(check: &Node) -> Option<String> {
    let given = check.get("id").and_then(Node::as_str).map(String::from);
    given.or_else(|| Some(identifier(check.get("quantity")?.as_str()?)))
}

/// Puts entries into a table, in place of those of the same key; names of variants, and what they set, are
/// put together.
fn put(node: &mut Node, entries: &Table) {
    let Value::Table(table) = &mut node.value else { return };
    for (key, entry) in entries {
        match (key.as_str(), table.get_mut(key).map(|node| &mut node.value), &entry.value) {
            ("name", Some(Value::String(name)), Value::String(more)) => name.push_str(more),
            ("set", Some(Value::Table(all)), Value::Table(more)) => all.extend(more.clone()),
            _ => drop(table.insert(key.clone(), entry.clone())),
        }
    }
}

/// Puts the folder before the reference of a check; `None` if it has no reference.
fn put_reference_into(check: &mut Node, folder: &str) -> Option<()> {
    let Value::Table(table) = &mut check.value else { return None };
    let Value::String(name) = &mut table.get_mut("reference")?.value else { return None };
    name.insert_str(0, folder);
    Some(())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::super::Case;

    const HEAD: &str = "claim = \"c\"\nseconds = 1\nstudy = \"basis\"\n";
    const SETS: &str = "[[ends]]\nquantity = \"first a\"\n[[ends]]\nid = \"b\"\nquantity = \"second\"\nmax = 2\nwhy = \"w\"\n\
                        [[all]]\nset = \"ends\"\nunit = \"m\"\n[[all]]\neach = [{ quantity = \"c\" }, { quantity = \"d\" }]\n";
    const BASES: &str = "[bar]\nlabel = \"bar\"\n[bar.scene.mesh]\ndegree = 2\ncells = [1, 2]\n\
                         [[bar.scene.body]]\nname = \"one\"\n[[bar.scene.body]]\nname = \"two\"\nfrozen = true\n";
    const CHECK: &str = "[[check]]\nquantity = \"first\"\n";

    /// A case with this text, beside a file of sets and one of bases.
    fn read(text: &str, sets: &str, bases: &str) -> Result<Case, String> {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("trial")).unwrap();
        fs::write(folder.path().join(super::SETS), sets).unwrap();
        fs::write(folder.path().join(super::BASES), bases).unwrap();
        let path = folder.path().join("trial/case.toml");
        let overrides = ["mesh.cells=[3, 4]".to_string()];
        let overrides = if text.contains("base") { &overrides[..] } else { &[] };
        Case::parse(&path, &format!("{HEAD}{text}"), overrides).map_err(|e| e.to_string())
    }

    #[test]
    fn checks_of_a_set_stand_in_the_case_with_what_it_changes() {
        let text = "[[check]]\nset = \"all\"\nvariant = \"p=2\"\n[check.with]\n\
                    b = { max = 3, why = \"v\" }\nfirst-a = { unit = \"s\" }\n";
        let case = read(text, SETS, BASES).unwrap();
        assert!(case.checks.iter().all(|check| check.variant.as_deref() == Some("p=2")));
        let found: Vec<_> = case.checks.iter().map(|c| (c.id.as_str(), c.unit.as_str(), c.accept.max)).collect();
        assert_eq!(found, [("first-a", "s", None), ("b", "m", Some(3.0)), ("c", "1", None), ("d", "1", None)]);
    }

    #[test]
    fn a_folder_beside_a_set_holds_the_references_of_its_checks() {
        let sets = "[[two]]\neach = [{ quantity = \"a\", reference = \"x\" }, { quantity = \"b\" }]\n";
        let case = read("[[check]]\nset = \"two\"\nreference = \"folder/part/\"\n", sets, BASES).unwrap();
        let found: Vec<_> = case.checks.iter().map(|check| check.reference.as_deref()).collect();
        assert_eq!(found, [Some("folder/part/x"), None]);
        let none = read("[[check]]\nset = \"ends\"\nreference = \"folder/\"\n", SETS, BASES).unwrap_err();
        assert!(none.contains("check.0.reference: no check of the set has a reference"), "{none}");
    }

    #[test]
    fn a_check_with_a_list_is_one_for_each_entry_in_this_order() {
        let text = "[[check]]\nid = \"a\"\nquantity = \"first\"\nwhy = \"w\"\neach = [\n\
                    { variant = \"q\", min = 1 },\n{ variant = \"p\", max = 2, why = \"v\" },\n]\n";
        let case = read(text, SETS, BASES).unwrap();
        let found: Vec<_> =
            case.checks.iter().map(|c| (c.variant.as_deref().unwrap(), c.accept.why.as_str())).collect();
        assert_eq!(found, [("q", "w"), ("p", "v")]);
    }

    #[test]
    fn lists_in_a_list_are_combined_and_entries_may_be_lists() {
        let text = "[[check]]\nunit = \"m\"\neach = [[{ quantity = \"a\" }, { quantity = \"b\", unit = \"s\" }], \
                    [{ variant = \"p\" }, { each = [{ variant = \"q\" }, { variant = \"r\" }] }]]\n";
        let case = read(text, SETS, BASES).unwrap();
        let found = case.checks.iter().map(|c| format!("{} {} {}", c.id, c.unit, c.variant.as_deref().unwrap()));
        assert_eq!(found.collect::<Vec<_>>(), ["a m p", "a m q", "a m r", "b s p", "b s q", "b s r"]);
    }

    #[test]
    fn variants_of_a_list_share_what_stands_beside_it() {
        let each = "[{ name = \"a\", set = {} }, { name = \"b\", set = {}, energy_factor = 1 }]";
        let variants =
            format!("[[variant]]\nenergy_factor = 2\neach = {each}\n[[variant]]\nname = \"c\"\nset = {{}}\n");
        let text = format!("{variants}{CHECK}");
        let case = read(&text, SETS, BASES).unwrap();
        let found: Vec<_> = case.variants.iter().map(|v| (v.name.as_str(), v.energy_factor)).collect();
        assert_eq!(found, [("a", Some(2.0)), ("b", Some(1.0)), ("c", None)]);
    }

    #[test]
    fn a_case_stands_over_its_base_and_those_of_it_and_an_override_over_all() {
        let bases = format!("{BASES}[upon]\nbase = \"bar\"\nlabel = \"upon\"\nscene.mesh.degree = 4\n");
        for base in ["bar", "upon"] {
            let text = format!("base = \"{base}\"\n[scene]\nmesh.degree = 3\nbody.1.name = \"end\"\n{CHECK}");
            let case = read(&text, SETS, &bases).unwrap();
            assert_eq!((case.label.as_str(), case.document.root.get("base")), (base, None));
            let scene = case.scene_node().unwrap().canonical();
            let bodies = r#"[{name = String("one")}, {frozen = Boolean(true), name = String("end")}]"#;
            let mesh = "{cells = [Integer(3), Integer(4)], degree = Integer(3)}";
            assert_eq!(scene, format!("{{body = {bodies}, mesh = {mesh}}}"));
        }
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let told = |text: &str, sets: &str, bases: &str, parts: &[&str]| {
            let message = read(text, sets, bases).unwrap_err();
            assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        };
        let wrong = |checks: &str, sets: &str, parts: &[&str]| told(checks, sets, BASES, parts);
        wrong("[[check]]\nset = \"end\"\n", SETS, &["case.toml:5:7: check.0.set", "did you mean \"ends\"?"]);
        let ids = "ids of this set: first-a, b";
        wrong("[[check]]\nset = \"ends\"\nwith = { c = { max = 1 } }\n", SETS, &["no check \"c\"", ids]);
        wrong("[[check]]\nquantity = \"q\"\neach = { p = 1 }\n", SETS, &["expected a list of tables"]);
        let typing = SETS.replace("max = 2", "mox = 2");
        wrong("[[check]]\nset = \"ends\"\n", &typing, &["check-sets.toml:6:1", "mox"]);
        wrong("[[check]]\nset = \"ends\"\n", "[[ends\n", &["check-sets.toml:1"]);
        wrong("[[check]]\nset = \"a\"\n", "[[a]]\nset = \"a\"\n", &["check-sets.toml:2", "the set holds itself"]);

        let based = |name: &str, rest: &str| format!("base = \"{name}\"\n{rest}{CHECK}");
        told(&based("bare", ""), SETS, BASES, &["case.toml:4:8: base", "did you mean \"bar\"?"]);
        let typing = BASES.replace("label", "lable");
        told(&based("bar", ""), SETS, &typing, &["bases.toml:2:1: lable", "did you mean \"label\"?"]);
        let nested = BASES.replace("label", "base");
        told(&based("bar", ""), SETS, &nested, &["bases.toml:2:8: base", "the base holds itself"]);
        let third = "[scene]\nbody.2.name = \"three\"\n";
        told(&based("bar", third), SETS, BASES, &["case.toml:6", "scene.body.2", "entries count from 0: 0 to 1"]);
    }
}
