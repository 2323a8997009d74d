//! `report DIR`: the report of stored results once more.

use std::fs;
use std::path::{Path, PathBuf};

use fisura_reports::{ReportError, bench, read_results, render};
use fisura_verification::output::replace_file;
use serde_json::json;

use crate::cli::{Common, Format};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, folders};

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder with results.json or bench.json; the report is written there, or to --out
    #[arg(value_name = "DIR")]
    folder: PathBuf,
}

/// Renders a results folder and names the files written.
///
/// # Errors
/// `results.json` is missing or foreign, or there beside `bench.json`, a file cannot be written, or a figure cannot be drawn.
pub fn report(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let of_bench = bench::is_bench(&args.folder);
    if of_bench && args.folder.join("results.json").is_file() {
        let message = format!("{}: results.json and bench.json are both there", args.folder.display());
        return Err(Failure::new(Exit::BadInput, message)
            .help("their reports have files of the same names; give one of them a folder of its own"));
    }
    if of_bench {
        bench::read(&args.folder)?;
    } else {
        read_results(&args.folder).map_err(|error| unreadable(error, &args.folder))?;
    }
    let folder = match &common.out {
        Some(_) => copied(&args.folder, if of_bench { "bench.json" } else { "results.json" }, common)?,
        None => args.folder.clone(),
    };
    let rendered = if of_bench { bench::render(&folder)? } else { render(&folder)?.files };
    let files: Vec<String> = rendered.iter().map(|f| folder.join(f).display().to_string()).collect();
    match common.format {
        Format::Json => console::json(&json!({ "files": files })),
        Format::Text => console::result(&(files.join("\n") + "\n")),
    }
    Ok(Exit::Done)
}

/// Results that cannot be read, with what would help.
pub fn unreadable(error: ReportError, folder: &Path) -> Failure {
    let missing = !folder.join("results.json").is_file();
    let help =
        if missing { "give the folder that `cargo xtask verify` wrote" } else { "run `cargo xtask verify` again" };
    Failure::from(error).help(help)
}

/// The results and their series in the folder of `--out`.
fn copied(from: &Path, results: &str, common: &Common) -> Result<PathBuf, Failure> {
    let to = folders::output(common, "report")?;
    let same = fs::canonicalize(from).ok() == fs::canonicalize(&to).ok();
    if !same {
        copy(&from.join(results), &to.join(results))?;
        if from.join("series").is_dir() {
            copy(&from.join("series"), &to.join("series"))?;
        }
    }
    Ok(to)
}

/// Copies a file, or a folder with all that is in it.
fn copy(from: &Path, to: &Path) -> Result<(), Failure> {
    let fail = |error: std::io::Error| {
        Failure::new(Exit::BadInput, format!("{} cannot be copied to {}: {error}", from.display(), to.display()))
    };
    if !from.is_dir() {
        return Ok(replace_file(to, |part| Ok(fs::copy(from, part).map(|_| ())?))?);
    }
    fs::create_dir_all(to).map_err(fail)?;
    for entry in fs::read_dir(from).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}
