//! Time and memory per point against the number of points.

use fisura_verification::bench::record::BenchRecord;
use fisura_verification::output::history::Table;
use fisura_verification::record::{Axis, Curve, CurveStyle, Figure, FigureBody, Scale};

use super::{Exhibit, Plot, Records};
use crate::figure::render_figure;
use crate::number::plain;
use crate::series::SeriesSet;
use crate::svg::slug;

/// Points from which on a block is far larger than a cache.
const LARGE: f64 = 1e6;
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
        plot(&blocks, "memory", "memory of the model per point (bytes)", "bytes", bytes, memory),
    ]
}

fn points(record: &BenchRecord) -> f64 {
    record.number("particles").unwrap_or(f64::NAN)
}

fn bytes(record: &BenchRecord) -> f64 {
    record.memory_bytes as f64 / points(record)
}

/// How much the time per point changes between blocks larger than a cache.
fn flatness(label: &str, records: &[&BenchRecord]) -> Option<String> {
    let large: Vec<&&BenchRecord> = records.iter().filter(|r| points(r) >= LARGE).collect();
    let (first, last) = match large.as_slice() {
        [first, .., last] => (*first, *last),
        _ => (records.first()?, records.last()?),
    };
    let change = last.ns_per_unit.median / first.ns_per_unit.median;
    Some(format!(
        "{label}: {} ns at {} points, {} ns at {} points, {} times as much.",
        plain(first.ns_per_unit.median, 3),
        plain(points(first), 3),
        plain(last.ns_per_unit.median, 3),
        plain(points(last), 3),
        plain(change, 3)
    ))
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
    Some(format!(
        "{label}: {} bytes per point at {} points{verdict}, {} GB in all.",
        plain(bytes(last), 3),
        plain(points(last), 3),
        plain(last.memory_bytes as f64 / 1e9, 3)
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
        Curve {
            label: label.to_string(),
            series,
            x: "points".into(),
            y: unit.into(),
            x_scale: 1.0,
            y_scale: 1.0,
            style: CurveStyle::Markers,
            uncertainty_absolute: 0.0,
            uncertainty_relative: 0.0,
        }
    };
    let curves = blocks.iter().map(curve).collect();
    let of = |label: &str| Axis { label: label.into(), scale: Scale::Log, range: None };
    let title = format!("Blocks from 10⁴ points: {axis}");
    let caption = "Square blocks, p = 2 with 2 × 2 points per span, one thread".to_string();
    let figure = Figure {
        id: id.clone(),
        suite: "bench".into(),
        title: title.clone(),
        caption: caption.clone(),
        deviations: vec![],
        body: FigureBody::Chart {
            x: of("points"),
            y: of(axis),
            curves,
            regions: vec![],
            slopes: vec![],
            floors: vec![],
        },
    };
    let svg = render_figure(&figure, &set);
    Exhibit::Plot(Plot { id, title, caption, reading: reading.join(" "), svg })
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
        let records = [record(100, 10.0, 200), record(800, 20.0, 200), record(2000, 25.0, 300)];
        let exhibits = exhibits(Records(&records));
        let readings: Vec<&str> = exhibits
            .iter()
            .map(|e| match e {
                Exhibit::Plot(plot) => plot.reading.as_str(),
                Exhibit::Grid(_) => "",
            })
            .collect();
        assert!(readings[0].contains("1.25 times as much") && readings[1].contains("missed"), "{readings:?}");
        assert!(super::exhibits(Records(&[])).is_empty());
    }
}
