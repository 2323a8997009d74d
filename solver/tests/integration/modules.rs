//! The folders of the solver call downwards only, and no files import each other in a circle. The folders
//! of the harness call downwards only.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use syn::visit::{self, Visit};

/// The folders of the harness, lowest first.
const OF_THE_HARNESS: [&str; 14] = [
    "arithmetic",
    "output",
    "watch",
    "record",
    "scene",
    "reference",
    "case",
    "exact",
    "measure",
    "scene_run",
    "study",
    "suite",
    "bench",
    "judge",
];

/// The folders of the solver, lowest first: each calls those before it. `faults` is everywhere.
const OF_THE_SOLVER: [&str; 14] = [
    "faults",
    "checkpoint",
    "linear_algebra",
    "scene",
    "splines",
    "material",
    "particles",
    "transfer",
    "phase_field",
    "contact",
    "output",
    "dynamics",
    "validate",
    "simulation",
];

/// Names of modules from the crate on, `["splines", "nurbs"]` for `splines/nurbs.rs`.
type Module = Vec<String>;

/// Collects every path of a file outside its tests.
#[derive(Default)]
struct Paths(Vec<Vec<String>>);

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        let is_test = item.attrs.iter().any(|attribute| attribute.path().is_ident("cfg"));
        if !is_test {
            visit::visit_item_mod(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.add(&item.tree, Vec::new());
    }

    /// Who may see an item is no import.
    fn visit_visibility(&mut self, _: &'ast syn::Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        // one word is a variable or what a `use` brought
        if path.segments.len() > 1 {
            self.0.push(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}

impl Paths {
    fn of(source: &str) -> Vec<Vec<String>> {
        let mut paths = Self::default();
        paths.visit_file(&syn::parse_file(source).expect("a source file"));
        paths.0
    }

    /// The paths of a `use`.
    fn add(&mut self, tree: &syn::UseTree, mut above: Vec<String>) {
        match tree {
            syn::UseTree::Path(path) => {
                above.push(path.ident.to_string());
                self.add(&path.tree, above);
            }
            syn::UseTree::Group(group) => group.items.iter().for_each(|item| self.add(item, above.clone())),
            syn::UseTree::Name(name) if name.ident == "self" => self.0.push(above),
            syn::UseTree::Name(syn::UseName { ident }) | syn::UseTree::Rename(syn::UseRename { ident, .. }) => {
                above.push(ident.to_string());
                self.0.push(above);
            }
            syn::UseTree::Glob(_) => self.0.push(above),
        }
    }
}

/// The files that each file names in a path.
struct Imports(BTreeMap<Module, BTreeSet<Module>>);

impl Imports {
    fn of(files: &BTreeMap<Module, String>) -> Self {
        let import = |(module, source): (&Module, &String)| {
            let named = Paths::of(source).into_iter().filter_map(|path| resolve(files, module, &path));
            (module.clone(), named.filter(|other| other != module).collect())
        };
        Self(files.iter().map(import).collect())
    }

    /// Imports from a folder that stands above.
    fn upward(&self, folders: &[&str]) -> Vec<String> {
        let rank = |module: &Module| {
            let folder = folders.iter().position(|folder| *folder == module[0]);
            folder.unwrap_or_else(|| panic!("{} has no folder: give it a place in the list", module.join("/")))
        };
        let pairs = self.0.iter().flat_map(|(from, all)| all.iter().map(move |to| (from, to)));
        pairs.filter(|(from, to)| rank(from) < rank(to)).map(|(from, to)| arrow(&[from, to])).collect()
    }

    /// A way back to where it began from every file that has one.
    fn circles(&self) -> Vec<String> {
        let way_back = |start: &Module| {
            let mut came_from: BTreeMap<&Module, &Module> = BTreeMap::new();
            let mut open = vec![start];
            while let Some(at) = open.pop() {
                for next in &self.0[at] {
                    if next == start {
                        let mut way = vec![start, at];
                        while let Some(before) = came_from.get(way[way.len() - 1]) {
                            way.push(before);
                        }
                        way.reverse();
                        return Some(arrow(&way));
                    }
                    if !came_from.contains_key(next) {
                        came_from.insert(next, at);
                        open.push(next);
                    }
                }
            }
            None
        };
        self.0.keys().filter_map(way_back).collect()
    }
}

fn arrow(modules: &[&Module]) -> String {
    modules.iter().map(|module| module.join("/")).collect::<Vec<_>>().join(" -> ")
}

/// The file a path leads into, seen from a module.
fn resolve(files: &BTreeMap<Module, String>, from: &Module, path: &[String]) -> Option<Module> {
    let up = path.iter().take_while(|segment| *segment == "super").count();
    let (mut module, rest) = match path[0].as_str() {
        "crate" => (Module::new(), &path[1..]),
        "self" => (from.clone(), &path[1..]),
        "super" => (from[..from.len().checked_sub(up)?].to_vec(), &path[up..]),
        _ => (from.clone(), path),
    };
    for segment in rest {
        module.push(segment.clone());
        if !files.contains_key(&module) {
            module.pop();
            break;
        }
    }
    files.contains_key(&module).then_some(module)
}

/// The files of a crate of the workspace but its root.
fn files(name: &str) -> BTreeMap<Module, String> {
    fn walk(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap().flatten() {
            let path = entry.path();
            if path.is_dir() { walk(&path, found) } else { found.push(path) }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().join(name).join("src");
    let mut found = Vec::new();
    walk(&root, &mut found);
    let module = |path: &PathBuf| -> Module {
        let name = path.strip_prefix(&root).unwrap().with_extension("");
        name.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect()
    };
    let sources = found.iter().map(|path| (module(path), fs::read_to_string(path).unwrap()));
    sources.filter(|(module, _)| module[0] != "lib" && module[module.len() - 1] != "tests").collect()
}

#[test]
fn folders_call_downwards_and_files_import_in_no_circle() {
    let imports = Imports::of(&files("solver"));
    assert!(imports.0.values().map(BTreeSet::len).sum::<usize>() > 500, "paths are found");
    assert_eq!(imports.upward(&OF_THE_SOLVER), [""; 0]);
    assert_eq!(imports.circles(), [""; 0]);
}

#[test]
fn folders_of_the_harness_call_downwards() {
    let imports = Imports::of(&files("verification"));
    assert!(imports.0.values().map(BTreeSet::len).sum::<usize>() > 300, "paths are found");
    assert_eq!(imports.upward(&OF_THE_HARNESS), [""; 0]);
}

#[test]
fn an_upward_import_and_circles_are_found() {
    let imports = |sources: &[(&str, &str)]| {
        let module = |name: &str| name.split('/').map(String::from).collect();
        Imports::of(&sources.iter().map(|(name, source)| (module(name), source.to_string())).collect())
    };
    let up = imports(&[
        ("splines", "pub mod patch;"),
        ("splines/patch", "fn f() -> f64 { crate::dynamics::mass::of() }"),
        ("dynamics", ""),
        ("dynamics/mass", "use crate::splines::{self, patch::Patch};"),
    ]);
    assert_eq!(up.upward(&OF_THE_SOLVER), ["splines/patch -> dynamics/mass"]);
    let pair = imports(&[("contact", "mod touch; pub use touch::Touch;"), ("contact/touch", "use super::Contact;")]);
    assert_eq!(pair.circles(), ["contact -> contact/touch -> contact", "contact/touch -> contact -> contact/touch"]);
    let ring = imports(&[
        ("scene", "use crate::splines::A;"),
        ("splines", "fn f(x: crate::material::B) {}"),
        ("material", "#[cfg(test)] mod tests { use crate::dynamics::D; } use crate::scene::C;"),
        ("dynamics", ""),
    ]);
    assert_eq!(ring.circles().len(), 3);
    assert_eq!(ring.circles()[1], "scene -> splines -> material -> scene");
    assert_eq!(ring.upward(&OF_THE_SOLVER).len(), 2, "what tests import does not count");
}

#[test]
fn no_two_types_share_a_name() {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (module, source) in files("solver") {
        for item in syn::parse_file(&source).unwrap().items {
            let name = match item {
                syn::Item::Struct(item) => item.ident,
                syn::Item::Enum(item) => item.ident,
                syn::Item::Trait(item) => item.ident,
                syn::Item::Type(item) => item.ident,
                _ => continue,
            };
            places.entry(name.to_string()).or_default().push(module.join("/"));
        }
    }
    assert!(places.len() > 150, "types are found");
    places.retain(|_, modules| modules.len() > 1);
    assert_eq!(places, BTreeMap::new());
}
