//! The error of a motion in which points cross spans, against time.

use super::work_precision::{Chart, Cost, lines, on_finest};
use super::{Exhibit, Records};

/// One figure.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let lines = lines(records.below("motion/"));
    if lines.is_empty() {
        return Vec::new();
    }
    let chart = Chart {
        id: "timing/motion".into(),
        title: "Points that cross spans: error of the displacement against time".into(),
        lines: &lines,
        front: None,
        fem: &[],
        cost: Cost::Time,
        axis: "processor time of the run (s)",
        uncertainty: 0.0,
    };
    let caption = "Axis-aligned displacement of finite strain (convergence/gauss-axis-aligned), one thread; against the exact motion";
    vec![chart.plot(caption, on_finest(&lines, "spans"))]
}
