//! Checks of factors over time.

use super::findings::Findings;
use crate::scene::time::{Course, TimeFactor};

/// Times at which a formula is looked at, of the simulated time.
const LOOKS: usize = 1000;

/// Checks the factor of the load or condition at `key` over the simulated time, `end` seconds.
pub(super) fn check(key: &str, factor: &TimeFactor, end: f64, findings: &mut Findings) {
    match &factor.course {
        Course::Constant => {}
        Course::Ramp(rise) => {
            let like = "\"1 us\", or leave it out for the full value from t = 0";
            findings.positive(format!("{key}.time.ramp"), *rise, like);
        }
        Course::Smooth(rise) => {
            findings.positive(format!("{key}.time.smooth"), *rise, "\"1 us\"");
        }
        Course::Table(rows) => table(&format!("{key}.time"), rows, findings), // of the scene, or of a file
        Course::Formula(formula) => {
            let times = (0..=LOOKS).map(|i| end * i as f64 / LOOKS as f64);
            if let Some(time) = times.clone().find(|&time| !factor.value(time).is_finite()) {
                let message = format!("{:?} is not finite at t = {time:e} s", formula.text());
                findings.error(format!("{key}.time.formula"), message, "give a formula that is finite from t = 0 on");
            }
        }
    }
    if let Some(until) = factor.until {
        findings.positive(format!("{key}.time.until"), until, "\"5 us\", or leave it out");
    }
}

/// Times that increase, and factors that are finite.
fn table(key: &str, rows: &[[f64; 2]], findings: &mut Findings) {
    if rows.is_empty() {
        return findings.error(key, "a table without rows", "give rows of time and factor: [[\"0 us\", 0.0], …]");
    }
    if !findings.finite(key, &rows.concat()) {
        return;
    }
    if let Some(i) = (1..rows.len()).find(|&i| rows[i][0] <= rows[i - 1][0]) {
        let message = format!("row {i} of the table is at {} s, after {} s", rows[i][0], rows[i - 1][0]);
        findings.error(key, message, "give times that increase from row to row");
    }
}
