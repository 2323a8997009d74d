//! The committed gallery: every chart is drawn from the numbers beside it, and these from the cases as they
//! are. Pictures of fields have their provenance only: their rasters are large, and `figures` computes them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use fisura_reports::bundle::{read, redraw};
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

const REMEDY: &str = "draw it anew with `cargo xtask figures` and copy it, see reports/gallery/README.md";

#[test]
fn every_figure_has_its_numbers_and_provenance_and_is_drawn_again_to_the_same_bytes() {
    let drawn = stems(".svg");
    assert!(!drawn.is_empty());
    assert_eq!(drawn, stems(".json"));
    assert_eq!(drawn, stems(".caption.txt"));
    let cases = load_cases(&root().join("verification/cases"), &[]).unwrap();
    let mut owned = BTreeSet::new();
    for name in drawn {
        let bundle = read(&gallery(), &name).unwrap();
        assert!(!bundle.inputs.is_empty(), "{name} comes from no case");
        for (id, expected) in &bundle.inputs {
            let found = cases.iter().find(|case| case.id() == *id).map(Case::inputs);
            assert_eq!(found.as_ref(), Some(expected), "{name}: the case {id} is another than was run: {REMEDY}");
        }
        if matches!(bundle.figure.body, FigureBody::Field { .. }) {
            continue;
        }
        for (file, expected) in &bundle.data {
            let found = fingerprint([std::fs::read(gallery().join(file)).unwrap()]);
            assert_eq!(&found, expected, "{file} was changed by hand");
        }
        let committed = std::fs::read_to_string(gallery().join(format!("{name}.svg"))).unwrap();
        assert!(redraw(&gallery(), &bundle).unwrap() == committed, "{name}.svg is out of date: {REMEDY}");
        owned.extend(bundle.data.into_keys().map(|file| file.trim_end_matches(".csv").to_string()));
    }
    assert_eq!(owned, stems(".csv"), "numbers without a figure, or the other way round");
}

#[test]
fn the_readme_shows_figures_of_the_gallery() {
    let text = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(text.contains("](reports/gallery/"));
}
