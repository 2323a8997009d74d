//! All measures: what each reads of its check and of the run, and how it is found.

use super::{Measured, Run, column, series, tip};
use crate::case::Check;
use crate::reference::Library;

/// What a measure is asked.
pub(super) struct Question<'a> {
    pub check: &'a Check,
    pub run: &'a Run<'a>,
    /// Runs of all scenes of the case.
    pub runs: &'a [Run<'a>],
    pub library: &'a Library,
}

type Answer = Result<Measured, String>;

/// A measure: how a check gets its number from a run.
pub struct Measure {
    /// Name in case files.
    pub name: &'static str,
    /// Keys of a check that it has to have, and others that it reads.
    pub needs: &'static [&'static str],
    /// Keys that it reads if they are there.
    pub takes: &'static [&'static str],
    /// What it looks at beside the column of the check.
    pub looks_at: LooksAt,
    pub(super) find: fn(&Question<'_>) -> Answer,
}

/// What a measure looks at beside the column of its check.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LooksAt {
    /// Nothing that not every run has.
    Run,
    /// The tip of the crack against time.
    Tip,
    /// Pictures of the phase field.
    PhaseField,
    /// Pictures of any field.
    Pictures,
}

const WINDOW: &[&str] = &["from", "to"];

/// All measures that a check can name.
pub static MEASURES: [Measure; 31] = [
    on_curve("relative-rms", |q| series::against_curve("relative-rms", q.check, q.run, q.library)),
    on_curve("rms-difference", |q| series::against_curve("rms-difference", q.check, q.run, q.library)),
    of_column("value-at", &["column", "at"], &[], |q| some(series::value_at(q.check, q.run, false)?)),
    of_column("increment-at", &["column", "at"], &[], |q| some(series::value_at(q.check, q.run, true)?)),
    of_column("initial", &["column"], &[], |q| some(q.run.column(column(q.check)?)?.first().copied())),
    of_column("final", &["column"], &[], |q| some(q.run.column(column(q.check)?)?.last().copied())),
    of_column("smooth-mean", &["column"], WINDOW, |q| value(series::smooth_mean(q.check, q.run)?)),
    of_column("slope-from-zero", &["column"], WINDOW, |q| value(series::slope_from_zero(q.check, q.run)?)),
    of_column("slope", &["column"], WINDOW, |q| value(series::slope(q.check, q.run)?)),
    of_column("slope-over-tip", &["column"], WINDOW, |q| value(series::slope_over_tip(q.check, q.run)?)),
    of_column("slope-ratio", &["column"], WINDOW, |q| series::slope_over_plane_wave_power(q.check, q.run)),
    of_column("closure", &[], &[], |q| value(series::closure(q.run)?)),
    of_column("drift", &["column"], WINDOW, |q| value(series::drift(q.check, q.run)?)),
    of_column("largest", &["column"], WINDOW, |q| value(series::largest(q.check, q.run)?)),
    of_column("peak-value", &["column"], &["from", "to", "at"], |q| {
        some(series::peak(q.check, q.run)?.map(|(_, value)| value))
    }),
    of_column("peak-time", &["column"], &["from", "to", "at"], |q| {
        some(series::peak(q.check, q.run)?.map(|(time, _)| time))
    }),
    of_column("largest-decrease", &["column"], &[], |q| value(series::largest_decrease(q.check, q.run)?)),
    of_column("largest-fall", &["column"], &[], |q| value(series::largest_fall(q.check, q.run)?)),
    of_column("difference", &["column", "against"], &[], |q| value(series::difference(q.check, q.run, q.runs)?)),
    of_column("order-in-step", &["column"], WINDOW, |q| some(series::order_in_step(q.check, q.runs)?)),
    looking("stress-in-the-middle", LooksAt::Pictures, &[], |q| value(series::stress_in_the_middle(q.run)?)),
    looking("tip-passes", LooksAt::Tip, &["at"], |q| some(tip::passes(q.check, q.run)?)),
    looking("branching-time", LooksAt::Tip, &[], |q| some(tip::branching(q.run)?.map(|b| b.time))),
    looking("branching-place", LooksAt::Tip, &[], |q| some(tip::branching(q.run)?.map(|b| b.x))),
    looking("axis-end", LooksAt::PhaseField, &[], |q| some(tip::end_along_axis(q.run))),
    looking("tip-speed-ratio", LooksAt::Tip, &["at"], |q| some(tip::largest_speed_before_branching(q.check, q.run)?)),
    looking("tip-exit", LooksAt::Tip, &["at"], |q| some(tip::exit_offset(q.check, q.run)?)),
    looking("growth-time", LooksAt::Tip, &["at"], |q| some(tip::growth(q.check, q.run)?.map(|grown| grown[0]))),
    looking("chord-angle", LooksAt::Tip, &["at"], |q| some(tip::chord_angle(q.check, q.run)?)),
    looking("branches", LooksAt::PhaseField, &["at"], |q| some(tip::branches(q.check, q.run)?)),
    looking("asymmetry", LooksAt::PhaseField, &[], |q| some(tip::asymmetry(q.run))),
];

impl Measure {
    /// Whether it compares the run with a curve of the reference data, as a whole.
    pub fn compares_curves(&self) -> bool {
        self.needs.contains(&"reference")
    }
}

const fn of_column(
    name: &'static str,
    needs: &'static [&'static str],
    takes: &'static [&'static str],
    find: fn(&Question<'_>) -> Answer,
) -> Measure {
    Measure { name, needs, takes, looks_at: LooksAt::Run, find }
}

const fn on_curve(name: &'static str, find: fn(&Question<'_>) -> Answer) -> Measure {
    of_column(name, &["column", "reference"], WINDOW, find)
}

const fn looking(
    name: &'static str,
    looks_at: LooksAt,
    needs: &'static [&'static str],
    find: fn(&Question<'_>) -> Answer,
) -> Measure {
    Measure { name, needs, takes: &[], looks_at, find }
}

fn some(value: Option<f64>) -> Answer {
    Ok(Measured::of(value))
}

fn value(value: f64) -> Answer {
    some(Some(value))
}

/// The measure of that name, or the last value of the run.
///
/// # Errors
/// If there is none of that name.
pub fn find(name: Option<&str>) -> Result<&'static Measure, String> {
    let name = name.unwrap_or("final");
    let known = || MEASURES.iter().map(|measure| measure.name).collect::<Vec<_>>().join(", ");
    let found = MEASURES.iter().find(|measure| measure.name == name);
    found.ok_or_else(|| format!("unknown measure {name:?}; known: {}", known()))
}
