//! Feeds readers with mutated files and watches time, memory and panics; shared by the tests of several
//! crates.

use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};

use crate::mutation::mutation;

/// Longest input, bytes.
pub const LONGEST: usize = 64 << 10;
/// Processor time an input may take where fuzzing is asked for; the best of three counts.
const PATIENCE: Duration = Duration::from_secs(1);
/// On a busy machine everything may take this many times longer: this long is a hang.
const BUSY: u32 = 10;
/// Memory an input may take, bytes.
const MEMORY: usize = 1 << 30;

/// Counts what is allocated.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static MOST: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator with the arguments that came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.fetch_add(layout.size(), Ordering::Relaxed) + layout.size();
        MOST.fetch_max(held, Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as the caller promises.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Files with an extension below some folders of this crate, in the order of their names.
pub fn files(folders: &[&str], extension: &str) -> Vec<Vec<u8>> {
    fn walk(folder: &Path, extension: &str, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder").flatten() {
            let path = entry.path();
            if path.is_dir() {
                walk(&path, extension, found);
            } else if path.extension().is_some_and(|e| e == extension) {
                found.push(path);
            }
        }
    }
    let mut found = Vec::new();
    for folder in folders {
        walk(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), extension, &mut found);
    }
    found.sort();
    let read = |path: &PathBuf| fs::read(path).expect("a file");
    let texts: Vec<_> = found.iter().map(read).filter(|text| text.len() < LONGEST).collect();
    assert!(!texts.is_empty(), "nothing below {folders:?}");
    texts
}

/// Inputs asked for.
static ASKED: LazyLock<Option<u32>> = LazyLock::new(|| std::env::var("FISURA_FUZZ").ok().and_then(|n| n.parse().ok()));

/// Feeds `reader` with mutated files of the corpus: `part` of all inputs.
pub fn fuzz(part: f64, corpus: &[Vec<u8>], reader: impl Fn(&[u8])) {
    let cases = (part * f64::from(ASKED.unwrap_or(10_000))) as u32;
    corpus.iter().for_each(|text| watched(text, &reader).expect("the corpus itself"));
    let config = Config { cases, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    let mut runner = if ASKED.is_some() { TestRunner::new(config) } else { TestRunner::new_with_rng(config, fixed()) };
    let input = (any::<prop::sample::Index>(), prop::collection::vec(mutation(), 1..6));
    let result = runner.run(&input, |(which, mutations)| {
        let start = which.get(corpus).clone();
        let mut text = mutations.iter().fold(start, |text, mutation| mutation.apply(text, corpus));
        text.truncate(LONGEST);
        watched(&text, &reader).map_err(|what| {
            let shown = String::from_utf8_lossy(&text[..text.len().min(4000)]).into_owned();
            TestCaseError::fail(format!("{what}:\n{shown}"))
        })
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

/// The same numbers every time.
fn fixed() -> TestRng {
    TestRng::deterministic_rng(RngAlgorithm::ChaCha)
}

/// What is wrong with the reading of one input, if anything is.
pub fn watched(text: &[u8], reader: &impl Fn(&[u8])) -> Result<(), String> {
    let mut best = [Duration::MAX; 2];
    let patience = if ASKED.is_some() { PATIENCE } else { PATIENCE * BUSY };
    for _ in 0..3 {
        let before = HELD.load(Ordering::Relaxed);
        MOST.store(before, Ordering::Relaxed);
        let (start, worked) = (Instant::now(), processor_time());
        catch_unwind(AssertUnwindSafe(|| reader(text))).map_err(|_| "a panic")?;
        let took = [processor_time().saturating_sub(worked), start.elapsed()];
        best = [0, 1].map(|i| best[i].min(took[i]));
        let memory = MOST.load(Ordering::Relaxed).saturating_sub(before);
        if memory > MEMORY {
            return Err(format!("{} MiB of memory", memory >> 20));
        }
        if best[0] <= patience && best[1] <= BUSY * patience {
            return Ok(());
        }
    }
    Err(format!("{:?} of processor time in {:?}", best[0], best[1]))
}

/// Processor time of this thread so far: that of a busy machine is no longer. The time that passes has a
/// limit of its own.
fn processor_time() -> Duration {
    #[cfg(unix)]
    {
        let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
        Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec as u32)
    }
    #[cfg(not(unix))]
    Duration::ZERO
}
