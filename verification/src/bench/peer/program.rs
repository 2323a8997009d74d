//! A program of the user as a process: its time, a limit to it, and its end with ours.

use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::Duration;

use wait_timeout::ChildExt;

use super::super::BenchError;
use super::super::record::Sample;
use super::super::timing::Stopwatch;

/// A command of the user.
pub struct Program {
    /// Command line as one string, for labels and messages.
    pub command: String,
    words: Vec<String>,
    limit: Duration,
}

/// A running process; it and what it started are ended when it is dropped.
struct Running(Child);

impl Program {
    /// Words of a command line, with quotes as in a shell; `limit` is the time that one run may take.
    ///
    /// # Errors
    /// A command that is empty or has a quote without its end.
    pub fn new(command: &str, limit: Duration) -> Result<Self, BenchError> {
        let program = |words| Self { command: command.to_string(), words, limit };
        match shlex::split(command) {
            Some(words) if !words.is_empty() => Ok(program(words)),
            Some(_) => Err(program(Vec::new()).failed("the command is empty")),
            None => Err(program(Vec::new()).failed("a quote in the command has no end")),
        }
    }

    /// A program and its arguments as they are.
    pub fn of_words(words: Vec<String>, limit: Duration) -> Self {
        Self { command: words.join(" "), words, limit }
    }

    fn failed(&self, message: impl Into<String>) -> BenchError {
        BenchError::Peer { command: self.command.clone(), message: message.into() }
    }

    /// Runs it with a folder as its last argument.
    ///
    /// # Errors
    /// If it cannot be started, fails, or takes longer than it may.
    pub fn run(&self, folder: &Path) -> Result<Sample, BenchError> {
        let mut command = Command::new(&self.words[0]);
        command.args(&self.words[1..]).arg(folder).stdout(Stdio::null()).stdin(Stdio::null());
        end_with_this_process(&mut command);
        let before = seconds_of_children();
        let watch = Stopwatch::start();
        let child = command.spawn().map_err(|e| self.failed(format!("it cannot be started: {e}")))?;
        let status =
            Running(child).wait(self.limit).map_err(|e| self.failed(format!("it cannot be waited for: {e}")))?;
        let wall_s = watch.read().wall_s;
        match status {
            None => Err(self
                .failed(format!("timeout: ended after {} s; --peer-timeout changes the limit", self.limit.as_secs()))),
            Some(status) if !status.success() => Err(self.failed(format!("it ended with {status}"))),
            Some(_) => {
                let cpu = before.zip(seconds_of_children()).map(|(before, after)| after - before);
                Ok(Sample { wall_s, cpu_s: cpu.unwrap_or(wall_s) })
            }
        }
    }
}

impl Running {
    fn wait(mut self, limit: Duration) -> std::io::Result<Option<ExitStatus>> {
        self.0.wait_timeout(limit)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Some(group) = rustix::process::Pid::from_raw(self.0.id() as i32) {
            // it may have ended, with all it started: then there is no such group
            let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
        }
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The process gets a group of its own, to be ended with what it starts; on Linux it also ends if this one
/// does, however that ends.
fn end_with_this_process(command: &mut Command) {
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    #[cfg(target_os = "linux")]
    {
        use rustix::process::{Signal, getpid, getppid, set_parent_process_death_signal};
        let parent = getpid();
        let tie = move || {
            set_parent_process_death_signal(Some(Signal::KILL))?;
            if getppid() == Some(parent) { Ok(()) } else { Err(std::io::ErrorKind::BrokenPipe.into()) }
        };
        // SAFETY: between fork and exec the closure makes three system calls; it neither allocates nor takes
        // locks.
        unsafe { std::os::unix::process::CommandExt::pre_exec(command, tie) };
    }
}

/// Processor time of all programs this process has started and seen to their end, s, where `/proc` tells it.
fn seconds_of_children() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let [user, system] = [fields.get(13)?, fields.get(14)?].map(|f| f.parse::<f64>());
    Some((user.ok()? + system.ok()?) / 100.0) // clock ticks of 10 ms
}

#[cfg(all(test, unix))]
mod tests {
    use std::time::Instant;

    use super::*;

    fn run(command: &str, folder: &Path, seconds: u64) -> Result<Sample, String> {
        let program = Program::new(command, Duration::from_secs(seconds)).map_err(|error| error.to_string())?;
        program.run(folder).map_err(|error| error.to_string())
    }

    #[test]
    fn quotes_are_those_of_a_shell() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("a folder");
        std::fs::create_dir(&place).unwrap();
        run("sh -c 'echo \"$1 $2\" > \"$3/words\"' name \"two  words\" it\\'s", &place, 20).unwrap();
        assert_eq!(std::fs::read_to_string(place.join("words")).unwrap(), "two  words it's\n");
        for (command, complaint) in
            [("sh -c 'exit", "a quote in the command has no end"), ("  ", "the command is empty")]
        {
            assert!(run(command, &place, 20).unwrap_err().contains(complaint));
        }
        assert!(run("sh -c 'exit 3'", &place, 20).unwrap_err().contains("exit status: 3"));
    }

    #[test]
    fn a_slow_program_is_ended_with_all_it_started() {
        let folder = tempfile::tempdir().unwrap();
        let started = Instant::now();
        let slow = "sh -c 'sleep 600 & echo $! > \"$0/child\"; wait'";
        assert!(run(slow, folder.path(), 1).unwrap_err().contains("ended after 1 s; --peer-timeout"));
        assert!(started.elapsed() < Duration::from_secs(60));
        let child = std::fs::read_to_string(folder.path().join("child")).unwrap();
        let state = || std::fs::read_to_string(format!("/proc/{}/stat", child.trim())).unwrap_or_default();
        let gone = || state().is_empty() || state().contains(") Z");
        assert!((0..200).any(|_| gone() || {
            std::thread::sleep(Duration::from_millis(50));
            false
        }));
    }
}
