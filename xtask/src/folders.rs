//! Where files are read and written.

use std::env;
use std::path::{Path, PathBuf};

use fisura_verification::output::OutputFolder;

use crate::cli::Common;
use crate::console;
use crate::failure::Failure;

/// Name of the folder of the references in the workspace.
const REFERENCES: &str = "reference-data";

/// Root of the workspace as cargo tells it, else the current folder.
pub fn workspace() -> PathBuf {
    of_cargo().filter(|root| root.join("Cargo.toml").is_file()).unwrap_or_default()
}

/// The folder above that of the package that cargo runs.
fn of_cargo() -> Option<PathBuf> {
    let manifest = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    manifest.and_then(|crate_folder| crate_folder.parent().map(Path::to_path_buf))
}

/// The folder of the references, for commands that work in any folder: in the workspace that cargo tells,
/// else in the current folder or the nearest above it, else in the nearest above this program.
///
/// # Errors
/// If it is nowhere; the message says where it was looked for.
pub fn reference_data() -> Result<PathBuf, Failure> {
    let (cargo, here, program) = (of_cargo(), env::current_dir().ok(), env::current_exe().ok());
    let above = |path: &Option<PathBuf>| {
        path.iter().flat_map(|path| path.ancestors()).map(Path::to_path_buf).collect::<Vec<_>>()
    };
    let roots = cargo.iter().cloned().chain(above(&here)).chain(above(&program));
    if let Some(found) = roots.map(|root| root.join(REFERENCES)).find(|folder| has_sources(folder)) {
        return Ok(found);
    }
    let places = [
        cargo.map(|root| format!("in {}, the workspace of cargo", root.display())),
        here.map(|folder| format!("in {} and above, the current folder", folder.display())),
        program.as_deref().and_then(Path::parent).map(|f| format!("in {} and above, the program", f.display())),
    ];
    let places: Vec<String> = places.into_iter().flatten().collect();
    let message = format!("no folder {REFERENCES} with references was found: not {}", places.join("; not "));
    Err(Failure::input(message).help("start it with `cargo xtask`, or anywhere in the workspace of fisura"))
}

/// Whether it is a folder of references: other projects may have one of this name.
fn has_sources(folder: &Path) -> bool {
    let mut entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.any(|entry| entry.path().join("source.toml").is_file())
}

/// A file as it is named from the current folder or else from the root of the workspace.
///
/// # Errors
/// If it is in neither; the message names both.
pub fn find(path: &Path) -> Result<PathBuf, Failure> {
    let places = [PathBuf::new(), workspace()];
    if let Some(found) = places.iter().map(|place| place.join(path)).find(|found| found.exists()) {
        return Ok(found);
    }
    let mut looked = vec![env::current_dir().unwrap_or_default()];
    looked.extend(places.into_iter().filter(|place| path.is_relative() && *place != PathBuf::new()));
    let looked: Vec<String> = looked.iter().map(|place| place.display().to_string()).collect();
    let message = format!("there is no {}: looked in {}", path.display(), looked.join(" and "));
    Err(Failure::input(message).help("give the path from the current folder or from the root of the workspace"))
}

/// The folder of `--out`, or `target/fisura/<command>`: made if it is not there, writable, and locked for
/// this process.
///
/// # Errors
/// If it cannot be had, see [`OutputFolder::open`]: better now than after an hour.
pub fn output(common: &Common, command: &str) -> Result<OutputFolder, Failure> {
    let default = || workspace().join("target/fisura").join(command);
    let folder = OutputFolder::open(&common.out.clone().unwrap_or_else(default), command)?;
    note_without_lock(common, &folder);
    Ok(folder)
}

/// Says so if nothing keeps another process from writing to the folder as well.
pub fn note_without_lock(common: &Common, folder: &OutputFolder) {
    if !folder.is_locked() {
        let folder = folder.path().display();
        console::note(
            common,
            &format!(
                "warning: the file system of {folder} does not support locks: run one command at a time in this folder"
            ),
        );
    }
}
