//! `merge DIR…`: the results of all slices of a plan as one.

use std::path::PathBuf;

use fisura_verification::suite::merge::{MergeError, merge as join};

use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::verify::conclude;
use crate::{built, console, folders};

/// Arguments of `merge`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folders that `verify --partition` wrote, one per slice, in any order
    #[arg(value_name = "DIR", required = true)]
    folders: Vec<PathBuf>,
}

/// Joins parts, renders the report, and says whether every check holds.
///
/// # Errors
/// Parts of different plans or programs, emptied or edited parts, slices missing or doubled, folders that
/// cannot be read or written.
pub fn merge(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let references = folders::reference_data()?;
    let folder = folders::output(common, "merge")?;
    let results = join(&args.folders, &folder, &references, built::SOURCES)?;
    if results.environment.dirty {
        console::note(common, "warning: all parts were run with the same uncommitted changes");
    }
    conclude(&results, &folder, common)
}

impl From<MergeError> for Failure {
    fn from(error: MergeError) -> Self {
        match error {
            MergeError::File(error) => error.into(),
            MergeError::Parts { message, remedy } => Self::input(message).help(remedy),
        }
    }
}
