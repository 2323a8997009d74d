use std::fs;
use std::path::{Path, PathBuf};

use approx::assert_relative_eq;
use tempfile::TempDir;

use super::*;
use crate::output::history::Table;
use crate::record::CurveStyle;

const FRAME: &str = r#"citation = "made up"
obtained = "published-output"
kind = "literature"
model = "m"
resolution = "r"
"#;

const CURVE: &str = r#"
[[curve]]
quantity = "plate/elastic-energy"
label = "made up"
file = "curve.csv"
x = "time_us"
x_unit = "us"
y = "elastic_j_per_m"
y_unit = "J/m"
uncertainty_absolute = 0.5
uncertainty_relative = 0.1
uncertainty_note = "made up"
"#;

fn committed() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data")
}

/// A library of one folder `made-up`, with these files.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    fs::create_dir(root.path().join("made-up")).unwrap();
    for (name, text) in files {
        fs::write(root.path().join("made-up").join(name), text).unwrap();
    }
    root
}

fn load(source: &str, csv: &str) -> Result<Library, ReferenceError> {
    Library::load(folder(&[("source.toml", source), ("curve.csv", csv)]).path())
}

fn curve(csv: &str, extra: &str) -> ReferenceCurve {
    let library = load(&format!("{FRAME}{CURVE}{extra}"), &format!("time_us,elastic_j_per_m\n{csv}")).unwrap();
    library.curve("made-up", "plate/elastic-energy").unwrap().clone()
}

#[test]
fn every_committed_folder_loads_and_says_where_it_comes_from() {
    let library = Library::load(&committed()).unwrap();
    let ids: Vec<_> = library.sources().iter().map(|s| s.id.as_str()).collect();
    let expected = ["estrada-2024", "estrada-2024/figure-3a", "estrada-2024/figure-3b", "estrada-2024/figure-5b"];
    assert!(expected.iter().all(|id| ids.contains(id)), "{ids:?}");
    for folder in ["independent-fem", "mandal-2020", "nguyen-2019", "plate-events", "raibagi-2022"] {
        assert!(ids.contains(&folder), "{folder} is missing in {ids:?}");
    }
    for source in library.sources() {
        let is_entry = source.bibtex.as_ref().is_some_and(|entry| entry.starts_with('@'));
        assert!(is_entry || source.id.ends_with("/runs"), "{source:?}");
        assert!(!source.citation.is_empty() && !source.model.is_empty() && !source.resolution.is_empty(), "{source:?}");
    }
    for source in library.bands().iter().flat_map(|b| &b.sources) {
        assert!(ids.contains(&source.as_str()), "a band names the unknown source {source}");
    }
    assert!(quantities().filter(|q| *q != "rings/fracture-energy").all(|q| !library.curves(q).is_empty()));
    // A reader may have added figures of the source paper.
    let elastic = library.curves("plate/elastic-energy").into_iter().map(|c| c.id.as_str());
    let elastic: Vec<_> = elastic.filter(|id| !id.starts_with("estrada-2024")).collect();
    let others = ["plate-family", "raibagi-2022", "raibagi-benchmark-digitised"];
    assert_eq!(elastic[..3], ["mandal-2020/at2", "mandal-2020/at1", "mandal-2020/pfczm"]);
    assert_eq!(elastic[3..], others);
}

#[test]
fn committed_numbers_come_out_in_si_units() {
    let library = Library::load(&committed()).unwrap();
    let tip = library.curve("plate-family", "plate/tip-x").unwrap();
    assert_eq!((tip.x[70], tip.x_unit, tip.y_unit), (35e-6, "s", "m"));
    assert!((50.1e-3..50.3e-3).contains(&tip.y[0]) && (0.1e-3..1e-3).contains(&tip.uncertainty_absolute), "{tip:?}");
    let time = library.band("plate-events", "branching-time").unwrap();
    assert_eq!((time.min, time.max, time.unit), (30.5e-6, 38e-6, "s"));
    let value = library.value("plate-family", "plane-stress/onset-time").unwrap();
    assert_eq!((value.value, value.unit), (12.7e-6, "s"));
    assert_eq!(library.value("estrada-2024", "plate-density").unwrap().unit, "kg/m^3");
    assert_eq!(library.value("estrada-2024", "rings-young-modulus").unwrap().value, 190e9);
}

#[test]
fn the_reference_of_the_plate_lies_in_its_bands() {
    let library = Library::load(&committed()).unwrap();
    let increment = library.curve("plate-family", "plate/fracture-increment").unwrap();
    for (time, name) in [(50e-6, "fracture-increment-50us"), (80e-6, "fracture-increment-80us")] {
        let band = library.band("plate-events", name).unwrap();
        let value = increment.at(time).unwrap();
        assert!((band.min..=band.max).contains(&value), "{name}: {value}");
    }
}

/// Copies `source.toml` of a committed folder to a temporary library; the folder's own name is kept.
fn copy_of(id: &str, root: &Path) -> PathBuf {
    let target = root.join(id);
    fs::create_dir_all(&target).unwrap();
    fs::copy(committed().join(id).join("source.toml"), target.join("source.toml")).unwrap();
    target
}

#[test]
fn a_figure_that_a_reader_digitises_appears_without_a_code_change() {
    let root = tempfile::tempdir().unwrap();
    let figure = copy_of("estrada-2024/figure-3a", root.path());
    let count = |quantity| Library::load(root.path()).unwrap().curves(quantity).len();
    assert_eq!(count("plate/elastic-energy"), 0);
    fs::write(figure.join("curve.csv"), "time_us,elastic_j_per_m\n0,0\n10.5,0.12\n20,0.06\n").unwrap();
    assert_eq!((count("plate/elastic-energy"), count("plate/fracture-increment")), (1, 0));
    let library = Library::load(root.path()).unwrap();
    let added = library.curve("estrada-2024/figure-3a", "plate/elastic-energy").unwrap();
    assert_eq!(added.at(10.5e-6), Some(0.12));
    assert_eq!(added.series_path(), "series/reference-estrada-2024-figure-3a-plate-elastic-energy.csv");

    let both = copy_of("estrada-2024/figure-3b", root.path());
    fs::write(both.join("curve.csv"), "time_us,fracture_j_per_m\n0,0.25\n80,0.75\n").unwrap();
    let library = Library::load(root.path()).unwrap();
    assert_eq!(library.curves("plate/fracture-increment")[0].y, [0.0, 0.5], "raw values become increments");

    let rings = copy_of("estrada-2024/figure-5b", root.path());
    fs::write(rings.join("curve.csv"), "time_us,fracture_j\n0,0\n150,0.5\n").unwrap();
    assert_eq!(count("rings/fracture-energy"), 1);
}

#[test]
fn a_misspelt_column_of_a_digitised_figure_is_named() {
    let root = tempfile::tempdir().unwrap();
    let figure = copy_of("estrada-2024/figure-3a", root.path());
    fs::write(figure.join("curve.csv"), "time_us,elastic\n0,0\n").unwrap();
    let error = Library::load(root.path()).unwrap_err().to_string();
    assert!(
        error.contains("curve.csv") && error.contains("\"elastic\"") && error.contains("elastic_j_per_m"),
        "{error}"
    );
    fs::write(figure.join("curve.csv"), "time_us,fracture_j_per_m\n30,0.2\n80,0.6\n").unwrap();
    let error = Library::load(root.path()).unwrap_err().to_string();
    assert!(error.contains("subtract_first") && error.contains("add that point"), "{error}");
    fs::write(figure.join("curve.csv"), "time_us,fracture_j_per_m,fracture_increment_j_per_m\n0,1,0\n").unwrap();
    let error = Library::load(root.path()).unwrap_err().to_string();
    assert!(error.contains("a second curve"), "{error}");
}

#[test]
fn interpolation_is_linear_and_never_extrapolates() {
    let curve = curve("0,1\n2,3\n4,0\n", "");
    assert_eq!(curve.at(0.0), Some(1.0));
    assert_eq!(curve.at(4e-6), Some(0.0));
    assert_relative_eq!(curve.at(1e-6).unwrap(), 2.0, max_relative = 1e-14);
    assert_relative_eq!(curve.at(3e-6).unwrap(), 1.5, max_relative = 1e-14);
    for outside in [-1e-12, 4.0001e-6, f64::NAN] {
        assert_eq!(curve.at(outside), None);
    }
    assert_eq!(curve.range(), [0.0, 4e-6]);
    assert_eq!((curve.uncertainty(1.0), curve.uncertainty(-10.0)), (0.5, 1.0));
}

#[test]
fn gaps_stay_gaps() {
    let curve = curve("0,1\n1,2\n4,8\n5,9\n", "max_gap = 1.0\n");
    assert_eq!((curve.at(2e-6), curve.at(1e-6), curve.at(4e-6)), (None, Some(2.0), Some(8.0)));
    assert!(curve.at(0.5e-6).is_some() && curve.at(4.5e-6).is_some());
    let (_, table) = curve.series(1.0, 1.0);
    assert_eq!(table.rows(), 5);
    assert!(table.columns[1][2].is_nan(), "the line breaks in the gap");
}

#[test]
fn falling_abscissae_are_turned_round() {
    let curve = curve("4,1\n2,3\n0,5\n", "");
    assert_eq!((curve.x.clone(), curve.y.clone()), (vec![0.0, 2e-6, 4e-6], vec![5.0, 3.0, 1.0]));
}

#[test]
fn distances_follow_their_formulas() {
    let curve = curve("0,3\n1,4\n2,5\n", "");
    let x = [0.0, 2e-6, 4e-6];
    let y = [3.0, 6.0, 9.0]; // 3, 4.5, 6 at the reference's abscissae
    let relative = relative_rms(&curve, &x, &y, 0.0, 2e-6).unwrap();
    assert_relative_eq!(relative, (1.25_f64 / 50.0).sqrt(), max_relative = 1e-12);
    let absolute = rms_difference(&curve, &x, &y, 0.0, 2e-6).unwrap();
    assert_relative_eq!(absolute, (1.25_f64 / 3.0).sqrt(), max_relative = 1e-12);
    assert_relative_eq!(rms_difference(&curve, &x, &y, 1.5e-6, 9e-6).unwrap(), 1.0, max_relative = 1e-12);
    let short = [0.0, 1e-6, 2e-6 * (1.0 - 1e-13)];
    assert_eq!(rms_difference(&curve, &short, &[3.0, 4.0, 5.0], 0.0, 2e-6), Some(0.0), "round-off of the last time");
}

#[test]
fn uncertainties_are_measured_in_the_norms_of_the_distances() {
    let steep = curve("0,100\n1,100\n2,104\n3,108", "uncertainty_x = 0.5\n");
    // relative 0.1, and 0.5 us of a slope of 0, 2, 4 and 4 per us
    let rows = [10.0_f64, 10.0_f64.hypot(1.0), 10.4_f64.hypot(2.0), 10.8_f64.hypot(2.0)];
    let norm = rows.iter().map(|u| u * u).sum::<f64>().sqrt();
    let size = [100.0_f64, 100.0, 104.0, 108.0].iter().map(|y| y * y).sum::<f64>().sqrt();
    let close =
        |found: Option<f64>, expected: f64| assert!((found.unwrap() / expected - 1.0).abs() < 1e-12, "{found:?}");
    close(relative_uncertainty(&steep, 0.0, 3e-6), norm / size);
    close(rms_uncertainty(&steep, 0.0, 3e-6), norm / 2.0);
    close(rms_uncertainty(&steep, 2e-6, 2e-6), rows[2]);
    close(steep.reference_at(2e-6, -2.0).unwrap().uncertainty, 2.0 * rows[2]);
    assert_eq!(steep.reference_at(2e-6, -2.0).unwrap().value, Some(-208.0));
    assert_eq!(relative_uncertainty(&steep, 4e-6, 5e-6), None, "no row there");
    let unknown = ReferenceCurve { uncertainty_absolute: 0.0, uncertainty_relative: 0.0, uncertainty_x: 0.0, ..steep };
    assert_eq!((relative_uncertainty(&unknown, 0.0, 3e-6), rms_uncertainty(&unknown, 0.0, 3e-6)), (None, None));
    assert_eq!(unknown.reference_at(2e-6, 1.0).unwrap().uncertainty, None);
}

#[test]
fn a_run_that_ended_early_has_no_distance() {
    let curve = curve("0,3\n1,4\n2,5\n", "");
    assert_eq!(relative_rms(&curve, &[0.0, 1e-6], &[3.0, 4.0], 0.0, 2e-6), None);
    assert_eq!(relative_rms(&curve, &[0.0, 2e-6], &[3.0, f64::NAN], 0.0, 2e-6), None);
    assert_eq!(rms_difference(&curve, &[0.0, 2e-6], &[3.0, 4.0], 3e-6, 4e-6), None, "no reference points");
    assert_eq!(rms_difference(&curve, &[], &[], 0.0, 2e-6), None);
}

#[test]
fn a_curve_becomes_a_dashed_line_with_its_table() {
    let (line, table) = curve("0,1\n2,3\n", "").series(1e6, 1e3);
    assert_eq!((line.style, line.x_scale, line.y_scale), (CurveStyle::Reference, 1e6, 1e3));
    assert_eq!((line.uncertainty_absolute, line.uncertainty_relative), (500.0, 0.1));
    assert_eq!(line.series, "series/reference-made-up-plate-elastic-energy.csv");
    assert_eq!(table, Table { names: vec!["x".into(), "y".into()], columns: vec![vec![0.0, 2e-6], vec![1.0, 3.0]] });
    assert_eq!(curve("1,1\n", "").series(1.0, 1.0).0.style, CurveStyle::Points);
}

#[test]
fn what_is_wrong_is_named_with_its_place_and_remedy() {
    let good = format!("{FRAME}{CURVE}");
    let csv = "time_us,elastic_j_per_m\n0,1\n1,2\n";
    let cases = [
        (good.replace("citation", "sitation"), csv, vec!["line 1", "sitation", "citation"]),
        (good.replace("\"made up\"\nobtained", "\" \"\nobtained"), csv, vec!["line 1", "citation", "empty"]),
        (good.replace("published-output", "dreamt"), csv, vec!["line 2", "dreamt", "digitised"]),
        (good.replace("x_unit = \"us\"", "x_unit = \"mm\""), csv, vec!["line 7", "x_unit", "a time"]),
        (good.replace("\"J/m\"", "\"J/q\""), csv, vec!["y_unit", "unknown unit"]),
        (good.replace("plate/elastic-energy", "plate/joy"), csv, vec!["plate/joy", "plate/tip-x"]),
        (good.replace("curve.csv", "gone.csv"), csv, vec!["line 7", "gone.csv", "picture-only"]),
        (good.replace("y = \"elastic_j_per_m\"", "y = \"e\""), csv, vec!["no column \"e\"", "elastic_j_per_m"]),
        (good.replace("absolute = 0.5", "absolute = -0.5"), csv, vec!["uncertainty_absolute", "at least 0"]),
        (format!("{good}uncertainty_x = -1.0\n"), csv, vec!["uncertainty_x", "at least 0"]),
        (good.replace("note = \"made up\"", "note = \"\""), csv, vec!["uncertainty_note", "estimated"]),
        (format!("{good}{CURVE}"), csv, vec!["line 19", "a second curve", "variant"]),
        (good.clone(), "time_us,elastic_j_per_m\n0,1\n0,2\n", vec!["does not increase", "sort"]),
        (good.clone(), "time_us,elastic_j_per_m\n0,1\n1,nan\n", vec!["line 7", "elastic_j_per_m", "number"]),
        (good.clone(), "time_us,elastic_j_per_m\n0,one\n", vec!["curve.csv", "line 2", "one"]),
        (good.clone(), "time_us,elastic_j_per_m\n", vec!["no rows", "add points"]),
        (format!("{good}[[band]]\nname='b'\nunit='us'\nmin=2.0\nmax=1.0\nnote=''\n"), csv, vec!["\"b\"", "swap"]),
        (format!("{good}[[value]]\nname='v'\nunit='W'\nvalue=2.0\nnote=''\n"), csv, vec!["\"W\"", "multiple"]),
    ];
    for (source, csv, words) in cases {
        let error = load(&source, csv).expect_err(&source).to_string();
        assert!(words.iter().all(|word| error.contains(word)), "{words:?} in {error}");
    }
}

#[test]
fn folders_without_provenance_are_errors() {
    let error = Library::load(folder(&[("curve.csv", "a\n1\n")]).path()).unwrap_err().to_string();
    assert!(error.contains("provenance") && error.contains("curve.csv"), "{error}");
    let error = Library::load(folder(&[]).path()).unwrap_err().to_string();
    assert!(error.contains("no source.toml"), "{error}");
    assert!(Library::load(Path::new("no-such-folder")).is_err());
}
