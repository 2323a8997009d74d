//! The part of `faults` that runs in the program in which errors are planted: cases one after the other, and
//! a line of JSON on standard output for each as soon as it is done.

use std::io::{Write, stdout};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use fisura_verification::record::{Environment, Record};
use fisura_verification::suite::{self, Case, Options, Progress, Seconds};

use super::runner::Report;
use crate::cli::Common;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{folders, verify};

/// Arguments of `planted`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Ids of the cases to run, in this order
    #[arg(required = true)]
    case: Vec<String>,
    /// Change a value of their scenes
    #[arg(long, value_name = "key.path=value")]
    set: Vec<String>,
}

/// Runs the cases.
///
/// # Errors
/// A case or reference file that is wrong, a folder that cannot be written.
pub fn planted(args: &Args, common: &Common) -> Result<Exit, Failure> {
    let all = verify::cases_folder()?;
    let load = |id: &String| Case::load(&all.join(id).with_extension("toml"), &args.set);
    let cases = args.case.iter().map(load).collect::<Result<Vec<Case>, _>>()?;
    let (out, reference_data) = (folders::output(common, "planted")?, folders::workspace().join("reference-data"));
    let options = Options {
        out: Arc::new(out),
        reference_data: &reference_data,
        environment: Environment::default(),
        program: "planted",
        resume: false,
        case_timeout: Some(Duration::MAX), // the one who started this process ends it: a case without records
        seconds: &Seconds::default(),
    };
    fisura::faults::take_passed(); // what was passed on the way here
    suite::verify(&cases, &options, &Teller(Mutex::new(Instant::now())))?;
    Ok(Exit::Done)
}

/// Tells what each case found; the time at which it started.
struct Teller(Mutex<Instant>);

impl Progress for Teller {
    fn started(&self, _case: &Case) {
        if let Ok(mut started) = self.0.lock() {
            *started = Instant::now();
        }
    }

    fn finished(&self, case: &Case, records: &[Record]) {
        let report = Report {
            case: case.id(),
            seconds: self.0.lock().map_or(0.0, |started| started.elapsed().as_secs_f64()),
            records: records.iter().map(|record| (record.id.clone(), record.status)).collect(),
            passed: fisura::faults::take_passed().into_iter().map(String::from).collect(),
        };
        let line = serde_json::to_string(&report).unwrap_or_default();
        if writeln!(stdout(), "{line}").and_then(|()| stdout().flush()).is_err() {
            std::process::exit(Exit::BadInput as i32); // nobody listens any more
        }
    }
}
