//! Error against time over the benchmarks, for this solver and for finite elements that are made for speed.

use super::work_precision::{Chart, fastest_to, lines};
use super::{Exhibit, Records};
use crate::number::plain;
use crate::view::by_key;

/// Errors whose cost is listed.
const ERRORS: [f64; 7] = [0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.003];

/// What an error costs in each problem, and a figure for each of them.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let all = records.below("scoreboard/");
    let problems = by_key(all.into_iter().filter_map(|r| Some((r.parameters.get("problem")?.as_str()?, r))));
    let (mut plots, mut rows) = (Vec::new(), Vec::new());
    for (problem, records) in problems {
        let lines = lines(records);
        let Some(error) = lines.first().and_then(|line| line.records[0].error.as_ref()) else { continue };
        let of = |code: &str| lines.iter().filter(|line| line.label.starts_with(code)).collect::<Vec<_>>();
        let codes = ["fisura", "elements"].map(of);
        let known = ERRORS.iter().filter(|&&listed| listed >= 2.0 * error.uncertainty);
        let matches: Vec<_> =
            known.map(|&error| (error, codes.each_ref().map(|code| fastest_to(code, error)))).collect();
        rows.extend(matches.iter().filter(|(_, best)| best.iter().any(Option::is_some)).map(|m| row(problem, m)));
        let ahead = matches.iter().filter_map(|(_, best)| ratio(best));
        let (ahead, both) = (ahead.clone().filter(|ratio| *ratio >= 1.0).count(), ahead.count());
        let reading = match both {
            0 => String::new(),
            both => format!("Of {both} errors that both reach, fisura is not slower at {ahead}."),
        };
        let (id, title) = (format!("timing/scoreboard-{problem}"), format!("{problem}: error against time"));
        let axis = "processor time of the run (s)";
        let chart = Chart { uncertainty: error.uncertainty, ..Chart::of_time(&id, &title, &lines, axis) };
        let caption = "Whole runs on one thread with a solve for the phase field in every step. The references are \
                       extrapolated from runs of the same elements, which favours them";
        plots.push(chart.plot(caption, reading));
    }
    let head = ["benchmark", "error", "fisura", "s", "finite elements", "s", "elements over fisura"];
    let note = "Processor time of the fastest way of each code to an error, between meshes by a power law. An error counts \
                for a mesh if no finer one of the same way has a larger error. Errors below twice the uncertainty of \
                the reference are left out. In strip, ring and arrest the elements are not made for speed, and \
                take no part";
    let board = (!rows.is_empty()).then(|| Exhibit::grid("What an error costs", &head, rows, note));
    board.into_iter().chain(plots).collect()
}

/// The fastest way of fisura and of the elements, and its time, s.
type Best = [Option<(String, f64)>; 2];

/// Time of the elements over that of fisura.
fn ratio([fisura, elements]: &Best) -> Option<f64> {
    Some(elements.as_ref()?.1 / fisura.as_ref()?.1)
}

/// A dash for a code that takes no part or does not reach the error.
fn row(problem: &str, (error, best): &(f64, Best)) -> Vec<String> {
    let dash = || "–".to_string();
    let cells = best.iter().flat_map(|best| match best {
        Some((label, time)) => [label.clone(), plain(*time, 3)],
        None => [dash(), dash()],
    });
    let error = format!("{} %", plain(100.0 * error, 2));
    let ratio = ratio(best).map_or_else(dash, |ratio| plain(ratio, 3));
    [problem.to_string(), error].into_iter().chain(cells).chain([ratio]).collect()
}
