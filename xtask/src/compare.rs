//! `compare BASE NEW`: two results folders side by side.

use std::path::PathBuf;

use fisura_reports::compare::{compare as side_by_side, render_markdown, render_text};
use fisura_reports::read_results;

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::report::unreadable;
use crate::{console, folders};

/// Arguments of `compare`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Results folder to compare with
    #[arg(value_name = "BASE")]
    base: PathBuf,
    /// Results folder that is judged
    #[arg(value_name = "NEW")]
    new: PathBuf,
    /// List slower runs without an effect on the exit status, for machines with unreliable times
    #[arg(long)]
    warn_times: bool,
}

/// Compares record by record, in accuracy, work and speed; writes `comparison.md` and `comparison.json`.
///
/// # Errors
/// Results that cannot be read, that have nothing in common, or files that cannot be written.
pub fn compare(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let [base, new] = [&args.base, &args.new].map(|f| read_results(f).map_err(|error| unreadable(error, f)));
    let (base, new) = (base?, new?);
    let compared = side_by_side(&base, &new);
    if !compared.records.iter().any(|record| record.base.is_some() && record.new.is_some()) {
        let message = format!("{} and {} have no record in common", args.base.display(), args.new.display());
        return Err(Failure::new(Exit::NothingSelected, message).help("compare results of the same suites"));
    }
    let folder = folders::output(common, "compare")?;
    folder.begin(|_| false)?;
    folder.write("comparison.md", render_markdown(&compared))?;
    folder.write_json("comparison.json", &compared)?;
    folder.finish()?;
    console::show(common, &compared, || render_text(&compared));
    let losses = if args.warn_times { compared.losses_besides_speed() } else { compared.major_losses };
    Ok(if losses > 0 { Exit::CheckFailed } else { Exit::Done })
}
