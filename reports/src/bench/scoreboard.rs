//! Error against time over the benchmarks, for this solver and for finite elements.

use super::work_precision::{Chart, Line, at_equal_error, lines};
use super::{Exhibit, Records};

/// One figure for all of them.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let lines = lines(records.below("scoreboard/"));
    if lines.is_empty() {
        return Vec::new();
    }
    let mut problems: Vec<&str> =
        lines.iter().filter_map(|line| line.records[0].parameters.get("problem")?.as_str()).collect();
    problems.dedup();
    let reading = problems.into_iter().map(|problem| {
        let of = |line: &&Line, code: &str| line.records[0].id.starts_with(&format!("scoreboard/{problem}/{code}/"));
        let [elements, fisura] = ["elements", "fisura"].map(|code| lines.iter().filter(|l| of(l, code)).collect());
        at_equal_error([elements, fisura])
    });
    let reading = reading.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(" ");
    let title = "Benchmarks: error against time";
    let chart = Chart::of_time("timing/scoreboard", title, &lines, "processor time of the run (s)");
    let caption = "Whole runs on one thread with a solve for the phase field in every step. Meshes are uniform, and \
                   this solver also runs with spans that are halved along the crack. The references are \
                   extrapolated from runs of the same elements, which favours them";
    vec![chart.plot(caption, reading)]
}
