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
/// Geometries with up to this score, s, count as near: half of the time between the events.
const NEAR: f64 = 15e-6;
/// Part of the broken material aside the diameter up to which a ring counts as split along it.
const ASIDE: f64 = 0.1;

type Events = [Option<f64>; 6];

/// A geometry, what it led to, and its score.
struct Trial {
    geometry: Geometry,
    events: Events,
    aside: f64,
    score: f64,
}

impl Trial {
    /// Near the events of the paper with a ring that splits along the diameter.
    fn is_near(&self) -> bool {
        self.score <= NEAR && self.aside <= ASIDE
    }
}

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
    let mut trials: Vec<Trial> = geometries
        .par_iter()
        .map(|&geometry| {
            let watched = Watched::run(&geometry.quarter(&template.scene)).ok();
            let ring = watched.as_ref().map(|watched| &watched.rings[0]);
            let events = ring.map_or([None; 6], |ring| ring.events());
            let aside = ring.and_then(|ring| ring.table.column("broken_aside")?.last().copied());
            Trial { geometry, events, aside: aside.unwrap_or(f64::NAN), score: score(&events, end) }
        })
        .collect();
    trials.sort_by(|a, b| a.score.total_cmp(&b.score));
    let mut findings = Findings::default();
    let best = |split: bool| trials.iter().find(|trial| !split || trial.aside <= ASIDE).map(|trial| trial.score);
    findings.add("", "geometries run", trials.len() as f64, None);
    let near = trials.iter().filter(|trial| trial.is_near()).count();
    findings.add("", "geometries near the paper that split along the diameter", near as f64, None);
    findings.measurements.push(in_microseconds("", "smallest score", best(false), None));
    findings.measurements.push(in_microseconds(
        "",
        "smallest score of those that split along the diameter",
        best(true),
        None,
    ));
    findings.series.push((series_stem(case, ""), table(&trials)));
    Ok(findings)
}

/// All geometries, the best first; an event that does not come is NaN.
fn table(trials: &[Trial]) -> Table {
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
        "broken_aside",
        "score_us",
    ]);
    let rounded = |value: f64| (1e3 * value).round() / 1e3;
    for Trial { geometry, events, aside, score } in trials {
        let Geometry { outer, inner, length_scale, points } = *geometry;
        let h = points as f64 * geometry.spacing(PARTICLES);
        let mut row = vec![1e3 * outer, 1e3 * inner, 1e3 * length_scale, points as f64, 1e3 * h];
        row.extend(events.map(|time| 1e6 * time.unwrap_or(f64::NAN)));
        row.extend([*aside, 1e6 * score]);
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
