//! Files on their way to their names.

use std::path::Path;

use tempfile::{Builder, NamedTempFile};

/// Names begin and end so, with six random characters between.
pub(super) const TEMPORARY: &str = ".fisura-";
pub(super) const PART: &str = ".part";

/// A new file of a name that did not exist, with the permissions that any new file gets; it goes unless it is renamed.
pub(super) fn create(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(TEMPORARY).suffix(PART);
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// Whether a file was made by [`create`], by its name.
pub(super) fn is_temporary(name: &str) -> bool {
    let name = name.rsplit('/').next().unwrap_or(name);
    name.starts_with(TEMPORARY) && name.ends_with(PART)
}
