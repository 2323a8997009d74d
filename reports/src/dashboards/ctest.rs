//! `Test.xml` as `ctest` writes it and CDash reads it: a test per run, with its numbers as named
//! measurements.
//!
//! Form: `app/Validators/Schemas/Test.xsd` and `common.xsd` of CDash. Numbers are `numeric/double`; CDash
//! takes the measurement `Execution Time` (s) for the time of the test.

use std::collections::HashMap;

use chrono::DateTime;
use fisura_verification::record::{Record, ResultSet, Status};
use quick_junit::XmlString;
use quick_xml::Writer;
use quick_xml::events::BytesText;

use crate::metrics::Metric;
use crate::view::{Counts, runs};

type Xml = Writer<Vec<u8>>;

/// The tests of a set and their measurements; `kind` is a part of the name of the build, so that both may be
/// submitted.
///
/// # Errors
/// Only if XML cannot be written, which has no cause in the results.
pub fn document(set: &ResultSet, kind: &str, metrics: &[Metric]) -> std::io::Result<String> {
    let environment = &set.environment;
    let started = DateTime::parse_from_rfc3339(&environment.started).unwrap_or_default();
    let seconds = started.timestamp().to_string();
    let build = format!("fisura {kind}");
    let stamp = started.format("%Y%m%d-%H%M-Experimental").to_string();
    let site = if environment.cpu.is_empty() { "unknown" } else { &environment.cpu };
    let generator = format!("fisura {}", env!("CARGO_PKG_VERSION"));
    let attributes = [
        ("BuildName", build.as_str()),
        ("BuildStamp", &stamp),
        ("Name", site),
        ("Generator", &generator),
        ("CompilerName", "rustc"),
        ("CompilerVersion", &environment.rustc),
        ("ChangeId", &environment.commit),
    ];
    let runs = runs(&set.records);
    let mut of_run: HashMap<&str, Vec<&Metric>> = HashMap::new();
    metrics.iter().for_each(|metric| of_run.entry(&metric.run).or_default().push(metric));
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 1);
    let attributes = attributes.map(|(name, value)| (name, clean(value)));
    let site =
        writer.create_element("Site").with_attributes(attributes.iter().map(|(name, value)| (*name, value.as_str())));
    site.write_inner_content(|site| {
        let testing = site.create_element("Testing");
        testing.write_inner_content(|testing| {
            text(testing, "StartTestTime", &seconds)?;
            let list = testing.create_element("TestList");
            list.write_inner_content(|list| {
                runs.iter().try_for_each(|(run, _)| text(list, "Test", &format!("./{run}")))
            })?;
            for (run, records) in &runs {
                test(testing, run, records, of_run.get(run).map_or(&[][..], Vec::as_slice))?;
            }
            text(testing, "EndTestTime", &seconds)
        })?;
        Ok(())
    })?;
    let body = String::from_utf8(writer.into_inner()).map_err(std::io::Error::other)?;
    Ok(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{body}\n"))
}

/// A run with its measurements.
fn test(parent: &mut Xml, run: &str, records: &[&Record], metrics: &[&Metric]) -> std::io::Result<()> {
    let first = records[0];
    let status = status(Counts::of(records.iter().copied()).verdict());
    let test = parent.create_element("Test").with_attribute(("Status", status));
    test.write_inner_content(|test| {
        text(test, "Name", run)?;
        text(test, "Path", ".")?;
        text(test, "FullName", &format!("./{run}"))?;
        text(test, "FullCommandLine", &format!("cargo xtask verify --case {}/{}", first.suite, first.case))?;
        test.create_element("Results")
            .write_inner_content(|results| metrics.iter().try_for_each(|metric| measurement(results, metric)))?;
        test.create_element("Labels").write_inner_content(|labels| text(labels, "Label", &first.suite))?;
        Ok(())
    })?;
    Ok(())
}

/// Nothing was judged where a run has no bounds: it ended, and so passed.
fn status(verdict: Status) -> &'static str {
    match verdict {
        Status::Pass | Status::KnownLimit | Status::Info => "passed",
        Status::Fail | Status::Error => "failed",
    }
}

fn measurement(results: &mut Xml, metric: &Metric) -> std::io::Result<()> {
    let record = metric.subject.strip_prefix(&metric.run).unwrap_or_default().trim_start_matches('/');
    let name = match (record, metric.measure) {
        ("", Some("wall time")) => "Execution Time".to_string(),
        ("", measure) => format!("{} ({})", measure.unwrap_or_default(), metric.unit),
        (record, Some(measure)) => format!("{record}: {measure}"),
        (record, None) => format!("{record} ({})", metric.unit),
    };
    let name = clean(&name);
    let element = results.create_element("NamedMeasurement").with_attribute(("type", "numeric/double"));
    let element = element.with_attribute(("name", name.as_str()));
    element.write_inner_content(|value| text(value, "Value", &format!("{:?}", metric.value))).map(drop)
}

fn text(parent: &mut Xml, name: &str, content: &str) -> std::io::Result<()> {
    parent.create_element(name).write_text_content(BytesText::new(&clean(content))).map(drop)
}

/// Without the characters that XML has no form for.
fn clean(text: &str) -> String {
    XmlString::new(text).as_str().to_string()
}
