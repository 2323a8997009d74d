//! Files on their way to their names.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Result};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

/// Names begin and end so, with six random characters between.
pub(super) const TEMPORARY: &str = ".fisura-";
pub(super) const PART: &str = ".part";

/// A new file of a name that did not exist, with the permissions that any new file gets; it goes unless it is
/// renamed. `list` hears the name before the file is there: a process that is killed leaves none that nobody
/// knows.
pub(super) fn create(folder: &Path, mut list: impl FnMut(&str) -> Result<()>) -> Result<NamedTempFile<File>> {
    Builder::new().prefix(TEMPORARY).suffix(PART).make_in(folder, |path| {
        if fs::symlink_metadata(path).is_ok() {
            return Err(ErrorKind::AlreadyExists.into()); // another name is drawn, and this one not listed
        }
        list(&path.file_name().unwrap_or_default().to_string_lossy())?;
        OpenOptions::new().read(true).write(true).create_new(true).open(path)
    })
}

/// Whether a file was made by [`create`], by its name.
pub(super) fn is_temporary(name: &str) -> bool {
    let name = name.rsplit('/').next().unwrap_or(name);
    name.starts_with(TEMPORARY) && name.ends_with(PART)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_listed_before_its_file_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let count = || fs::read_dir(folder.path()).unwrap().count();
        let mut listed = Vec::new();
        let file = create(folder.path(), |name| {
            assert!(is_temporary(name) && count() == 0);
            listed.push(name.to_string());
            Ok(())
        });
        let file = file.unwrap();
        assert_eq!(listed, [file.path().file_name().unwrap().to_string_lossy()]);
        drop(file);
        assert!(create(folder.path(), |_| Err(ErrorKind::StorageFull.into())).is_err());
        assert_eq!(count(), 0, "what cannot be listed is not made");
    }
}
