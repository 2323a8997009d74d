//! Errors of collisions against time.

use super::work_precision::{Chart, lines, on_finest};
use super::{Exhibit, Records};

/// Bodies and errors in the order of the report: parts of the id.
const BODIES: [(&str, &str, &str); 2] = [("bars", "Two equal bars", "length"), ("discs", "Two equal discs", "radius")];
const ERRORS: [(&str, &str); 3] =
    [("rebound", "rebound velocity"), ("duration", "contact time"), ("loss", "energy lost")];

/// A figure for each pair of bodies and each error.
pub fn exhibits(records: Records) -> Vec<Exhibit> {
    let mut exhibits = Vec::new();
    for (bodies, title, size) in BODIES {
        let all = records.below(&format!("contact/{bodies}/"));
        for (name, words) in ERRORS {
            let lines = lines(all.iter().copied().filter(|record| record.id.ends_with(&format!("/{name}"))));
            let Some(first) = lines.first() else { continue };
            let reference = first.records[0].error.as_ref();
            let uncertainty = reference.map_or(0.0, |error| error.uncertainty);
            let caption = format!(
                "{title}, head-on, elastic, without friction, one thread; against {}",
                reference.map_or("", |error| error.reference.as_str())
            );
            let (id, title) =
                (format!("timing/contact-{bodies}-{name}"), format!("{title} in collision: {words} against time"));
            let chart = Chart::of_time(&id, &title, &lines, "processor time of the steps (s)");
            let chart = Chart { uncertainty, ..chart };
            exhibits.push(chart.plot(&caption, on_finest(&lines, &format!("spans per {size}"))));
        }
    }
    exhibits
}
