//! Case files that are wrong: said with line, key and remedy before anything runs.

use std::path::Path;

use fisura_verification::case::Case;
use fisura_verification::reference::Library;
use fisura_verification::suite::prepare::prepare;

use crate::support::SCENE;

/// A case without a scene, with these checks.
fn case(checks: &str) -> Result<Case, String> {
    let text = format!("claim = \"a trial\"\nseconds = 1\nstudy = \"basis\"\n{checks}");
    Case::parse(Path::new("trial/case.toml"), &text, &[]).map_err(|error| error.to_string())
}

/// A check of the basis with this id and more lines.
fn check(id: &str, more: &str) -> String {
    format!("[[check]]\nid = {id:?}\nquantity = \"partition of unity, largest error\"\n{more}\n")
}

#[track_caller]
fn refused(checks: &str, parts: &[&str]) {
    let error = case(checks).unwrap_err();
    for part in [&["case.toml:"], parts].concat() {
        assert!(error.contains(part), "{part:?} is missing in {error}");
    }
}

#[test]
fn every_check_has_an_id_of_its_own() {
    let without = "[[check]]\nquantity = \"partition of unity, largest error\"\n";
    assert_eq!(case(without).unwrap().checks[0].id, "partition-of-unity-largest-error");
    refused_by("basis", &[without; 2].concat(), &["two records with the id trial/case/p=2/partition"]);
    refused(&check("Largest error", ""), &["\"Largest error\" is not a valid id", "\"largest-error\""]);
    refused(&check("", ""), &["\"\" is not a valid id"]);
    let other = |id, variant: &str| check(id, &format!("variant = \"p={variant}\""));
    for twice in [
        check("unity", "") + &check("unity", ""),
        check("unity", "") + &other("unity", "2"),
        other("unity", "2") + &other("unity", "2"),
    ] {
        refused_by("basis", &twice, &["check.1.id", "two records with the id trial/case/p=2/unity", "its own id"]);
    }
    assert_eq!(prepared("basis", &(other("unity", "1") + &other("unity", "2"))), "");
    refused("check = []", &["there is no check"]);
}

#[test]
fn a_former_id_is_no_id_of_today() {
    let renamed = |old: &str| check("unity", &format!("formerly = [{old:?}]"));
    assert_eq!(case(&renamed("sum-of-the-functions")).unwrap().checks[0].formerly, ["sum-of-the-functions"]);
    for old in ["unity", "linear"] {
        let linear = quantity("linear precision, largest error", "").replace("\"q\"", "\"linear\"");
        refused_by("basis", &(renamed(old) + &linear), &["check.0.formerly", "is the id of a current record"]);
    }
    refused(&renamed("Sum"), &["check.0.formerly.0", "is not a valid id"]);
}

/// What `prepare` says about a case, nothing if it could run.
fn prepared(study: &str, rest: &str) -> String {
    let text = format!("claim = \"a trial\"\nseconds = 1\nstudy = {study:?}\n{rest}");
    let case = Case::parse(Path::new("trial/case.toml"), &text, &[]);
    let library = Library::load(&crate::support::repository("reference-data")).unwrap();
    let prepared = case.and_then(|case| prepare(&case, &library).map(|_| ()));
    prepared.map_or_else(|error| error.to_string(), |()| String::new())
}

#[track_caller]
fn refused_by(study: &str, rest: &str, parts: &[&str]) {
    let error = prepared(study, rest);
    for part in [&["case.toml:"], parts].concat() {
        assert!(error.contains(part), "{part:?} is missing in {error}");
    }
}

#[test]
fn bounds_that_no_value_can_meet_or_that_count_from_nothing_are_refused() {
    let with = |more: &str| check("unity", &format!("{more}\nwhy = \"a reason\""));
    refused(&with("min = 2\nmax = 1"), &["min 2 is above max 1"]);
    refused(&with("below = -1\nabove = 2"), &["a distance from the reference is negative"]);
    refused(&with("max = 1\nbelow = 1\nabove = 2"), &["bounds of two kinds"]);
    refused(&with("from = 2\nto = 1"), &["to is before from"]);
    refused(&with("expect_source = \"a table\""), &["expect_source without expect"]);
    refused(&check("unity", "max = 1\nwhy = \" \""), &["bounds without a reason"]);
    refused_by("basis", &with("below = 1\nabove = 2"), &["below", "need a reference value", "expect"]);
    assert_eq!(prepared("basis", &with("expect = 0\nbelow = 1\nabove = 2")), "");
    refused_by("pulse", &quantity("speed of a Rayleigh pulse over c_R", "expect = 1"), &["its own reference value"]);
}

/// A check of this quantity.
fn quantity(quantity: &str, more: &str) -> String {
    format!("[[check]]\nid = \"q\"\nquantity = {quantity:?}\n{more}\n")
}

#[test]
fn what_a_study_does_not_read_or_measure_is_refused_before_it_runs() {
    let unity = |more: &str| check("unity", more);
    refused_by("bases", &unity(""), &["unknown study \"bases\"", "did you mean \"basis\""]);
    for key in
        ["band = \"plate-events/axis-end-x\"", "measure = \"closure\"", "at = 1", "scale = 2", "against = \"p=1\""]
    {
        let name = key.split(' ').next().unwrap();
        refused_by("basis", &unity(key), &["does not read", name, "remove it"]);
    }
    refused_by("basis", &unity("variant = \"p=7\""), &["check.0.variant", "known variants: p=1; p=2"]);
    refused_by("basis", &unity("unit = \"m\""), &["check.0.unit", "in \"1\""]);
    refused_by("basis", &quantity("partition of unit, largest error", ""), &["does not measure", "did you mean"]);
    refused_by("basis", &format!("energy_factor = 2\n{}", unity("")), &["does not read energy_factor"]);
    refused_by("basis", &format!("{}\n{}", unity(""), SCENE), &["does not read scene"]);
    refused_by("rotation", &unity(""), &["scene", "needs a [scene] table"]);
    refused_by("convergence", &unity(""), &["convergence", "missing"]);
    let negative = "claim = \"c\"\nseconds = -1\n".to_string() + &unity("");
    let error = Case::parse(Path::new("trial/case.toml"), &negative, &[]).unwrap_err().to_string();
    assert!(error.contains("seconds") && error.contains("not positive"), "{error}");
}

#[test]
fn what_no_run_of_a_scene_has_is_refused_before_it_runs() {
    let of = |lines: &str| format!("{}\n{}", SCENE, quantity("q", lines));
    for (lines, parts) in [
        ("", &["the measure \"final\" needs column", "add column"][..]),
        ("measure = \"closuer\"", &["unknown measure"]),
        ("measure = \"closure\"\nvariant = \"none\"", &["no run of this case"]),
        ("measure = \"closure\"\nmax = 1.0", &["bounds without a reason"]),
        ("meshes = \"finest-mesh\"\ndiscretisation = 0.1\nwhy = \"w\"", &["discretisation beside meshes"]),
        ("measure = \"closure\"\ncolumn = \"elastic_j\"", &["does not read \"column\""]),
        ("measure = \"drift\"", &["needs column", "add column"]),
        ("measure = \"initial\"\ncolumn = \"elastic_j + elastics_j\"", &["no column \"elastics_j\"", "momentum_x"]),
        ("measure = \"initial\"\ncolumn = \" \"", &["the formula is blank"]),
        ("measure = \"initial\"\ncolumn = \"elastic_j^2\"", &["check.0.column", "write pow(a, b)"]),
        ("measure = \"initial\"\ncolumn = \"{greatest elastic_j}\"", &["no column \"greatest elastic_j\""]),
        ("measure = \"slope\"\ncolumn = \"elastic_j\"\nto = \"= 2*period\"", &["no column \"period\""]),
        ("measure = \"slope\"\ncolumn = \"elastic_j\"\nto = \"= 2*elastic_j\"", &["where a number is needed"]),
        ("measure = \"slope\"\ncolumn = \"elastic_j\"\nfrom = 2\nto = 3", &["no sample lies between", "ends at"]),
        ("measure = \"slope\"\ncolumn = \"elastic_j\"\nfrom = 0.11\nto = 0.19", &["no sample lies between"]),
        ("measure = \"value-at\"\ncolumn = \"elastic_j\"\nat = 2", &["check.0.at", "outside the run"]),
        ("measure = \"tip-passes\"\nat = 2", &["needs a crack, but nothing fractures"]),
        ("measure = \"stress-in-the-middle\"", &["there are none", "scene.output.frames"]),
        ("measure = \"difference\"\ncolumn = \"elastic_j\"\nagainst = \"fine\"", &["no run of this case"]),
        ("measure = \"difference\"\ncolumn = \"elastic_j\"\nagainst = \"\"", &["no other run"]),
        ("measure = \"relative-rms\"\ncolumn = \"elastic_j\"\nreference = \"a/b\"", &["no reference curve \"a/b\""]),
        ("measure = \"closure\"\nband = \"a/b\"", &["no reference band \"a/b\"", "plate-events/"]),
        ("measure = \"closure\"\nbelow = 1\nabove = 1\nwhy = \"w\"", &["need a reference value"]),
    ] {
        refused_by("scene", &of(lines), parts);
    }
    assert_eq!(prepared("scene", &of("measure = \"slope\"\ncolumn = \"elastic_j\"\nfrom = 0.1\nto = 0.3")), "");
}

#[test]
fn values_follow_the_scene_and_charts_name_what_is_there() {
    let closure = quantity("q", "measure = \"closure\"");
    let of = |more: &str| format!("{SCENE}\n{more}\n{closure}");
    let chart = |column: &str| {
        format!("[[chart]]\nid = \"c\"\ntitle = \"t\"\naxes = [\"x\", \"y\"]\ncurves = [{{ column = {column:?} }}]\n")
    };
    let values = "[values]\nend = \"= {analysis.end_time}\"\nhalf = \"= end/2\"\n";
    assert_eq!(prepared("scene", &of(&format!("{values}{}", chart("elastic_j*(time_s < half)")))), "");
    refused_by("scene", &of(&chart("elastic")), &["chart.0.curves.0.column", "no column \"elastic\""]);
    for (value, parts) in [
        ("a = \"= b\"\nb = \"= a\"", &["values.a", "depends on itself"][..]),
        ("a = \"= c\"", &["values.a", "no value \"c\""]),
        ("a = \"= {analysis.ende}\"", &["no key \"analysis.ende\""]),
        ("a = \"= {initial elastic_j}\"", &["known only after a run"]),
        ("a = \"= 1/0\"", &["it is inf"]),
        ("a = \"= (\"", &["not a valid formula"]),
        ("\"a b\" = 1", &["is not a valid name in a formula"]),
    ] {
        refused_by("scene", &of(&format!("[values]\n{value}\n")), parts);
    }
    refused_by("basis", &format!("[values]\na = 1\n{}", check("unity", "")), &["does not read values"]);
}

#[test]
fn a_check_is_there_once() {
    let other = check("other", "max = 1\nwhy = \"in other words\"");
    refused_by(
        "basis",
        &(check("unity", "max = 1\nwhy = \"a reason\"") + &other),
        &["check.1", "duplicate of check.0"],
    );
}

#[test]
fn runs_of_one_name_are_refused() {
    let closure = quantity("q", "measure = \"closure\"");
    let equal = SCENE.replace("cells = [8, 4]", "cells = [[8, 4], [8, 4]]");
    refused_by("scene", &format!("{equal}\n{closure}"), &["two records with the id trial/case/cells=8x4/q", "differ"]);
    let variant = "[[variant]]\nname = \"fine\"\nset = { \"mesh.degree\" = 3 }\n";
    let twice = format!("{}\n{variant}{variant}{closure}", SCENE);
    refused_by("scene", &twice, &["two records with the id trial/case/fine/q", "its own name"]);
}

#[test]
fn the_fingerprint_of_a_case_knows_the_numbers_its_scene_names() {
    let folder = tempfile::tempdir().unwrap();
    let suite = folder.path().join("energy");
    std::fs::create_dir(&suite).unwrap();
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases");
    std::fs::copy(cases.join("bases.toml"), folder.path().join("bases.toml")).unwrap();
    let text = std::fs::read_to_string(cases.join("energy/driven-bar.toml")).unwrap();
    let formula = "formula = \"0.5 - 0.5*cos(2*PI*t / 1 s)\"";
    assert!(text.contains(formula));
    let file = suite.join("driven-bar.toml");
    std::fs::write(&file, text.replace(formula, "file = \"pulse.csv\"")).unwrap();
    let prints = |rows: &str| {
        std::fs::write(suite.join("pulse.csv"), rows).unwrap();
        let case = Case::load(&file, &[]).unwrap();
        [case.fingerprint(), case.inputs()]
    };
    let first = prints("0, 0\n1, 1\n");
    assert_eq!(prints("0, 0\n1, 1\n"), first);
    assert!(prints("0, 0\n1, 2\n").iter().zip(&first).all(|(new, old)| new != old));
}
