//! `CITATION.cff`, `codemeta.json`, the workflows and `Cargo.toml` say the same.

use std::path::{Path, PathBuf};

use serde_json::Value;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(name: &str) -> String {
    std::fs::read_to_string(root().join(name)).unwrap()
}

fn package() -> toml::Table {
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    manifest["workspace"]["package"].as_table().unwrap().clone()
}

/// Values below a key at the left of a file in YAML: what follows it, or its list.
fn of_key(text: &str, key: &str) -> Vec<String> {
    let mut lines = text.lines().skip_while(|line| !line.starts_with(&format!("{key}:")));
    let first = lines.next().unwrap_or_else(|| panic!("no {key}"))[key.len() + 1..].trim().to_string();
    let list = lines.take_while(|line| line.starts_with(' ')).map(|line| line.trim().trim_start_matches("- "));
    let list = list.map(|item| item.trim_start_matches("name: ").to_string());
    if first.is_empty() {
        list.collect()
    } else if first == ">-" {
        vec![list.collect::<Vec<_>>().join(" ")]
    } else {
        vec![first]
    }
}

fn strings(value: &Value) -> Vec<String> {
    value.as_array().unwrap().iter().map(|item| item.as_str().unwrap().to_string()).collect()
}

#[test]
fn what_is_cited_is_the_package() {
    let (package, citation) = (package(), read("CITATION.cff"));
    let codemeta: Value = serde_json::from_str(&read("codemeta.json")).unwrap();
    let version = package["version"].as_str().unwrap();
    assert_eq!((of_key(&citation, "version"), &codemeta["version"]), (vec![version.to_string()], &version.into()));
    let licences: Vec<&str> = package["license"].as_str().unwrap().split(" OR ").collect();
    assert_eq!(of_key(&citation, "license"), licences);
    let spdx: Vec<String> = licences.iter().map(|name| format!("https://spdx.org/licenses/{name}")).collect();
    assert_eq!(strings(&codemeta["license"]), spdx);
    let author = package["authors"][0].as_str().unwrap();
    assert_eq!(
        (of_key(&citation, "authors"), &codemeta["author"][0]["name"]),
        (vec![author.to_string()], &author.into())
    );
    let title = of_key(&citation, "title");
    assert_eq!((title.as_slice(), &codemeta["name"]), (&["fisura".to_string()][..], &"fisura".into()));
    assert_eq!(of_key(&citation, "abstract"), [codemeta["description"].as_str().unwrap()]);
    assert_eq!(of_key(&citation, "keywords"), strings(&codemeta["keywords"]));
    for paper in codemeta["referencePublication"].as_array().unwrap() {
        assert!(citation.contains(paper["name"].as_str().unwrap()), "{paper}");
    }
    assert_eq!(codemeta["runtimePlatform"], format!("Rust {}", package["rust-version"].as_str().unwrap()));
}

#[test]
fn workflows_and_recipes_take_the_compiler_of_the_package() {
    let compiler = package()["rust-version"].as_str().unwrap().to_string();
    for (name, form) in [
        (".github/workflows/ci.yml", "rustup default "),
        (".github/workflows/release.yml", "rustup default "),
        (".github/workflows/full-verification.yml", "rustup default "),
        ("xtask/templates/gitlab-ci.yml", "image: rust:"),
        (".ci/Containerfile", "library/rust:"),
    ] {
        let text = read(name);
        let versions: Vec<&str> =
            text.split(form).skip(1).map(|rest| rest.split(['\n', '-']).next().unwrap()).collect();
        assert!(!versions.is_empty() && versions.iter().all(|version| *version == compiler), "{name}: {versions:?}");
    }
}

#[test]
fn a_release_is_built_from_the_lock_file_and_has_checksums() {
    let release = read(".github/workflows/release.yml");
    assert!(release.contains("--release --locked") && release.contains("sha256sum --check"), "{release}");
}
