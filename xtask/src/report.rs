//! `report DIR`: the report of stored results once more.

use std::fs;
use std::io::Error;
use std::path::{Path, PathBuf};

use fisura_reports::{ReportError, bench, read_results, render};
use fisura_verification::output::OutputFolder;
use fisura_verification::output::foreign;
use serde_json::json;

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, docs, folders};

/// Arguments of `report`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder with results.json or bench.json; the report is written there, or to --out
    #[arg(value_name = "DIR", required_unless_present = "docs")]
    folder: Option<PathBuf>,
    /// Write the generated parts of README and book again; those that show results only if DIR is given
    #[arg(long)]
    docs: bool,
}

/// Renders a results folder and names the files written.
///
/// # Errors
/// `results.json` is missing or foreign, or there beside `bench.json`, a file cannot be written, or a figure
/// cannot be drawn.
pub fn report(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let folder = match &args.folder {
        from if args.docs => return docs::docs(from.as_ref(), common),
        Some(folder) => folder,
        None => return Err(Failure::input("no folder is given")), // clap asks for one
    };
    let of_bench = bench::is_bench(folder);
    if of_bench && folder.join("results.json").is_file() {
        let message = format!("{}: results.json and bench.json are both there", folder.display());
        return Err(Failure::input(message)
            .help("their reports have files of the same names; give one of them a folder of its own"));
    }
    if of_bench {
        bench::read(folder)?;
    } else {
        read_results(folder).map_err(|error| unreadable(error, folder))?;
    }
    let same = |out: &PathBuf| fs::canonicalize(out).is_ok_and(|out| Some(out) == fs::canonicalize(folder).ok());
    let out = match common.out.as_ref().filter(|out| !same(out)) {
        Some(_) => copied(folder, if of_bench { "bench.json" } else { "results.json" }, common)?,
        None => OutputFolder::reopen(folder)?,
    };
    folders::note_without_lock(common, &out);
    let path = out.path();
    let rendered = if of_bench { bench::render(path, &out)? } else { render(path, &out)?.files };
    let files: Vec<String> = rendered.iter().map(|f| path.join(f).display().to_string()).collect();
    console::show(common, &json!({ "files": files }), || files.join("\n") + "\n");
    Ok(Exit::Done)
}

/// Results that cannot be read, with what would help.
pub fn unreadable(error: ReportError, folder: &Path) -> Failure {
    let missing = !folder.join("results.json").is_file();
    let help =
        if missing { "give the folder that `cargo xtask verify` wrote" } else { "run `cargo xtask verify` again" };
    Failure::from(error).help(help)
}

/// The results and their series in the folder of `--out`. What is to be copied is known before the first file
/// is written, so that a folder below that of the results is no part of it.
fn copied(from: &Path, results: &str, common: &Common) -> Result<OutputFolder, Failure> {
    let fail = |name: &str, error: Error| {
        let message = format!("{} cannot be copied: {error}", from.join(name).display());
        Failure::input(message).help("remove it, or render the report in its folder, without --out")
    };
    let series = foreign::series_files(from).map_err(|error| fail("series", error))?;
    let to = folders::output(common, "report")?;
    let own = fs::canonicalize(to.path()).ok();
    let copies = |name: &&String| {
        fs::canonicalize(from.join(name)).ok().zip(own.as_ref()).is_none_or(|(f, own)| !f.starts_with(own))
    };
    let series: Vec<&str> = series.iter().filter(copies).map(String::as_str).collect();
    to.begin(|_| false)?;
    for name in std::iter::once(results).chain(series) {
        let most = if name == results { foreign::DOCUMENT_BYTES } else { foreign::SERIES_BYTES };
        let bytes = foreign::read(from, name, most).map_err(|error| fail(name, error))?;
        to.write(name, bytes)?;
    }
    to.finish()?;
    Ok(to)
}
