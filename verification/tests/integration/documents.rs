//! The documents and the chapters of the book name only files, headings and cases that exist.

use std::path::{Path, PathBuf};

const BOOK: &str = "reports/book/src";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(document: &str) -> String {
    std::fs::read_to_string(root().join(document)).unwrap()
}

/// File names of the book.
fn chapters() -> Vec<String> {
    let files = std::fs::read_dir(root().join(BOOK)).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    files.filter(|name| name.ends_with(".md")).collect()
}

/// Some documents, and every file of the book.
fn with_the_book(documents: &[&str]) -> Vec<String> {
    let chapters = chapters().into_iter().map(|name| format!("{BOOK}/{name}"));
    documents.iter().map(ToString::to_string).chain(chapters).collect()
}

/// Pieces of a document between two marks on one line.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Vec<&'a str> {
    let lines = text.lines();
    lines.flat_map(|line| line.split(open).skip(1).filter_map(|rest| rest.split(close).next())).collect()
}

/// The name by which links find a heading, on GitHub and in the book.
fn anchor(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect::<String>().to_lowercase()
}

#[test]
fn every_link_leads_to_a_file_and_its_heading() {
    for document in
        with_the_book(&["README.md", "CHANGELOG.md", "reports/gallery/README.md", "reference-data/README.md"])
    {
        let text = read(&document);
        for link in between(&text, "](", ")").into_iter().filter(|link| !link.starts_with("http")) {
            let (name, heading) = link.split_once('#').unwrap_or((link, ""));
            let path = root().join(&document);
            let file = if name.is_empty() { path } else { path.parent().unwrap().join(name) };
            assert!(file.exists(), "{document} links to {link}");
            if !heading.is_empty() {
                let target = std::fs::read_to_string(&file).unwrap();
                let mut headings = target.lines().filter_map(|line| line.strip_prefix('#'));
                let found = headings.any(|line| anchor(line.trim_start_matches('#')) == heading);
                assert!(found, "{document} links to {link}, and there is no such heading");
            }
        }
    }
}

#[test]
fn the_summary_of_the_book_names_every_chapter() {
    let summary = read(&format!("{BOOK}/SUMMARY.md"));
    for name in chapters().into_iter().filter(|name| name != "SUMMARY.md") {
        assert!(summary.contains(&format!("]({name})")), "{name} is not in SUMMARY.md");
    }
}

#[test]
fn every_case_that_is_named_exists() {
    let mut naming = Vec::new();
    for document in with_the_book(&["README.md"]) {
        let text = read(&document);
        for word in text.split('`').skip(1).step_by(2) {
            let Some((suite, case)) = word.split_once('/') else { continue };
            let plain = case.chars().all(|c| c.is_ascii_alphanumeric() || c == '-') && !case.is_empty();
            if root().join("verification/cases").join(suite).is_dir() && plain {
                let file = root().join(format!("verification/cases/{suite}/{case}.toml"));
                let quantity = text.contains(&format!("`{word}` quantity"));
                assert!(file.exists() || quantity, "{document} names the case {word}");
                naming.push(document.clone());
            }
        }
    }
    for document in ["discretisation", "results", "add-a-case"].map(|chapter| format!("{BOOK}/{chapter}.md")) {
        assert!(naming.contains(&document), "{document} names no case: has the spelling changed?");
    }
}

#[test]
fn the_cases_shown_in_the_book_are_the_files() {
    let text = read(&format!("{BOOK}/add-a-case.md"));
    for case in ["energy/free-vibration", "convergence/kirsch-plane-strain"] {
        let file = read(&format!("verification/cases/{case}.toml"));
        assert!(
            text.contains(&format!("```toml\n{file}```")),
            "{BOOK}/add-a-case.md shows another {case} than its file"
        );
    }
}

#[test]
fn exact_solutions_and_keys_of_convergence_cases_have_their_lines() {
    let cases = read(&format!("{BOOK}/add-a-case.md"));
    for solution in fisura_verification::exact::all() {
        let row = format!("| `{}` |", solution.name);
        assert!(cases.lines().any(|line| line.starts_with(&row)), "add-a-case.md has no row {row}");
    }
    let schema = fisura_verification::case::json_schema();
    let keys = schema["$defs"]["ConvergenceTable"]["properties"].as_object().unwrap();
    assert!(keys.len() > 10);
    for key in keys.keys() {
        assert!(
            cases.contains(&format!("`{key}")) || cases.contains(&format!("\n{key} = ")),
            "add-a-case.md lacks `{key}`"
        );
    }
    let patches = schema["$defs"]["PatchFamily"]["oneOf"].as_array().unwrap();
    assert!(patches.len() > 5);
    for name in patches.iter().map(|patch| patch["const"].as_str().unwrap()) {
        assert!(cases.contains(&format!("`{name}`")), "add-a-case.md lacks the patch `{name}`");
    }
}

#[test]
fn every_key_of_a_scene_has_its_line() {
    let page = read(&format!("{BOOK}/scenes.md"));
    let sources = ["read.rs", "read_body.rs", "read_load.rs", "read_mesh.rs"];
    let text: String = sources.iter().map(|name| read(&format!("verification/src/scene/{name}"))).collect();
    let asks = ["need", "or", "maybe", "get"].map(|ask| format!("fields.{ask}(\""));
    let asked = asks.iter().flat_map(|ask| text.split(ask.as_str()).skip(1));
    let keys: Vec<&str> = asked.filter_map(|rest| rest.split('"').next()).collect();
    assert!(keys.len() > 50, "{keys:?}");
    for key in keys {
        let forms = [format!("`{key}"), format!("{{ {key} ="), format!("[{key}]")];
        assert!(forms.iter().any(|form| page.contains(form)), "scenes.md lacks `{key}`");
    }
}
