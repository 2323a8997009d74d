//! Processes of the program in which errors are planted: several side by side, each with one fault and one
//! thread.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use fisura_verification::record::Status;
use serde::{Deserialize, Serialize};

use super::PLANTED;
use crate::failure::Failure;

/// What a process says of a case it has run, on a line of its standard output.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Report {
    /// Id of the case: `suite/name`.
    pub case: String,
    /// Wall time of the case, s.
    pub seconds: f64,
    /// Id and status of each record of the case.
    pub records: Vec<(String, Status)>,
    /// Faults whose sites it passed.
    pub passed: Vec<String>,
}

/// How a case ended in a process: what it reported, or why it did not.
pub type Ending = Result<Report, String>;

/// Cases to be run one after the other in one process.
#[derive(Debug)]
pub struct Job {
    /// The fault to plant; none for a sound run.
    pub fault: Option<&'static str>,
    /// Id of each case, and the time it may take.
    pub cases: Vec<(String, Duration)>,
}

/// Told what became of a case, and in which folder its series are until this returns.
pub type Tell<'a> = &'a (dyn Fn(Option<&'static str>, &str, Ending, &Path) -> Result<(), Failure> + Sync);

/// Runs jobs in processes side by side, until a deadline.
#[derive(Debug)]
pub struct Runner {
    program: PathBuf,
    side_by_side: usize,
    deadline: Option<Instant>,
}

/// A process, ended when it is dropped.
struct Process(Child);

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.0.kill(); // it may have ended by itself
        let _ = self.0.wait();
    }
}

impl Runner {
    /// Runs `program`, so many processes side by side, and starts no case after the deadline.
    pub fn new(program: PathBuf, side_by_side: usize, deadline: Option<Instant>) -> Self {
        Self { program, side_by_side, deadline }
    }

    /// Whether nothing more is to be started.
    pub fn expired(&self) -> bool {
        self.deadline.is_some_and(|deadline| Instant::now() >= deadline)
    }

    /// Runs the jobs, in this order as far as there is only one process; cases after the deadline are left
    /// out.
    ///
    /// # Errors
    /// A process that cannot be started, and what `tell` says.
    pub fn run(&self, jobs: Vec<Job>, tell: Tell) -> Result<(), Failure> {
        let queue = Mutex::new(VecDeque::from(jobs));
        let next = || queue.lock().ok().and_then(|mut queue| queue.pop_front());
        let work = || -> Result<(), Failure> {
            while let Some(job) = next() {
                let mut rest = &job.cases[..];
                while !rest.is_empty() && !self.expired() {
                    rest = &rest[self.process(&job, rest, tell)?..];
                }
            }
            Ok(())
        };
        std::thread::scope(|scope| {
            let slots: Vec<_> = (0..self.side_by_side.max(1)).map(|_| scope.spawn(work)).collect();
            let mut ended = slots.into_iter().map(|slot| slot.join());
            ended.try_for_each(|result| result.unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
        })
    }

    /// Runs cases in one process until it has done them all or ends before that; how many are settled.
    fn process(&self, job: &Job, cases: &[(String, Duration)], tell: Tell) -> Result<usize, Failure> {
        let unstarted =
            |error: std::io::Error| Failure::input(format!("{} cannot be started: {error}", self.program.display()));
        let (out, mut complaints) = (tempfile::tempdir().map_err(unstarted)?, tempfile::tempfile().map_err(unstarted)?);
        let mut command = Command::new(&self.program);
        command.arg("planted").args(cases.iter().map(|(case, _)| case)).args(["--threads", "1", "--quiet", "--out"]);
        command.arg(out.path()).env_remove(PLANTED);
        command.envs(job.fault.map(|fault| (PLANTED, fault)));
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(complaints.try_clone().map_err(unstarted)?);
        let mut process = Process(command.spawn().map_err(unstarted)?);
        let lines = reports(&mut process.0);
        for (settled, (case, limit)) in cases.iter().enumerate() {
            let ending = match lines.recv_timeout(*limit) {
                Ok(report) if report.case == *case => Ok(report),
                Ok(report) => Err(format!("it reported {} instead of {case}", report.case)),
                Err(RecvTimeoutError::Timeout) => Err(format!("timeout: it did not finish in {} s", limit.as_secs())),
                Err(RecvTimeoutError::Disconnected) => {
                    let status = process.0.wait().map_err(unstarted)?;
                    let mut text = String::new();
                    let read = complaints.rewind().and_then(|()| complaints.read_to_string(&mut text));
                    Err(format!(
                        "{status}: {}",
                        read.map_or("", |_| text.lines().find(|line| !line.is_empty()).unwrap_or_default())
                    ))
                }
            };
            let over = ending.is_err() || self.expired();
            tell(job.fault, case, ending, out.path())?;
            if over {
                return Ok(settled + 1);
            }
        }
        Ok(cases.len())
    }
}

/// What the process reports, until it closes its standard output.
fn reports(child: &mut Child) -> Receiver<Report> {
    let (sender, receiver) = channel();
    if let Some(output) = child.stdout.take() {
        std::thread::spawn(move || {
            let lines = BufReader::new(output).lines().map_while(Result::ok);
            for report in lines.filter_map(|line| serde_json::from_str(&line).ok()) {
                if sender.send(report).is_err() {
                    return; // the process is given up
                }
            }
        });
    }
    receiver
}
