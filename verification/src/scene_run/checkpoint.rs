//! Checkpoints of a run: one file from which the same program goes on with the same scene, bit by bit.
//!
//! ```text
//! fisura checkpoint 1⏎   CRC-32 of the rest   program   scene   run: rows, pictures, times   state of the simulation
//! ```
//!
//! The file appears in full or not at all: see [`replace_file`].

use std::fs;
use std::path::{Path, PathBuf};

use fisura::scene::Scene;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::output::{OutputError, replace_file};

/// First line of the file, with the version of its form.
const FORM: &[u8] = b"fisura checkpoint 1\n";
/// What every version begins with.
const MAGIC: &[u8] = b"fisura checkpoint ";

/// Name of the file in the output folder of a run.
pub const CHECKPOINT: &str = "checkpoint.bin";

/// Why a run cannot be taken up from a file.
#[derive(Debug, Error)]
#[error("{} cannot be taken up: {message}", path.display())]
pub struct CheckpointError {
    /// File.
    pub path: PathBuf,
    /// Reason.
    pub message: String,
    /// What would be right.
    pub remedy: &'static str,
}

const BEGIN_ANEW: &str = "leave out --resume to begin anew, or give the folder of another run with --out";
const SAME_SCENE: &str = "resume with the scene and the --set values of that run, or leave out --resume to begin anew";
const SAME_PROGRAM: &str = "resume with the program of that run, or leave out --resume to begin anew";

/// What a file holds behind its check sum. Who reads it knows scene and program.
#[derive(Debug, Serialize, Deserialize)]
struct Content<R> {
    program: String,
    scene: String,
    run: R,
    state: Vec<u8>,
}

/// Writes a checkpoint of a run of `scene` by `program`.
///
/// # Errors
/// If the file cannot be written; the one before it then stays.
pub(super) fn write<R: Serialize>(
    path: &Path,
    program: &str,
    scene: &Scene,
    run: &R,
    state: Vec<u8>,
) -> Result<(), OutputError> {
    let content = Content { program: program.to_string(), scene: canonical(scene), run, state };
    replace_file(path, |part| {
        let bytes = postcard::to_stdvec(&content)?;
        let mut file = Vec::with_capacity(FORM.len() + 4 + bytes.len());
        file.extend(FORM);
        file.extend(crc32fast::hash(&bytes).to_le_bytes());
        file.extend(bytes);
        Ok(fs::write(part, file)?)
    })
}

/// Reads what [`write`] wrote for the same program and scene; `None` if there is no such file.
///
/// # Errors
/// A file that cannot be read, is damaged, or belongs to another scene or program.
pub(super) fn read<R: for<'de> Deserialize<'de>>(
    path: &Path,
    program: &str,
    scene: &Scene,
) -> Result<Option<(R, Vec<u8>)>, CheckpointError> {
    let fail = |message: String, remedy| CheckpointError { path: path.to_path_buf(), message, remedy };
    let file = match fs::read(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(fail(error.to_string(), BEGIN_ANEW)),
    };
    let Some((sum, bytes)) = file.strip_prefix(FORM).and_then(|rest| rest.split_first_chunk::<4>()) else {
        let other = file.starts_with(MAGIC) && !file.starts_with(FORM);
        let what = if other { "it has the form of another version" } else { "it is no checkpoint, or not all of one" };
        return Err(fail(what.to_string(), BEGIN_ANEW));
    };
    if crc32fast::hash(bytes) != u32::from_le_bytes(*sum) {
        return Err(fail("its check sum is wrong, so it is damaged".to_string(), BEGIN_ANEW));
    }
    // The program comes first: another one may have another form of all that follows.
    let (writer, _) = postcard::take_from_bytes::<String>(bytes).map_err(|e| fail(e.to_string(), BEGIN_ANEW))?;
    if writer != program {
        return Err(fail(format!("it is of {writer}, and this is {program}"), SAME_PROGRAM));
    }
    let content: Content<R> = postcard::from_bytes(bytes).map_err(|e| fail(e.to_string(), BEGIN_ANEW))?;
    if content.scene != canonical(scene) {
        return Err(fail("it is of another scene".to_string(), SAME_SCENE));
    }
    Ok(Some((content.run, content.state)))
}

/// The scene in SI units with every value that was left out, digits that read back to the same number.
fn canonical(scene: &Scene) -> String {
    format!("{scene:?}")
}

impl CheckpointError {
    /// A file whose content does not fit the scene after all.
    pub(super) fn unfit(path: &Path, message: String) -> Self {
        Self { path: path.to_path_buf(), message, remedy: BEGIN_ANEW }
    }
}
