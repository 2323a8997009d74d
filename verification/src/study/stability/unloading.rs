//! A body that vibrates below its strength: the history field rises with the tensile energy and stays when
//! that falls.
//!
//! Over many periods psi+ goes up and down at every point. History is a maximum over time, so that it may
//! fall at no point in any step, not by a rounding. Points are told apart by where they were at t = 0: in the
//! updated frame they change places.

use std::collections::BTreeMap;

use fisura::Simulation;
use fisura::scene::{Boundary, Fracture, Frame, Mesh, Scene, Shape, Side};

use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::scene::plain::PlainScene;
use crate::study::charts::{chart, curve};
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact};

/// Length and height of the bar, m.
const LENGTH: f64 = 2.0;
const HEIGHT: f64 = 0.5;

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let (mut curves, mut series) = (Vec::new(), Vec::new());
    for (name, frame) in [("total", Frame::Total), ("updated", Frame::Updated)] {
        let stem = series_stem(case, name);
        for (label, column) in [("Σ V H", "history_j_per_m"), ("elastic energy", "elastic_j_per_m")] {
            curves.push(curve(&format!("{name}, {label}"), &stem, ["time_s", column], CurveStyle::Line));
        }
        let fall = "largest fall of the history of a point in a step over the largest history";
        let quantities = [(fall, exact(0.0, "a maximum over time")), ("peaks of the elastic energy", None)];
        findings.measure(name, quantities, || {
            let (table, fall) = vibrate(frame)?;
            let turns = table.columns[2].windows(3).filter(|e| e[1] > e[0] && e[1] > e[2]).count();
            series.push((stem, table));
            Ok([fall, turns as f64])
        })?;
    }
    findings.series.extend(series);
    let axes = ["time (s)", "energy (J/m)"];
    findings.figures.push(chart(case, "history", "History field of a vibrating body", "", axes, curves));
    Ok(())
}

/// Sum of V H and elastic energy against time, and the largest fall of the history of a point in a step over
/// the largest history.
fn vibrate(frame: Frame) -> Result<(Table, f64), StudyError> {
    let mut simulation = Simulation::new(&bar(frame))?;
    let mut table = Table::new(&["time_s", "history_j_per_m", "elastic_j_per_m"]);
    let mut fall = 0.0;
    let mut before = histories(&simulation);
    while !simulation.finished() {
        simulation.step()?;
        let now = histories(&simulation);
        fall = larger(fall, largest_fall(&before, &now));
        let sample = simulation.sample();
        let mean = now.values().sum::<f64>() / now.len() as f64;
        table.push(&[sample.time, mean * LENGTH * HEIGHT, sample.elastic]);
        before = now;
        crate::watch::check()?;
    }
    Ok((table, fall / largest(before.into_values())))
}

/// History of every point by its place at t = 0, in units of 1e-6 m.
type Histories = BTreeMap<[i64; 2], f64>;

fn histories(simulation: &Simulation) -> Histories {
    let mut all = Histories::new();
    simulation.for_each_point(&mut |point| {
        let place = [0, 1].map(|d| (1e6 * (point.present[d] - point.displacement[d])).round() as i64);
        all.insert(place, point.fracture.map_or(f64::NAN, |fracture| fracture.history));
    });
    all
}

/// Largest fall between two steps; not a number if a point of one is missing in the other.
fn largest_fall(before: &Histories, now: &Histories) -> f64 {
    let missing = if before.len() == now.len() { 0.0 } else { f64::NAN };
    let falls = before.iter().map(|(place, history)| now.get(place).map_or(f64::NAN, |now| history - now));
    falls.fold(missing, larger)
}

/// A bar held at its left side and set in motion along x; strained to about a tenth of its strength.
fn bar(frame: Frame) -> Scene {
    let mesh = Mesh::uniform([2; 2], [0.0; 2], [2.5, HEIGHT], [20, 4]);
    let mut plain = PlainScene { points: 2, ..PlainScene::unit(mesh, 0.2) };
    plain.material.fracture = Some(Fracture::at2(1e-2, 0.25));
    let mut scene = plain.scene();
    scene.analysis.frame = frame;
    scene.analysis.end_time = 40.0;
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [LENGTH, HEIGHT] };
    scene.bodies[0].velocity = [5e-3, 0.0];
    scene.boundaries = vec![Boundary::fixed(Side::Left, [true; 2])];
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fall_at_one_point_shows_beside_rises_at_the_others() {
        let histories = |values: [f64; 3]| (0..3).map(|i| ([i, 0], values[i as usize])).collect::<Histories>();
        let before = histories([1.0, 2.0, 3.0]);
        assert_eq!(largest_fall(&before, &histories([1.0, 2.5, 9.0])), 0.0);
        assert_eq!(largest_fall(&before, &histories([5.0, 1.75, 9.0])), 0.25);
        let elsewhere = [([0, 0], 1.0), ([1, 0], 2.0), ([2, 1], 3.0)].into_iter().collect();
        assert!(largest_fall(&before, &elsewhere).is_nan(), "a point that is lost is no point that rises");
    }
}
