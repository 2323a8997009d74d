//! The error of a motion in both frames, against time.

use super::work_precision::{Chart, Line, at_equal_error, lines, on_finest};
use super::{Exhibit, Records};

/// One figure.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let lines = lines(records.below("motion/"));
    if lines.is_empty() {
        return Vec::new();
    }
    let title = "A body that moves: error of the displacement against time";
    let chart = Chart::of_time("timing/motion", title, &lines, "processor time of the run (s)");
    let caption = "Axis-aligned displacement of finite strain (convergence/axis-aligned, moving-axis-aligned), one thread; against the exact motion";
    let in_total = |line: &&Line| line.records.iter().all(|record| record.id.contains("-total/"));
    let (total, updated) = lines.iter().partition(in_total);
    let reading = format!("{} {}", at_equal_error([updated, total]), on_finest(&lines, "spans"));
    vec![chart.plot(caption, reading)]
}

#[cfg(test)]
mod tests {
    use fisura_verification::bench::record::{AnswerError, BenchRecord, Sample};

    use super::*;

    #[test]
    fn frames_are_compared_at_the_errors_that_both_reach() {
        let run = |word: &str, seconds: f64, error: f64| {
            let mut record = BenchRecord::new(format!("motion/p2-{word}/{seconds}"), word, 1.0, "unknown");
            record.samples = vec![Sample { wall_s: seconds, cpu_s: seconds }];
            record.error = Some(AnswerError::relative("error", error, "exact"));
            record.verify(true, "");
            record.summarise();
            record
        };
        let records = [run("points", 1.0, 0.05), run("points", 8.0, 0.01), run("total", 2.0, 0.01)];
        let Exhibit::Plot(plot) = exhibits(Records(&records)).remove(0) else { panic!("a plot") };
        assert!(
            plot.reading.starts_with("For an error of 5 %: points, 1 s; total, 2 s; ratio 0.5."),
            "{}",
            plot.reading
        );
        assert!(
            plot.reading.contains("For an error of 1 %: points, 8 s; total, 2 s; ratio 4.")
                && !plot.reading.contains("0.5 %:")
        );
    }
}
