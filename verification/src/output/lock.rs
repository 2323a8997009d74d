//! One process at a time: a lock on a file of the folder, which names who holds it.
//!
//! The file stays when the lock goes: who removed it could remove that of another process.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

use super::error::OutputError;

/// Name of the file that is locked.
pub(super) const LOCK: &str = ".fisura.lock";

/// Most bytes of a command line that are told.
const SHOWN: u64 = 300;

/// Takes the lock of a folder; `None` where the file system has none.
///
/// # Errors
/// If another process holds it, or the file cannot be written or is a link.
pub(super) fn take(folder: &Path) -> Result<Option<File>, OutputError> {
    let path = folder.join(LOCK);
    if fs::symlink_metadata(&path).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(OutputError::foreign(&path));
    }
    let failed = |error: std::io::Error| OutputError::folder(folder, error);
    let options = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
    let mut file = options.map_err(failed)?;
    match file.try_lock() {
        Ok(()) => {
            file.set_len(0).map_err(failed)?;
            file.write_all(this_process().as_bytes()).map_err(failed)?;
            Ok(Some(file))
        }
        Err(TryLockError::WouldBlock) => {
            let mut holder = String::new();
            let _ = file.take(SHOWN).read_to_string(&mut holder); // some systems do not let it be read
            let holder = holder.trim();
            Err(OutputError::in_use(folder, if holder.is_empty() { "another process" } else { holder }))
        }
        Err(TryLockError::Error(error)) if error.kind() == ErrorKind::Unsupported => Ok(None),
        Err(TryLockError::Error(error)) => Err(failed(error)),
    }
}

/// Number and command line of this process.
fn this_process() -> String {
    let mut words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let program = words.next().unwrap_or_default();
    let program = Path::new(&program).file_name().map_or(program.clone(), |name| name.to_string_lossy().into_owned());
    let line: Vec<String> = std::iter::once(program).chain(words).collect();
    format!("process {}: {}\n", std::process::id(), line.join(" ").escape_debug())
}
