//! Sweep over the geometries of a case's `[rings]` table: a ring against a frictionless wall, scored by the
//! events.

use fisura::scene::Scene;
use fisura::simulation::breakdown::Breakdown;
use rayon::prelude::*;

use super::{PAPER, Watched, in_microseconds};
use crate::case::geometry::{Geometry, PARTICLES};
use crate::extremes::larger;
use crate::output::history::Table;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, other};

/// Events the score counts: the first three. The level of the fracture energy and the end of contact are held
/// out.
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
    /// Part of the broken material aside the diameter at the end.
    aside: f64,
    /// Fracture energy at the end over that of the walls that broke on the line of centres; none without such
    /// a wall.
    energy_over_walls: Option<f64>,
    /// Not a number if the run broke down.
    score: f64,
    /// Time at which the run broke down, s.
    broke_down: Option<f64>,
}

impl Trial {
    fn run(geometry: Geometry, template: &Scene) -> Result<Self, StudyError> {
        match Watched::run(&geometry.against_a_wall(template)) {
            Ok(watched) => {
                let ring = &watched.rings[0];
                let events = ring.events();
                let aside = ring.table.column("broken_aside").and_then(|column| column.last().copied());
                let score = score(&events, template.analysis.end_time);
                let energy = ring.table.column("fracture_j").and_then(|column| column.last().copied());
                let energy_over_walls =
                    walls(&geometry, &events, template).map(|least| energy.unwrap_or(f64::NAN) / least);
                let aside = aside.unwrap_or(f64::NAN);
                Ok(Self { geometry, events, aside, energy_over_walls, score, broke_down: None })
            }
            Err(StudyError::Breakdown(Breakdown { time, .. })) => Ok(Self::broken(geometry, time)),
            Err(other) => Err(other),
        }
    }

    /// A run that broke down says nothing about its geometry.
    fn broken(geometry: Geometry, time: f64) -> Self {
        let (aside, score) = (f64::NAN, f64::NAN);
        Self { geometry, events: [None; 6], aside, energy_over_walls: None, score, broke_down: Some(time) }
    }

    /// Near the events of the paper with a ring that splits along the diameter.
    fn is_near(&self) -> bool {
        self.score <= NEAR && self.splits()
    }

    /// Its cracks come in the paper's order, one after the other.
    fn is_in_order(&self) -> bool {
        let times = self.events[..SCORED].iter().copied().collect::<Option<Vec<f64>>>();
        times.is_some_and(|times| times.windows(2).all(|pair| pair[0] < pair[1]))
    }

    fn splits(&self) -> bool {
        self.aside <= ASIDE
    }
}

/// Energy (J) that the walls of a ring broken on the line of centres cost at least: Gc per unit area of
/// crack, over the depth that counts as reached; none if no wall is broken through.
fn walls(geometry: &Geometry, events: &Events, template: &Scene) -> Option<f64> {
    let broken = [events[1], events[3]].iter().flatten().count();
    let fracture = template.materials.values().find_map(|material| material.fracture.as_ref())?;
    let depth = geometry.outer - geometry.inner - 2.0 * geometry.length_scale;
    let of_one = fracture.critical_energy_release_rate * template.analysis.thickness * depth;
    (broken > 0).then_some(broken as f64 * of_one)
}

/// Root mean square of the scored events' differences from the paper, s; an event that does not come counts
/// as at the end.
fn score(events: &Events, end: f64) -> f64 {
    let scored =
        events.iter().zip(PAPER).filter_map(|(found, paper)| Some((found.unwrap_or(end), paper?))).take(SCORED);
    (scored.map(|(found, paper)| (found - paper).powi(2)).sum::<f64>() / SCORED as f64).sqrt()
}

pub fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let geometries = case.rings.as_ref().filter(|geometries| !geometries.is_empty());
    let (Some(geometries), [template]) = (geometries, scenes) else {
        return Err(other("a sweep needs a [rings] table with geometries, and one scene"));
    };
    let trials = findings.compute(|| {
        let runs = geometries.par_iter().map(|&geometry| Trial::run(geometry, &template.scene));
        let mut trials = runs.collect::<Result<Vec<_>, _>>()?;
        trials.sort_by(|a, b| a.score.total_cmp(&b.score));
        Ok(trials)
    })?;
    add(findings, trials.as_deref());
    findings.series.extend(trials.map(|trials| (series_stem(case, ""), table(&trials))));
    Ok(())
}

/// Numbers for the checks; the best trials stand first.
fn add(findings: &mut Findings, trials: Option<&[Trial]>) {
    let mut count = |quantity: &str, counts: fn(&Trial) -> bool| {
        let count = trials.map(|trials| trials.iter().filter(|trial| counts(trial)).count() as f64);
        findings.add("", quantity, count, None);
    };
    count("geometries that broke down", |trial| trial.broke_down.is_some());
    count("geometries whose cracks come in the paper's order", Trial::is_in_order);
    count("geometries near the paper", |trial| trial.score <= NEAR);
    count("geometries near the paper that split along the diameter", Trial::is_near);
    let least = trials.map(|trials| {
        let ratios = trials.iter().filter_map(|trial| trial.energy_over_walls);
        ratios.map(|ratio| -ratio).reduce(larger).map_or(f64::NAN, |ratio| -ratio)
    });
    findings.add("", "least fracture energy over that of the broken walls", least, None);
    let mut smallest = |quantity: &str, counts: fn(&Trial) -> bool| {
        let best = |trials: &[Trial]| trials.iter().find(|trial| counts(trial)).map_or(f64::NAN, |trial| trial.score);
        let best = trials.map(|trials| 1e6 * best(trials));
        findings.measurements.push(in_microseconds("", quantity, best, None));
    };
    smallest("smallest score", |_| true);
    smallest("smallest score of those that split along the diameter", Trial::splits);
}

/// All geometries, the best first and those that broke down last; an event that does not come is NaN.
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
        "broke_down_us",
    ]);
    let rounded = |value: f64| (1e3 * value).round() / 1e3;
    for Trial { geometry, events, aside, score, broke_down, .. } in trials {
        let Geometry { outer, inner, length_scale, points } = *geometry;
        let h = points as f64 * geometry.spacing(PARTICLES);
        let mut row = vec![1e3 * outer, 1e3 * inner, 1e3 * length_scale, points as f64, 1e3 * h];
        let microseconds = |time: Option<f64>| 1e6 * time.unwrap_or(f64::NAN);
        row.extend(events.map(microseconds));
        row.extend([*aside, 1e6 * score, microseconds(*broke_down)]);
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

    #[test]
    fn what_is_counted_tells_good_geometries_from_bad() {
        let geometry = Geometry { outer: 0.05, inner: 0.03, length_scale: 1e-3, points: 2 };
        let trial = |events: [f64; 3], score: f64, aside: f64, energy: Option<f64>| {
            let [a, b, c] = events.map(Some);
            let events = [a, b, c, None, None, None];
            Trial { events, score, aside, energy_over_walls: energy, broke_down: None, ..Trial::broken(geometry, 0.0) }
        };
        let near = trial([29e-6, 61e-6, 99e-6], 1e-6, 0.05, Some(1.25));
        let aside = trial([29e-6, 61e-6, 99e-6], 1e-6, 0.5, Some(1.5));
        let backwards = trial([99e-6, 61e-6, 29e-6], 6e-5, 0.0, None);
        let mut findings = Findings::default();
        add(&mut findings, Some(&[near, aside, backwards]));
        let value =
            |quantity: &str| findings.measurements.iter().find(|m| m.quantity == quantity).unwrap().value.unwrap();
        assert_eq!(value("geometries whose cracks come in the paper's order"), 2.0);
        assert_eq!(value("geometries near the paper"), 2.0);
        assert_eq!(value("geometries near the paper that split along the diameter"), 1.0);
        assert_eq!(value("least fracture energy over that of the broken walls"), 1.25);
    }

    #[test]
    fn a_run_that_broke_down_is_counted_and_never_the_best() {
        let geometry = Geometry { outer: 0.05, inner: 0.03, length_scale: 1e-3, points: 2 };
        let late = Trial { score: 9e-5, aside: 0.0, broke_down: None, ..Trial::broken(geometry, 0.0) };
        let trials = [late, Trial::broken(geometry, 4e-5)];
        let mut findings = Findings::default();
        add(&mut findings, Some(&trials));
        let value = |quantity: &str| {
            findings.measurements.iter().find(|m| m.quantity == quantity).and_then(|m| m.value).unwrap()
        };
        assert_eq!(value("geometries that broke down"), 1.0);
        assert!(value("least fracture energy over that of the broken walls").is_nan(), "no wall broke");
        assert!((value("smallest score") - 90.0).abs() < 1e-9);
        let table = table(&trials);
        let column = table.column("broke_down_us").unwrap();
        assert!(column[0].is_nan() && column[1] == 40.0 && table.column("score_us").unwrap()[1].is_nan());
    }
}
