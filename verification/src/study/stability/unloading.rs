//! A body that vibrates below its strength: the history field rises with the tensile energy and stays when that falls.
//!
//! Over many periods psi+ goes up and down at every point; `Σ V H`, the history summed over the points, and with it the fracture
//! energy of a body that is nowhere broken, may only rise.

use fisura::Simulation;
use fisura::scene::{Boundary, Fracture, Frame, Material, Mesh, Scene, Shape, Side, Split};

use super::super::contact::{chart, curve};
use super::exact;
use crate::case::Case;
use crate::expand::CaseScene;
use crate::extremes::larger;
use crate::history::Table;
use crate::plain_scene::PlainScene;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

pub(in super::super) fn offers(_case: &Case, _scenes: &[CaseScene]) -> crate::study::Offered {
    let mut offers = crate::study::Offers::default();
    for name in ["total", "updated"] {
        offers.held(name, ["largest fall of the history field in a step over its last value"]);
        offers.bare(name, ["peaks of the elastic energy"]);
    }
    Ok(offers)
}

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = Vec::new();
    for (name, frame) in [("total", Frame::Total), ("updated", Frame::Updated)] {
        let table = vibrate(frame)?;
        let history = &table.columns[1];
        let last = history.last().copied().unwrap_or(f64::NAN);
        let fall = history.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, larger);
        findings.add(
            name,
            "largest fall of the history field in a step over its last value",
            fall / last,
            exact(0.0, "it only grows"),
        );
        let turns = table.columns[2].windows(3).filter(|e| e[1] > e[0] && e[1] > e[2]).count();
        findings.add(name, "peaks of the elastic energy", turns as f64, None);
        let stem = series_stem(case, name);
        for (label, column) in [("Σ V H", "history_j_per_m"), ("elastic energy", "elastic_j_per_m")] {
            curves.push(curve(&format!("{name}, {label}"), &stem, ["time_s", column], CurveStyle::Line));
        }
        findings.series.push((stem, table));
    }
    let axes = ["time (s)", "energy (J/m)"];
    findings.figures.push(chart(case, "history", "History field of a vibrating body", "", axes, curves));
    Ok(findings)
}

/// Time, `Σ V H` and elastic energy after every step.
fn vibrate(frame: Frame) -> Result<Table, StudyError> {
    let mut simulation = Simulation::new(&bar(frame))?;
    let mut table = Table::new(&["time_s", "history_j_per_m", "elastic_j_per_m"]);
    while !simulation.finished() {
        crate::watch::check()?;
        simulation.step()?;
        let sample = simulation.sample();
        let history = sum_of_history(&simulation).ok_or_else(|| StudyError::Other("nothing fractures here".into()))?;
        table.push(&[sample.time, history, sample.elastic]);
    }
    Ok(table)
}

fn sum_of_history(simulation: &Simulation) -> Option<f64> {
    if let Some(frame) = simulation.total_frame() {
        let history = &frame.fracture.as_ref()?.history;
        let mut sum = 0.0;
        frame.lattice().for_each_point(|batch, lane, _, weight| sum += weight * history[batch][lane]);
        return Some(sum);
    }
    let field = &simulation.updated_frame()?.fields()[0];
    let points = field.points().iter().zip(&field.fracture.as_ref()?.points);
    Some(points.map(|(point, fracture)| point.volume * fracture.history).sum())
}

/// A bar held at its left side and set in motion along x; strained to about a tenth of its strength.
fn bar(frame: Frame) -> Scene {
    let fracture = Fracture {
        critical_energy_release_rate: 1e-2,
        length_scale: 0.25,
        residual_stiffness: 0.0,
        split: Split::Spectral,
    };
    let mut scene = PlainScene::free(
        Mesh::uniform([2; 2], [0.0; 2], [2.5, 0.5], [20, 4]),
        Material { young_modulus: 1.0, poisson_ratio: 0.2, density: 1.0, fracture: Some(fracture) },
        2,
    )
    .scene();
    scene.analysis.frame = frame;
    scene.analysis.end_time = 40.0;
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [2.0, 0.5] };
    scene.bodies[0].velocity = [5e-3, 0.0];
    scene.boundaries = vec![Boundary { side: Side::Left, fix: [true; 2], velocity: [0.0; 2] }];
    scene
}
