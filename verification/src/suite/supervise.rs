//! A case under supervision: one that panics, or does not end, leaves the others their turn.
//!
//! The case runs in a pool of threads of its own. Beyond its time it is asked to stop, which every loop over time steps does at
//! its next round. A case that does not is left behind with its threads after as long again; it takes processor time from
//! what follows until the program ends, but nothing waits for it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use crate::watch::{self, Watch};

/// How often the one that waits looks up.
const LOOK: Duration = Duration::from_millis(50);
/// Least time that a case has to stop.
const GRACE: Duration = Duration::from_secs(2);

/// What becomes of `work`, if it ends as planned and within `limit`; else what happened. `advanced` is told the finished
/// fraction now and then, and `late` once the time is over.
pub(super) fn supervised<T: Send + 'static>(
    limit: Duration,
    advanced: &dyn Fn(f64),
    late: &dyn Fn(),
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, String> {
    watch::note_panics();
    let watch = Arc::new(Watch::default());
    let entered = Arc::clone(&watch);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(rayon::current_num_threads())
        .start_handler(move |_| Arc::clone(&entered).enter())
        .build()
        .map_err(|error| format!("no threads could be started for it: {error}"))?;
    let (sender, receiver) = channel();
    pool.spawn(move || {
        // nobody listens any more to a case that was left behind
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    });
    let start = Instant::now();
    let over = || {
        let (took, limit) = (start.elapsed().as_secs_f64(), limit.as_secs_f64());
        format!("stopped after {took:.1} s, over the limit of {limit} s for a case; --case-timeout sets another")
    };
    let mut asked = false;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(Ok(_)) if asked => return Err(over()),
            Ok(Ok(value)) => return Ok(value),
            Ok(Err(payload)) => return Err(watch.panic().map_or_else(|| words(payload.as_ref()), String::from)),
            Err(RecvTimeoutError::Disconnected) => return Err("its thread ended without a result".to_string()),
            Err(RecvTimeoutError::Timeout) => advanced(watch.fraction()),
        }
        let elapsed = start.elapsed();
        if elapsed > limit && !asked {
            asked = true;
            watch.stop(over());
            late();
        }
        if elapsed > limit.saturating_add(limit.max(GRACE)) {
            return Err(format!("{}, and did not end when asked to: it runs on beside what follows", over()));
        }
    }
}

/// What a panic says.
fn words(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    let text = text.or_else(|| payload.downcast_ref::<String>().cloned());
    format!("panicked: {}", text.unwrap_or_else(|| "without a message".to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run<T: Send + 'static>(seconds: f64, work: impl FnOnce() -> T + Send + 'static) -> Result<T, String> {
        supervised(Duration::from_secs_f64(seconds), &|_| (), &|| (), work)
    }

    #[test]
    fn what_ends_in_time_gives_its_value() {
        assert_eq!(run(60.0, || rayon::current_num_threads()), Ok(rayon::current_num_threads()));
    }

    #[test]
    fn a_panic_is_told_with_its_place_also_from_another_thread_of_the_pool() {
        let parallel = || rayon::join(|| (), || [1, 2][std::hint::black_box(2)]).1;
        let told = run(60.0, parallel).unwrap_err();
        assert!(told.contains("supervise.rs") && told.contains("index out of bounds"), "{told}");
        assert!(run(60.0, || -> () { std::panic::resume_unwind(Box::new("quiet")) }).unwrap_err().contains("quiet"));
    }

    #[test]
    fn a_loop_that_looks_stops_and_one_that_does_not_is_left_behind() {
        let looks = || while watch::check().is_ok() {};
        let told = run(0.05, looks).unwrap_err();
        assert!(told.contains("over the limit of 0.05 s") && !told.contains("runs on"), "{told}");
        let told = run(0.05, || std::thread::sleep(Duration::from_secs(3600))).unwrap_err();
        assert!(told.contains("runs on beside"), "{told}");
    }

    #[test]
    fn work_beyond_its_time_does_not_count_even_if_it_ends() {
        let slow = || std::thread::sleep(Duration::from_millis(400));
        assert!(run(0.05, slow).unwrap_err().contains("stopped after"));
    }
}
