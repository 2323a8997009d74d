//! Pictures of a single run: energies against time, and one phase-field picture per frame.

use fisura_verification::extremes::larger;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Axis, Curve, Figure, FigureBody};

use crate::field::{Raster, render_raster};
use crate::figure::render_figure;
use crate::number::{plain, pretty};
use crate::series::{FigureError, SeriesSet};

/// Name under which the history is passed to the chart.
const HISTORY: &str = "history.csv";

/// Draws all energies of a `history.csv` (columns `time_s` and `*_j`) against time, in units that suit their
/// size. A column without any number is left out.
///
/// # Errors
/// There is no `time_s` column, or no energy column with a number in it.
pub fn energies_svg(history: &Table, title: &str) -> Result<String, FigureError> {
    let largest = |name: &str| {
        let values = history.column(name).unwrap_or_default();
        values.iter().filter(|v| v.is_finite()).map(|v| v.abs()).reduce(larger)
    };
    let drawn: Vec<&String> = history.names.iter().filter(|n| n.ends_with("_j") && largest(n).is_some()).collect();
    let top = drawn.iter().filter_map(|n| largest(n)).fold(0.0, larger);
    let (energy_scale, energy_unit) = unit(top, &[("kJ", 1e3), ("J", 1.0), ("mJ", 1e-3), ("µJ", 1e-6), ("nJ", 1e-9)]);
    let (time_scale, time_unit) = unit(largest("time_s").unwrap_or(0.0), &TIMES);
    let curves: Vec<Curve> = drawn
        .into_iter()
        .map(|name| Curve { x_scale: time_scale, ..Curve::energy(HISTORY, name, energy_scale) })
        .collect();
    if curves.is_empty() {
        let present = history.names.join(", ");
        return Err(FigureError::new("energies", format!("{HISTORY} has no column of an energy; it has {present}")));
    }
    let axes = [format!("time ({time_unit})"), format!("energy ({energy_unit})")].map(|label| Axis::linear(&label));
    let body = FigureBody::chart(axes, curves, Vec::new());
    let mut set = SeriesSet::default();
    set.insert(HISTORY, history.clone());
    render_figure(&Figure::new("", ["energies", title, ""], body), &set)
}

/// Draws the phase field of a frame between 0, broken, and 1, intact.
///
/// # Errors
/// As [`render_raster`].
pub fn phase_svg(frame: &Raster, time_s: f64, title: &str) -> Result<String, FigureError> {
    let (scale, word) = unit(time_s.abs(), &TIMES);
    let title = format!("{title}, phase field at {} {word}", pretty(time_s * scale, 4));
    render_raster([&phase_name(time_s), &title, ""], frame, ("phase field c", [0.0, 1.0]))
}

/// File name, without ending, of the picture of a frame: `phase-45us`. Times that differ have names that
/// differ, to nine digits.
pub fn phase_name(time_s: f64) -> String {
    let units = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
    let (scale, word) = unit(time_s.abs(), &units);
    format!("phase-{}{word}", plain(time_s * scale, 9))
}

const TIMES: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];

/// Factor and name of the largest unit in which `size` is at least 1; the first for zero, else the smallest.
fn unit(size: f64, units: &[(&'static str, f64)]) -> (f64, &'static str) {
    let basic = units.iter().find(|u| u.1 == 1.0).copied().unwrap_or(("", 1.0));
    let fits = units.iter().find(|u| size >= 0.999_999_999 * u.1).copied();
    let smallest = units.last().copied().unwrap_or(basic);
    let (name, size_of_unit) = if size > 0.0 { fits.unwrap_or(smallest) } else { basic };
    ((1.0 / size_of_unit), name)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history() -> Table {
        let mut table = Table::new(&["time_s", "kinetic_j", "contact_loss_j", "time_step_s"]);
        for i in 0..=40 {
            let t = i as f64 * 2e-6;
            table.push(&[t, 0.3 * (t * 1e5).sin().abs(), f64::NAN, 1e-8]);
        }
        table
    }

    #[test]
    fn energies_choose_their_units() {
        let svg = energies_svg(&history(), "Plate").unwrap();
        assert!(svg.contains("time (µs)") && svg.contains("energy (mJ)") && svg.contains("kinetic"));
        assert!(!svg.contains("contact loss") && !svg.contains("NaN"));
        assert_eq!(svg, energies_svg(&history(), "Plate").unwrap());
        assert!(energies_svg(&Table::new(&["time_s"]), "Plate").is_err(), "a history without energies");
    }

    #[test]
    fn frames_are_named_by_their_time() {
        assert_eq!(phase_name(0.0), "phase-0s");
        assert_eq!(phase_name(45e-6), "phase-45us");
        assert_eq!(phase_name(4.50125e-5), "phase-45.0125us");
        assert_eq!(phase_name(1.0), "phase-1s");
    }

    #[test]
    fn a_frame_is_drawn_with_a_gap_where_there_is_no_body() {
        let mut values = vec![0.5; 12];
        values[5] = f64::NAN;
        let frame = Raster { pixels: [4, 3], low: [0.0; 2], high: [4e-3, 3e-3], values };
        let svg = phase_svg(&frame, 45e-6, "Plate").unwrap();
        assert!(svg.contains("phase field at 45 µs") && svg.contains("m0 0h4v1h-4z"), "{svg}");
    }
}
