//! Where and when: what stands under `environment` in `results.json`.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use chrono::{DateTime, SecondsFormat};
use fisura_verification::record::Environment;

use crate::built;

/// The present environment; what cannot be found out is empty.
pub fn environment(workspace: &Path) -> Environment {
    let git = |args: &[&str]| output(Command::new("git").args(args).current_dir(folder(workspace)));
    let changes = git(&["status", "--porcelain"]);
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let since = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    Environment {
        dirty: changes.is_some_and(|c| !c.is_empty()),
        commit: built::COMMIT.to_string(),
        rustc: output(Command::new(rustc).arg("-V")).unwrap_or_default(),
        cpu: cpu().unwrap_or_default(),
        threads: rayon::current_num_threads(),
        started: utc(since),
    }
}

/// The current folder, if the path is empty.
fn folder(path: &Path) -> &Path {
    if path.as_os_str().is_empty() { Path::new(".") } else { path }
}

/// Trimmed standard output of a command that succeeds.
fn output(command: &mut Command) -> Option<String> {
    let output = command.output().ok().filter(|o| o.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// Model name of the processor, where `/proc` tells it.
fn cpu() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_string())
}

/// ISO 8601 of seconds since 1970 in UTC: `2026-07-01T12:00:00Z`.
fn utc(seconds: u64) -> String {
    let time = i64::try_from(seconds).ok().and_then(|seconds| DateTime::from_timestamp(seconds, 0));
    time.map_or_else(String::new, |time| time.to_rfc3339_opts(SecondsFormat::Secs, true))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_become_dates() {
        let dates = [0, 951_782_400, 1_798_761_599].map(utc);
        assert_eq!(dates, ["1970-01-01T00:00:00Z", "2000-02-29T00:00:00Z", "2026-12-31T23:59:59Z"]);
    }

    #[test]
    fn the_commit_is_that_of_the_program_wherever_it_runs() {
        let folder = tempfile::tempdir().unwrap();
        let environment = environment(folder.path());
        assert_eq!((environment.commit.as_str(), environment.dirty), (built::COMMIT, false));
        assert!(environment.threads >= 1);
    }
}
