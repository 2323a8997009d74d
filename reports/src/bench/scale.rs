//! Time and memory per point against the number of points.

use fisura_verification::bench::record::BenchRecord;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Curve, CurveStyle};

use super::{Exhibit, Records};
use crate::number::plain;
use crate::series::SeriesSet;
use crate::svg::slug;

/// Bytes per point that a block with fracture may have.
const BYTES: f64 = 250.0;

/// A figure for time and one for memory.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let all = records.below("scale/");
    if all.is_empty() {
        return Vec::new();
    }
    let mut blocks: Vec<&str> = all.iter().map(|r| r.label.as_str()).collect();
    blocks.dedup();
    let of = |label: &str| all.iter().copied().filter(|r| r.label == label).collect::<Vec<_>>();
    let blocks: Vec<(&str, Vec<&BenchRecord>)> = blocks.into_iter().map(|label| (label, of(label))).collect();
    let times: Vec<String> = blocks.iter().filter_map(|(label, records)| flatness(label, records)).collect();
    let memory: Vec<String> = blocks.iter().filter_map(|(label, records)| weight(label, records)).collect();
    vec![
        plot(&blocks, "time", "processor time per particle-step (ns)", "ns", |r| r.ns_per_unit.median, times),
        plot(&blocks, "memory", "counted memory of the model per point (bytes)", "bytes", bytes, memory),
    ]
}

fn points(record: &BenchRecord) -> f64 {
    record.number("particles").unwrap_or(f64::NAN)
}

fn bytes(record: &BenchRecord) -> f64 {
    record.memory_bytes as f64 / points(record)
}

/// Ranges of points over which the time per point is compared: beyond what small caches hold, and beyond all
/// caches.
const RANGES: [f64; 2] = [1.5e5, 2.5e6];

/// How much the time per point changes over each range.
fn flatness(label: &str, records: &[&BenchRecord]) -> Option<String> {
    let last = *records.last()?;
    let part = |least: f64| {
        let first = *records.iter().find(|record| points(record) >= least)?;
        let change = last.ns_per_unit.median / first.ns_per_unit.median;
        let [ns, from, change] = [first.ns_per_unit.median, points(first), change].map(|value| plain(value, 3));
        (points(first) < points(last)).then(|| format!("{change} times the {ns} ns at {from} points"))
    };
    let parts: Vec<String> = RANGES.into_iter().filter_map(part).collect();
    let [ns, count] = [last.ns_per_unit.median, points(last)].map(|value| plain(value, 3));
    let compared = if parts.is_empty() { String::new() } else { format!(", {}", parts.join(" and ")) };
    Some(format!("{label}: {ns} ns at {count} points{compared}."))
}

fn weight(label: &str, records: &[&BenchRecord]) -> Option<String> {
    let last = records.last()?;
    let verdict = match last.number("phase_field_bytes") {
        Some(carried) if carried > 0.0 => {
            let word = if bytes(last) <= BYTES { "met" } else { "missed" };
            format!(" (at most {BYTES} with fracture: {word})")
        }
        _ => String::new(),
    };
    let peak = last.number("peak_bytes").map_or(String::new(), |peak| {
        format!(
            "; the peak of the process is {} bytes per point, {} GB in total",
            plain(peak / points(last), 3),
            plain(peak / 1e9, 3)
        )
    });
    Some(format!(
        "{label}: {} bytes per point counted at {} points{verdict}{peak}.",
        plain(bytes(last), 3),
        plain(points(last), 3)
    ))
}

fn plot(
    blocks: &[(&str, Vec<&BenchRecord>)],
    name: &str,
    axis: &str,
    unit: &str,
    value: impl Fn(&BenchRecord) -> f64,
    reading: Vec<String>,
) -> Exhibit {
    let id = format!("timing/scale-{name}");
    let mut set = SeriesSet::default();
    let curve = |(label, records): &(&str, Vec<&BenchRecord>)| {
        let mut table = Table::new(&["points", unit]);
        records.iter().for_each(|record| table.push(&[points(record), value(record)]));
        let series = format!("{id}-{}", slug(label));
        set.insert(series.clone(), table);
        Curve { style: CurveStyle::Markers, ..Curve::line(label, &series, ["points", unit]) }
    };
    let curves = blocks.iter().map(curve).collect();
    let title = format!("Blocks from 10⁴ points: {axis}");
    let caption = "Square blocks, p = 2 with 2 × 2 points per span, one thread";
    Exhibit::log_log([&id, &title, caption], ["points", axis], curves, Vec::new(), (&set, reading.join(" ")))
}

#[cfg(test)]
mod tests {
    use fisura_verification::bench::record::Sample;

    use super::*;

    fn record(cells: usize, ns: f64, bytes: u64) -> BenchRecord {
        let points = 4.0 * (cells * cells) as f64;
        let mut record = BenchRecord::new(format!("scale/cracking/{cells}"), "cracking", points, "particle-step")
            .with("particles", points)
            .with("phase_field_bytes", 1.0);
        record.samples = vec![Sample { wall_s: 1e-9 * ns * points, cpu_s: 1e-9 * ns * points }];
        record.memory_bytes = bytes * points as u64;
        record.verify(true, "");
        record.summarise();
        record
    }

    #[test]
    fn large_blocks_are_compared_and_heavy_ones_named() {
        let heavy = record(2000, 25.0, 300).with("peak_bytes", 1.6e7 * 320.0);
        let records = [record(100, 10.0, 200), record(200, 12.5, 200), record(800, 20.0, 200), heavy];
        let exhibits = exhibits(Records(&records));
        let readings: Vec<&str> = exhibits
            .iter()
            .map(|e| match e {
                Exhibit::Plot(plot) => plot.reading.as_str(),
                Exhibit::Grid(_) => "",
            })
            .collect();
        let both =
            "25 ns at 1.6e7 points, 2 times the 12.5 ns at 160000 points and 1.25 times the 20 ns at 2.56e6 points";
        assert!(readings[0].contains(both), "{readings:?}");
        assert!(
            readings[1].contains("missed") && readings[1].contains("the process is 320 bytes per point"),
            "{readings:?}"
        );
        assert!(super::exhibits(Records(&[])).is_empty());
    }
}
