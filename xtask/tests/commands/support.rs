//! Starting the binary, and the scenes it is started on.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;
use tempfile::TempDir;

/// An elastic block pulled upwards: 200 particles.
pub const BLOCK: &str = r#"title = "Block"

[mesh]
degree = 2
origin = ["0 mm", "0 mm"]
size   = ["10 mm", "5 mm"]
cells  = [10, 5]

[analysis]
end_time = "5 us"

[material.glass]
young_modulus = "32 GPa"
poisson_ratio = 0.2
density       = "2450 kg/m^3"

[[body]]
name     = "block"
material = "glass"
shape    = { rectangle = { min = ["0 mm", "0 mm"], max = ["10 mm", "5 mm"] } }
particles_per_cell = [2, 2]
[[body.traction]]
edge   = "top"
stress = ["0 MPa", "1 MPa"]

[output]
samples = 10
frames  = ["0 us", "5 us"]
"#;

/// The block with a notch and a material that breaks.
pub fn notched() -> String {
    let fracture = "[material.glass.fracture]\ncritical_energy_release_rate = \"3 J/m^2\"\nlength_scale = \"1 mm\"\n\n";
    let crack = "[[body.crack]]\nfrom = [\"0 mm\", \"2.5 mm\"]\nto = [\"4 mm\", \"2.5 mm\"]\nhalf_width = \"1 mm\"\n\n";
    let pulled = "[[body.traction]]\nedge = \"bottom\"\nstress = [\"0 MPa\", \"-1 MPa\"]\n";
    let text = BLOCK.replacen("[[body]]", &format!("{fracture}[[body]]"), 1);
    text.replacen("[output]", &format!("{pulled}{crack}[output]"), 1)
}

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

    /// Starts `xtask` here.
    pub fn xtask(&self, arguments: &[&str]) -> Outcome {
        self.xtask_in(self.folder.path(), arguments)
    }

    /// Starts `xtask` in another folder.
    pub fn xtask_in(&self, folder: &Path, arguments: &[&str]) -> Outcome {
        self.start(Path::new(env!("CARGO_BIN_EXE_xtask")), folder, arguments)
    }

    /// Starts a copy of the binary in another folder.
    pub fn start(&self, program: &Path, folder: &Path, arguments: &[&str]) -> Outcome {
        let output = self.command_of(program, folder, arguments).output().expect("the binary starts");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        Outcome {
            status: output.status.code().expect("an exit status, not a signal"),
            out: text(output.stdout),
            err: text(output.stderr),
        }
    }
}

impl Place {
    /// `xtask` here, to be started.
    pub fn command(&self, arguments: &[&str]) -> Command {
        self.command_of(Path::new(env!("CARGO_BIN_EXE_xtask")), self.folder.path(), arguments)
    }

    fn command_of(&self, program: &Path, folder: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(folder);
        ["CARGO_MANIFEST_DIR", "COLUMNS", "LINES", "GITHUB_ACTIONS"].iter().for_each(|name| {
            command.env_remove(name);
        });
        command.envs(self.manifest.iter().map(|m| ("CARGO_MANIFEST_DIR", m)));
        command.envs(self.variables.iter().copied());
        command
    }
}

/// Paths of all keys, one per line; the entries of an array count as one.
pub fn keys(value: &Value) -> String {
    fn collect(value: &Value, path: &str, out: &mut Vec<String>) {
        match value {
            Value::Object(entries) => {
                for (key, value) in entries {
                    let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
                    out.push(path.clone());
                    collect(value, &path, out);
                }
            }
            Value::Array(entries) => {
                for entry in entries {
                    collect(entry, &format!("{path}[]"), out);
                }
            }
            _ => {}
        }
    }
    let mut out = Vec::new();
    collect(value, "", &mut out);
    out.dedup();
    out.join("\n")
}
