//! The error of a motion in both frames, against time.

use super::work_precision::{Chart, Line, at_equal_error, lines, on_finest};
use super::{Exhibit, Records};

/// Figure of the error of a motion against time; absent if there are no records of it.
pub fn exhibit(records: Records) -> Option<Exhibit> {
    let lines = lines(records.below("motion/"));
    lines.first()?;
    let title = "A body that moves: error of the displacement against time";
    let chart = Chart::of_time("timing/motion", title, &lines, "processor time of the run (s)");
    let caption = "Axis-aligned displacement of finite strain (convergence/axis-aligned, moving-axis-aligned), one thread; against the exact motion";
    let in_total = |line: &&Line| line.records.iter().all(|record| record.id.contains("-total/"));
    let (total, updated) = lines.iter().partition(in_total);
    let reading = format!("{} {}", at_equal_error([updated, total]), on_finest(&lines, "spans"));
    Some(chart.plot(caption, reading))
}
