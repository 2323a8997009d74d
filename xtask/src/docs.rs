//! `report --docs`: the generated parts of README and book, see [`fisura_reports::docs`].

use std::fs;
use std::path::{Path, PathBuf};

use clap::CommandFactory;
use fisura_reports::docs::{Stored, rewritten};
use fisura_reports::judge::{board_of_the_book, stored_boards};
use fisura_reports::read_results;
use fisura_verification::record::ResultSet;
use serde_json::json;

use crate::cli::{Cli, Common, Format};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::unreadable;
use crate::{console, folders};

/// Folder of the book, and the file in it that holds what its tables show.
const BOOK: &str = "reports/book";
const STORED: &str = "records.json";
/// Folder of the figures of the book.
const FIGURES: &str = "src/figures";

/// Stores what `from` holds, if it is given, and writes every generated part anew; names the files that
/// changed.
///
/// # Errors
/// Results or documents that cannot be read or written, or a block that nobody knows.
pub fn docs(from: Option<&PathBuf>, common: &Common) -> Result<Exit, Failure> {
    let root = folders::workspace();
    let mut changed = Vec::new();
    let mut store = |path: PathBuf, text: String| -> Result<(), Failure> {
        if fs::read_to_string(&path).is_ok_and(|old| old == text) {
            return Ok(());
        }
        let unwritable = |error| Failure::new(Exit::BadInput, format!("{} cannot be written: {error}", path.display()));
        fs::write(&path, text).map_err(unwritable)?;
        changed.push(path.display().to_string());
        Ok(())
    };
    if let Some(from) = from {
        let set = read_results(from).map_err(|error| unreadable(error, from))?;
        refuse_parts(&set, from)?;
        let stored = Stored::of(&set);
        for figure in &stored.figures {
            let name = format!("{}.svg", figure.id);
            let drawn = from.join("figures").join(&name);
            let missing = |error| Failure::new(Exit::BadInput, format!("{}: {error}", drawn.display()));
            let text = fs::read_to_string(&drawn).map_err(missing)?;
            store(root.join(BOOK).join(FIGURES).join(&name), text)?;
        }
        let text = serde_json::to_string_pretty(&stored).unwrap_or_default() + "\n"; // plain data
        store(root.join(BOOK).join(STORED), text)?;
    }
    for (path, text) in anew(&root)? {
        store(path, text)?;
    }
    match common.format {
        Format::Json => console::json(&json!({ "files": changed })),
        Format::Text => console::result(&changed.iter().map(|file| format!("{file}\n")).collect::<String>()),
    }
    Ok(Exit::Done)
}

/// Numbers of an unfinished run, or of some suites only, would stand in the book as if they were all.
fn refuse_parts(set: &ResultSet, from: &Path) -> Result<(), Failure> {
    if set.is_unfinished() || Stored::of(set).block("suite plate").is_none() {
        let message = format!("{} does not hold all suites", from.display());
        return Err(Failure::new(Exit::BadInput, message).help("run `cargo xtask verify` to its end"));
    }
    Ok(())
}

/// Every document with its generated parts as they should be, and the drawings of the board.
fn anew(root: &Path) -> Result<Vec<(PathBuf, String)>, Failure> {
    let bad = |path: &Path, error: String| Failure::new(Exit::BadInput, format!("{}: {error}", path.display()));
    let stored = Stored::read(&root.join(BOOK), STORED)?;
    let source = root.join(BOOK).join("src");
    let entries = fs::read_dir(&source).map_err(|error| bad(&source, error.to_string()))?;
    let mut paths: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    paths.push(root.join("README.md"));
    paths.sort();
    let one = |path: PathBuf| {
        let text = fs::read_to_string(&path).map_err(|error| bad(&path, error.to_string()))?;
        let block = |name: &str| match name {
            "commands" => Some(commands()),
            "board" => Some(board_of_the_book()),
            _ => stored.block(name),
        };
        let text = rewritten(&text, block).map_err(|error| bad(&path, error))?;
        Ok((path, text))
    };
    let figures = root.join(BOOK).join(FIGURES);
    let boards = stored_boards().into_iter().map(|board| Ok((figures.join(board.file), board.svg.to_string())));
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
    fn the_documents_say_what_is_stored_and_what_the_command_line_offers() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let documents = anew(&root).unwrap();
        for (path, text) in &documents {
            let found = fs::read_to_string(path).unwrap();
            assert!(found == *text, "{} is out of date: cargo xtask report --docs", path.display());
        }
        let all: String = documents.iter().map(|(_, text)| text.as_str()).collect();
        for block in ["suites", "verdict", "commands", "board", "suite plate", "orders convergence"] {
            assert!(all.contains(&format!("<!-- docs: {block} -->")), "no document has the block {block}");
        }
        assert!(commands().contains("## verify") && commands().contains("--partition <slice:K/N>"));
    }

    #[test]
    fn every_figure_of_the_book_is_one_of_the_stored_results() {
        let book = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(BOOK);
        let stored = Stored::read(&book, STORED).unwrap();
        let mut named: Vec<String> = stored.figures.iter().map(|figure| format!("{}.svg", figure.id)).collect();
        named.extend(stored_boards().iter().map(|board| board.file.to_string()));
        let files = fs::read_dir(book.join(FIGURES)).unwrap();
        let mut found: Vec<String> = files.map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        named.sort();
        found.sort();
        assert_eq!(named, found);
    }
}
