//! The forms that other programs read: the schema of `results.json`, JUnit, benchmark dashboards, step
//! summaries.

use std::collections::BTreeMap;
use std::path::Path;

use fisura_reports::junit::render_junit;
use fisura_reports::markdown::render_markdown;
use fisura_verification::record::{ResultSet, json_schema};
use quick_xml::Reader;
use quick_xml::events::Event;
use serde_json::{Value, json};

/// Size above which GitHub drops a step summary.
const STEP_SUMMARY: usize = 1 << 20;

fn results() -> Value {
    serde_json::to_value(crate::fixture::results()).unwrap()
}

/// With `FISURA_BLESS=1` the files are written instead of compared.
#[test]
fn the_committed_schemas_are_those_of_the_types() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../verification/schema");
    let schemas = [
        ("results", json_schema()),
        ("verdict", fisura_verification::judge::verdict::json_schema()),
        ("case", fisura_verification::case::json_schema()),
    ];
    for (name, schema) in schemas {
        let path = folder.join(format!("{name}.schema.json"));
        let text = serde_json::to_string_pretty(&schema).unwrap() + "\n";
        if std::env::var_os("FISURA_BLESS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let command = "FISURA_BLESS=1 cargo test --workspace the_committed_schemas";
        assert!(std::fs::read_to_string(&path).unwrap() == text, "write {name} anew: {command}");
    }
}

/// A reader that follows the types takes the results, and refuses what they exclude.
#[test]
fn results_follow_their_types_and_others_do_not() {
    let reads = |value: &Value| serde_json::from_value::<ResultSet>(value.clone()).is_ok();
    assert!(reads(&results()));
    type Change = fn(&mut Value);
    let wrong: [(&str, Change); 4] = [
        ("an unknown status", |r| r["records"][0]["status"] = json!("skipped")),
        ("a value in words", |r| r["records"][0]["value"] = json!("4.02")),
        ("a reference of no kind", |r| r["records"][0]["reference"]["kind"] = json!("rumour")),
        ("no bounds table", |r| drop(r["records"][0].as_object_mut().unwrap().remove("accept"))),
    ];
    for (what, change) in wrong {
        let mut value = results();
        change(&mut value);
        assert!(!reads(&value), "{what}");
    }
}

/// What the JUnit schema of Jenkins (`junit-10.xsd`) says of the elements in use: required attributes,
/// further attributes, children.
fn rules(element: &str) -> Option<(&'static [&'static str], &'static [&'static str], &'static [&'static str])> {
    const COUNTS: &[&str] = &["name", "time", "tests", "failures", "errors", "skipped", "disabled"];
    Some(match element {
        "testsuites" => (&[], COUNTS, &["testsuite"]),
        "testsuite" => (&["name"], COUNTS, &["properties", "testcase", "system-out", "system-err"]),
        "testcase" => (
            &["name"],
            &["classname", "time", "assertions", "status"],
            &["skipped", "error", "failure", "system-out", "system-err"],
        ),
        "failure" | "error" | "skipped" => (&[], &["type", "message"], &[]),
        "system-out" => (&[], &[], &[]),
        _ => return None,
    })
}

/// An element of a JUnit file.
struct Element {
    name: String,
    parent: Option<String>,
    attributes: BTreeMap<String, String>,
}

/// All elements of a file, in its order.
fn elements(text: &str) -> Vec<Element> {
    let (mut reader, mut parents, mut found) = (Reader::from_str(text), Vec::<String>::new(), Vec::new());
    let word = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    loop {
        let event = reader.read_event().unwrap();
        match &event {
            Event::Start(element) | Event::Empty(element) => {
                let attributes = element.attributes().map(|attribute| attribute.unwrap());
                let attributes = attributes.map(|a| (word(a.key.as_ref()), word(&a.value))).collect();
                let (name, parent) = (word(element.name().as_ref()), parents.last().cloned());
                if matches!(event, Event::Start(_)) {
                    parents.push(name.clone());
                }
                found.push(Element { name, parent, attributes });
            }
            Event::End(_) => drop(parents.pop()),
            Event::Eof => return found,
            _ => {}
        }
    }
}

/// Sum of an attribute over all elements of a name.
fn sum(elements: &[Element], name: &str, key: &str) -> f64 {
    let of_name = elements.iter().filter(|element| element.name == name);
    of_name.map(|element| element.attributes[key].parse::<f64>().unwrap()).sum()
}

/// Wall times that a JUnit file declares for its suites and for its cases.
fn times(text: &str) -> [f64; 2] {
    ["testsuite", "testcase"].map(|name| sum(&elements(text), name, "time"))
}

#[test]
fn the_time_of_a_study_is_counted_once() {
    let mut set = crate::fixture::results();
    let template = set.records[2].clone();
    let record = |case: &str, variant: &str, wall_s: f64| {
        let mut record = template.clone();
        record.id = format!("energy/{case}/{variant}/closure");
        record.case = case.to_string();
        record.timing.wall_s = wall_s;
        record
    };
    // a study of three variants timed as a whole, and a case of two runs timed one by one, with two checks
    // each
    set.records = ["p=1", "p=2", "p=3"].iter().map(|p| record("study", p, 30.5)).collect();
    set.records.extend([("a", 2.0), ("a", 2.0), ("b", 4.0), ("b", 4.0)].map(|(run, wall)| record("scene", run, wall)));
    assert_eq!(times(&render_junit(&set).unwrap()), [36.5, 36.5]);
    set.records[0].timing.wall_s = 1e300;
    assert!(render_junit(&set).is_ok());
}

#[test]
fn junit_keeps_to_its_schema_and_counts_right() {
    let elements = elements(&render_junit(&crate::fixture::results()).unwrap());
    for Element { name, parent, attributes } in &elements {
        let (required, optional, _) = rules(name).unwrap_or_else(|| panic!("unknown element {name}"));
        match parent.as_deref().and_then(rules) {
            Some((_, _, children)) => assert!(children.contains(&name.as_str()), "{name} below {parent:?}"),
            None => assert_eq!(name, "testsuites", "the root"),
        }
        assert!(required.iter().all(|key| attributes.contains_key(*key)), "{name} has {attributes:?}");
        for (key, value) in attributes {
            assert!(required.contains(&key.as_str()) || optional.contains(&key.as_str()), "{key} of {name}");
            match key.as_str() {
                "time" => assert!(value.parse::<f64>().is_ok_and(|t| t >= 0.0), "{key}={value}"),
                "tests" | "failures" | "errors" | "skipped" => assert!(value.parse::<u64>().is_ok(), "{key}={value}"),
                _ => {}
            }
        }
    }
    let found = ["testcase", "failure", "error", "skipped"]
        .map(|name| elements.iter().filter(|element| element.name == name).count() as f64);
    assert_eq!(found, [13.0, 2.0, 1.0, 3.0], "records, failures, errors of the fixture, and what was not judged");
    let [tests, failures, errors] = ["tests", "failures", "errors"].map(|key| sum(&elements, "testsuites", key));
    assert_eq!([tests, failures, errors, sum(&elements, "testsuite", "skipped")], found);
}

#[test]
fn a_summary_fits_a_step_whatever_the_number_of_records() {
    let mut set = crate::fixture::results();
    set.records = std::iter::repeat_n(set.records, 2000).flatten().collect();
    let text = render_markdown(&set);
    assert!(text.len() <= STEP_SUMMARY, "{} bytes", text.len());
    assert!(text.contains("## Does not hold") && text.contains("more are in `report.html`"));
    assert!(text.lines().count() < 100, "{text}");
}
