//! One process at a time: a lock on a file of the folder, which names who holds it.
//!
//! The file stays when the lock goes: who removed it could remove that of another process.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{Error, ErrorKind, Read, Write};
use std::path::Path;

use super::error::OutputError;

/// Name of the file that is locked.
pub(super) const LOCK: &str = ".fisura.lock";

/// Most bytes of a command line that are told.
const SHOWN: u64 = 300;

/// Takes the lock of a folder; `None` where the file system has none.
///
/// # Errors
/// If another process holds it, or the file cannot be written, is a link, or has a second name elsewhere.
pub(super) fn take(folder: &Path) -> Result<Option<File>, OutputError> {
    let path = folder.join(LOCK);
    if fs::symlink_metadata(&path).is_ok_and(|metadata| !is_own(&metadata)) {
        return Err(OutputError::foreign(&path));
    }
    let failed = |error: Error| OutputError::folder(folder, error);
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
        Err(TryLockError::Error(error)) if has_no_locks(&error) => Ok(None),
        Err(TryLockError::Error(error)) => Err(failed(error)),
    }
}

/// Whether it is a file that has no other name: through that its content would be lost.
fn is_own(metadata: &Metadata) -> bool {
    #[cfg(unix)]
    let names = std::os::unix::fs::MetadataExt::nlink(metadata);
    #[cfg(not(unix))]
    let names = 1;
    metadata.is_file() && names == 1
}

/// Whether the file system has no locks; those on a network say so in their own way.
fn has_no_locks(error: &Error) -> bool {
    #[cfg(unix)]
    let unavailable = error.raw_os_error() == Some(rustix::io::Errno::NOLCK.raw_os_error());
    #[cfg(not(unix))]
    let unavailable = false;
    unavailable || error.kind() == ErrorKind::Unsupported
}

/// Number and command line of this process.
fn this_process() -> String {
    let mut words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let program = words.next().unwrap_or_default();
    let program = Path::new(&program).file_name().map_or(program.clone(), |name| name.to_string_lossy().into_owned());
    let line: Vec<String> = std::iter::once(program).chain(words).collect();
    format!("process {}: {}\n", std::process::id(), line.join(" ").escape_debug())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_file_system_without_locks_is_told_from_other_failures() {
        let error = |number: rustix::io::Errno| Error::from_raw_os_error(number.raw_os_error());
        assert!(has_no_locks(&error(rustix::io::Errno::NOLCK)) && has_no_locks(&ErrorKind::Unsupported.into()));
        assert!(!has_no_locks(&error(rustix::io::Errno::ACCESS)));
    }
}
