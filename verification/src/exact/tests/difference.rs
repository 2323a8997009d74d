//! Central differences of eighth order.

/// Spacing: truncation and round-off both stay below 1e-9 for every solution here.
const SPACING: f64 = 2e-3;

const FIRST: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
const SECOND: [f64; 4] = [8.0 / 5.0, -1.0 / 5.0, 8.0 / 315.0, -1.0 / 560.0];
const SECOND_CENTRE: f64 = -205.0 / 72.0;

/// First derivative of `f` at 0.
pub fn first(f: impl Fn(f64) -> f64) -> f64 {
    (1..).zip(FIRST).map(|(i, w)| w * (f(f64::from(i) * SPACING) - f(-f64::from(i) * SPACING))).sum::<f64>() / SPACING
}

/// Second derivative of `f` at 0.
pub fn second(f: impl Fn(f64) -> f64) -> f64 {
    let pairs = (1..).zip(SECOND).map(|(i, w)| w * (f(f64::from(i) * SPACING) + f(-f64::from(i) * SPACING)));
    (pairs.sum::<f64>() + SECOND_CENTRE * f(0.0)) / (SPACING * SPACING)
}

/// Partial derivative of `f` in direction `d`.
pub fn partial(f: impl Fn([f64; 2]) -> f64, at: [f64; 2], d: usize) -> f64 {
    first(|h| f(shifted(at, d, h)))
}

/// Laplacian of `f` at the point `at`.
pub fn laplacian(f: impl Fn([f64; 2]) -> f64, at: [f64; 2]) -> f64 {
    [0, 1].iter().map(|&d| second(|h| f(shifted(at, d, h)))).sum()
}

fn shifted(mut at: [f64; 2], d: usize, h: f64) -> [f64; 2] {
    at[d] += h;
    at
}
