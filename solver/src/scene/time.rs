//! How loads and conditions vary in time: a factor of their full value.

use std::fmt;
use std::sync::Arc;

use crate::linear_algebra::extremes::{larger, smaller};

/// Intervals into which the time of a formula is cut to integrate it, or to look at it.
const PANELS: usize = 256;

/// A factor over time (s).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeFactor {
    /// Value of the factor as a function of the time, until it ends.
    pub course: Course,
    /// From this time on (s) the factor is zero: a load is gone, and a velocity is zero. Validation refuses
    /// it for displacements.
    pub until: Option<f64>,
}

/// Course of a factor.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Course {
    /// The factor is 1 from t = 0 on.
    #[default]
    Constant,
    /// Rises linearly from 0 to 1 over this time, s.
    Ramp(f64),
    /// Rises from 0 to 1 over this time (s) as `3 s² − 2 s³`, without a jump of its rate.
    Smooth(f64),
    /// Times (s) and factors, linear in between; the first and the last factor hold beyond the ends.
    Table(Vec<[f64; 2]>),
    /// A formula of the time.
    Formula(TimeFormula),
}

/// A factor as a function of the time (s).
pub type TimeFormula = Formula<f64, f64>;

/// A function and the text that it was read from; two are equal if their texts are.
#[derive(Clone)]
pub struct Formula<A, B> {
    text: String,
    value: Arc<dyn Fn(A) -> B + Send + Sync>,
}

impl<A, B> Formula<A, B> {
    /// The function that `text` stands for.
    pub fn new(text: impl Into<String>, value: impl Fn(A) -> B + Send + Sync + 'static) -> Self {
        Self { text: text.into(), value: Arc::new(value) }
    }

    /// Its value where its argument has this one.
    pub fn value(&self, at: A) -> B {
        (self.value)(at)
    }

    /// The formula as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl<A, B> fmt::Debug for Formula<A, B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Formula({:?})", self.text)
    }
}

impl<A, B> PartialEq for Formula<A, B> {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl TimeFactor {
    /// Rises linearly from 0 to 1 over `time` seconds.
    pub fn ramp(time: f64) -> Self {
        Self { course: Course::Ramp(time), until: None }
    }

    /// Whether it is 1 at all times.
    pub fn is_constant(&self) -> bool {
        *self == Self::default()
    }

    /// The factor at a time, s.
    pub fn value(&self, time: f64) -> f64 {
        if self.until.is_some_and(|end| time >= fault!("load-without-end", end => f64::INFINITY)) {
            return 0.0;
        }
        match fault!("ramp-forgotten", &self.course => &Course::Constant) {
            Course::Constant => 1.0,
            Course::Ramp(rise) => (time / rise).clamp(0.0, 1.0),
            Course::Smooth(rise) => {
                let s = (time / rise).clamp(0.0, 1.0);
                fault!("smooth-course-linear", s * s * (3.0 - 2.0 * s) => s)
            }
            Course::Table(rows) => interpolate(rows, time),
            Course::Formula(formula) => formula.value(time),
        }
    }

    /// The factor over the time from 0 on, s: exact, but for a formula, which has [`PANELS`] intervals of two
    /// Gauss points.
    pub(crate) fn integral(&self, time: f64) -> f64 {
        self.over([0.0, time], PANELS)
    }

    /// Mean of the factor between two times, s: exact, but for a formula, which has two Gauss points.
    pub(crate) fn mean(&self, times: [f64; 2]) -> f64 {
        if self.is_constant() { 1.0 } else { self.over(times, 1) / (times[1] - times[0]) }
    }

    /// The factor over the time between two times, s, of a formula with so many intervals.
    fn over(&self, [start, stop]: [f64; 2], panels: usize) -> f64 {
        let end = self.until.map_or(stop, |until| smaller(until, stop));
        if end <= start {
            return 0.0;
        }
        let mut ends = vec![start];
        match &self.course {
            Course::Constant => return end - start,
            Course::Ramp(rise) | Course::Smooth(rise) => ends.push(*rise),
            Course::Table(rows) => {
                let later = rows[rows.partition_point(|row| row[0] <= start)..].iter();
                ends.extend(later.map(|row| row[0]).take_while(|at| *at < end));
            }
            Course::Formula(_) => ends.extend((1..panels).map(|i| start + (end - start) * i as f64 / panels as f64)),
        }
        ends.retain(|at| (start..end).contains(at));
        ends.push(end);
        let gauss = |[from, to]: [f64; 2]| {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            half * (self.value(middle - half / 3.0_f64.sqrt()) + self.value(middle + half / 3.0_f64.sqrt()))
        };
        ends.windows(2).map(|pair| gauss([pair[0], pair[1]])).sum()
    }

    /// Smallest and largest factor up to a time (s), of a formula at [`PANELS`] times and of a table at its
    /// rows.
    pub(crate) fn range(&self, end: f64) -> [f64; 2] {
        let times = (0..=PANELS).map(|i| end * i as f64 / PANELS as f64);
        let rows = if let Course::Table(rows) = &self.course { rows.as_slice() } else { &[] };
        let within = rows.iter().map(|row| row[0]).filter(|time| *time <= end);
        let values = times.chain(within).map(|time| self.value(time));
        values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [smaller(v, low), larger(v, high)])
    }
}

/// Linear interpolation in rows of time and value, constant beyond the ends.
fn interpolate(rows: &[[f64; 2]], time: f64) -> f64 {
    let next = rows.partition_point(|row| row[0] <= time);
    match (next.checked_sub(1).map(|last| rows[last]), rows.get(next)) {
        (Some([t0, v0]), Some([t1, v1])) => v0 + fault!("table-of-steps", (time - t0) / (t1 - t0) => 0.0) * (v1 - v0),
        (Some([_, value]), None) | (None, Some(&[_, value])) => value,
        (None, None) => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn courses_begin_rise_and_end_where_they_say() {
        let of = |course| TimeFactor { course, until: Some(4.0) };
        let table = vec![[1.0, 2.0], [2.0, 4.0], [3.0, -1.0]];
        let formula = TimeFormula::new("t * t", |t| t * t);
        let cases = [
            (of(Course::Constant), [1.0, 1.0, 1.0]),
            (of(Course::Ramp(2.0)), [0.0, 0.5, 1.0]),
            (of(Course::Smooth(4.0)), [0.0, 0.15625, 0.84375]),
            (of(Course::Table(table)), [2.0, 2.0, -1.0]),
            (of(Course::Formula(formula)), [0.0, 1.0, 9.0]),
        ];
        for (factor, values) in cases {
            assert_eq!([0.0, 1.0, 3.0].map(|t| factor.value(t)), values, "{factor:?}");
            assert_eq!(factor.value(4.0), 0.0, "{factor:?}");
        }
        let inside = TimeFactor { course: Course::Table(vec![[1.0, 2.0], [2.0, 4.0]]), until: None };
        assert_eq!([1.25, 9.0].map(|t| inside.value(t)), [2.5, 4.0]);
    }

    #[test]
    fn integrals_are_exact_and_end_with_the_factor() {
        let of = |course| TimeFactor { course, until: Some(4.0) };
        let table = vec![[1.0, 2.0], [2.0, 4.0], [3.0, -1.0]];
        let cases = [
            (of(Course::Constant), [1.0, 4.0], [1.0, 1.0]),
            (of(Course::Ramp(2.0)), [0.25, 3.0], [0.0, 1.0]),
            (of(Course::Smooth(2.0)), [0.1875, 3.0], [0.0, 1.0]), // at half the rise 3/32 of it, then half
            (of(Course::Table(table)), [2.0, 5.5], [-1.0, 4.0]),
            (of(Course::Formula(TimeFormula::new("t * t", |t| t * t))), [1.0 / 3.0, 64.0 / 3.0], [0.0, 9.0]),
        ];
        for (factor, integrals, range) in cases {
            for (time, exact) in [1.0, 5.0].into_iter().zip(integrals) {
                assert!((factor.integral(time) - exact).abs() < 1e-12, "{factor:?} {time}: {}", factor.integral(time));
            }
            assert_eq!(factor.range(3.0), range, "{factor:?}");
        }
    }
}
