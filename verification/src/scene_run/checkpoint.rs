//! The file of a run that can be taken up: four lines of text, what the run gathered with the state of its
//! simulation, and a check sum of all that.
//!
//! ```text
//! fisura checkpoint 4
//! <name, version, commit and sources of the program>
//! <fingerprint of the scene>
//! <its title>
//! ```

use std::fmt::Display;
use std::fs::File;
use std::io::{BufRead, BufReader, ErrorKind, Read};
use std::path::Path;

use fisura::scene::Scene;
use serde::{Deserialize, Serialize};

use super::Record;
use crate::output::fingerprint::fingerprint;
use crate::output::{OutputError, OutputFolder};

/// First line of the file, with the version of its form.
const FORM: &str = "fisura checkpoint 4";
/// What every version begins with.
const MAGIC: &str = "fisura checkpoint ";
/// Most bytes of a line of the head.
const LINE: u64 = 4096;
/// Most characters of the title.
const TITLE: usize = 200;

/// Name of the file in the output folder of a run.
pub const CHECKPOINT: &str = "checkpoint.bin";

const BEGIN_ANEW: &str = "omit --resume to start again, or give the folder of another run with --out";
const SAME_SCENE: &str = "resume with the scene and the --set values of that run, or omit --resume to start again";
const SAME_PROGRAM: &str = "resume with the program of that run, or omit --resume to start again";

/// A run at a whole step.
#[derive(Debug, Serialize, Deserialize)]
pub struct Stored {
    pub(super) run: Record,
    pub(super) state: Vec<u8>,
    /// Whether the run wrote files of its own at its frames, which then stand in the folder.
    pub frame_files: bool,
}

/// Where a run of a scene keeps its checkpoint.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Name in the folder.
    pub name: String,
    /// Title of the scene whose checkpoint stands in [`CHECKPOINT`], if that is another scene; it stays.
    pub other: Option<String>,
}

/// Where a run of `scene` keeps its checkpoint in a folder: [`CHECKPOINT`], unless the run of another scene
/// has it.
pub fn find(folder: &Path, scene: &Scene) -> Place {
    let own = scene_print(scene);
    let name = format!("checkpoint-{}.bin", &own[..8]);
    let other = match Head::read(&folder.join(CHECKPOINT)) {
        Ok(None) => None,
        Ok(Some(head)) if head.scene == own => None,
        Ok(Some(head)) => Some(head.title),
        Err(_) => Some("unknown".to_string()),
    };
    let name = if other.is_some() || folder.join(&name).exists() { name } else { CHECKPOINT.to_string() };
    Place { name, other }
}

/// Whether a file of an output folder is a checkpoint.
pub fn is_checkpoint(name: &str) -> bool {
    name.starts_with("checkpoint") && name.ends_with(".bin")
}

/// Writes a checkpoint of a run of `scene` by `program`.
///
/// # Errors
/// If the file cannot be written; the one before it then stays.
pub(super) fn write(
    (out, name): (&OutputFolder, &str),
    program: &str,
    scene: &Scene,
    stored: &Stored,
) -> Result<(), OutputError> {
    let failed = |error: postcard::Error| OutputError::unwritable(&out.path().join(name), error);
    let title: String = scene.title.chars().take(TITLE).collect();
    let head = format!("{FORM}\n{program}\n{}\n{}\n", scene_print(scene), title.escape_debug());
    let mut bytes = postcard::to_extend(stored, head.into_bytes()).map_err(failed)?;
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    out.write(name, bytes)
}

/// Reads what a run of the same scene by the same program stored; `None` if there is no such file.
///
/// # Errors
/// A file that cannot be read, is damaged, or belongs to another scene or program.
pub fn read(path: &Path, program: &str, scene: &Scene) -> Result<Option<Stored>, OutputError> {
    let fail = |message: String, remedy| unusable(path, message, remedy);
    let Some(head) = Head::read(path).map_err(|message| fail(message, BEGIN_ANEW))? else { return Ok(None) };
    let bytes = std::fs::read(path).map_err(|error| fail(error.to_string(), BEGIN_ANEW))?;
    let (content, sum) = bytes.split_last_chunk::<4>().unwrap_or((&[], &[0; 4]));
    if crc32fast::hash(content) != u32::from_le_bytes(*sum) {
        return Err(fail("its checksum is wrong: the file is damaged".to_string(), BEGIN_ANEW));
    }
    if head.program != program {
        return Err(fail(format!("it was written by {}, but this program is {program}", head.program), SAME_PROGRAM));
    }
    if head.scene != scene_print(scene) {
        return Err(fail(format!("it belongs to another scene, {:?}", head.title), SAME_SCENE));
    }
    let stored = postcard::from_bytes(content.get(head.length..).unwrap_or_default());
    stored.map(Some).map_err(|error| fail(error.to_string(), BEGIN_ANEW))
}

/// The lines before the binary part.
struct Head {
    program: String,
    scene: String,
    title: String,
    /// Length of these lines with their line ends, in bytes: the binary part starts there.
    length: usize,
}

impl Head {
    /// `None` if there is no file; otherwise, if it is no checkpoint, why.
    fn read(path: &Path) -> Result<Option<Self>, String> {
        let file = match File::open(path) {
            Ok(file) => file,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error.to_string()),
        };
        let mut reader = BufReader::new(file);
        let mut length = 0;
        let mut line = || {
            let mut line = Vec::new();
            reader.by_ref().take(LINE).read_until(b'\n', &mut line).map_err(|e| e.to_string())?;
            length += line.len();
            match line.pop() {
                Some(b'\n') => String::from_utf8(line).map_err(|e| e.to_string()),
                _ => Err("it is not a checkpoint, or it is incomplete".to_string()),
            }
        };
        match line()? {
            form if form == FORM => {}
            form if form.starts_with(MAGIC) => return Err("it has the format of another version".to_string()),
            _ => return Err("it is not a checkpoint".to_string()),
        }
        let [program, scene, title] = [line()?, line()?, line()?];
        Ok(Some(Self { program, scene, title, length }))
    }
}

/// Fingerprint of the scene in SI units with every value that was left out, digits that read back to the same
/// number.
fn scene_print(scene: &Scene) -> String {
    fingerprint([format!("{scene:?}")])
}

/// A checkpoint that a run cannot be taken up from.
fn unusable(path: &Path, message: impl Display, remedy: &str) -> OutputError {
    OutputError::new(format!("{} cannot be resumed: {message}", path.display()), remedy)
}

/// A file whose content does not fit the scene after all.
pub(super) fn unfit(path: &Path, message: impl Display) -> OutputError {
    unusable(path, message, BEGIN_ANEW)
}
