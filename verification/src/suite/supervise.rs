//! A case under supervision: one that panics, or does not end, leaves the others their turn.
//!
//! The case runs in a pool of threads of its own. Beyond its time it is asked to stop, which every loop over
//! time steps does at its next round. A case that does not is left behind with its threads after as long
//! again; it takes processor time from what follows until the program ends, but nothing waits for it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use crate::watch::{self, Watch};

/// How often the one that waits looks up.
const LOOK: Duration = Duration::from_millis(50);
/// Least time that a case has to stop.
const GRACE: Duration = Duration::from_secs(2);

/// How supervised work ended.
#[derive(Debug, PartialEq)]
pub(super) enum Ended<T> {
    /// The work ended within its time and gave this.
    InTime(T),
    /// When it was asked to: what it has until then.
    Stopped(T),
    /// With a panic, or not at all: what happened.
    Broken(String),
}

/// Runs work on threads of its own and limits its time.
pub(super) struct Supervisor<'a> {
    /// Of the pool in which it runs.
    pub threads: usize,
    /// Time after which `is_slow` is told.
    pub slow: Duration,
    /// Time after which `is_late` is told and the work is asked to stop.
    pub limit: Duration,
    /// Told the finished fraction now and then.
    pub advanced: &'a dyn Fn(f64),
    /// Called once, when the work takes longer than `slow`.
    pub is_slow: &'a dyn Fn(),
    /// Called once, when the work takes longer than `limit`.
    pub is_late: &'a dyn Fn(),
}

impl Supervisor<'_> {
    /// Runs `work` and waits until it ends or is left behind.
    pub(super) fn run<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> Ended<T> {
        watch::note_panics();
        let watch = Arc::new(Watch::default());
        let pool = match watch.pool(self.threads) {
            Ok(pool) => pool,
            Err(error) => return Ended::Broken(format!("no threads could be started for it: {error}")),
        };
        let (sender, receiver) = channel();
        pool.spawn(move || {
            // nobody listens any more to a case that was left behind
            let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
        });
        let start = Instant::now();
        let (mut asked, mut told) = (false, false);
        loop {
            match receiver.recv_timeout(LOOK) {
                Ok(Ok(value)) if asked => return Ended::Stopped(value),
                Ok(Ok(value)) => return Ended::InTime(value),
                Ok(Err(payload)) => {
                    return Ended::Broken(watch.panic().map_or_else(|| words(payload.as_ref()), String::from));
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Ended::Broken("its thread ended without a result".to_string());
                }
                Err(RecvTimeoutError::Timeout) => (self.advanced)(watch.fraction()),
            }
            let elapsed = start.elapsed();
            if elapsed > self.slow && !told {
                told = true;
                (self.is_slow)();
            }
            if elapsed > self.limit && !asked {
                asked = true;
                watch.stop(self.over(elapsed));
                (self.is_late)();
            }
            if elapsed > self.limit.saturating_add(self.limit.max(GRACE)) {
                watch.leave();
                let over = self.over(elapsed);
                return Ended::Broken(format!(
                    "{over}; it did not stop on request, was abandoned and still runs beside the next cases"
                ));
            }
        }
    }

    fn over(&self, elapsed: Duration) -> String {
        let (took, limit) = (elapsed.as_secs_f64(), self.limit.as_secs_f64());
        format!(
            "timeout: stopped after {took:.1} s, over the limit of {limit} s for a case; --case-timeout changes the limit"
        )
    }
}

/// Message of a panic in words, made from its payload.
fn words(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    format!("panicked: {}", text.unwrap_or_else(|| "without a message".to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run<T: Send + 'static>(seconds: f64, work: impl FnOnce() -> T + Send + 'static) -> Ended<T> {
        let limit = Duration::from_secs_f64(seconds);
        let supervisor =
            Supervisor { threads: 2, slow: limit, limit, advanced: &|_| (), is_slow: &|| (), is_late: &|| () };
        supervisor.run(work)
    }

    /// What is told of work that broke.
    #[track_caller]
    fn told<T>(ended: Ended<T>) -> String {
        match ended {
            Ended::Broken(message) => message,
            _ => panic!("it ended well"),
        }
    }

    #[test]
    fn what_ends_in_time_gives_its_value() {
        assert_eq!(run(60.0, rayon::current_num_threads), Ended::InTime(2));
    }

    #[test]
    fn a_panic_is_told_with_its_place_also_from_another_thread_of_the_pool() {
        let message = told(run(60.0, || rayon::join(|| (), || [1, 2][std::hint::black_box(2)]).1));
        assert!(message.contains("supervise.rs") && message.contains("index out of bounds"), "{message}");
        assert!(told(run(60.0, || -> () { std::panic::resume_unwind(Box::new("quiet")) })).contains("quiet"));
    }

    #[test]
    fn a_loop_that_looks_stops_and_one_that_does_not_is_left_behind() {
        let looks = || loop {
            if let Err(stopped) = watch::check() {
                return stopped.to_string();
            }
        };
        let Ended::Stopped(why) = run(0.05, looks) else { panic!("it stops") };
        assert!(why.contains("over the limit of 0.05 s"), "{why}");
        let message = told(run(0.05, || std::thread::sleep(Duration::from_secs(3600))));
        assert!(message.contains("abandoned"), "{message}");
    }

    #[test]
    fn what_is_left_behind_writes_nothing_and_threads_of_its_own_know_of_the_stop() {
        let (sender, receiver) = channel();
        let work = move || {
            std::thread::sleep(Duration::from_secs(5));
            let own = watch::pool(2).unwrap().install(|| watch::check().is_err());
            let mut written = false;
            watch::unless_left(|| -> Result<(), ()> {
                written = true;
                Ok(())
            })
            .unwrap();
            sender.send((own, written)).unwrap();
        };
        assert!(told(run(0.05, work)).contains("abandoned"));
        assert_eq!(receiver.recv(), Ok((true, false)));
    }
}
