//! Lines of comment stay short enough to be read beside other windows.

use std::fs;
use std::path::Path;

use super::folds::sources;

/// Most characters of a line of comment, indentation included.
const WIDTH: usize = 110;

/// Numbers of the lines of a source that hold a comment and are too long.
fn findings(text: &str) -> Vec<usize> {
    let is_comment = |line: &str| line.trim_start().starts_with("//");
    let too_long = |line: &&str| is_comment(line) && line.chars().count() > WIDTH;
    text.lines().zip(1..).filter(|(line, _)| too_long(line)).map(|(_, number)| number).collect()
}

#[test]
fn lines_of_comment_fit() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut files = Vec::new();
    for folder in ["solver", "verification", "reports", "xtask", "reference-data"] {
        sources(&root.join(folder), &mut files);
    }
    assert!(files.len() > 100, "only {} sources", files.len());
    let of = |file: &std::path::PathBuf| {
        let lines = findings(&fs::read_to_string(file).unwrap());
        lines.into_iter().map(|line| format!("{}:{line}", file.display())).collect::<Vec<_>>()
    };
    let found: Vec<String> = files.iter().flat_map(of).collect();
    assert!(found.is_empty(), "longer than {WIDTH} characters:\n{}", found.join("\n"));
}

#[test]
fn long_lines_are_found() {
    let long = format!("let x = 1;\n    //! {}\n", "a".repeat(WIDTH));
    assert_eq!(findings(&long), [2]);
    assert_eq!(findings(&format!("let x = \"{}\";", "a".repeat(WIDTH))), [0; 0]);
}
