//! What this program was built from, as `build.rs` found it: the work tree may be another one by now.

/// Fingerprint of the sources of all crates: it tells uncommitted changes apart.
pub const SOURCES: &str = env!("FISURA_SOURCES");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sources_have_a_fingerprint() {
        assert!(SOURCES.len() == 16 && SOURCES.chars().all(|c| c.is_ascii_hexdigit()), "{SOURCES}");
    }
}
