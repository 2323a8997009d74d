//! A verification under way: which cases are finished, and at any moment the results that they give.

use std::collections::BTreeMap;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Instant;

use super::part::{PART_SCHEMA, Part, Plan, series_fingerprints};
use super::partition::Slice;
use super::prepare::{Prepared, prepare};
use super::resume::Store;
use super::schedule::Schedule;
use super::supervise::Ended;
use super::{Case, CaseOutcome, Options, Progress, VerifyError, assemble, inputs, judge, run_case};
use crate::record::{Record, ResultSet};
use crate::reference::Library;

/// Cases that are being run into a folder.
#[derive(Debug)]
pub struct Session<'a> {
    cases: &'a [Case],
    slice: Option<(Slice, Plan)>,
    options: &'a Options<'a>,
    library: Arc<Library>,
    prepared: Vec<Arc<Prepared>>,
    store: Store,
    outcomes: Mutex<BTreeMap<usize, CaseOutcome>>,
}

impl<'a> Session<'a> {
    /// Removes the results of the run before from the folder and leaves there, until the cases are finished,
    /// results that say so. `slice` is what the cases are of a plan, if they are not the whole.
    ///
    /// # Errors
    /// Wrong cases or reference data, finished cases of an interrupted run that this one would not go on
    /// with, a folder that cannot be written.
    pub fn begin(
        cases: &'a [Case],
        slice: Option<(Slice, Plan)>,
        options: &'a Options<'a>,
    ) -> Result<Self, VerifyError> {
        let library = Arc::new(Library::load(options.reference_data)?);
        let prepared = cases.iter().map(|case| Ok(Arc::new(prepare(case, &library)?)));
        let prepared = prepared.collect::<Result<_, VerifyError>>()?;
        let store = Store::open(cases, options)?;
        options.out.begin(|name| store.keeps(name))?;
        let session = Self { cases, slice, options, library, prepared, store, outcomes: Mutex::default() };
        session.results()?;
        Ok(session)
    }

    /// Runs the cases that no interrupted run finished, side by side where that is faster.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn run(&self, progress: &dyn Progress) -> Result<(), VerifyError> {
        let threads = rayon::current_num_threads();
        let cases = self.cases.iter().zip(self.prepared.iter().map(Arc::as_ref));
        let Schedule { alone, side_by_side } = Schedule::new(cases, self.options.seconds, threads);
        let run = alone.into_iter().try_for_each(|index| self.run_one(index, threads, progress));
        let run = run.and_then(|()| self.run_side_by_side(&side_by_side, threads, progress));
        self.options.seconds.remember();
        run
    }

    /// Runs cases on one thread each.
    fn run_side_by_side(&self, order: &[usize], threads: usize, progress: &dyn Progress) -> Result<(), VerifyError> {
        let next = AtomicUsize::new(0);
        let turns = || {
            while let Some(&index) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
                if let Err(error) = self.run_one(index, 1, progress) {
                    next.store(order.len(), Ordering::Relaxed); // the others finish what they have begun
                    return Err(error);
                }
            }
            Ok(())
        };
        thread::scope(|scope| {
            let workers: Vec<_> = (0..threads.min(order.len())).map(|_| scope.spawn(turns)).collect();
            let ends = workers.into_iter().map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)));
            ends.fold(Ok(()), Result::and)
        })
    }

    fn run_one(&self, index: usize, threads: usize, progress: &dyn Progress) -> Result<(), VerifyError> {
        let (case, prepared) = (&self.cases[index], &self.prepared[index]);
        progress.started(case);
        let start = Instant::now();
        let outcome = match self.store.load(case) {
            Some(outcome) => outcome,
            None => match run_case(case, prepared, threads, self.options, &self.library, progress) {
                Ended::InTime(outcome) => {
                    let outcome = outcome?;
                    self.store.save(case, &outcome)?;
                    self.options.seconds.took(case, start.elapsed().as_secs_f64());
                    outcome
                }
                // to be tried again, and not taken up
                Ended::Stopped(outcome) => outcome?,
                Ended::Broken(message) => judge::broken(case, prepared, &message),
            },
        };
        let records = outcome.records.clone();
        // Before it is said: an interrupt now would leave it out of the report.
        self.outcomes().insert(index, outcome);
        progress.finished(case, &records);
        Ok(())
    }

    /// Of the finished cases, by their number.
    fn outcomes(&self) -> MutexGuard<'_, BTreeMap<usize, CaseOutcome>> {
        self.outcomes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Number of finished cases, and of all.
    pub fn finished(&self) -> (usize, usize) {
        (self.outcomes().len(), self.cases.len())
    }

    /// Writes the results of the finished cases. As long as others are to come, a record of status error says
    /// so; then a slice leaves its part as well.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn results(&self) -> Result<ResultSet, VerifyError> {
        let mut outcomes: Vec<CaseOutcome> = self.outcomes().values().cloned().collect();
        let (finished, all) = (outcomes.len(), self.cases.len());
        let Options { out, environment, .. } = self.options;
        let inputs = inputs(self.cases);
        if finished < all {
            let records = vec![Record::unfinished(finished, all)];
            outcomes.push(CaseOutcome { records, figures: Vec::new(), runs: Vec::new() });
            return assemble(out, outcomes, inputs, environment.clone(), &self.library);
        }
        let named = self.cases.iter().map(Case::id).zip(outcomes.iter().cloned()).collect();
        let results = assemble(out, outcomes, inputs.clone(), environment.clone(), &self.library)?;
        if let Some((slice, plan)) = self.slice.clone() {
            let (schema, digest) = (PART_SCHEMA.to_string(), String::new());
            let (environment, files) = (environment.clone(), series_fingerprints(out));
            Part { schema, slice, plan, environment, inputs, outcomes: named, files, digest }.write(out)?;
        }
        self.store.finish()?;
        Ok(results)
    }
}
