//! Critical steps of bodies whose edge cuts a span, and the step the solver takes against dense eigenvalues.
//!
//! In one dimension, as a strip so high that only waves along it count (nu = 0), the largest eigenvalue of a
//! bar held at its left end gives `c dt/h = 2/ω_max`. A function that lives on the cut part η h alone has
//! stiffness over mass of `K/M ~ η^(2p−1)/η^(p+1)` with the lumped mass: the step falls as η^((2−p)/2) for p
//! = 1 and not for p ≥ 2; with the consistent mass `η^(2p−1)/η^(2p+1)`, so that it falls as η.

use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::scene::{Analysis, Frame, Mass, Mesh, Scene, Shape, Side};

use super::{logarithmic, total_frame};
use crate::output::history::Table;
use crate::record::{CurveStyle, Reference, ReferenceKind};
use crate::scene::plain::PlainScene;
use crate::study::charts::curve;
use crate::study::dense;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other, theory};

/// Whole spans of the bar, and the cut part of the next one.
const SPANS: usize = 16;
const CUTS: [f64; 13] = [1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9, 1.0];

/// Two fine cuts, for p = 1, 2, 3, whose function has a mass that counts, `η^(p+1)/(p+1)!` of a span. With
/// less than 1e-17 of the largest a control point is not accelerated, and the step is that of a body without
/// the cut part.
const FINE_CUTS: [[f64; 2]; 3] = [[1e-4, 1e-3], [1e-3, 1e-2], [1e-2, 3e-2]];

/// Squares whose critical step is held against a dense eigenvalue: words, mass, cut part of the last span.
const SQUARES: [(&str, Mass, f64); 3] =
    [("lumped", Mass::Lumped, 1.0), ("consistent", Mass::Consistent, 1.0), ("lumped, cut", Mass::Lumped, 1e-3)];

/// Cut parts η of [`TABLE`].
const PUBLISHED_CUTS: [f64; 4] = [0.1, 1e-2, 1e-3, 1e-4];

/// `c dt/h` at those as reference-data/derivations/bar_eigenvalues.py prints it, where that function counts.
const TABLE: [(usize, Mass, [&str; 4]); 6] = [
    (1, Mass::Lumped, ["0.445168", "0.141414", "0.0447213", "0.0141421"]),
    (1, Mass::Consistent, ["0.103581", "0.0114011", "0.0011532", "0.000115455"]),
    (2, Mass::Lumped, ["0.944186", "0.987128", "0.99855", "0.999853"]),
    (2, Mass::Consistent, ["0.0670296", "0.00760785", "0.000773166", "7.74453e-05"]),
    (3, Mass::Lumped, ["1.14429", "1.14429", "1.14429", "1.14429"]),
    (3, Mass::Consistent, ["0.04738", "0.00551145", "0.000562156", ""]),
];

/// An entry of the table, uncertain by half a unit of its last digit; none where it is empty.
fn printed(entry: &str) -> Option<Reference> {
    let (_, decimals) = entry.split_once('.')?;
    let uncertainty = Some(0.5 * 0.1_f64.powi(decimals.len() as i32));
    let source = "reference-data/derivations/bar_eigenvalues.py, as printed";
    Some(Reference { uncertainty, ..Reference::new(entry.parse().ok(), ReferenceKind::IndependentCode, source) })
}

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    bars(case, findings)?;
    for degree in 1..=3 {
        for (word, mass, cut) in SQUARES {
            let variant = format!("p={degree}, {word}");
            let found = findings.compute(|| {
                let scene = patch(degree, mass, cut);
                let frame = total_frame(&scene)?;
                let frequency = dense::highest(&dense::frequencies(&frame)?);
                Ok((scene, frequency, frame.critical_step() * frequency / 2.0))
            })?;
            let ratio = found.as_ref().map(|(_, _, ratio)| *ratio);
            let source = exact(1.0, "2/ω of the dense eigenvalue");
            findings.add(&variant, "critical step of a square over that of the dense eigenvalue", ratio, source);
            if mass == Mass::Lumped {
                let moving = |(scene, frequency, _): (Scene, f64, f64)| {
                    let analysis = Analysis { frame: Frame::Updated, ..scene.analysis.clone() };
                    let moving = UpdatedFrame::new(&Scene { analysis, ..scene });
                    let step = moving.map_err(|_| other("a point is off the mesh"))?.critical_step();
                    Ok::<f64, StudyError>(step * frequency / std::f64::consts::SQRT_2)
                };
                let source = theory(1.0, "√2/ω, the limit of FLIP for waves the points do not see");
                let ratio = found.map(moving).transpose()?;
                findings.add(&variant, "critical step in the updated frame over that of theory", ratio, source);
            }
        }
    }
    Ok(())
}

/// Critical steps of cut bars against the table, their scaling, and their chart.
fn bars(case: &Case, findings: &mut Findings) -> Result<(), StudyError> {
    let stem = series_stem(case, "cut");
    let mut table =
        Table::new(&["cut", "p1_lumped", "p1_consistent", "p2_lumped", "p2_consistent", "p3_lumped", "p3_consistent"]);
    let mut steps: Vec<Vec<f64>> = Vec::new();
    for cut in CUTS.into_iter().filter(|_| !findings.plan) {
        crate::watch::check()?;
        let row: Result<Vec<f64>, StudyError> =
            TABLE.iter().map(|&(degree, mass, _)| bar_step(degree, mass, cut)).collect();
        let row = row?;
        table.push(&[&[cut], &row[..]].concat());
        steps.push(row);
    }
    let step_at = |cut: f64, column: usize| {
        let row = CUTS.iter().position(|known| *known == cut);
        row.and_then(|row| steps.get(row)).map_or(f64::NAN, |row| row[column])
    };
    let mut curves = Vec::new();
    for (column, (degree, mass, published)) in TABLE.iter().enumerate() {
        let word = if *mass == Mass::Lumped { "lumped" } else { "consistent" };
        for (cut, published) in PUBLISHED_CUTS.into_iter().zip(published) {
            if let Some(reference) = printed(published) {
                let variant = format!("p={degree}, cut {cut:e}");
                findings.add(&variant, &format!("c dt/h, {word} mass"), step_at(cut, column), Some(reference));
            }
        }
        let [less, more] = FINE_CUTS[degree - 1];
        let slope = (step_at(more, column) / step_at(less, column)).ln() / (more / less).ln();
        let expected = match (mass, degree) {
            (Mass::Consistent, _) => 1.0,
            (Mass::Lumped, 1) => 0.5,
            (Mass::Lumped, _) => 0.0,
        };
        let source = theory(expected, "stiffness over mass of the function on the cut part");
        findings.add(&format!("p={degree}, {word}"), "exponent of the critical step in the cut part", slope, source);
        let style = if *mass == Mass::Lumped { CurveStyle::Markers } else { CurveStyle::Line };
        curves.push(curve(&format!("p = {degree}, {word}"), &stem, ["cut", &table.names[column + 1]], style));
    }
    let caption = "A bar held at one end, whose free end cuts a span; 2/ω of dense eigenvalues. Where the curve of p = 3 jumps, the mass of the last control point is below 1e-17 of the largest and no longer counts.";
    let axes = ["cut part of the span", "c dt/h"];
    let title = "Critical step against the cut part of a span";
    findings.figures.push(logarithmic(case, "cut", title, caption, axes, curves));
    findings.series.push((stem, table));
    Ok(())
}

/// `c dt/h` of a bar of unit spans, modulus and density with a free end at a fraction of a span.
fn bar_step(degree: usize, mass: Mass, cut: f64) -> Result<f64, StudyError> {
    let height = 100.0; // in spans: slow waves across the bar alone
    let mesh = Mesh::uniform([degree, 1], [0.0; 2], [SPANS as f64 + 1.0, height], [SPANS + 1, 1]);
    let mut plain = PlainScene::unit_bar(mesh, Mass::Lumped);
    plain.held.retain(|(side, _)| *side != Side::Right);
    let mut scene = plain.scene();
    scene.bodies[0].particles_per_cell[1] = 2;
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [SPANS as f64 + cut, height] };
    let frame = total_frame(&scene)?;
    let frequencies = match mass {
        Mass::Lumped => dense::frequencies(&frame)?,
        Mass::Consistent => dense::frequencies_of_consistent_mass(&frame, 1.0)?,
    };
    Ok(2.0 / dense::highest(&frequencies))
}

/// A free square of 6 spans a side; `cut` of the last span in each direction belongs to it.
fn patch(degree: usize, mass: Mass, cut: f64) -> Scene {
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [6.0; 2], [6; 2]);
    let mut scene = PlainScene { mass, ..PlainScene::unit(mesh, 0.3) }.scene();
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [5.0 + cut; 2] };
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_uncertain_by_half_a_unit_of_its_last_digit() {
        let reference = printed("0.0012").unwrap();
        assert_eq!(reference.value, Some(0.0012));
        assert!((reference.uncertainty.unwrap() - 0.00005).abs() < 1e-18);
        assert!(printed("").is_none());
        assert!(TABLE.iter().flat_map(|row| row.2).all(|entry| entry.is_empty() || printed(entry).is_some()));
    }
}
