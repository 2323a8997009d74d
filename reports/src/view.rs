//! What all written reports say in common: verdicts in words, bounds, references, records grouped by suite
//! and run.

use std::collections::{HashMap, HashSet};

use fisura_verification::record::{Accept, Record, Reference, ReferenceKind, ResultSet, Status, Timing};
use serde::Serialize;

use crate::number::{DIGITS, plain};

/// Digits of an uncertainty; more mean nothing.
const UNCERTAINTY_DIGITS: usize = 2;

/// What a record that holds was compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Basis {
    /// A closed form, unless its value is zero.
    ClosedForm,
    /// A theorem or an asymptotic rate.
    Theory,
    /// Numbers from a publication.
    Literature,
    /// Another code, which may be one of this project.
    IndependentCode,
    /// Finer runs of the solver itself.
    FinerRuns,
    /// Nothing, or zero: a property such as a balance that closes, within stated bounds.
    Invariant,
    /// An earlier result of the solver.
    Regression,
}

/// Every basis with its name, in the order of tables.
pub const BASES: [(Basis, &str); 7] = [
    (Basis::ClosedForm, "closed form"),
    (Basis::Theory, "theory"),
    (Basis::Literature, "literature"),
    (Basis::IndependentCode, "other program"),
    (Basis::FinerRuns, "finer runs"),
    (Basis::Invariant, "invariant"),
    (Basis::Regression, "regression"),
];

impl Basis {
    /// Basis of a record, by the kind and value of its reference and by how its bounds were chosen.
    pub fn of(record: &Record) -> Self {
        let zero = record.reference.as_ref().is_some_and(|reference| reference.value == Some(0.0));
        match record.reference.as_ref().map(|reference| reference.kind) {
            _ if record.is_regression() => Self::Regression,
            None => Self::Invariant,
            Some(ReferenceKind::Exact) if zero => Self::Invariant,
            Some(ReferenceKind::Exact) => Self::ClosedForm,
            Some(ReferenceKind::Theory) => Self::Theory,
            Some(ReferenceKind::Literature) => Self::Literature,
            Some(ReferenceKind::IndependentCode) => Self::IndependentCode,
            Some(ReferenceKind::SelfConvergence) => Self::FinerRuns,
            Some(ReferenceKind::Regression) => Self::Regression,
        }
    }
}

/// How often each status occurs.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// Agrees with its reference, or lies within its bounds where there is none.
    pub pass: usize,
    /// Within a documented limit.
    pub known_limit: usize,
    /// Outside bounds and limits.
    pub fail: usize,
    /// Broke down, or could not be measured.
    pub error: usize,
    /// Not bounded, or its reference is too uncertain or its bounds are too wide to decide.
    pub info: usize,
    /// Passes by what they were compared with, in the order of [`BASES`].
    pub passes: [usize; BASES.len()],
}

impl Counts {
    /// Counts the records of each status.
    pub fn of<'a>(records: impl IntoIterator<Item = &'a Record>) -> Self {
        let mut counts = Self::default();
        for record in records {
            match record.status {
                Status::Pass => {
                    counts.pass += 1;
                    counts.passes[Basis::of(record) as usize] += 1;
                }
                Status::KnownLimit => counts.known_limit += 1,
                Status::Fail => counts.fail += 1,
                Status::Error => counts.error += 1,
                Status::Info => counts.info += 1,
            }
        }
        counts
    }

    /// Records that have a status other than `info`.
    pub fn judged(&self) -> usize {
        self.pass + self.known_limit + self.fail + self.error
    }

    /// Status of the whole: `pass` if something holds and nothing fails.
    pub fn verdict(&self) -> Status {
        match self {
            Self { error: 1.., .. } => Status::Error,
            Self { fail: 1.., .. } => Status::Fail,
            Self { pass: 1.., .. } => Status::Pass,
            Self { known_limit: 1.., .. } => Status::KnownLimit,
            _ => Status::Info,
        }
    }

    /// The status of the whole in a sentence.
    pub fn sentence(&self) -> String {
        let limits = match self.known_limit {
            0 => String::new(),
            1 => "; 1 is a known limit".to_string(),
            n => format!("; {n} are known limits"),
        };
        match self.verdict() {
            Status::Info => "No check has a verdict".to_string(),
            Status::KnownLimit => format!("No check fails{limits}"),
            Status::Pass if self.pass == 1 => format!("1 check holds{limits}"),
            Status::Pass => format!("{} checks hold{limits}", self.pass),
            Status::Fail | Status::Error => {
                let bad = self.fail + self.error;
                let verb = if bad == 1 { "does" } else { "do" };
                let checks = if self.judged() == 1 { "check" } else { "checks" };
                format!("{bad} of {} {checks} {verb} not hold{limits}", self.judged())
            }
        }
    }

    /// `12 pass, 2 known limits, 1 fail, 0 errors, 3 info`.
    pub fn list(&self) -> String {
        let Self { pass, fail, info, .. } = self;
        let limits = if self.known_limit == 1 { "known limit" } else { "known limits" };
        let errors = if self.error == 1 { "error" } else { "errors" };
        format!("{pass} pass, {} {limits}, {fail} fail, {} {errors}, {info} info", self.known_limit, self.error)
    }

    /// What the passes were compared with: `passes: 340 closed form, 12 theory, 900 invariant`; empty if
    /// nothing passes.
    pub fn remarks(&self) -> String {
        let named = BASES.iter().zip(self.passes).filter(|(_, count)| *count > 0);
        let words: Vec<String> = named.map(|((_, name), count)| format!("{count} {name}")).collect();
        if words.is_empty() { String::new() } else { format!("passes: {}", words.join(", ")) }
    }
}

/// Name of a status for people, such as `known limit`.
pub fn word(status: Status) -> &'static str {
    word_and_symbol(status).0
}

/// A status as a symbol.
pub fn symbol(status: Status) -> &'static str {
    word_and_symbol(status).1
}

fn word_and_symbol(status: Status) -> (&'static str, &'static str) {
    match status {
        Status::Pass => ("pass", "✓"),
        Status::KnownLimit => ("known limit", "≈"),
        Status::Fail => ("fail", "✗"),
        Status::Error => ("error", "‼"),
        Status::Info => ("info", "·"),
    }
}

/// Records that do not hold: failures, then errors, each in the order of the plan.
pub fn broken(set: &ResultSet) -> Vec<&Record> {
    let with = |status| set.records.iter().filter(move |r| r.status == status);
    with(Status::Fail).chain(with(Status::Error)).collect()
}

/// Records within a documented limit, in the order of the plan.
pub fn limited(set: &ResultSet) -> Vec<&Record> {
    set.records.iter().filter(|r| r.status == Status::KnownLimit).collect()
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
    by_key(records.into_iter().map(|record| (run_id(record), record)))
}

/// Values grouped by their keys, in the order in which these first appear.
pub fn by_key<'a, V>(pairs: impl Iterator<Item = (&'a str, V)>) -> Vec<(&'a str, Vec<V>)> {
    let mut groups: Vec<(&str, Vec<V>)> = Vec::new();
    let mut place = HashMap::new();
    for (key, value) in pairs {
        let at = *place.entry(key).or_insert(groups.len());
        match groups.get_mut(at) {
            Some((_, members)) => members.push(value),
            None => groups.push((key, vec![value])),
        }
    }
    groups
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
    record.value.map_or("none".to_string(), |value| with_unit(&shown(record, value, DIGITS, show), &record.unit))
}

/// A value of a record with at least so many digits.
pub fn shown(record: &Record, value: f64, least: usize, show: fn(f64, usize) -> String) -> String {
    let bounds = [record.accept.min, record.accept.max];
    let hidden = |digits: usize| {
        let text = plain(value, digits);
        bounds.iter().flatten().any(|b| *b != value && plain(*b, digits) == text)
    };
    show(value, (least..17).find(|digits| !hidden(*digits)).unwrap_or(17))
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

/// The accepted range, with a word on where it comes from: `3.9 to 4.5 (regression)`.
pub fn accepted(record: &Record, show: fn(f64, usize) -> String) -> String {
    let kind = match record.uncertainty() {
        _ if record.is_regression() => " (regression)",
        Some(_) => " (uncertainty)",
        None => "",
    };
    bounds(&record.accept, show) + kind
}

/// The documented limit of a record: `0.165 to 0.2`.
pub fn limit(record: &Record, show: fn(f64, usize) -> String) -> Option<String> {
    record.limit.as_ref().map(|limit| range(limit.min, limit.max, show))
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

/// The comparison with the uncertainty: `|E| = 0.1, U = 0.3`; absent where no uncertainty is known.
pub fn comparison(record: &Record, show: fn(f64, usize) -> String) -> Option<String> {
    let uncertainty = record.uncertainty()?;
    let error = record.value? - record.reference.as_ref()?.value.unwrap_or(0.0);
    let [error, uncertainty] = [error.abs(), uncertainty].map(|v| show(v, UNCERTAINTY_DIGITS));
    let mesh = match &record.discretisation {
        Some(error) => format!(", with the discretisation error ({})", error.from),
        None => ", without a discretisation error".to_string(),
    };
    Some(format!("|E| = {error}, U = {uncertainty}{mesh}"))
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
    let why = match &record.limit {
        Some(limit) if record.accept.why.trim().is_empty() => limit.why.trim(),
        _ => record.accept.why.trim(),
    };
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
