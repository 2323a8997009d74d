//! Time and memory per point against the number of points.

use fisura_verification::bench::record::BenchRecord;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Curve, CurveStyle};

use super::{Exhibit, Records};
use crate::number::plain;
use crate::series::SeriesSet;
use crate::svg::slug;
use crate::view::by_key;

/// Bytes per point that a block with fracture may have.
const BYTES: f64 = 250.0;

/// A figure for time and one for memory.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let all = records.below("scale/");
    if all.is_empty() {
        return Vec::new();
    }
    let blocks = by_key(all.into_iter().map(|record| (record.label.as_str(), record)));
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
        let [each, all] = [peak / points(last), peak / 1e9].map(|value| plain(value, 3));
        format!("; the peak of the process is {each} bytes per point, {all} GB in total")
    });
    let [counted, points] = [bytes(last), points(last)].map(|value| plain(value, 3));
    Some(format!("{label}: {counted} bytes per point counted at {points} points{verdict}{peak}."))
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
