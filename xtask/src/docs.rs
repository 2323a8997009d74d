//! `report --docs`: the generated parts of README and book, see [`fisura_reports::docs`].

use std::fs;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use fisura_reports::docs::{self, rewritten};
use fisura_reports::judge::{board_of_the_book, stored_boards};
use fisura_reports::read_results;
use fisura_verification::record::ResultSet;
use serde_json::json;

use crate::cli::{Cli, Common};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::unreadable;
use crate::{console, folders};

/// Folder of the pages of the book, and of their figures in it.
const PAGES: &str = "reports/book/src";
const FIGURES: &str = "figures";

/// Writes every generated part again, those that show results only if `from` holds results; names the files
/// that changed.
///
/// # Errors
/// Results or documents that cannot be read or written, or a block that nobody knows.
pub fn docs(from: Option<&PathBuf>, common: &Common) -> Result<Exit, Failure> {
    let root = folders::workspace();
    let set = from.map(|from| read_results(from).map_err(|error| unreadable(error, from))).transpose()?;
    let mut files = Vec::new();
    if let (Some(from), Some(set)) = (from, &set) {
        refuse_parts(set, from)?;
        files = figures(&root, from)?;
    }
    files.extend(documents(&root, set.as_ref())?);
    let mut changed = Vec::new();
    for (path, text) in files {
        if fs::read_to_string(&path).is_ok_and(|old| old == text) {
            continue;
        }
        fs::write(&path, text).map_err(|error| bad(&path, format!("cannot be written: {error}")))?;
        changed.push(path.display().to_string());
    }
    console::show(common, &json!({ "files": changed }), || {
        changed.iter().map(|file| format!("{file}\n")).collect::<String>()
    });
    Ok(Exit::Done)
}

fn bad(path: &Path, error: String) -> Failure {
    Failure::input(format!("{}: {error}", path.display()))
}

/// Numbers of an unfinished run, or of some suites only, would stand in README as if they were all.
fn refuse_parts(set: &ResultSet, from: &Path) -> Result<(), Failure> {
    if set.is_unfinished() || !docs::holds_all_suites(set) {
        let message = format!("{} does not hold all suites", from.display());
        return Err(Failure::input(message).help("run `cargo xtask verify` to its end"));
    }
    Ok(())
}

/// The figures of the book that the results have, drawn as there.
fn figures(root: &Path, from: &Path) -> Result<Vec<(PathBuf, String)>, Failure> {
    let folder = root.join(PAGES).join(FIGURES);
    let entries = fs::read_dir(&folder).map_err(|error| bad(&folder, error.to_string()))?;
    let drawn = |path: PathBuf| {
        let text = fs::read_to_string(from.join("figures").join(path.file_name()?)).ok()?;
        Some((path, text))
    };
    Ok(entries.filter_map(|entry| drawn(entry.ok()?.path())).collect())
}

/// Every document with its generated parts as they should be, and the drawings of the board.
fn documents(root: &Path, set: Option<&ResultSet>) -> Result<Vec<(PathBuf, String)>, Failure> {
    let source = root.join(PAGES);
    let entries = fs::read_dir(&source).map_err(|error| bad(&source, error.to_string()))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.push(root.join("README.md"));
    paths.sort();
    let one = |path: PathBuf| {
        let text = fs::read_to_string(&path).map_err(|error| bad(&path, error.to_string()))?;
        let block = |name: &str, old: &str| match name {
            "commands" => Some(commands()),
            "board" => Some(board_of_the_book()),
            _ if docs::shows_results(name) => match set {
                Some(set) => docs::block(set, name),
                None => Some(old.to_string()),
            },
            _ => None,
        };
        let text = rewritten(&text, block).map_err(|error| bad(&path, error))?;
        Ok((path, text))
    };
    let boards = stored_boards().into_iter();
    let boards = boards.map(|board| Ok((source.join(FIGURES).join(board.file), board.svg.to_string())));
    paths.into_iter().map(one).chain(boards).collect()
}

/// Heading of the options that every command has.
const COMMON: &str = "\n\nCommon options:\n";

/// Every command with its options, as the command line itself describes them; those of all commands once.
fn commands() -> String {
    let mut cli = Cli::command();
    cli.build();
    let (mut out, mut common) = (String::new(), String::new());
    for command in cli.get_subcommands_mut().filter(|command| !command.is_hide_set() && command.get_name() != "help") {
        let name = command.get_name().to_string();
        let help = command.clone().term_width(100).render_help().to_string();
        let help: Vec<&str> = help.lines().map(str::trim_end).collect();
        let help = help.join("\n");
        let (own, of_all) = help.split_once(COMMON).unwrap_or((&help, ""));
        out.push_str(&format!("## {name}\n\n```text\n{}\n```\n\n", own.trim_end()));
        common = of_all.trim_end().to_string();
    }
    out.push_str(&format!("## Options of every command\n\n```text\n{common}\n```\n"));
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_documents_show_what_the_command_line_offers_and_the_board() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let documents = documents(&root, None).unwrap();
        for (path, text) in &documents {
            let found = fs::read_to_string(path).unwrap();
            assert!(found == *text, "{} is out of date: cargo xtask report --docs", path.display());
        }
        let all: String = documents.iter().map(|(_, text)| text.as_str()).collect();
        for block in ["suites", "verdict", "commands", "board"] {
            assert!(all.contains(&format!("<!-- docs: {block} -->")), "no document has the block {block}");
        }
        assert!(commands().contains("## verify") && commands().contains("--partition <slice:K/N>"));
    }

    #[test]
    fn every_figure_of_the_book_is_shown() {
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(PAGES);
        let pages = fs::read_dir(&book).unwrap().filter_map(|page| fs::read_to_string(page.unwrap().path()).ok());
        let text: String = pages.collect();
        for file in fs::read_dir(book.join(FIGURES)).unwrap() {
            let name = file.unwrap().file_name().into_string().unwrap();
            assert!(text.contains(&format!("{FIGURES}/{name}")), "no page shows {name}");
        }
    }
}
