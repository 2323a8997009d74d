//! From a case to the scenes it runs: study axes and variants.
//!
//! A list where a scene has one value is an axis; several axes span their product. Each variant changes its
//! keys on top. Then formulas of keys are evaluated.

use std::collections::BTreeMap;

use fisura::scene::Scene;

use crate::case::formula::{Amount, Formula, Name, value_of_key};
use crate::case::{Case, Variant};
use crate::scene::document::{Node, Value, join};
use crate::scene::{Problem, SceneFileError, check_scene, read_scene};

/// Most scenes of a case.
const MOST_SCENES: usize = 100;

/// Longest chain of formulas of a scene.
const MOST_LINKS: usize = 32;

/// One scene of a case.
#[derive(Debug, Clone)]
pub struct CaseScene {
    /// Name within the case: `degree=3`, or the variant's; empty for the only one.
    pub name: String,
    /// Values along the axes.
    pub parameters: Vec<(String, serde_json::Value)>,
    /// Scene with the values of the axes and the variant, and with its formulas evaluated.
    pub scene: Scene,
    /// Values of the case in this scene.
    pub values: BTreeMap<String, f64>,
    /// Energies of its run times this are those of the whole body.
    pub energy_factor: f64,
}

/// Keys whose one value is itself a list, with its depth.
fn depth_of_one_value(path: &str) -> usize {
    let key = path.rsplit('.').next().unwrap_or(path);
    match key {
        "cells" | "long_ends" | "origin" | "size" | "particles_per_cell" | "velocity" | "displacement" | "gravity"
        | "fix" | "frames" | "at" | "min" | "max" | "center" | "from" | "to" | "stress" | "weights" | "angles" => 1,
        "knots" | "points" | "segment" | "control_points" | "table" | "velocity_gradient" | "tensor" => 2,
        "minus" => usize::MAX,
        _ => 0,
    }
}

fn depth(node: &Node) -> usize {
    match node.as_array() {
        Some(entries) => 1 + entries.iter().map(depth).max().unwrap_or(0),
        None => 0,
    }
}

/// Every key path below `node` that has more values than a scene needs.
fn find_axes(node: &Node, path: &str, axes: &mut Vec<(String, Vec<Node>)>) {
    if let Some(table) = node.as_table() {
        for (key, child) in table {
            find_axes(child, &join(path, key), axes);
        }
    } else if let Some(entries) = node.as_array() {
        if entries.iter().any(|entry| entry.as_table().is_some()) {
            for (index, entry) in entries.iter().enumerate() {
                find_axes(entry, &format!("{path}.{index}"), axes);
            }
        } else if depth(node) > depth_of_one_value(path) {
            axes.push((path.to_string(), entries.to_vec()));
        }
    }
}

impl Case {
    /// All scenes of the case, in order; none if it has no `[scene]`.
    ///
    /// # Errors
    /// Everything wrong with a scene, with its place in the case file.
    pub fn scenes(&self) -> Result<Vec<CaseScene>, SceneFileError> {
        let Some(base) = self.scene_node() else { return Ok(Vec::new()) };
        let mut axes = Vec::new();
        find_axes(base, "", &mut axes);
        let values =
            axes.iter().map(|(_, values)| values.len()).fold(self.variants.len().max(1), usize::saturating_mul);
        if values > MOST_SCENES {
            let longest =
                axes.iter().max_by_key(|(_, values)| values.len()).map_or("variant", |(path, _)| path.as_str());
            let remedy = format!("give shorter lists: at most {MOST_SCENES} scenes in all");
            return Err(self.error(&format!("scene.{longest}"), &format!("{values} scenes in one case"), &remedy));
        }
        let start =
            Tree { name: String::new(), parameters: Vec::new(), energy_factor: self.energy_factor, node: base.clone() };
        let mut trees = vec![start];
        for (path, values) in &axes {
            let pairs = trees.iter().flat_map(|tree| values.iter().map(move |value| (tree, value)));
            let along: Result<Vec<Tree>, String> = pairs.map(|(tree, value)| tree.along(path, value)).collect();
            trees = along.map_err(|e| self.error(&format!("scene.{path}"), &e, "use plain keys"))?;
        }
        if !self.variants.is_empty() {
            let pairs = trees.iter().flat_map(|tree| self.variants.iter().map(move |variant| (tree, variant)));
            let varied: Result<Vec<Tree>, String> = pairs.map(|(tree, variant)| tree.varied(variant)).collect();
            trees = varied.map_err(|e| self.error("variant", &e, "name a key of the scene"))?;
        }
        trees.into_iter().map(|tree| self.scene_of(tree)).collect()
    }

    /// The `[scene]` with numbers in place of formulas, as it stands without axes and variants.
    ///
    /// # Errors
    /// A formula that has no value.
    pub fn scene_with_numbers(&self) -> Result<Option<Node>, SceneFileError> {
        let numbers = |scene| self.with_numbers(scene, "scene", scene);
        self.scene_node().map(numbers).transpose().map_err(|problem| self.document.error(&[problem]))
    }

    fn scene_of(&self, tree: Tree) -> Result<CaseScene, SceneFileError> {
        let Tree { name, parameters, energy_factor, node } = tree;
        let fail = |problems: Vec<Problem>| self.document.error(&problems);
        let node = self.with_numbers(&node, "scene", &node).map_err(|problem| fail(vec![problem]))?;
        let scene = read_scene(&node, "scene", self.document.folder()).map_err(fail)?;
        check_scene(&scene, &node, "scene").map_err(fail)?;
        let values = self.values(&node)?;
        Ok(CaseScene { name, parameters, scene, values, energy_factor })
    }

    /// `node`, at `path` of the case, with numbers in place of formulas; a whole number is an integer.
    fn with_numbers(&self, node: &Node, path: &str, scene: &Node) -> Result<Node, Problem> {
        let inner = |key: &str, child| self.with_numbers(child, &join(path, key), scene);
        let value = match &node.value {
            Value::Table(table) => {
                let entries = table.iter().map(|(key, child)| Ok((key.clone(), inner(key, child)?)));
                Value::Table(entries.collect::<Result<_, Problem>>()?)
            }
            Value::Array(entries) => {
                let entries = entries.iter().enumerate().map(|(i, child)| inner(&i.to_string(), child));
                Value::Array(entries.collect::<Result<_, Problem>>()?)
            }
            Value::String(text) if text.starts_with('=') => match self.key(path, node, scene, MOST_LINKS) {
                Ok(number) if number == number.trunc() && number.abs() < 1e15 => Value::Integer(number as i64),
                Ok(number) => Value::Float(number),
                Err(message) => {
                    let remedy =
                        "give a number, or a formula of values and of other keys of the scene in braces".into();
                    return Err(Problem { key: path.into(), location: node.location.clone(), message, remedy });
                }
            },
            _ => return Ok(node.clone()),
        };
        Ok(Node { value, ..node.clone() })
    }

    /// The `[values]` in a scene.
    fn values(&self, scene: &Node) -> Result<BTreeMap<String, f64>, SceneFileError> {
        let value = |(name, _): &(String, Amount)| {
            let found = self.value(name, scene, self.values.len());
            let remedy = "give numbers, formulas of other values, and keys of the scene in braces";
            Ok((name.clone(), found.map_err(|message| self.error(&format!("values.{name}"), &message, remedy))?))
        };
        self.values.iter().map(value).collect()
    }

    /// One of the values; a chain of them has at most `links`.
    fn value(&self, name: &str, scene: &Node, links: usize) -> Result<f64, String> {
        let (_, amount) = self.values.iter().find(|(known, _)| known == name).ok_or(format!("no value {name:?}"))?;
        let formula = match amount {
            Amount::Given(value) => return Ok(*value),
            Amount::Formula(formula) => formula,
        };
        let links = links.checked_sub(1).ok_or_else(|| format!("the value {name:?} depends on itself"))?;
        self.evaluate(formula, scene, links)
    }

    /// What a formula gives in a scene; a chain of values and keys in it has at most `links`.
    fn evaluate(&self, formula: &Formula, scene: &Node, links: usize) -> Result<f64, String> {
        let value = formula.number(&mut |name| match name {
            Name::Plain(other) => self.value(other, scene, links),
            Name::Key(path) => self.key(path, scene.at(path).unwrap_or(scene), scene, links),
            Name::Of(_, columns) => Err(format!("{columns:?} is known only after a run")),
        })?;
        if value.is_finite() { Ok(value) } else { Err(format!("it is {value}")) }
    }

    /// The value of a key of the scene, `node`, which may be a formula.
    fn key(&self, path: &str, node: &Node, scene: &Node, links: usize) -> Result<f64, String> {
        let Some(formula) = node.as_str().and_then(|text| text.strip_prefix('=')) else {
            return value_of_key(scene, path);
        };
        let links = links.checked_sub(1).ok_or_else(|| format!("the key {path:?} depends on itself"))?;
        self.evaluate(&formula.trim().parse()?, scene, links)
    }
}

/// A `[scene]` table on its way to one scene.
#[derive(Clone)]
struct Tree {
    name: String,
    parameters: Vec<(String, serde_json::Value)>,
    energy_factor: f64,
    node: Node,
}

impl Tree {
    /// With one value of an axis.
    fn along(&self, path: &str, value: &Node) -> Result<Self, String> {
        let mut tree = self.clone();
        tree.node.set(path, value.clone())?;
        let key = path.rsplit('.').next().unwrap_or(path);
        let json = value.to_json();
        let shown = json.to_string().replace('"', "").replace(',', "x").replace(['[', ']'], "");
        tree.parameters.push((key.to_string(), json));
        tree.name = join_names(&tree.name, &format!("{key}={shown}"));
        Ok(tree)
    }

    /// With the keys of a variant changed.
    fn varied(&self, variant: &Variant) -> Result<Self, String> {
        let mut tree = self.clone();
        for (key, value) in &variant.set {
            tree.node.set(key, value.clone())?;
        }
        tree.name = join_names(&tree.name, &variant.name);
        tree.energy_factor = variant.energy_factor.unwrap_or(self.energy_factor);
        Ok(tree)
    }
}

fn join_names(first: &str, second: &str) -> String {
    if first.is_empty() { second.to_string() } else { format!("{first},{second}") }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// The only scene of a case with this end of time.
    fn scene(end_time: &str) -> Result<CaseScene, String> {
        let text = format!(
            "claim = \"c\"\nseconds = 1\n[values]\nlater = \"= 3*{{mesh.size.0}}\"\n\
             [scene.mesh]\ndegree = 3\norigin = [0, 0]\ncells = [8, 4]\n\
             size = [\"= {{mesh.size.1}}*{{mesh.cells.0}}/{{mesh.cells.1}}\", 0.5]\n\
             [scene.analysis]\nend_time = {end_time}\n\
             [scene.material.a]\nyoung_modulus = 1\npoisson_ratio = 0\ndensity = 1\n\
             [[scene.body]]\nname = \"a\"\nmaterial = \"a\"\nparticles_per_cell = \"= {{mesh.degree}}\"\n\
             shape = {{ rectangle = {{ min = [0, 0], max = [\"= {{mesh.size.0}}\", 0.5] }} }}\n\
             [scene.output]\nsamples = 1\n[[check]]\nquantity = \"q\"\n"
        );
        let case = Case::parse(Path::new("s/c.toml"), &text, &[]).map_err(|e| e.to_string())?;
        Ok(case.scenes().map_err(|e| e.to_string())?.remove(0))
    }

    #[test]
    fn formulas_of_a_scene_use_its_keys_and_the_values() {
        let found = scene("\"= later/2\"").unwrap();
        assert_eq!((found.values["later"], found.scene.bodies[0].particles_per_cell), (3.0, [3, 3]));
    }

    #[test]
    fn a_formula_without_a_number_is_told_with_its_place() {
        for (end_time, message) in [
            ("\"= {analysis.end_time}\"", "depends on itself"),
            ("\"= {analysis.end}\"", "the scene has no key"),
            ("\"= 1/0\"", "it is inf"),
            ("\"= 1 +\"", "is not a valid formula"),
        ] {
            let told = scene(end_time).unwrap_err();
            assert!(told.contains("c.toml:11:12: scene.analysis.end_time") && told.contains(message), "{told}");
        }
    }
}
