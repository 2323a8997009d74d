//! `judge FOLDER…`: results of any code held against the benchmarks.

use std::fs;
use std::path::{Path, PathBuf};

use fisura_reports::judge::{board, board_markdown, board_page, page, render_text};
use fisura_verification::judge::template::template;
use fisura_verification::judge::verdict::{Outcome, SCHEMA, VerdictSet};
use fisura_verification::judge::{BENCHMARKS, Judged, judge as judge_one};
use fisura_verification::reference::Library;
use fisura_verification::suite::VerifyError;

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders};

/// Arguments of `judge`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folders, each with a submission.toml and the files that it names
    #[arg(value_name = "FOLDER", required_unless_present_any = ["new", "board"])]
    folders: Vec<PathBuf>,
    /// Write a commented submission.toml for a benchmark to standard output
    #[arg(long, value_name = "BENCHMARK", conflicts_with_all = ["folders", "board"], value_parser = BENCHMARKS.map(|b| b.name))]
    new: Option<String>,
    /// Errors of all submissions in reference-data/submissions, and of the folders given
    #[arg(long)]
    board: bool,
    /// Compare the plate with this reference instead of the nearest variant: slit, plane-stress,
    /// low-traction, …
    #[arg(long, value_name = "ID")]
    against: Option<String>,
}

/// Judges submissions; writes `verdict.json` and `judge.html`.
///
/// # Errors
/// A submission that cannot be read, with file, line and column; a file that cannot be written.
pub fn judge(args: &Args, common: &Common) -> Result<Exit, Failure> {
    if let Some(benchmark) = &args.new {
        console::no_files(common, "judge --new");
        console::result(&template(benchmark));
        return Ok(Exit::Done);
    }
    let data = folders::reference_data()?;
    let library = Library::load(&data).map_err(VerifyError::from)?;
    let mut all = if args.board { submissions(&data.join("submissions"))? } else { Vec::new() };
    all.extend(args.folders.iter().cloned());
    let judged = all.iter().map(|folder| Ok(judge_one(folder, &library, &data, args.against.as_deref())?));
    let mut judged = judged.collect::<Result<Vec<Judged>, Failure>>()?;
    for one in &mut judged {
        let root = data.parent().unwrap_or(&data);
        let shown = Path::new(&one.verdict.folder).strip_prefix(root).ok().map(Path::to_path_buf);
        one.verdict.folder = shown.map_or(one.verdict.folder.clone(), |path| path.display().to_string());
    }
    let set = VerdictSet { schema: SCHEMA.into(), verdicts: judged.iter().map(|j| j.verdict.clone()).collect() };
    write(args, common, &judged, &set)?;
    let text = || if args.board { sentences(&judged) } else { render_text(&set) };
    console::show(common, &set, text);
    let holds = set.verdicts.iter().all(|v| matches!(v.outcome, Outcome::Pass | Outcome::Diagnostic));
    Ok(if args.board || holds { Exit::Done } else { Exit::CheckFailed })
}

fn write(args: &Args, common: &Common, judged: &[Judged], set: &VerdictSet) -> Result<(), Failure> {
    let folder = folders::output(common, "judge")?;
    folder.begin(|_| false)?;
    folder.write_json("verdict.json", set)?;
    let unfilled = |error| Failure::input(format!("the page cannot be made: {error}"));
    if args.board {
        folder.write("board.html", board_page(judged).map_err(unfilled)?)?;
        let boards = board(judged);
        folder.write("board.md", board_markdown(&boards))?;
        for board in boards.iter().filter(|b| !b.svg.is_empty()) {
            folder.write(&format!("board-{}.svg", board.key), &board.svg)?;
        }
    } else {
        folder.write("judge.html", page(judged).map_err(unfilled)?)?;
    }
    folder.finish()?;
    Ok(())
}

/// The folders of all submissions of the project, in the order of their names.
fn submissions(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let missing = |e| {
        let message = format!("{} cannot be read: {e}", folder.display());
        Failure::input(message).help("restore the folder of the submissions")
    };
    let entries = fs::read_dir(folder).map_err(missing)?;
    let mut found: Vec<PathBuf> = entries.flatten().map(|e| e.path()).filter(|p| p.is_dir()).collect();
    found.sort();
    Ok(found)
}

fn sentences(judged: &[Judged]) -> String {
    board(judged).iter().map(|b| format!("{}\n  {}\n", b.title, b.sentence)).collect()
}
