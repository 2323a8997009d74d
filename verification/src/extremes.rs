//! Extremes that do not lose what is not a number, as `f64::max` does: a gap must not pass for agreement.

/// The larger of two numbers; not a number if either is not.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The largest of magnitudes, 0 of none; not a number if one of them is not.
pub fn largest(magnitudes: impl IntoIterator<Item = f64>) -> f64 {
    magnitudes.into_iter().fold(0.0, larger)
}

/// Largest less smallest; not a number if one of them is not.
pub fn spread(values: &[f64]) -> f64 {
    let [high, low] = [1.0, -1.0].map(|sign| values.iter().map(|v| sign * v).fold(f64::NEG_INFINITY, larger));
    high + low
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_find_the_extremes() {
        assert_eq!(largest([0.5, 2.0, 1.0]), 2.0);
        assert_eq!(largest([]), 0.0);
        assert_eq!(spread(&[3.0, -1.0, 2.0]), 4.0);
    }

    #[test]
    fn what_is_not_a_number_stays_wherever_it_stands() {
        for at in 0..3 {
            let mut values = [1.0, 2.0, 3.0];
            values[at] = f64::NAN;
            assert!(largest(values).is_nan() && spread(&values).is_nan(), "{at}");
        }
    }
}
