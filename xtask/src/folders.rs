//! Where files are read and written.

use std::env;
use std::path::{Path, PathBuf};

use fisura_verification::output::OutputFolder;

use crate::cli::Common;
use crate::console;
use crate::failure::Failure;

/// Root of the workspace as cargo tells it, else the current folder.
pub fn workspace() -> PathBuf {
    let manifest = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let root = manifest.and_then(|crate_folder| crate_folder.parent().map(Path::to_path_buf));
    root.filter(|root| root.join("Cargo.toml").is_file()).unwrap_or_default()
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
