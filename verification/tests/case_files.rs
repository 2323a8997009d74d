//! Case files that are wrong: said with line, key and remedy before anything runs.

use std::path::Path;

use fisura_verification::case::Case;

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
fn every_check_declares_an_id_of_its_own() {
    let without = "[[check]]\nquantity = \"Partition of unity, largest error\"\n";
    refused(without, &["check.0.id", "missing", "id = \"partition-of-unity-largest-error\""]);
    refused(&check("Largest error", ""), &["\"Largest error\" is no id", "\"largest-error\""]);
    refused(&check("", ""), &["\"\" is no id"]);
    let other = |id, variant: &str| check(id, &format!("variant = \"p={variant}\""));
    for twice in [
        check("unity", "") + &check("unity", ""),
        check("unity", "") + &other("unity", "2"),
        other("unity", "2") + &other("unity", "2"),
    ] {
        refused(&twice, &["check.1", "a second check with the id \"unity\"", "id of its own"]);
    }
    case(&(other("unity", "1") + &other("unity", "2"))).unwrap();
    refused("check = []", &["there is no check"]);
}

#[test]
fn a_former_id_is_no_id_of_today() {
    let renamed = |old: &str| check("unity", &format!("formerly = [{old:?}]"));
    assert_eq!(case(&renamed("sum-of-the-functions")).unwrap().checks[0].formerly, ["sum-of-the-functions"]);
    for old in ["unity", "linear"] {
        refused(&(renamed(old) + &check("linear", "")), &["check.0", "is that of a check of today"]);
    }
    refused(&renamed("Sum"), &["check.0.formerly.0", "is no id"]);
}
