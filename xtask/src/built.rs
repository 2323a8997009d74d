//! What this program was built from, as `build.rs` found it: the work tree may be another one by now.

/// Commit that was checked out, or `unknown`.
pub const COMMIT: &str = env!("FISURA_COMMIT");

/// Fingerprint of the sources of all crates: it tells uncommitted changes apart.
pub const SOURCES: &str = env!("FISURA_SOURCES");

/// Name, version, commit and sources in words.
pub fn program() -> String {
    format!("fisura {} of commit {COMMIT}, sources {SOURCES}", env!("CARGO_PKG_VERSION"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commit_and_sources_are_fingerprints() {
        let is_hexadecimal = |text: &str| text.chars().all(|c| c.is_ascii_hexdigit());
        assert!(COMMIT == "unknown" || (COMMIT.len() == 40 && is_hexadecimal(COMMIT)), "{COMMIT}");
        assert!(SOURCES.len() == 16 && is_hexadecimal(SOURCES), "{SOURCES}");
    }
}
