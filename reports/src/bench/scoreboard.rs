//! Error against time over the benchmarks, for this solver and for finite elements that are made for speed.

use super::pareto::cost_to_reach;
use super::work_precision::{Chart, Cost, Line, at_equal_error, lines};
use super::{Exhibit, Records};
use crate::number::plain;
use crate::view::by_key;

/// Errors whose cost is listed.
const ERRORS: [f64; 7] = [0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.003];

/// A figure for each problem, and what an error costs in each of them.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let all = records.below("scoreboard/");
    let problems = by_key(all.into_iter().filter_map(|r| Some((r.parameters.get("problem")?.as_str()?, r))));
    let (mut plots, mut rows) = (Vec::new(), Vec::new());
    for (problem, records) in problems {
        let lines = lines(records);
        let Some(error) = lines.first().and_then(|line| line.records[0].error.as_ref()) else { continue };
        let of = |line: &&Line, code: &str| line.records[0].id.starts_with(&format!("scoreboard/{problem}/{code}/"));
        let codes = ["elements", "fisura"].map(|code| lines.iter().filter(|line| of(line, code)).collect::<Vec<_>>());
        rows.extend(ERRORS.iter().filter(|&&e| e >= 2.0 * error.uncertainty).filter_map(|&e| row(problem, &codes, e)));
        let (id, title) = (format!("timing/scoreboard-{problem}"), format!("{problem}: error against time"));
        let axis = "processor time of the run (s)";
        let chart = Chart { uncertainty: error.uncertainty, ..Chart::of_time(&id, &title, &lines, axis) };
        let caption = "Whole runs on one thread with a solve for the phase field in every step. The references are \
                       extrapolated from runs of the same elements, which favours them";
        plots.push(chart.plot(caption, at_equal_error(codes)));
    }
    let head = ["benchmark", "error", "fisura", "s", "finite elements", "s", "elements over fisura"];
    let note = "Processor time of the fastest way of each code to an error, between meshes by a power law. An error counts \
                for a mesh if no finer one of the same way has a larger error. Errors below twice the uncertainty of \
                the reference are left out. In strip, ring and arrest the elements are not made for speed, and \
                take no part";
    let board = (!rows.is_empty()).then(|| Exhibit::grid("What an error costs", &head, rows, note));
    board.into_iter().chain(plots).collect()
}

/// What both codes take to an error; a dash for a code that takes no part or does not reach it.
fn row(problem: &str, codes: &[Vec<&Line>; 2], error: f64) -> Option<Vec<String>> {
    let [elements, fisura] = codes.each_ref().map(|group| {
        let cost = |line: &&Line| Some((line.label.clone(), cost_to_reach(&line.points(Cost::Time), error)?));
        group.iter().filter_map(cost).min_by(|a, b| a.1.total_cmp(&b.1))
    });
    let ratio = elements.as_ref().zip(fisura.as_ref()).map_or("–".into(), |(a, b)| plain(a.1 / b.1, 3));
    (elements.is_some() || fisura.is_some()).then(|| {
        let [theirs, ours] = [elements, fisura].map(|best| {
            best.map_or(["–".to_string(), "–".to_string()], |(label, time)| {
                [label.trim_start_matches(&format!("{problem}: ")).to_string(), plain(time, 3)]
            })
        });
        let error = format!("{} %", plain(100.0 * error, 2));
        [vec![problem.to_string(), error], ours.to_vec(), theirs.to_vec(), vec![ratio]].concat()
    })
}
