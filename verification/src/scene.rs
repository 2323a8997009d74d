//! Scene files: TOML text to a checked [`Scene`] in SI units.
//!
//! `units` reads quantities, `document` keeps the tree with the place of every value, `overrides` changes it
//! by key, `fields` walks it and collects problems, `read` and `read_body` make the typed scene, and
//! [`fisura::validate::validate`] says whether it makes sense. Every problem names file, line, column and
//! full key path.

mod accuracy;
pub mod diagnostic;
pub mod document;
pub mod fields;
mod overrides;
pub mod plain;
pub(crate) mod read;
mod read_body;
mod read_file;
mod read_function;
mod read_load;
mod read_mesh;
pub mod suggest;
pub mod typed;
pub mod units;
mod words;

use std::path::Path;

use fisura::scene::Scene;
use fisura::scene::error::SceneError;
use fisura::validate::validate;

pub use diagnostic::{Location, Problem, SceneDiagnostic, SceneFileError, Severity};
pub use document::{Document, Node, Value};
pub use read::{SCENE_KEYS, read_scene};

/// A scene that passed every check, with the text it came from.
#[derive(Debug, Clone)]
pub struct SceneFile {
    /// The scene, SI units.
    pub scene: Scene,
    /// What is legal but probably not meant.
    pub warnings: Vec<SceneDiagnostic>,
    /// Text of the file, without the overrides.
    pub source: String,
    document: Document,
}

impl SceneFile {
    /// Reads and checks a scene file, with `key.path=value` overrides.
    ///
    /// # Errors
    /// A file that cannot be read, is not UTF-8 or not TOML; and those of [`SceneFile::parse`].
    pub fn load(path: &Path, overrides: &[String]) -> Result<Self, SceneFileError> {
        Self::from_document(Document::load(path)?, overrides)
    }

    /// Reads and checks the scene in `text`; `name` stands for it in messages.
    ///
    /// # Errors
    /// All that is wrong with the syntax; if nothing, with the overrides; if nothing, with keys, types and
    /// units; if nothing, with the scene itself.
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<Self, SceneFileError> {
        Self::from_document(Document::parse(name, text)?, overrides)
    }

    fn from_document(mut document: Document, overrides: &[String]) -> Result<Self, SceneFileError> {
        document.apply(overrides)?;
        let scene = read_scene(&document.root, "", document.folder()).map_err(|problems| document.error(&problems))?;
        let warnings = check_scene(&scene, &document.root, "").map_err(|problems| document.error(&problems))?;
        let warnings = warnings.iter().map(|w| document.warning(w)).collect();
        Ok(Self { scene, warnings, source: document.text().to_string(), document })
    }

    /// What is wrong with the scene and shows only when it is made ready to run, at its place in the file.
    pub fn error(&self, error: &SceneError) -> SceneFileError {
        self.document.error(&[place(&self.document.root, "", &error.key, &error.message, &error.remedy)])
    }
}

/// A finding at its key in `node`, which stands at key path `prefix`.
fn place(node: &Node, prefix: &str, key: &str, message: &str, remedy: &str) -> Problem {
    Problem {
        key: [prefix, key].iter().filter(|s| !s.is_empty()).copied().collect::<Vec<_>>().join("."),
        location: node.locate(key),
        message: message.to_string(),
        remedy: remedy.to_string(),
    }
}

/// Validates a scene read from `node` at key path `prefix`, and gives every finding its place; returns the
/// warnings.
///
/// # Errors
/// Everything that makes the scene impossible to model.
pub fn check_scene(scene: &Scene, node: &Node, prefix: &str) -> Result<Vec<Problem>, Vec<Problem>> {
    match validate(scene) {
        Ok(warnings) => Ok(warnings.iter().map(|w| place(node, prefix, &w.key, &w.message, "")).collect()),
        Err(errors) => Err(errors.iter().map(|e| place(node, prefix, &e.key, &e.message, &e.remedy)).collect()),
    }
}
