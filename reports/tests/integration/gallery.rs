//! The committed gallery: every chart is drawn from the numbers beside it, and these from the cases as they
//! are. Pictures of fields have their provenance only: their rasters are large, and `figures` computes them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fisura_reports::bundle::{Bundle, read, redraw};
use fisura_verification::output::fingerprint::fingerprint;
use fisura_verification::record::FigureBody;
use fisura_verification::suite::{Case, load_cases};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn gallery() -> PathBuf {
    root().join("reports/gallery")
}

/// File names in the gallery that end so, without the ending.
fn stems(ending: &str) -> BTreeSet<String> {
    let names = std::fs::read_dir(gallery()).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap());
    names.filter_map(|name| name.strip_suffix(ending).map(String::from)).collect()
}

fn is_picture(bundle: &Bundle) -> bool {
    matches!(bundle.figure.body, FigureBody::Field { .. })
}

const REMEDY: &str = "draw it anew with `cargo xtask figures` and copy it, see reports/gallery/README.md";

#[test]
fn every_figure_has_its_numbers_and_provenance() {
    let drawn = stems(".svg");
    assert!(!drawn.is_empty());
    assert_eq!(drawn, stems(".json"));
    assert_eq!(drawn, stems(".caption.txt"));
    let mut owned = BTreeSet::new();
    for name in &drawn {
        let bundle = read(&gallery(), name).unwrap();
        if is_picture(&bundle) {
            continue;
        }
        owned.extend(bundle.data.into_keys().map(|file| file.trim_end_matches(".csv").to_string()));
    }
    assert_eq!(owned, stems(".csv"), "numbers without a figure, or the other way round");
}

#[test]
fn drawing_again_gives_the_committed_bytes() {
    for name in stems(".svg") {
        let bundle = read(&gallery(), &name).unwrap();
        if is_picture(&bundle) {
            continue;
        }
        for (file, expected) in &bundle.data {
            let found = fingerprint([std::fs::read(gallery().join(file)).unwrap()]);
            assert_eq!(&found, expected, "{file} was changed by hand");
        }
        let committed = std::fs::read_to_string(gallery().join(format!("{name}.svg"))).unwrap();
        assert!(redraw(&gallery(), &bundle).unwrap() == committed, "{name}.svg is out of date: {REMEDY}");
    }
}

#[test]
fn the_cases_are_those_that_were_run() {
    let cases = load_cases(&root().join("verification/cases"), &[]).unwrap();
    for name in stems(".svg") {
        let inputs = read(&gallery(), &name).unwrap().inputs;
        assert!(!inputs.is_empty(), "{name} comes from no case");
        for (id, expected) in inputs {
            let found = cases.iter().find(|case| case.id() == id).map(Case::inputs);
            assert_eq!(found.as_ref(), Some(&expected), "{name}: the case {id} is another than was run: {REMEDY}");
        }
    }
}

#[test]
fn the_readme_shows_figures_of_the_gallery() {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(text.contains("](reports/gallery/"));
}
