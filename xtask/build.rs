//! Bakes into the program what it was built from: the commit, and a fingerprint of the sources, which tells
//! uncommitted changes apart. Results and checkpoints name both; the work tree may be another one by the time
//! the program runs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

/// What results depend on, below the root of the workspace.
const SOURCES: [&str; 11] = [
    "Cargo.lock",
    "Cargo.toml",
    "reports/Cargo.toml",
    "reports/src",
    "reports/templates",
    "solver/Cargo.toml",
    "solver/src",
    "verification/Cargo.toml",
    "verification/templates",
    "verification/src",
    "xtask/src",
];

fn main() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=FISURA_COMMIT={}", commit(&root).unwrap_or_else(|| "unknown".to_string()));
    println!("cargo::rustc-env=FISURA_SOURCES={}", fingerprint(&root));
}

/// The commit that is checked out; none outside git, or in a repository of something else.
fn commit(root: &Path) -> Option<String> {
    git(root, &["ls-files", "--error-unmatch", "Cargo.toml"])?;
    let branch = git(root, &["rev-parse", "--symbolic-full-name", "HEAD"]);
    for name in ["HEAD", "packed-refs"].into_iter().map(str::to_string).chain(branch) {
        let path = root.join(git(root, &["rev-parse", "--git-path", &name])?);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(root, &["rev-parse", "HEAD"])
}

/// Trimmed standard output of a git command that succeeds.
fn git(root: &Path, arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).current_dir(root).output().ok().filter(|o| o.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// The first 16 hexadecimal digits of the SHA-256 of all sources with their names.
fn fingerprint(root: &Path) -> String {
    let mut hasher = Sha256::new();
    for name in SOURCES {
        println!("cargo::rerun-if-changed={}", root.join(name).display());
        for file in files(&root.join(name)) {
            let relative = file.strip_prefix(root).unwrap_or(&file).to_string_lossy().replace('\\', "/");
            let content = fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            for part in [relative.as_bytes(), &content] {
                hasher.update((part.len() as u64).to_le_bytes());
                hasher.update(part);
            }
        }
    }
    hasher.finalize().iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// The file itself, or all files below the folder in order of their names.
fn files(path: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(path) else { return vec![path.to_path_buf()] };
    let mut paths: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    paths.sort();
    paths.iter().flat_map(|path| files(path)).collect()
}
