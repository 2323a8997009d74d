//! What can be said on the command line.

use std::num::NonZeroU16;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::{bench, check, compare, demo, faults, figures, judge, list, merge, report, run, verify};

const EXIT_STATUS: &str = "\
Exit status: 0 all checks hold, 1 a check fails, 2 bad arguments or bad input, 3 a run broke down, \
4 nothing was selected, 130 a run was interrupted.";

/// Runs and verifies fisura, an explicit phase-field material point method.
#[derive(Debug, Parser)]
#[command(name = "xtask", bin_name = "cargo xtask", version, after_help = EXIT_STATUS, max_term_width = 100)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// Flags of every command.
    #[command(flatten)]
    pub common: Common,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the verification suites, write the report, and state whether every check holds
    Verify(verify::Args),
    /// Join the results of all slices of `verify --partition`
    Merge(merge::Args),
    /// Compare the accuracy and the speed of two results folders, record by record
    Compare(compare::Args),
    /// List the cases: what each claims and models, its tier and estimated time
    List(list::Args),
    /// Run a cracking plate in less than a minute and show its energies
    Demo(demo::Args),
    /// Run a scene to its end and write its history, summary and pictures
    Run(run::Args),
    /// Validate a scene and show its model and its cost; runs its first steps for about a second
    Check(check::Args),
    /// Reproduce the figures of the paper, or redraw them from stored results
    Figures(figures::Args),
    /// Render the report of a results folder again, without running anything
    Report(report::Args),
    /// Measure run times and errors of fisura and of programs that do the same work
    Bench(bench::Args),
    /// Plant known errors, one at a time, and show which checks catch each
    Faults(faults::Args),
    /// Compare results of any code with a reference, name likely mistakes, and list errors of several codes
    Judge(judge::Args),
    /// Run cases with the error that the environment names, for `faults`
    #[cfg(feature = "faults")]
    #[command(hide = true)]
    Planted(faults::worker::Args),
}

/// Flags of every command.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Common options")]
pub struct Common {
    /// Output folder; by default `target/fisura/` and the name of the command
    #[arg(long, global = true, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; the results do not depend on it [default: all cores]
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<NonZeroU16>,
    /// Print only errors on standard error: no progress, no warnings
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Format of standard output
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub format: Format,
}

/// Form of standard output.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    // no doc comments: they would spread over the help of every command
    Text,
    Json,
}

/// A scene file and changes to it.
#[derive(Debug, Clone, Args)]
pub struct SceneArgs {
    /// Scene file, from the current folder or from the root of the workspace
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// Change a value of the scene, such as mesh.degree=3 or body.0.crack.0.half_width="0.25 mm"; entries
    /// count from 0
    #[arg(long, value_name = "key.path=value")]
    pub set: Vec<String>,
}
