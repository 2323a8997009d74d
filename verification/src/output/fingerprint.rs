//! Fingerprints of texts and of folders of data.

use std::path::Path;

use sha2::{Digest, Sha256};

use super::OutputError;

/// The first 16 hexadecimal digits of the SHA-256 of some texts, each ended by a zero byte.
pub fn fingerprint<T: AsRef<[u8]>>(texts: impl IntoIterator<Item = T>) -> String {
    let mut hasher = Sha256::new();
    for text in texts {
        hasher.update(text.as_ref());
        hasher.update([0]);
    }
    hasher.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// Fingerprint of all TOML and CSV files below a folder, with their names.
///
/// # Errors
/// A file that cannot be read.
pub fn folder_fingerprint(folder: &Path) -> Result<String, OutputError> {
    let mut texts: Vec<Vec<u8>> = Vec::new();
    for ending in ["toml", "csv"] {
        let pattern = folder.join("**").join(format!("*.{ending}"));
        for path in glob::glob(&pattern.to_string_lossy()).into_iter().flatten().flatten() {
            let name = path.strip_prefix(folder).unwrap_or(&path).to_string_lossy().replace('\\', "/");
            texts.push(name.into_bytes());
            texts.push(std::fs::read(&path).map_err(|e| OutputError::unreadable(&path, e))?);
        }
    }
    Ok(fingerprint(texts))
}
