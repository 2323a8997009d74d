//! Threads, ceilings of the machine, scenes with more and less physics, other codes.

use fisura_verification::bench::record::{BenchRecord, BenchSet, Spread};

use super::bars::BarChart;
use super::{Exhibit, Records, range};
use crate::number::{plain, pretty};

/// Steps with 1, 2, … threads.
pub fn threads(records: Records) -> Option<Exhibit> {
    let all = records.below("threads/");
    let mut numbers: Vec<usize> = all.iter().map(|r| r.threads).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let mut scenes: Vec<&str> = all.iter().filter_map(|r| r.id.split('/').nth(1)).collect();
    scenes.dedup();
    scenes.first()?;
    let of = |scene: &str, threads: usize| records.get(&format!("threads/{scene}/{threads}"));
    let row = |scene: &&str| {
        let label = of(scene, 1).map_or(scene.to_string(), |r| r.label.clone());
        (label, numbers.iter().map(|&n| of(scene, n).map(|r| r.ns_per_unit)).collect())
    };
    let count = |n: &usize| if *n == 1 { "1 thread".to_string() } else { format!("{n} threads") };
    let chart = BarChart {
        id: "timing/threads".into(),
        title: "Steps with more threads".into(),
        axis: "wall time per particle-step (ns)".into(),
        series: numbers.iter().map(count).collect(),
        rows: scenes.iter().map(row).collect(),
    };
    let most = numbers.last().copied().unwrap_or(1);
    let sentence = |scene: &&str| -> Option<String> {
        let (one, many) = (of(scene, 1)?, of(scene, most)?);
        let gain = one.ns_per_unit.median / many.ns_per_unit.median;
        let best = one.ns_per_unit.min / many.ns_per_unit.min;
        let (gain, best) = (pretty(gain, 3), pretty(best, 3));
        (most > 1).then(|| {
            format!(
                "{}: with {} the wall time falls by a factor of {gain} (least times: {best}); the results are bitwise identical.",
                one.label,
                count(&most)
            )
        })
    };
    let reading = scenes.iter().filter_map(sentence).collect::<Vec<_>>().join(" ");
    let caption =
        "Wall time, affected by other load on the machine. Bars: median; whiskers: minimum and maximum of the rounds";
    Some(chart.exhibit(caption, reading))
}

/// Most time of a sweep over that of the larger ceiling.
const CEILING: f64 = 1.2;

/// Bandwidth, arithmetic, and how far the elastic sweep is from both.
pub fn ceilings(records: Records) -> Option<Exhibit> {
    let (triad, add) = (records.get("ceilings/triad")?, records.get("ceilings/multiply-add")?);
    let (byte, flop) = (triad.ns_per_unit.median, add.ns_per_unit.median);
    let mut rows = vec![rate(triad, "GB/s"), rate(add, "GF/s")];
    let mut notes = Vec::new();
    for sweep in records.below("ceilings/elastic-sweep/") {
        let per_point = |name: &str| sweep.number(name).unwrap_or(f64::NAN);
        let (flops, bytes) = (per_point("flops_per_point"), per_point("bytes_per_point"));
        let (by_flops, by_bytes) = (flops * flop, bytes * byte);
        let median = sweep.ns_per_unit.median;
        let bound = if by_flops > by_bytes { "arithmetic" } else { "bandwidth" };
        let distance = median / by_flops.max(by_bytes);
        let [arithmetic, bandwidth, transferred] = [by_flops, by_bytes, bytes].map(|value| plain(value, 3));
        rows.push(vec![
            sweep.label.clone(),
            format!("{} ns per point", plain(median, 3)),
            range(sweep.ns_per_unit),
            format!("{arithmetic} ns by {} operations, {bandwidth} ns by {transferred} bytes", plain(flops, 4)),
        ]);
        let degree = sweep.number("degree").unwrap_or(f64::NAN);
        let beyond = if distance < 1.0 { ", and is faster than the measured ceiling" } else { "" };
        let word = if distance <= CEILING { "met" } else { "missed" };
        let distance = plain(distance, 3);
        notes.push(format!(
            "the sweep of p = {degree} takes {distance} times the time of its ceiling ({bound}; target ≤ {CEILING}, {word}){beyond}"
        ));
    }
    let moving =
        records.below("ceilings/elastic-sweep/").iter().find_map(|r| r.number("bytes_per_point_of_moving_points"));
    if let Some(bytes) = moving {
        notes.push(format!("moving points alone transfer {bytes} bytes per step in {} ns", plain(bytes * byte, 3)));
    }
    let note = format!(
        "Operations and bytes are counted from the code, not with hardware counters; times are processor times of this run: {}.",
        notes.join("; ")
    );
    let head = ["", "median", "rounds", "ceilings"];
    Some(Exhibit::grid("Ceilings of this machine on one thread", &head, rows, note))
}

/// A ceiling as a rate.
fn rate(record: &BenchRecord, unit: &str) -> Vec<String> {
    let Spread { median, min, max } = record.ns_per_unit;
    let rates = [median, max, min].map(|ns| plain(1.0 / ns, 3));
    vec![record.label.clone(), format!("{} {unit}", rates[0]), format!("{} to {}", rates[1], rates[2]), String::new()]
}

/// Another checkout on the same scenes.
pub fn baseline(records: Records) -> Option<Exhibit> {
    let row = |ours: &&BenchRecord| -> Option<Vec<String>> {
        let theirs = records.find(&format!("{}other", ours.id.strip_suffix("this")?))?;
        let difference = |r: &BenchRecord| r.error.as_ref().map_or("–".into(), |error| pretty(error.value, 2));
        let part = ours.cpu_s.median / theirs.cpu_s.median;
        let verdict = if ours.verified && theirs.verified { "both verified" } else { "an answer is not verified" };
        let [one, two] = [ours, theirs].map(|r| format!("{} s", plain(r.cpu_s.median, 3)));
        Some(vec![ours.label.clone(), one, two, plain(part, 3), difference(ours), difference(theirs), verdict.into()])
    };
    let ours: Vec<&BenchRecord> = records.0.iter().filter(|r| r.family == "baseline").collect();
    let rows: Vec<Vec<String>> = ours.iter().filter_map(row).collect();
    let other = ours.iter().find_map(|r| r.parameters.get("checkout")?.as_str().filter(|path| *path != "."))?;
    let head = ["scene", "this checkout", "other checkout", "ratio", "energies, this", "energies, other", "verified"];
    let note = format!(
        "The other checkout is {other}. Times are processor times of whole processes on all threads, run alternately. Energies: largest \
         difference at the end from a run of this checkout with a phase-field tolerance of 1e-10, over the largest energy."
    );
    Some(Exhibit::grid("Another checkout on the same scenes", &head, rows, note))
}

/// Time and memory of scenes by what they model.
pub fn scenes(records: Records) -> Option<Exhibit> {
    let all: Vec<&BenchRecord> = records.0.iter().filter(|record| record.family == "scenes").collect();
    all.first()?;
    let bytes = |record: &BenchRecord| record.memory_bytes as f64 / record.number("particles").unwrap_or(f64::NAN);
    let text = |record: &BenchRecord, name: &str| match record.parameters.get(name) {
        Some(serde_json::Value::String(s)) => s.clone(),
        Some(serde_json::Value::Array(a)) => a.iter().filter_map(|v| v.as_str()).collect::<Vec<_>>().join(", "),
        _ => String::new(),
    };
    let row = |record: &&BenchRecord| {
        vec![
            record.label.clone(),
            text(record, "frame"),
            text(record, "models"),
            plain(record.ns_per_unit.median, 3),
            range(record.ns_per_unit),
            plain(bytes(record), 3),
            plain(record.number("phase_field_bytes").unwrap_or(0.0) / record.number("particles").unwrap_or(1.0), 3),
            if record.verified { record.answer.clone() } else { format!("NOT verified: {}", record.answer) },
        ]
    };
    let head = [
        "scene",
        "frame",
        "models",
        "ns per particle-step",
        "rounds",
        "bytes per point",
        "of which phase field",
        "verified",
    ];
    let note = |frame: &str| -> Option<String> {
        let of = |name: &str| records.get(&format!("scenes/{frame}/{name}"));
        let (elastic, fracture) = (of("elastic")?, of("fracture")?);
        let carried = elastic.number("phase_field_bytes").unwrap_or(f64::NAN);
        Some(format!(
            "In the {frame} frame, the block with a growing crack needs {} times the time and {} times the memory of the elastic block. \
             The elastic block stores {carried} bytes of phase field.",
            plain(fracture.ns_per_unit.median / elastic.ns_per_unit.median, 3),
            plain(bytes(fracture) / bytes(elastic), 3)
        ))
    };
    let mut notes: Vec<String> = ["total", "updated"].into_iter().filter_map(note).collect();
    let halves = ["half-of-the-plate", "the-whole-plate"].map(|name| records.get(&format!("scenes/total/{name}")));
    if let [Some(half), Some(whole)] = halves {
        notes.push(format!(
            "Half of the plate needs {} % of the time and {} % of the memory of the whole plate.",
            plain(100.0 * half.cpu_s.median / whole.cpu_s.median, 3),
            plain(100.0 * half.memory_bytes as f64 / whole.memory_bytes as f64, 3)
        ));
    }
    Some(Exhibit::grid("Scenes by their models", &head, all.iter().map(row), notes.join(" ")))
}

/// Stored ratios to other codes, carried over by the kernels; and the program of the user, if it was run.
pub fn peers(set: &BenchSet) -> Vec<Exhibit> {
    let records = Records(&set.records);
    let mut exhibits = Vec::new();
    if let (Some(ours), Some(theirs)) = (records.get("peer/fisura"), records.find("peer/command")) {
        let row = |record: &BenchRecord| {
            let ns = record.ns_per_unit;
            vec![record.label.clone(), plain(ns.median, 3), range(ns), record.answer.clone()]
        };
        let factor = theirs.ns_per_unit.median / ours.ns_per_unit.median;
        let trust = if theirs.verified { "" } else { " Its answer is not verified, so its time is not valid." };
        let note = format!(
            "It takes {} times the time of fisura, without start and end of the program.{trust}",
            plain(factor, 3)
        );
        let head = ["program", "ns per particle-step", "rounds", "verified"];
        exhibits.push(Exhibit::grid("The program of --peer on the same block", &head, [row(ours), row(theirs)], note));
    }
    let tuned: Vec<_> = set.peers.iter().filter(|p| p.quantity == "over-tuned-kernel").collect();
    let Some(first) = tuned.first() else { return exhibits };
    let row = |peer: &&fisura_verification::bench::record::NamedPeer| {
        let naive = set
            .peers
            .iter()
            .find(|p| p.code == peer.code && p.degree == peer.degree && p.quantity == "over-naive-kernel");
        let naive = naive.map(|p| p.value);
        let estimate = naive.and_then(|naive| Some(naive * kernel_over_ours(records, peer.degree)?));
        let or_dash = |value: Option<f64>| value.map_or("–".into(), |v| plain(v, 3));
        let degree = peer.degree.to_string();
        vec![peer.code.clone(), degree, plain(peer.value, 3), or_dash(naive), or_dash(estimate), peer.remark.clone()]
    };
    let head = ["code", "p", "over a tuned kernel", "over a naive kernel", "over fisura, estimated", "remark"];
    let note = format!(
        "Not measured in this run: {}. The kernels are those of the stored run. The estimate is the ratio to the naive kernel, \
         multiplied by the ratio of the minimal kernel to an elastic step of fisura in the updated frame in this run. It \
         assumes that both kernels take the same time; they are only similar.",
        first.conditions
    );
    let title = "Named codes on an elastic block: stored ratios of times";
    exhibits.push(Exhibit::grid(title, &head, tuned.iter().map(row), note));
    exhibits
}

/// Time of the minimal kernel over our elastic step in the updated frame.
fn kernel_over_ours(records: Records, degree: usize) -> Option<f64> {
    let of = |phase: &str| Some(records.get(&format!("stages/p{degree}/{phase}"))?.ns_per_unit.median);
    Some(of("minimal-step")? / of("elastic-step-updated")?)
}
