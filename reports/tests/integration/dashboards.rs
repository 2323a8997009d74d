//! `metrics/`: each form by the rules of the program that reads it, restated here with their source.

use std::collections::{BTreeMap, BTreeSet};

use fisura_reports::dashboards::files;
use fisura_verification::record::ResultSet;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use serde_json::{Value, json};

fn named() -> ResultSet {
    let mut set = crate::fixture::results();
    set.environment.commit = "0123456789abcdef0123456789abcdef01234567".to_string();
    set
}

fn rendered(set: &ResultSet) -> BTreeMap<String, String> {
    files(set).unwrap().into_iter().collect()
}

fn document(files: &BTreeMap<String, String>, name: &str) -> Value {
    serde_json::from_str(&files[name]).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// What <https://bencher.dev/bmf.json> (draft 7) asks, and the lengths of names of its reference page.
#[test]
fn bencher_takes_the_metrics() {
    let measure = json!({
        "type": "object",
        "properties": { "value": { "type": "number" }, "lower_value": { "type": "number" }, "upper_value": { "type": "number" } },
        "required": ["value"],
    });
    let schema = json!({
        "type": "object",
        "propertyNames": { "minLength": 1, "maxLength": 1024 },
        "additionalProperties": {
            "type": "object",
            "propertyNames": { "minLength": 1, "maxLength": 64 },
            "additionalProperties": measure,
        },
    });
    let schema = jsonschema::validator_for(&schema).unwrap();
    let mut set = named();
    set.records[0].id = format!("plate/{}/slope", "x".repeat(2000));
    let files = rendered(&set);
    for kind in ["deterministic", "timing"] {
        let found = document(&files, &format!("{kind}/bencher.json"));
        let errors: Vec<String> = schema.iter_errors(&found).map(|error| error.to_string()).collect();
        assert!(errors.is_empty() && !found.as_object().unwrap().is_empty(), "{kind}: {errors:?}");
    }
    assert!(!schema.is_valid(&json!({ "run": { "wall time": { "lower_value": 1.0 } } })), "the rules refuse something");
}

/// `extractCustomBenchmarkResult` and `BenchmarkResult` of github-action-benchmark (`src/extract.ts`): an
/// array of name, value, unit, and range and extra if there are any, in words. It finds the value of the
/// commit before by the name.
#[test]
fn github_action_benchmark_takes_the_metrics() {
    let files = rendered(&named());
    for kind in ["deterministic", "timing"] {
        let mut names = BTreeSet::new();
        for entry in document(&files, &format!("{kind}/github-action-benchmark.json")).as_array().unwrap() {
            for (key, value) in entry.as_object().unwrap() {
                let holds = match key.as_str() {
                    "value" => value.as_f64().is_some_and(f64::is_finite),
                    "name" | "unit" | "range" | "extra" => value.as_str().is_some_and(|text| !text.is_empty()),
                    _ => false,
                };
                assert!(holds, "{kind}: {key} of {entry}");
            }
            assert!(["name", "unit", "value"].iter().all(|key| entry.get(key).is_some()), "{entry}");
            assert!(names.insert(entry["name"].to_string()), "{entry} is there twice");
        }
        assert!(!names.is_empty());
    }
}

/// `app/Validators/Schemas/Test.xsd` and `common.xsd` of CDash for the elements in use: attributes that must
/// be there, and children in their order with the least and most of each.
type Rule = (&'static [&'static str], &'static [(&'static str, usize, usize)]);

fn rule(element: &str) -> Rule {
    const MANY: usize = usize::MAX;
    match element {
        "Site" => {
            (&["BuildName", "BuildStamp", "Name"], &[("Subproject", 0, MANY), ("Labels", 0, MANY), ("Testing", 1, 1)])
        }
        "Testing" => (
            &[],
            &[
                ("StartDateTime", 0, 1),
                ("StartTestTime", 0, 1),
                ("TestList", 0, 1),
                ("Test", 0, MANY),
                ("EndDateTime", 0, 1),
                ("EndTestTime", 0, 1),
                ("ElapsedMinutes", 0, 1),
            ],
        ),
        "TestList" => (&[], &[("Test", 0, MANY)]),
        "Test" => (
            &["Status"],
            &[
                ("Name", 1, 1),
                ("Path", 1, 1),
                ("FullName", 1, 1),
                ("FullCommandLine", 1, 1),
                ("StartTestTime", 0, 1),
                ("Results", 1, 1),
                ("NamedMeasurement", 0, MANY),
                ("Labels", 0, 1),
            ],
        ),
        "Results" => (&[], &[("NamedMeasurement", 0, MANY)]),
        "NamedMeasurement" => (&["type", "name"], &[("Value", 1, 1)]),
        "Labels" => (&[], &[("Label", 1, MANY)]),
        "Name" | "Path" | "FullName" | "FullCommandLine" | "StartTestTime" | "EndTestTime" | "Value" | "Label" => {
            (&[], &[])
        }
        other => panic!("{other} is no element of Test.xml"),
    }
}

/// What is wrong with a document by these rules.
fn against_the_rules(text: &str) -> Vec<String> {
    let mut reader = Reader::from_str(text);
    let (mut open, mut wrong): (Vec<(String, Vec<String>)>, Vec<String>) = (Vec::new(), Vec::new());
    let mut close = |(name, children): (String, Vec<String>), in_list: bool| {
        let (_, expected) = if in_list { (&[][..], &[][..]) } else { rule(&name) };
        let mut rest = children.as_slice();
        for (child, least, most) in expected {
            let count = rest.iter().take_while(|found| found == child).count();
            if count < *least || count > *most {
                wrong.push(format!("{count} {child} in {name}"));
            }
            rest = &rest[count..];
        }
        wrong.extend(rest.first().map(|child| format!("{child} in {name}")));
    };
    let attributes = |element: &BytesStart, in_list: bool| -> Vec<String> {
        let (required, _) =
            if in_list { (&[][..], &[][..]) } else { rule(std::str::from_utf8(element.name().as_ref()).unwrap()) };
        let missing = required.iter().filter(|key| element.try_get_attribute(**key).unwrap().is_none());
        missing.map(|key| format!("no {key}")).collect()
    };
    let mut missing = Vec::new();
    loop {
        let event = reader.read_event().unwrap();
        match &event {
            Event::Start(element) | Event::Empty(element) => {
                let name = String::from_utf8(element.name().as_ref().to_vec()).unwrap();
                let in_list = open.last().is_some_and(|(parent, _)| parent == "TestList");
                missing.extend(attributes(element, in_list));
                open.iter_mut().last().into_iter().for_each(|(_, children)| children.push(name.clone()));
                open.push((name, Vec::new()));
                if matches!(event, Event::Empty(_)) {
                    close(open.pop().unwrap(), in_list);
                }
            }
            Event::End(_) => {
                let element = open.pop().unwrap();
                close(element, open.last().is_some_and(|(parent, _)| parent == "TestList"));
            }
            Event::Eof => break,
            _ => {}
        }
    }
    wrong.extend(missing);
    wrong
}

#[test]
fn cdash_takes_the_tests_and_their_measurements() {
    let files = rendered(&named());
    for kind in ["deterministic", "timing"] {
        let text = &files[&format!("{kind}/Test.xml")];
        assert_eq!(against_the_rules(text), Vec::<String>::new(), "{kind}");
        assert!(text.contains("<NamedMeasurement type=\"numeric/double\""), "{text}");
        assert_eq!(text.contains("name=\"Execution Time\""), kind == "timing", "{text}");
        let wrong = against_the_rules(&text.replacen("<Path>.</Path>", "", 1).replacen(" Status=\"passed\"", "", 1));
        assert_eq!(wrong, ["0 Path in Test", "no Status"], "the rules refuse something");
    }
}

/// "Benchmark suite layout and file formats" of the developer documentation of airspeed velocity, and what
/// `Results.load` (`asv/results.py`), `Benchmarks.load` and `Machine.load` ask for.
#[test]
fn asv_takes_the_results() {
    let set = named();
    let files = rendered(&set);
    let of_asv: Vec<&str> = files.keys().filter_map(|name| name.strip_prefix("asv/")).collect();
    let benchmarks = document(&files, "asv/benchmarks.json");
    assert_eq!(benchmarks["version"], 2);
    for (name, benchmark) in benchmarks.as_object().unwrap().iter().filter(|(name, _)| *name != "version") {
        assert_eq!((&benchmark["name"], &benchmark["type"]), (&json!(name), &json!("track")));
        assert!(
            benchmark["unit"].is_string() && benchmark["params"] == json!([]) && benchmark["param_names"] == json!([])
        );
    }
    let machine = of_asv.iter().find_map(|name| name.strip_suffix("/machine.json")).unwrap();
    let about = document(&files, &format!("asv/{machine}/machine.json"));
    assert_eq!((&about["machine"], &about["version"]), (&json!(machine), &json!(1)));
    for kind in ["deterministic", "timing"] {
        let results = document(&files, &format!("asv/{machine}/01234567-{kind}.json"));
        assert_eq!((&results["version"], &results["env_name"]), (&json!(2), &json!(kind)));
        assert_eq!(
            (&results["commit_hash"], &results["params"]["machine"]),
            (&json!(set.environment.commit), &json!(machine))
        );
        assert!(
            results["date"].is_i64()
                && ["python", "requirements", "env_vars", "durations"].iter().all(|key| results.get(key).is_some())
        );
        let columns: Vec<&str> =
            results["result_columns"].as_array().unwrap().iter().map(|c| c.as_str().unwrap()).collect();
        assert_eq!(columns, ["result", "params", "version"], "a prefix of what asv knows by these names");
        for (name, row) in results["results"].as_object().unwrap() {
            assert!(
                row[0].as_array().is_some_and(|values| values.len() == 1 && values[0].is_number()),
                "{name}: {row}"
            );
            assert_eq!((&row[1], &row[2]), (&json!([]), &benchmarks[name]["version"]), "{name}");
        }
    }
    let mut nameless = set;
    nameless.environment.commit = String::new();
    assert!(
        rendered(&nameless).keys().all(|name| !name.starts_with("asv/")),
        "results of no commit have no file there"
    );
}

#[test]
fn what_is_deterministic_does_not_depend_on_the_clock() {
    let mut later = named();
    later.environment.started = "2031-01-01T00:00:00Z".to_string();
    later.records.iter_mut().for_each(|record| record.timing.wall_s *= 3.0);
    let [before, after] = [rendered(&named()), rendered(&later)];
    for form in ["bencher.json", "github-action-benchmark.json"] {
        assert_eq!(before[&format!("deterministic/{form}")], after[&format!("deterministic/{form}")]);
        assert_ne!(before[&format!("timing/{form}")], after[&format!("timing/{form}")]);
    }
    let counted = ["particle-steps", "phase-field iterations", "phase-field traffic", "relative error"];
    let deterministic = &before["deterministic/github-action-benchmark.json"];
    assert!(
        counted.iter().all(|name| deterministic.contains(name)) && !deterministic.contains("wall time"),
        "{deterministic}"
    );
}
