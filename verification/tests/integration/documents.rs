//! README and METHODOLOGY name only files and cases that exist.

use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Pieces of a document between two marks on one line.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    let lines = text.lines();
    lines.flat_map(|line| line.split(open).skip(1).filter_map(|rest| rest.split(close).next())).collect()
}

#[test]
fn every_link_leads_to_a_file() {
    for document in [
        "README.md",
        "METHODOLOGY.md",
        "verification/TUTORIAL.md",
        "reports/gallery/README.md",
        "reference-data/README.md",
    ] {
        let path = root().join(document);
        let text = std::fs::read_to_string(&path).unwrap();
        for link in between(&text, "](", ")").into_iter().filter(|l| !l.starts_with("http") && !l.starts_with('#')) {
            let file = path.parent().unwrap().join(link.split('#').next().unwrap());
            assert!(file.exists(), "{document} links to {link}");
        }
    }
}

#[test]
fn every_case_that_is_named_exists() {
    for document in ["README.md", "METHODOLOGY.md"] {
        let text = std::fs::read_to_string(root().join(document)).unwrap();
        let mut named = 0;
        for word in text.split('`').skip(1).step_by(2) {
            let Some((suite, case)) = word.split_once('/') else { continue };
            let plain = case.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') && !case.is_empty();
            if ["contact", "convergence", "energy", "fracture", "manufactured", "patch", "plate", "stability"]
                .contains(&suite)
                && plain
            {
                let file = root().join(format!("verification/cases/{suite}/{case}.toml"));
                let quantity = text.contains(&format!("`{word}` quantity"));
                assert!(file.exists() || quantity, "{document} names the case {word}");
                named += 1;
            }
        }
        assert!(named > 0, "{document} names no case: has the spelling changed?");
    }
}
