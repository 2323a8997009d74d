//! The order of the runs: first the cases named for a fault, then the others, the cheap ones first.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Duration;

use fisura_verification::suite::Case;
use indicatif::ProgressBar;

use super::cells::Store;
use super::runner::{Ending, Job, Runner};
use super::table::Fault;
use crate::cli::Common;
use crate::failure::Failure;
use crate::{console, progress};

/// What is to be run, and on what.
pub struct Campaign<'a> {
    /// Faults that are planted, one in each run.
    pub faults: &'a [&'static Fault],
    /// Cases of the quick tier.
    pub cases: &'a [Case],
    /// Cells that are known; new ones are added here.
    pub store: &'a Store<'a>,
    /// Starts the processes in which the cases run.
    pub runner: &'a Runner,
    /// Flags that all commands have.
    pub common: &'a Common,
}

/// Cells to be filled together: first those of the sound runs.
struct Stage<'a> {
    what: String,
    cases: Vec<&'a Case>,
    named_only: bool,
}

/// Time that a run without a fault may take: its estimate is for an idle machine.
pub(super) fn sound_limit(case: &Case) -> Duration {
    Duration::from_secs_f64(120.0 + 20.0 * case.seconds)
}

/// Time that a run with a fault may take.
pub(super) fn planted_limit(sound_seconds: f64) -> Duration {
    Duration::from_secs_f64(30.0 + 5.0 * sound_seconds)
}

impl<'a> Campaign<'a> {
    /// Fills the cells that are wanted and not known, until all are or the time is over.
    ///
    /// # Errors
    /// A program that cannot be started, a cell that cannot be stored.
    pub fn run(&self, matrix: bool) -> Result<(), Failure> {
        for Stage { what, cases, named_only } in self.stages(matrix) {
            let sound: Vec<Job> = cases.iter().filter_map(|case| self.sound_job(case)).collect();
            self.fill(&format!("{what}, no fault"), sound)?;
            let planted = self.faults.iter().filter_map(|fault| self.planted_job(fault, &cases, named_only));
            self.fill(&format!("{what}, faults"), planted.collect())?;
        }
        Ok(())
    }

    fn stages(&self, matrix: bool) -> Vec<Stage<'a>> {
        let is_named = |case: &&Case| self.faults.iter().any(|fault| fault.cases.contains(&case.id()));
        let mut named: Vec<&Case> = self.cases.iter().filter(is_named).collect();
        named.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let mut stages = vec![Stage { what: "named cases".to_string(), cases: named, named_only: true }];
        let mut by_cost: BTreeMap<i32, Vec<&Case>> = BTreeMap::new();
        for case in self.cases.iter().filter(|_| matrix) {
            by_cost.entry(case.seconds.max(1.0).log2().ceil() as i32).or_default().push(case);
        }
        stages.extend(by_cost.into_iter().map(|(power, cases)| Stage {
            what: format!("cases of {} s", 2_f64.powi(power)),
            cases,
            named_only: false,
        }));
        stages
    }

    fn sound_job(&self, case: &Case) -> Option<Job> {
        let known = self.store.get(None, &case.id()).is_some();
        (!known).then(|| Job { fault: None, cases: vec![(case.id(), sound_limit(case))] })
    }

    /// The cells of a fault that are wanted: on sound cases that pass a site of it.
    fn planted_job(&self, fault: &'static Fault, cases: &[&Case], named_only: bool) -> Option<Job> {
        let wanted = cases.iter().map(|case| case.id()).filter(|id| !named_only || fault.cases.contains(id));
        let limited = wanted.filter_map(|id| {
            let sound = self.store.get(None, &id).filter(|sound| sound.holds())?;
            let missing = self.store.get(Some(&fault.id), &id).is_none();
            let passed = sound.passed.contains(&fault.id);
            (missing && passed).then(|| (id, planted_limit(sound.seconds)))
        });
        let cases: Vec<_> = limited.collect();
        (!cases.is_empty()).then_some(Job { fault: Some(&fault.id), cases })
    }

    fn fill(&self, what: &str, jobs: Vec<Job>) -> Result<(), Failure> {
        let count: usize = jobs.iter().map(|job| job.cases.len()).sum();
        if count == 0 || self.runner.expired() {
            return Ok(());
        }
        if !console::interactive(self.common) {
            console::note(self.common, &format!("{what}: {count} runs"));
        }
        let bar: ProgressBar = progress::bar(self.common, "{msg} {wide_bar} {pos}/{len}, {elapsed}", count as u64);
        let tell = |fault: Option<&'static str>, case: &str, ending: Ending, _: &Path| {
            bar.set_message(format!("{what}: {}, {case}", fault.unwrap_or("no fault")));
            bar.inc(1);
            Ok(self.store.put(fault, case, ending)?)
        };
        let run = self.runner.run(jobs, &tell);
        bar.finish_and_clear();
        run
    }
}
