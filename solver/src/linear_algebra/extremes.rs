//! Extremes that do not lose what is not a number, as `f64::max` and `f64::min` do: a gap must not pass for
//! agreement.
//!
//! They are what sums over points and checks fold with; a test of the workspace finds folds that lose it
//! (`solver/tests/integration/folds.rs`).

/// The larger of two numbers; not a number if either is not.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    fault!("gaps-are-overlooked", if a > b || a.is_nan() { a } else { b } => f64::max(a, b))
}

/// The smaller of two numbers; not a number if either is not.
#[inline(always)]
pub fn smaller(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The largest of magnitudes, 0 of none; not a number if one of them is not.
pub fn largest(magnitudes: impl IntoIterator<Item = f64>) -> f64 {
    magnitudes.into_iter().fold(0.0, larger)
}

/// The smallest of lengths, infinite of none; not a number if one of them is not.
pub fn smallest(lengths: impl IntoIterator<Item = f64>) -> f64 {
    lengths.into_iter().fold(f64::INFINITY, smaller)
}

/// The box around some boxes, each by its least and its largest coordinates.
pub(crate) fn around(boxes: impl IntoIterator<Item = [[f64; 2]; 2]>) -> [[f64; 2]; 2] {
    boxes.into_iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], [other_low, other_high]| {
        [[0, 1].map(|d| smaller(low[d], other_low[d])), [0, 1].map(|d| larger(high[d], other_high[d]))]
    })
}

/// Largest less smallest; not a number if one of them is not.
pub fn spread(values: &[f64]) -> f64 {
    let values = || values.iter().copied();
    values().fold(f64::NEG_INFINITY, larger) - values().fold(f64::INFINITY, smaller)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_find_the_extremes() {
        assert_eq!(largest([0.5, 2.0, 1.0]), 2.0);
        assert_eq!(largest([]), 0.0);
        assert_eq!(smallest([0.5, 2.0, 1.0]), 0.5);
        assert_eq!(spread(&[3.0, -1.0, 2.0]), 4.0);
    }

    #[test]
    fn what_is_not_a_number_stays_wherever_it_stands() {
        for at in 0..3 {
            let mut values = [1.0, 2.0, 3.0];
            values[at] = f64::NAN;
            assert!(largest(values).is_nan() && smallest(values).is_nan() && spread(&values).is_nan(), "{at}");
        }
    }
}
