//! The commands of the fisura workspace: `cargo xtask verify`, `merge`, `compare`, `list`, `demo`, `run`,
//! `check`, `figures`, `report`, `bench`, `faults`, `judge`.
//!
//! One file per command; beside them [`cli`] (what can be said on the command line), [`exit`] (statuses),
//! [`failure`] (how errors are shown), [`console`] (what goes to which stream), [`folders`] (where files go),
//! [`scene_input`] (scene files with their overrides), [`interrupt`] (Ctrl-C), [`progress`] (bars),
//! [`pictures`] (figures of a run), [`vtk`] (its files for ParaView), [`watch`] (what is shown of a
//! verification), [`environment`] (where and when), [`built`] (from which sources), [`docs`] (generated
//! parts of README and book).

mod bench;
mod built;
mod check;
mod cli;
mod compare;
mod console;
mod demo;
mod docs;
mod environment;
mod exit;
mod failure;
mod faults;
mod figures;
mod folders;
mod interrupt;
mod judge;
mod list;
mod merge;
mod pictures;
mod progress;
mod report;
mod run;
mod scene_input;
mod verify;
mod vtk;
mod watch;

use std::process::ExitCode;

use clap::Parser;

use cli::{Cli, Command, Common};
use failure::Failure;

fn main() -> ExitCode {
    let Cli { command, common } = Cli::parse();
    #[cfg(feature = "faults")]
    if let Err(failure) = faults::plant_from_environment() {
        return failure.show().into();
    }
    // within the pool: from outside, every parallel loop of a step would wake it and wait for it
    let outcome = set_threads(&common).and_then(|()| {
        rayon::scope(|_| match command {
            Command::Verify(args) => verify::verify(&args, &common),
            Command::Merge(args) => merge::merge(&args, &common),
            Command::Compare(args) => compare::compare(&args, &common),
            Command::List(args) => list::list(&args, &common),
            Command::Demo(_) => demo::demo(&common),
            Command::Run(args) => run::run(&args, &common),
            Command::Check(args) => check::check(&args, &common),
            Command::Figures(args) => figures::figures(&args, &common),
            Command::Report(args) => report::report(&args, &common),
            Command::Bench(args) => bench::bench(&args, &common),
            Command::Faults(args) => faults::faults(&args, &common),
            Command::Judge(args) => judge::judge(&args, &common),
            #[cfg(feature = "faults")]
            Command::Planted(args) => faults::worker::planted(&args, &common),
        })
    });
    outcome.unwrap_or_else(|failure| failure.show()).into()
}

/// All parallel work of the process runs on this many threads; on all cores unless told.
fn set_threads(common: &Common) -> Result<(), Failure> {
    let threads = common.threads.map_or(0, |n| usize::from(n.get())); // 0 lets rayon decide
    let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    built.map_err(|e| Failure::input(format!("{threads} threads cannot be started: {e}")).help("give fewer --threads"))
}
