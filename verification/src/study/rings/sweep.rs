//! Sweep over the geometries of a case's `[rings]` table: half a ring against a frictionless wall, scored by the events.

use rayon::prelude::*;

use super::{PAPER, Watched, in_microseconds};
use crate::case::Case;
use crate::expand::CaseScene;
use crate::history::Table;
use crate::rings::{Geometry, PARTICLES};
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

/// Events the score counts: the first three. The level of the fracture energy and the end of contact are held out.
const SCORED: usize = 3;
/// Scores up to this many times the best count as near it.
const NEAR: f64 = 2.0;

type Events = [Option<f64>; 6];

/// Root mean square of the scored events' differences from the paper, s; an event that does not come counts as at the end.
fn score(events: &Events, end: f64) -> f64 {
    let scored =
        events.iter().zip(PAPER).filter_map(|(found, paper)| Some((found.unwrap_or(end), paper?))).take(SCORED);
    (scored.map(|(found, paper)| (found - paper).powi(2)).sum::<f64>() / SCORED as f64).sqrt()
}

pub fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let (Some(geometries), [template]) = (&case.rings, scenes) else {
        return Err(StudyError::Other("a sweep needs a [rings] table and one scene".into()));
    };
    let end = template.scene.analysis.end_time;
    let mut runs: Vec<(Geometry, Events, f64)> = geometries
        .par_iter()
        .map(|geometry| {
            let watched = Watched::run(&geometry.quarter(&template.scene));
            let events = watched.map_or([None; 6], |watched| watched.rings[0].events());
            (*geometry, events, score(&events, end))
        })
        .collect();
    runs.sort_by(|a, b| a.2.total_cmp(&b.2));
    let mut findings = Findings::default();
    let best = runs.first().map(|(_, _, score)| *score);
    let near = runs.iter().filter(|run| best.is_some_and(|best| run.2 <= NEAR * best));
    findings.add("", "geometries run", runs.len() as f64, None);
    findings.add("", "geometries near the best", near.count() as f64, None);
    findings.measurements.push(in_microseconds("", "smallest score", best, None));
    findings.series.push((series_stem(case, ""), table(&runs)));
    Ok(findings)
}

/// All geometries, the best first; an event that does not come is NaN.
fn table(runs: &[(Geometry, Events, f64)]) -> Table {
    let mut table = Table::new(&[
        "outer_mm",
        "inner_mm",
        "length_scale_mm",
        "points_per_span",
        "span_mm",
        "inner_edge_us",
        "contact_reached_us",
        "rear_us",
        "rear_through_us",
        "level_us",
        "contact_end_us",
        "score_us",
    ]);
    let rounded = |value: f64| (1e3 * value).round() / 1e3;
    for (geometry, events, score) in runs {
        let Geometry { outer, inner, length_scale, points } = *geometry;
        let h = points as f64 * geometry.spacing(PARTICLES);
        let mut row = vec![1e3 * outer, 1e3 * inner, 1e3 * length_scale, points as f64, 1e3 * h];
        row.extend(events.map(|time| 1e6 * time.unwrap_or(f64::NAN)));
        row.push(1e6 * score);
        table.push(&row.into_iter().map(rounded).collect::<Vec<_>>());
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_leaves_out_what_is_held_out() {
        let exact = [Some(30e-6), Some(60e-6), Some(100e-6), None, Some(1.0), None];
        assert!(score(&exact, 200e-6) < 1e-12);
        let late = [Some(30e-6), Some(60e-6), None, None, None, None];
        assert!((score(&late, 200e-6) - 100e-6 / 3_f64.sqrt()).abs() < 1e-12);
    }
}
