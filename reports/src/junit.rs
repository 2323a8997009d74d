//! `junit.xml`: one test case per record, for the test views of CI services.

use std::time::Duration;

use fisura_verification::record::{Record, ResultSet, Status};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::number::plain;
use crate::view::{accepted, by_suite, kind, limit, own_times, reason, value, with_unit, word};

/// The report as XML. A value outside its bounds is a failure, a run that broke down an error; a record
/// without bounds is skipped, with its value in the message, since nothing was judged. The time of a run, or
/// of a study, stands in its first record only, so that times add up.
///
/// # Errors
/// Only if the XML cannot be written, which has no cause in the results.
pub fn render_junit(set: &ResultSet) -> Result<String, quick_junit::SerializeError> {
    let mut report = Report::new("fisura");
    let mut total = Duration::ZERO;
    for (name, records) in by_suite(set).into_iter().filter(|(_, records)| !records.is_empty()) {
        let times: Vec<Duration> = own_times(&records).iter().map(|timing| seconds(timing.wall_s)).collect();
        let mut suite = TestSuite::new(name);
        let time = times.iter().sum();
        suite.set_time(time);
        total += time;
        suite.add_test_cases(records.into_iter().zip(times).map(|(record, time)| case(record, time)));
        report.add_test_suite(suite);
    }
    report.set_time(total);
    report.to_string()
}

fn case(record: &Record, time: Duration) -> TestCase {
    let mut status = match record.status {
        Status::Pass | Status::KnownLimit => TestCaseStatus::success(),
        Status::Info => TestCaseStatus::skipped(),
        Status::Fail => TestCaseStatus::non_success(NonSuccessKind::Failure),
        Status::Error => TestCaseStatus::non_success(NonSuccessKind::Error),
    };
    match record.status {
        Status::Pass | Status::KnownLimit => &mut status,
        Status::Info => status.set_message(message(record)),
        Status::Fail => status.set_type("out of bounds").set_message(message(record)),
        Status::Error => status.set_type("broke down").set_message(reason(record)),
    };
    let mut case = TestCase::new(record.id.as_str(), status);
    case.set_classname(format!("{}.{}", record.suite, record.case));
    case.set_time(time);
    case.extra.insert("status".into(), word(record.status).into());
    case.set_system_out(message(record));
    case
}

/// Value, bounds, reason and reference in one text, as some services drop everything but the message.
fn message(record: &Record) -> String {
    let mut text = format!("{}: {}", record.quantity, value(record, plain));
    if record.status != Status::Info {
        text.push_str(&format!(", accepted {}", accepted(record, plain)));
    }
    let why = reason(record);
    if !why.is_empty() {
        text.push_str(&format!(" ({why})"));
    }
    if let Some((range, limit)) = limit(record, plain).zip(record.limit.as_ref()) {
        text.push_str(&format!("; known limit {range}: {}", limit.why));
    }
    if let Some(reference) = &record.reference {
        let number = reference.value.map(|v| with_unit(&plain(v, crate::number::DIGITS), &record.unit) + ", ");
        text.push_str(&format!("; reference: {}{}, {}", number.unwrap_or_default(), kind(reference), reference.source));
    }
    text
}

/// At most 30 years, of which any number can be added.
fn seconds(value: f64) -> Duration {
    Duration::try_from_secs_f64(value.min(1e9)).unwrap_or(Duration::ZERO)
}
