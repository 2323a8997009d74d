//! Blocks of one width and height on each other on a rigid floor (nu = 0), when gravity suddenly begins to
//! act.
//!
//! The blocks vibrate about the state of rest. In the mean over time every contact carries the weight above
//! it, and the settlement of a centre of mass is that of an elastic column: with W the weight above a block
//! of height H, per area, its lower half space moved by u, its centre settles by
//! `u + W H/(2E) + rho g H²/(3E)` and its top by `u + W H/E + rho g H²/(2E)`. Means are over the second half
//! of the run, with the weight sin² that suppresses vibrations. The mean of the normal force is the weight as
//! soon as the blocks stay where they are, whatever the law of the force.
//!
//! An impulse acts on control points by their mass, not by their shape functions at the boundary, and leaves
//! a boundary layer that gives way more than the column does. What a column settles too far is expressed as
//! the thickness, in spans, of a layer on every side of a contact that carries the stress there besides: a
//! number that does not fall with h stands for an error of order h.

use std::f64::consts::PI;

use fisura::material::elasticity::ElasticModuli;
use fisura::particles::spans::largest_spans;
use fisura::scene::Scene;

use super::{Books, center, chart, curve, exact, label, largest, run, sample_is_due, sum};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

pub(in super::super) fn offers(_case: &Case, scenes: &[CaseScene]) -> crate::study::Offered {
    let held =
        &["largest way sideways over the width", "layer that gives way besides, per side of a contact, in spans"];
    let bare = &[
        "largest kinetic energy of the last tenth over that of the first",
        "deepest overlap of boundaries in spans",
        "energy lost in contact and transfers together over the largest energy",
        "energy lost in contact over the largest energy",
        "closure of the energy ledger over the largest energy",
    ];
    let mut offers = crate::study::Offers::of_scenes(scenes, held, bare);
    for CaseScene { name, scene, .. } in scenes {
        for i in 0..Column::of(scene)?.heights.len() {
            offers.held(name, [mean_force(i), mean_settlement(i)]);
        }
    }
    Ok(offers)
}

fn mean_force(i: usize) -> String {
    let place = if i == 0 { "under the lowest block".to_string() } else { format!("on block {i}") };
    format!("mean force {place} over the weight above")
}

fn mean_settlement(i: usize) -> String {
    format!("mean settlement of block {} over that of a column", i + 1)
}

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = vec![];
    for CaseScene { name, scene, .. } in scenes {
        let column = Column::of(scene)?;
        let found = column.settle(scene)?;
        column.add(&found, name, &mut findings);
        let stem = format!("{}-forces", series_stem(case, name));
        for contact in 0..column.heights.len() {
            let place =
                if contact == 0 { "under the lowest block".to_string() } else { format!("above block {contact}") };
            curves.push(curve(
                &label(name, &place),
                &stem,
                ["time_s", &format!("contact_{contact}")],
                CurveStyle::Line,
            ));
        }
        findings.series.push((stem, found.forces));
    }
    findings.figures.push(chart(
        case,
        "forces",
        "Normal forces over the weight above",
        "",
        ["time (s)", "force over weight"],
        curves,
    ));
    Ok(findings)
}

/// Blocks from the lowest to the highest, and what they weigh.
struct Column {
    heights: Vec<f64>,
    /// Weight of a block per area, Pa, and its width, m.
    weights: Vec<f64>,
    width: f64,
    modulus: f64,
    /// Span, m.
    span: f64,
}

/// What a run gave.
struct Settled {
    /// Mean force of every contact, N/m, from below.
    means: Vec<f64>,
    /// Mean settlement of every centre of mass, m.
    settlement: Vec<f64>,
    /// Deepest overlap of boundaries, m.
    overlap: f64,
    /// Largest sideways way of a centre of mass, m.
    sideways: f64,
    /// Largest kinetic energies in the first and the last tenth of the run, J.
    kinetic: [f64; 2],
    books: Books,
    /// Forces over weights, against time.
    forces: Table,
}

impl Column {
    fn of(scene: &Scene) -> Result<Self, StudyError> {
        let blocks: Vec<_> = scene.bodies.iter().filter(|body| !body.rigid).collect();
        let (Some(first), true) = (blocks.first(), scene.bodies.last().is_some_and(|body| body.rigid)) else {
            return Err(StudyError::Other("this study takes blocks from below and a rigid floor at the end".into()));
        };
        let material = &scene.materials[&first.material];
        let boxes: Vec<_> = blocks.iter().map(|body| body.shape.bounding_box()).collect();
        let heights: Vec<f64> = boxes.iter().map(|(low, high)| high[1] - low[1]).collect();
        let weight = |height: &f64| material.density * -scene.analysis.gravity[1] * height;
        let moduli = ElasticModuli::new(material, scene.analysis.plane);
        Ok(Self {
            weights: heights.iter().map(weight).collect(),
            heights,
            width: boxes[0].1[0] - boxes[0].0[0],
            modulus: moduli.lambda + 2.0 * moduli.mu,
            span: largest_spans(&scene.mesh)[1],
        })
    }

    /// Weight that a contact carries, N/m.
    fn above(&self, contact: usize) -> f64 {
        self.width * self.weights[contact..].iter().sum::<f64>()
    }

    /// Settlement of every centre of mass at rest, m.
    fn settlement(&self) -> Vec<f64> {
        let mut top = 0.0;
        let block = |i: usize| {
            let (height, weight) = (self.heights[i], self.weights[i]);
            let above: f64 = self.weights[i + 1..].iter().sum();
            let center = top + (above / 2.0 + weight / 3.0) * height / self.modulus;
            top += (above + weight / 2.0) * height / self.modulus;
            center
        };
        (0..self.heights.len()).map(block).collect()
    }

    /// Thickness of the layer, in spans, that lets the highest block settle as far as it does.
    fn layer(&self, settlement: f64) -> f64 {
        let sides = |contact: usize| if contact == 0 { 1.0 } else { 2.0 };
        let stress = |contact: usize| sides(contact) * self.above(contact) / self.width;
        let whole: f64 = (0..self.heights.len()).map(stress).sum();
        let rest = self.settlement().last().map_or(f64::NAN, |expected| settlement - expected);
        rest * self.modulus / whole / self.span
    }

    fn settle(&self, scene: &Scene) -> Result<Settled, StudyError> {
        let count = self.heights.len();
        let names: Vec<String> = (0..count).map(|contact| format!("contact_{contact}")).collect();
        let columns: Vec<&str> = std::iter::once("time_s").chain(names.iter().map(String::as_str)).collect();
        let mut found = Settled {
            means: vec![0.0; count],
            settlement: vec![0.0; count],
            overlap: 0.0,
            sideways: 0.0,
            kinetic: [0.0; 2],
            books: Books::default(),
            forces: Table::new(&columns),
        };
        let (mut first, mut weights): (Vec<[f64; 2]>, f64) = (vec![], 0.0);
        run(scene, &mut |simulation, frame| {
            let plan = simulation.plan();
            let late = 2 * simulation.steps() > plan.steps();
            let due = sample_is_due(simulation);
            let all = if late || due { frame.contact_forces(plan.step) } else { vec![] };
            // Contact k joins block k with the one below, the lowest with the floor, which is counted after
            // the blocks.
            let bodies = |contact: usize| if contact == 0 { [0, count] } else { [contact - 1, contact] };
            let force = |contact: usize| sum(all.iter().filter(|f| f.bodies == bodies(contact)))[1].abs();
            let centers: Vec<_> = frame.fields().iter().map(center).collect();
            if first.is_empty() {
                first.clone_from(&centers);
            }
            found.sideways = super::larger(found.sideways, largest((0..count).map(|i| centers[i][0] - first[i][0])));
            if late {
                let along = 2.0 * simulation.steps() as f64 / plan.steps() as f64 - 1.0;
                let weight = (PI * along).sin().powi(2);
                weights += weight;
                let constraints = frame.contact().map_or(&[][..], |contact| contact.constraints());
                found.overlap =
                    super::larger(found.overlap, largest(constraints.iter().map(|touch| touch.gap.min(0.0))));
                for i in 0..count {
                    found.means[i] += weight * force(i);
                    found.settlement[i] += weight * (first[i][1] - centers[i][1]);
                }
            }
            if due {
                let sample = simulation.sample();
                found.books.enter(&sample);
                let tenth = [10 * simulation.steps() <= plan.steps(), 10 * simulation.steps() > 9 * plan.steps()];
                for (kinetic, _) in found.kinetic.iter_mut().zip(tenth).filter(|(_, within)| *within) {
                    *kinetic = super::larger(*kinetic, sample.kinetic);
                }
                let mut row = vec![frame.time()];
                row.extend((0..count).map(|i| force(i) / self.above(i)));
                found.forces.push(&row);
            }
        })?;
        found.means.iter_mut().chain(&mut found.settlement).for_each(|sum| *sum /= weights);
        Ok(found)
    }

    fn add(&self, found: &Settled, name: &str, findings: &mut Findings) {
        let settlement = self.settlement();
        for i in 0..self.heights.len() {
            findings.add(name, &mean_force(i), found.means[i] / self.above(i), exact(1.0, "equilibrium in the mean"));
            findings.add(
                name,
                &mean_settlement(i),
                found.settlement[i] / settlement[i],
                exact(1.0, "an elastic column"),
            );
        }
        findings.add(name, "largest way sideways over the width", found.sideways / self.width, exact(0.0, "symmetry"));
        let kinetic = "largest kinetic energy of the last tenth over that of the first";
        findings.add(name, kinetic, found.kinetic[1] / found.kinetic[0], None);
        let layer = found.settlement.last().map_or(f64::NAN, |settlement| self.layer(*settlement));
        findings.add(
            name,
            "layer that gives way besides, per side of a contact, in spans",
            layer,
            exact(0.0, "a column"),
        );
        findings.add(name, "deepest overlap of boundaries in spans", found.overlap / self.span, None);
        let books = &found.books;
        let lost = (books.loss + books.transfer) / books.energy;
        findings.add(name, "energy lost in contact and transfers together over the largest energy", lost, None);
        findings.add(name, "energy lost in contact over the largest energy", books.loss / books.energy, None);
        findings.add(name, "closure of the energy ledger over the largest energy", books.closure / books.energy, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_in_blocks_settles_as_one_in_one_piece() {
        let blocks = Column { heights: vec![0.5; 4], weights: vec![1.0; 4], width: 2.0, modulus: 10.0, span: 0.1 };
        let whole = Column { heights: vec![2.0], weights: vec![4.0], width: 2.0, modulus: 10.0, span: 0.1 };
        let mean = blocks.settlement().iter().sum::<f64>() / 4.0;
        assert!((mean - whole.settlement()[0]).abs() < 1e-15);
        let settled = blocks.settlement()[3] + (8.0 + 2.0 * 6.0 + 2.0 * 4.0 + 2.0 * 2.0) / 2.0 * 0.1 / 10.0;
        assert!((blocks.layer(settled) - 1.0).abs() < 1e-12, "a span of {} at every side", blocks.span);
        assert_eq!((blocks.above(0), blocks.above(3)), (8.0, 2.0));
    }
}
