//! Starting the binary, and the scenes it is started on.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use serde_json::Value;
use tempfile::TempDir;

/// An elastic block pulled upwards: 200 particles.
pub const BLOCK: &str = include_str!("block.toml");

/// The block with a notch and a material that breaks.
pub const NOTCHED: &str = include_str!("notched.toml");

/// A folder in which the binary is started, outside any workspace unless it is made one.
pub struct Place {
    folder: TempDir,
    /// Value of `CARGO_MANIFEST_DIR`, as cargo would set it.
    pub manifest: Option<PathBuf>,
    /// Further variables of the environment.
    pub variables: Vec<(&'static str, &'static str)>,
}

/// What a command left behind.
#[derive(Debug)]
pub struct Outcome {
    /// Exit status.
    pub status: i32,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl Outcome {
    /// Standard output read as JSON.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.out).unwrap_or_else(|e| panic!("{e}: {self:?}"))
    }

    /// Fails unless the status is the expected one.
    #[track_caller]
    pub fn with_status(self, expected: i32) -> Self {
        assert_eq!(self.status, expected, "{self:?}");
        self
    }

    /// Fails unless standard output has all of these.
    #[track_caller]
    pub fn says(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(self.out.contains(part), "{part:?} is missing from standard output: {self:?}");
        }
        self
    }

    /// Fails unless standard error has all of these.
    #[track_caller]
    pub fn complains_of(self, parts: &[&str]) -> Self {
        for part in parts {
            assert!(self.err.contains(part), "{part:?} is missing from standard error:\n{}", self.err);
        }
        self
    }
}

impl Place {
    /// An empty folder.
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a temporary folder"), manifest: None, variables: Vec::new() }
    }

    /// A folder with a scene file.
    pub fn with(name: &str, text: &str) -> Self {
        let place = Self::new();
        place.write(name, text);
        place
    }

    /// A file or folder in it.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, and the folders above it.
    pub fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder above")).expect("a new folder");
        fs::write(path, text).expect("a new file");
    }

    /// Text of a file.
    #[track_caller]
    pub fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Names of the files in a folder, sorted, without manifest and lock.
    pub fn files(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(name)).expect("a folder");
        let mut names: Vec<String> =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.retain(|name| !["fisura.sha256", ".fisura.lock"].contains(&name.as_str()));
        names.sort();
        names
    }

    /// A JSON file.
    #[track_caller]
    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Starts `xtask` here with the arguments of a line, as a shell reads it.
    pub fn xtask(&self, line: &str) -> Outcome {
        self.xtask_in("", line)
    }

    /// Starts `xtask` in a folder of this one.
    pub fn xtask_in(&self, folder: &str, line: &str) -> Outcome {
        self.start(Path::new(env!("CARGO_BIN_EXE_xtask")), folder, line)
    }

    /// Starts `xtask` here and fails unless it ends with 0.
    #[track_caller]
    pub fn succeeds(&self, line: &str) -> Outcome {
        self.xtask(line).with_status(0)
    }

    /// Starts `xtask` here and fails unless it ends with 2 and standard error has all of these.
    #[track_caller]
    pub fn refuses(&self, line: &str, parts: &[&str]) -> Outcome {
        self.xtask(line).with_status(2).complains_of(parts)
    }

    /// Starts a copy of the binary in a folder of this one.
    pub fn start(&self, program: &Path, folder: &str, line: &str) -> Outcome {
        let output = self.command(program, line).current_dir(self.path(folder)).output().expect("the binary starts");
        Outcome {
            status: output.status.code().expect("an exit status, not a signal"),
            out: String::from_utf8(output.stdout).expect("UTF-8"),
            err: String::from_utf8(output.stderr).expect("UTF-8"),
        }
    }

    /// Starts `xtask` here and does not wait for it; its standard error can be read.
    pub fn begin(&self, line: &str) -> Child {
        let mut command = self.command(Path::new(env!("CARGO_BIN_EXE_xtask")), line);
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the binary starts")
    }

    fn command(&self, program: &Path, line: &str) -> Command {
        let mut command = Command::new(program);
        command.args(shlex::split(line).expect("a line of a shell")).current_dir(self.folder.path());
        ["CARGO_MANIFEST_DIR", "COLUMNS", "LINES", "GITHUB_ACTIONS"].iter().for_each(|name| {
            command.env_remove(name);
        });
        command.envs(self.manifest.iter().map(|m| ("CARGO_MANIFEST_DIR", m)));
        command.envs(self.variables.iter().copied());
        command
    }
}

/// Sends a signal such as `-INT`; exit status, if there is one, and standard error.
pub fn end(child: Child, signal: &str) -> (Option<i32>, String) {
    let id = child.id().to_string();
    assert!(Command::new("kill").args([signal, &id]).status().expect("kill").success());
    let output = child.wait_with_output().expect("it ends");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

/// Waits until `there` is true, a minute at most; whether it is.
pub fn wait_until(there: impl Fn() -> bool) -> bool {
    let clock = Instant::now();
    while !there() && clock.elapsed() < Duration::from_secs(60) {
        sleep(Duration::from_millis(5));
    }
    there()
}

/// Paths of all keys, one per line; the entries of an array count as one.
pub fn keys(value: &Value) -> String {
    fn collect(value: &Value, path: &str) -> Vec<String> {
        let below = |(key, value): (&String, &Value)| {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            [vec![path.clone()], collect(value, &path)].concat()
        };
        match value {
            Value::Object(entries) => entries.iter().flat_map(below).collect(),
            Value::Array(entries) => entries.iter().flat_map(|entry| collect(entry, &format!("{path}[]"))).collect(),
            _ => Vec::new(),
        }
    }
    let mut paths = collect(value, "");
    paths.dedup();
    paths.join("\n")
}
