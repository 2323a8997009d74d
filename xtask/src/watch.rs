//! Shows a verification under way: on a terminal a bar for the whole and one for each case that runs,
//! elsewhere a line per finished case.

use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use fisura_reports::number::duration;
use fisura_verification::output::foreign::line;
use fisura_verification::record::{Record, Status};
use fisura_verification::suite::{Case, Progress, Seconds, worst};
use indicatif::{MultiProgress, ProgressBar};

use crate::cli::Common;
use crate::{console, progress};

/// Parts of a second, or of a case, that bars count.
const PARTS: f64 = 1000.0;

/// Shows how far a verification is: bars on a terminal, lines elsewhere.
#[derive(Debug)]
pub struct Watch<'a> {
    common: &'a Common,
    bars: MultiProgress,
    whole: ProgressBar,
    costs: BTreeMap<String, f64>,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    running: BTreeMap<String, Running>,
    finished: usize,
    /// What the finished cases were expected to take, s.
    seconds: f64,
}

#[derive(Debug)]
struct Running {
    bar: ProgressBar,
    start: Instant,
    fraction: f64,
}

impl<'a> Watch<'a> {
    /// Watches cases that are about to be run.
    pub fn new(cases: &[Case], seconds: &Seconds, common: &'a Common) -> Self {
        let bars = progress::bars(common);
        let costs: BTreeMap<String, f64> = cases.iter().map(|case| (case.id(), seconds.of(case))).collect();
        let length = PARTS * costs.values().sum::<f64>();
        let whole = progress::bar(common, "{msg} {wide_bar} {percent} %, {elapsed}, {eta} left", length as u64);
        let watch = Self { common, whole: bars.add(whole), bars, costs, state: Mutex::default() };
        watch.whole.set_message(format!("0/{} cases", cases.len()));
        watch
    }

    /// Takes the bars away.
    pub fn finish(&self) {
        for running in self.state().running.values() {
            running.bar.finish_and_clear();
        }
        self.whole.finish_and_clear();
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// One line, above the bars where there are any.
    fn say(&self, text: &str) {
        if console::interactive(self.common) {
            let _ = self.bars.println(line(text)); // as with any output to a terminal that is gone
        } else {
            console::note(self.common, &line(text));
        }
    }

    fn show(&self, state: &State) {
        let cost = |id: &String| self.costs.get(id).copied().unwrap_or(0.0);
        let running: f64 = state.running.iter().map(|(id, running)| running.fraction * cost(id)).sum();
        self.whole.set_position((PARTS * (state.seconds + running)) as u64);
        self.whole.set_message(format!("{}/{} cases", state.finished, self.costs.len()));
    }
}

impl Progress for Watch<'_> {
    fn started(&self, case: &Case) {
        let bar = progress::bar(self.common, "  {msg} {percent} %, {elapsed}", PARTS as u64);
        let bar = self.bars.insert_before(&self.whole, bar);
        bar.set_message(line(&case.id()).into_owned());
        self.state().running.insert(case.id(), Running { bar, start: Instant::now(), fraction: 0.0 });
    }

    fn advanced(&self, case: &Case, fraction: f64) {
        let mut state = self.state();
        if let Some(running) = state.running.get_mut(&case.id()) {
            running.fraction = fraction.clamp(0.0, 1.0);
            running.bar.set_position((PARTS * running.fraction) as u64);
            self.show(&state);
        }
    }

    fn slow(&self, case: &Case, limit: Duration) {
        let seconds = limit.as_secs_f64();
        self.say(&format!("{} takes more than {seconds} s, ten times its estimate", case.id()));
    }

    fn late(&self, case: &Case, limit: Duration) {
        let seconds = limit.as_secs_f64();
        self.say(&format!("warning: {} exceeded its timeout of {seconds} s and is being stopped", case.id()));
    }

    fn finished(&self, case: &Case, records: &[Record]) {
        let mut state = self.state();
        let Some(running) = state.running.remove(&case.id()) else { return };
        running.bar.finish_and_clear();
        self.bars.remove(&running.bar);
        state.finished += 1;
        state.seconds += self.costs.get(&case.id()).copied().unwrap_or(0.0);
        self.show(&state);
        let (finished, count) = (state.finished, self.costs.len());
        drop(state);
        let word = match worst(records.iter().map(|record| record.status)) {
            Some(Status::Error) => "error",
            Some(Status::Fail) => "fail",
            Some(Status::KnownLimit) => "pass, with known limits",
            Some(Status::Pass) => "pass",
            Some(Status::Info) | None => "info",
        };
        let took = duration(running.start.elapsed().as_secs_f64());
        self.say(&format!("[{finished}/{count}] {} {word}, {took}", case.id()));
    }
}
