//! What the checks said with and without a fault, and the table of both.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Output;

use fisura_verification::output::{OutputError, OutputFolder};
use fisura_verification::record::{ResultSet, Status};
use serde::Serialize;

use super::table::Fault;
use crate::exit::Exit;
use crate::failure::Failure;

/// A case that was run.
pub struct CaseRun {
    /// Its id.
    pub case: String,
    /// Its checks, or how it ended without any.
    outcome: Result<Vec<(String, Status)>, String>,
}

/// All that was found.
#[derive(Debug, Serialize)]
pub struct Results {
    /// One entry per fault.
    pub faults: Vec<Caught>,
}

/// What caught a fault.
#[derive(Debug, Serialize)]
pub struct Caught {
    id: &'static str,
    what: &'static str,
    cases: &'static [&'static str],
    /// Records that fail, or are errors, with the fault alone.
    caught_by: Vec<String>,
    /// Checks that were made.
    checks: usize,
    /// How cases ended that have no records.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    ended: Vec<String>,
}

impl CaseRun {
    /// Reads the results of a run.
    pub fn read(case: &str, folder: &Path, output: &Output) -> Self {
        let results = fs::read_to_string(folder.join("results.json")).ok();
        let results = results.and_then(|text| serde_json::from_str::<ResultSet>(&text).ok());
        // those of an earlier run that this one refused to replace, or of one that did not come to its end, are none
        let ran = output.status.code().is_some_and(|code| {
            [Exit::Done, Exit::CheckFailed, Exit::BrokeDown].iter().any(|exit| *exit as i32 == code)
        });
        let results = results.filter(|results| ran && !results.is_unfinished());
        let outcome = results
            .map(|results| results.records.into_iter().map(|record| (record.id, record.status)).collect())
            .ok_or_else(|| {
                let complaint = String::from_utf8_lossy(&output.stderr);
                format!("{case}: {}: {}", output.status, complaint.lines().next().unwrap_or_default())
            });
        Self { case: case.to_string(), outcome }
    }

    /// The same if every check holds.
    ///
    /// # Errors
    /// If one does not: nothing could be learnt from it.
    pub fn sound(self) -> Result<Self, Failure> {
        let fails = match &self.outcome {
            Ok(records) => records.iter().find(|(_, status)| is_red(*status)).map(|(id, _)| id.clone()),
            Err(ending) => Some(ending.clone()),
        };
        match fails {
            None => Ok(self),
            Some(what) => {
                let message = format!("without a fault, {} does not hold: {what}", self.case);
                Err(Failure::new(Exit::CheckFailed, message).help("see `cargo xtask verify --case` for why"))
            }
        }
    }
}

fn is_red(status: Status) -> bool {
    matches!(status, Status::Fail | Status::Error)
}

impl Caught {
    /// By nothing yet.
    pub fn new(fault: &Fault) -> Self {
        let Fault { id, what, cases } = *fault;
        Self { id, what, cases, caught_by: Vec::new(), checks: 0, ended: Vec::new() }
    }

    /// Adds the checks of a case that are red with the fault; without, none is.
    pub fn compare(&mut self, run: &CaseRun, sound: &CaseRun) {
        self.checks += sound.outcome.as_ref().map_or(0, Vec::len);
        match &run.outcome {
            Ok(records) => {
                let red = records.iter().filter(|(_, status)| is_red(*status));
                self.caught_by.extend(red.map(|(id, _)| id.clone()));
            }
            Err(ending) => self.ended.push(ending.clone()),
        }
    }
}

impl Results {
    /// Faults that no check caught.
    pub fn survivors(&self) -> impl Iterator<Item = &Caught> {
        self.faults.iter().filter(|fault| fault.caught_by.is_empty())
    }

    /// Writes `faults.json` and `faults.md`.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn write(&self, folder: &OutputFolder) -> Result<(), OutputError> {
        folder.write_json("faults.json", self)?;
        folder.write("faults.md", self.markdown())?;
        folder.finish()
    }

    /// One line per fault.
    pub fn text(&self) -> String {
        let width = self.faults.iter().map(|fault| fault.id.len()).max().unwrap_or(0);
        let mut out = String::new();
        for fault in &self.faults {
            let verdict = match fault.caught_by.first() {
                Some(first) => format!("caught    {:>3} of {:>3} checks: {first}", fault.caught_by.len(), fault.checks),
                None => format!("SURVIVES    0 of {:>3} checks: {}", fault.checks, fault.cases.join(", ")),
            };
            let _ = writeln!(out, "{:width$}  {verdict}", fault.id);
            for ending in &fault.ended {
                let _ = writeln!(out, "{:width$}  ended without records: {ending}", "");
            }
        }
        let _ = writeln!(
            out,
            "{} of {} faults are caught",
            self.faults.len() - self.survivors().count(),
            self.faults.len()
        );
        out
    }

    /// The table of faults and checks.
    fn markdown(&self) -> String {
        let mut out = String::from(
            "# Planted errors and the checks that catch them\n\n| fault | what is wrong | cases | red checks |\n|---|---|---|---|\n",
        );
        for fault in &self.faults {
            let red = match fault.caught_by.as_slice() {
                [] => format!("**none** of {}", fault.checks),
                all => {
                    let shown: Vec<String> = all.iter().take(3).map(|id| format!("`{id}`")).collect();
                    let more = if all.len() > 3 { ", …" } else { "" };
                    format!("{} of {}: {}{more}", all.len(), fault.checks, shown.join(", "))
                }
            };
            let _ = writeln!(out, "| {} | {} | {} | {red} |", fault.id, fault.what, fault.cases.join(", "));
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(statuses: &[Status]) -> CaseRun {
        let outcome = statuses.iter().enumerate().map(|(i, status)| (format!("a/b/{i}"), *status)).collect();
        CaseRun { case: "a/b".into(), outcome: Ok(outcome) }
    }

    #[test]
    fn a_fault_is_caught_by_what_turns_red_and_survives_what_ends_without_records() {
        let fault = Fault { id: "sign", what: "a sign", cases: &["a/b"] };
        let sound = run(&[Status::Pass, Status::Info, Status::Pass]).sound().unwrap();
        let mut caught = Caught::new(&fault);
        caught.compare(&run(&[Status::Pass, Status::Info, Status::Error]), &sound);
        assert_eq!((caught.caught_by.as_slice(), caught.checks), (&["a/b/2".to_string()][..], 3));
        let mut ended = Caught::new(&fault);
        ended.compare(&CaseRun { case: "a/b".into(), outcome: Err("a/b: exit status: 101".into()) }, &sound);
        let results = Results { faults: vec![caught, ended] };
        assert_eq!(results.survivors().count(), 1);
        assert!(results.text().contains("1 of 2 faults are caught") && results.markdown().contains("**none** of 3"));
        assert!(run(&[Status::Fail]).sound().is_err());
    }
}
