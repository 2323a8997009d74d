//! What all written reports say in common: verdicts in words, bounds, references, records grouped by suite
//! and run.

use std::collections::{HashMap, HashSet};

use fisura_verification::record::{
    Accept, Agreement, BoundKind, Record, Reference, ReferenceKind, ResultSet, Status, Timing, Validation,
};

use crate::number::{DIGITS, plain};

/// Digits of an uncertainty; more mean nothing.
const UNCERTAINTY_DIGITS: usize = 2;

/// How often each verdict was given.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Within bounds.
    pub pass: usize,
    /// Outside bounds.
    pub fail: usize,
    /// Broke down.
    pub error: usize,
    /// No bounds.
    pub info: usize,
    /// Those held against bounds that were chosen after the result.
    pub regression: usize,
    /// Those of which something was expected that is not met.
    pub unmet: usize,
    /// Those compared with a reference of known uncertainty.
    pub compared: usize,
    /// Those of them that agree within the validation uncertainty.
    pub agreeing: usize,
}

impl Counts {
    /// Counts records.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a Record>) -> Self {
        let mut counts = Self::default();
        for record in records {
            match record.status {
                Status::Pass => counts.pass += 1,
                Status::Fail => counts.fail += 1,
                Status::Error => counts.error += 1,
                Status::Info => counts.info += 1,
            }
            counts.regression += usize::from(record.is_regression());
            counts.unmet += usize::from(record.misses_expectation());
            counts.compared += usize::from(record.validation.is_some());
            counts.agreeing += usize::from(record.validation.as_ref().is_some_and(|v| v.verdict == Agreement::Agrees));
        }
        counts
    }

    /// Records that hold their claim against bounds or not; those without bounds are not counted.
    pub fn judged(&self) -> usize {
        self.pass + self.fail + self.error
    }

    /// Verdict on the whole: `pass` if something was judged and everything holds.
    pub fn verdict(&self) -> Status {
        match self {
            Self { error: 1.., .. } => Status::Error,
            Self { fail: 1.., .. } => Status::Fail,
            Self { pass: 1.., .. } => Status::Pass,
            _ => Status::Info,
        }
    }

    /// The verdict in a sentence.
    pub fn sentence(&self) -> String {
        let checks = |n: usize| if n == 1 { "1 check".to_string() } else { format!("{n} checks") };
        match self.verdict() {
            Status::Info => "Nothing was judged".to_string(),
            Status::Pass if self.pass == 1 => "The one check holds".to_string(),
            Status::Pass => format!("All {} checks hold", self.pass),
            _ => {
                let bad = self.fail + self.error;
                let verb = if bad == 1 { "does" } else { "do" };
                format!("{bad} of {} {verb} not hold", checks(self.judged()))
            }
        }
    }

    /// `12 pass, 1 fail, 0 errors, 3 info`.
    pub fn list(&self) -> String {
        let errors = if self.error == 1 { "error" } else { "errors" };
        format!("{} pass, {} fail, {} {errors}, {} info", self.pass, self.fail, self.error, self.info)
    }

    /// What pass and fail leave out: `2 checks by bounds of regression; 1 expectation not met; …`; empty if
    /// there is nothing.
    pub fn remarks(&self) -> String {
        let many = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
        let compared = many(self.compared, "value");
        let remarks = [
            (self.regression, format!("{} by bounds of regression", many(self.regression, "check"))),
            (self.unmet, format!("{} not met", many(self.unmet, "expectation"))),
            (self.compared, format!("{} of {compared} within the uncertainty of the comparison", self.agreeing)),
        ];
        let said = remarks.into_iter().filter(|(count, _)| *count > 0).map(|(_, words)| words);
        said.collect::<Vec<_>>().join("; ")
    }
}

/// A verdict as a word.
pub fn word(status: Status) -> &'static str {
    match status {
        Status::Pass => "pass",
        Status::Fail => "fail",
        Status::Error => "error",
        Status::Info => "info",
    }
}

/// A verdict as a symbol.
pub fn symbol(status: Status) -> &'static str {
    match status {
        Status::Pass => "✓",
        Status::Fail => "✗",
        Status::Error => "‼",
        Status::Info => "·",
    }
}

/// Records that do not hold: failures, then errors, each in the order of the plan.
pub fn broken(set: &ResultSet) -> Vec<&Record> {
    let with = |status| set.records.iter().filter(move |r| r.status == status);
    with(Status::Fail).chain(with(Status::Error)).collect()
}

/// Records of which something was expected that is not met, in the order of the plan.
pub fn unmet(set: &ResultSet) -> Vec<&Record> {
    set.records.iter().filter(|r| r.misses_expectation()).collect()
}

/// Suites in the order in which they first appear, those with figures only at the end.
pub fn suites(set: &ResultSet) -> Vec<&str> {
    let mut seen = HashSet::new();
    let all = set.records.iter().map(|r| r.suite.as_str()).chain(set.figures.iter().map(|f| f.suite.as_str()));
    all.filter(|suite| seen.insert(*suite)).collect()
}

/// The suites in the same order, with their records; none for a suite with figures only.
pub fn by_suite(set: &ResultSet) -> Vec<(&str, Vec<&Record>)> {
    let mut of: HashMap<&str, Vec<&Record>> = HashMap::new();
    set.records.iter().for_each(|record| of.entry(&record.suite).or_default().push(record));
    suites(set).into_iter().map(|suite| (suite, of.remove(suite).unwrap_or_default())).collect()
}

/// Records of one run: the id without its last part. A study over levels is one run here.
pub fn run_id(record: &Record) -> &str {
    record.id.rsplit_once('/').map_or(record.id.as_str(), |(run, _)| run)
}

/// Records grouped by run, in order of first appearance.
pub fn runs<'a>(records: impl IntoIterator<Item = &'a Record>) -> Vec<(&'a str, Vec<&'a Record>)> {
    let mut runs: Vec<(&str, Vec<&Record>)> = Vec::new();
    let mut place = HashMap::new();
    for record in records {
        let id = run_id(record);
        let at = *place.entry(id).or_insert(runs.len());
        match runs.get_mut(at) {
            Some((_, members)) => members.push(record),
            None => runs.push((id, vec![record])),
        }
    }
    runs
}

/// The time of each record, where it is the first of its case with that measurement: records of one run, and
/// runs of one study, repeat the time of the whole.
pub fn own_times<'a>(records: &[&'a Record]) -> Vec<Timing> {
    let mut seen = HashSet::new();
    let mut first = |record: &&'a Record| {
        let Timing { wall_s, particle_steps, .. } = record.timing;
        seen.insert((record.suite.as_str(), record.case.as_str(), wall_s.to_bits(), particle_steps))
    };
    records.iter().map(|record| if first(record) { record.timing } else { Timing::default() }).collect()
}

/// A value with its unit: as many digits as it takes to see on which side of its bounds it lies.
pub fn value(record: &Record, show: fn(f64, usize) -> String) -> String {
    let Some(value) = record.value else { return "none".to_string() };
    let bounds = [record.accept.min, record.accept.max];
    let hidden = |digits: usize| {
        let text = plain(value, digits);
        bounds.iter().flatten().any(|b| *b != value && plain(*b, digits) == text)
    };
    let digits = (DIGITS..17).find(|d| !hidden(*d)).unwrap_or(17);
    with_unit(&show(value, digits), &record.unit)
}

/// A number with its unit; `1` is no unit.
pub fn with_unit(number: &str, unit: &str) -> String {
    match unit {
        "" | "1" => number.to_string(),
        unit => format!("{number} {unit}"),
    }
}

/// The accepted range: `≤ 0.01`, `3.9 to 4.5`, `none`.
pub fn bounds(accept: &Accept, show: fn(f64, usize) -> String) -> String {
    range(accept.min, accept.max, show)
}

/// The accepted range, with a word on bounds of a kind of their own: `3.9 to 4.5 (regression)`.
pub fn accepted(record: &Record, show: fn(f64, usize) -> String) -> String {
    let kind = match record.accept.kind {
        _ if record.is_regression() => " (regression)",
        Some(BoundKind::Validation) => " (U_val)",
        _ => "",
    };
    bounds(&record.accept, show) + kind
}

/// The range in which a value is expected beside its bounds, if there is one: `0.165 to 0.2`.
pub fn expected(record: &Record, show: fn(f64, usize) -> String) -> Option<String> {
    record.expectation.as_ref().map(|e| range(e.min, e.max, show))
}

/// A reference value with unit and uncertainty: `31 ± 0.3 us`; of a curve its uncertainty alone.
pub fn reference_value(reference: &Reference, unit: &str, show: fn(f64, usize) -> String) -> String {
    let parts = [
        reference.value.map(|v| show(v, DIGITS)),
        reference.uncertainty.map(|u| format!("± {}", show(u, UNCERTAINTY_DIGITS))),
    ];
    match parts.into_iter().flatten().collect::<Vec<_>>().join(" ") {
        empty if empty.is_empty() => empty,
        number => with_unit(&number, unit),
    }
}

/// The comparison with the uncertainty of the reference: `agrees: |E| = 0.1 ≤ U_val = 0.3`.
pub fn comparison(record: &Record, show: fn(f64, usize) -> String) -> Option<String> {
    let Validation { error, u_num, u_val, at_least, .. } = record.validation.as_ref()?;
    let [e, u] = [error.abs(), *u_val].map(|v| show(v, UNCERTAINTY_DIGITS));
    let mesh = if u_num.is_some() { "" } else { " without the mesh" };
    Some(match at_least {
        None => format!("agrees: |E| = {e} ≤ U_val = {u}{mesh}"),
        Some(least) => {
            format!("off by at least {}: |E| = {e}, U_val = {u}{mesh}", show(*least, UNCERTAINTY_DIGITS))
        }
    })
}

fn range(min: Option<f64>, max: Option<f64>, show: fn(f64, usize) -> String) -> String {
    let show = |v| show(v, DIGITS + 1);
    match (min, max) {
        (None, None) => "none".to_string(),
        (Some(min), None) => format!("≥ {}", show(min)),
        (None, Some(max)) => format!("≤ {}", show(max)),
        (Some(min), Some(max)) if min == max => format!("= {}", show(min)),
        (Some(min), Some(max)) => format!("{} to {}", show(min), show(max)),
    }
}

/// Kind of reference in words.
pub fn kind(reference: &Reference) -> &'static str {
    match reference.kind {
        ReferenceKind::Exact => "exact",
        ReferenceKind::Theory => "theory",
        ReferenceKind::Literature => "literature",
        ReferenceKind::IndependentCode => "independent code",
        ReferenceKind::SelfConvergence => "self-convergence",
        ReferenceKind::Regression => "regression",
    }
}

/// Why a record does not hold: its message, or its bounds and their reason.
pub fn reason(record: &Record) -> String {
    let why = record.accept.why.trim();
    match (&record.message, record.status) {
        (Some(message), Status::Error) => message.clone(),
        (Some(message), _) if why.is_empty() => message.clone(),
        (Some(message), _) => format!("{why} — {message}"),
        (None, _) => why.to_string(),
    }
}

/// Parameters of a run: `degree = 2, cells = [8, 16]`.
pub fn parameters(record: &Record) -> String {
    let one = |(name, value): (&String, &serde_json::Value)| match value {
        serde_json::Value::String(text) => format!("{name} = {text}"),
        other => format!("{name} = {other}"),
    };
    record.parameters.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// Everything that differs from the source in a group of records, each once.
pub fn deviations<'a>(records: &[&'a Record]) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    records.iter().flat_map(|r| &r.deviations).map(String::as_str).filter(|text| seen.insert(*text)).collect()
}

/// Timing of a run: that of its longest record, as records of one run repeat it.
pub fn timing(records: &[&Record]) -> Timing {
    let longer = |a: &&&Record, b: &&&Record| a.timing.wall_s.total_cmp(&b.timing.wall_s);
    records.iter().max_by(longer).map(|r| r.timing).unwrap_or_default()
}

/// Where it was run, in pairs of name and value; what is unknown is left out.
pub fn environment(set: &ResultSet) -> Vec<(&'static str, String)> {
    let e = &set.environment;
    let commit = match (e.commit.as_str(), e.dirty) {
        ("", _) => String::new(),
        (commit, true) => format!("{commit}, with uncommitted changes"),
        (commit, false) => commit.to_string(),
    };
    let threads = if e.threads == 0 { String::new() } else { e.threads.to_string() };
    let all = [
        ("Commit", commit),
        ("Processor", e.cpu.clone()),
        ("Threads", threads),
        ("Compiler", e.rustc.clone()),
        ("Started", e.started.clone()),
    ];
    all.into_iter().filter(|(_, value)| !value.is_empty()).collect()
}
