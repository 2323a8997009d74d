//! Where files are read and written.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;

/// Root of the workspace as cargo tells it, else the current folder.
pub fn workspace() -> PathBuf {
    let manifest = env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
    let root = manifest.and_then(|crate_folder| crate_folder.parent().map(Path::to_path_buf));
    root.filter(|root| root.join("Cargo.toml").is_file()).unwrap_or_default()
}

/// The folder of `--out`, or `target/fisura/<command>`; made if it is not there, and known to be writable.
///
/// # Errors
/// If it cannot be made or written: better now than after an hour.
pub fn output(common: &Common, command: &str) -> Result<PathBuf, Failure> {
    let default = || workspace().join("target/fisura").join(command);
    let folder = common.out.clone().unwrap_or_else(default);
    let probe = folder.join(".fisura-writable.part");
    let written =
        fs::create_dir_all(&folder).and_then(|()| fs::write(&probe, "")).and_then(|()| fs::remove_file(&probe));
    match written {
        Ok(()) => Ok(folder),
        Err(error) => {
            let message = format!("the output folder {} cannot be written: {error}", folder.display());
            Err(Failure::new(Exit::BadInput, message).help("give a folder that can be written with --out"))
        }
    }
}
