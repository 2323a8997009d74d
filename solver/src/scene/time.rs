//! How loads and conditions vary in time: a factor of their full value.

use std::fmt;
use std::sync::Arc;

/// A factor over time (s).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TimeFactor {
    /// Its course.
    pub course: Course,
    /// From this time on (s) the factor is zero: a load is gone, and a velocity is zero. Validation refuses
    /// it for displacements.
    pub until: Option<f64>,
}

/// Course of a factor.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Course {
    /// 1 from t = 0.
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

/// A function of the time (s) and the text that it was read from; two are equal if their texts are.
#[derive(Clone)]
pub struct TimeFormula {
    text: String,
    value: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl TimeFormula {
    /// The function that `text` stands for.
    pub fn new(text: impl Into<String>, value: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { text: text.into(), value: Arc::new(value) }
    }

    /// The formula as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl fmt::Debug for TimeFormula {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "TimeFormula({:?})", self.text)
    }
}

impl PartialEq for TimeFormula {
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
            Course::Formula(formula) => (formula.value)(time),
        }
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
}
