//! Blocks of one width and height on each other on a rigid floor (nu = 0), when gravity suddenly begins to act.
//!
//! The blocks vibrate about the state of rest. In the mean over time every contact carries the weight above it, and the
//! settlement of a centre of mass is that of an elastic column: with W the weight above a block of height H, per area,
//! its lower half space moved by u, its centre settles by `u + W H/(2E) + rho g H²/(3E)` and its top by `u + W H/E + rho g
//! H²/(2E)`. The mean of the normal force is not a free quantity: it is the weight as soon as the block stays.

use fisura::material::ElasticModuli;
use fisura::scene::Scene;

use super::{Books, center, chart, curve, exact, largest, run, sum};
use crate::case::Case;
use crate::expand::CaseScene;
use crate::history::Table;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

/// Rows of a series.
const ROWS: usize = 400;

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = vec![];
    for CaseScene { name, scene, .. } in scenes {
        let column = Column::of(scene)?;
        let found = column.settle(scene)?;
        column.add(&found, name, &mut findings);
        let stem = format!("{}-forces", series_stem(case, name));
        for contact in 0..column.heights.len() {
            let label = if contact == 0 { "under the lowest block".to_string() } else { format!("above block {contact}") };
            let label = if name.is_empty() { label } else { format!("{name}: {label}") };
            curves.push(curve(&label, &stem, ["time_s", &format!("contact_{contact}")], CurveStyle::Line));
        }
        findings.series.push((stem, found.forces));
    }
    let title = format!("Normal forces over the weight above, {}", case.label);
    findings.figures.push(chart(series_stem(case, "forces"), &title, "", ["time (s)", "force over weight"], curves));
    Ok(findings)
}

/// Blocks from the lowest to the highest, and what they weigh.
struct Column {
    heights: Vec<f64>,
    /// Weight of a block per area, Pa, and its width, m.
    weights: Vec<f64>,
    width: f64,
    modulus: f64,
}

/// What a run gave.
struct Settled {
    /// Mean force of every contact over the second half of the run, N/m, from below.
    means: Vec<f64>,
    /// Mean settlement of every centre of mass over the second half of the run, m.
    settlement: Vec<f64>,
    /// Largest sideways way of a centre of mass, m.
    sideways: f64,
    /// Kinetic energy in the last tenth over the largest.
    kinetic: f64,
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

    fn settle(&self, scene: &Scene) -> Result<Settled, StudyError> {
        let count = self.heights.len();
        let names: Vec<String> = (0..count).map(|contact| format!("contact_{contact}")).collect();
        let columns: Vec<&str> = std::iter::once("time_s").chain(names.iter().map(String::as_str)).collect();
        let mut found = Settled {
            means: vec![0.0; count],
            settlement: vec![0.0; count],
            sideways: 0.0,
            kinetic: 0.0,
            books: Books::default(),
            forces: Table::new(&columns),
        };
        let (mut first, mut steps, mut largest_kinetic): (Vec<[f64; 2]>, f64, f64) = (vec![], 0.0, 0.0);
        run(scene, &mut |simulation, frame| {
            let (sample, plan) = (simulation.sample(), simulation.plan());
            found.books.enter(&sample);
            let all = frame.contact_forces(plan.step);
            // Contact k joins block k with the one below, the lowest with the floor, which is counted after the blocks.
            let bodies = |contact: usize| if contact == 0 { [0, count] } else { [contact - 1, contact] };
            let force = |contact: usize| sum(all.iter().filter(|f| f.bodies == bodies(contact)))[1].abs();
            let centers: Vec<_> = frame.fields().iter().map(center).collect();
            if first.is_empty() {
                first.clone_from(&centers);
            }
            found.sideways = super::larger(found.sideways, largest((0..count).map(|i| centers[i][0] - first[i][0])));
            largest_kinetic = super::larger(largest_kinetic, sample.kinetic);
            if 2 * simulation.steps() > plan.steps() {
                steps += 1.0;
                for i in 0..count {
                    found.means[i] += force(i);
                    found.settlement[i] += first[i][1] - centers[i][1];
                }
            }
            if 10 * simulation.steps() > 9 * plan.steps() {
                found.kinetic = super::larger(found.kinetic, sample.kinetic);
            }
            if simulation.steps().is_multiple_of(plan.steps().div_ceil(ROWS)) {
                let mut row = vec![frame.time()];
                row.extend((0..count).map(|i| force(i) / self.above(i)));
                found.forces.push(&row);
            }
        })?;
        found.means.iter_mut().chain(&mut found.settlement).for_each(|sum| *sum /= steps);
        found.kinetic /= largest_kinetic;
        Ok(found)
    }

    fn add(&self, found: &Settled, name: &str, findings: &mut Findings) {
        let settlement = self.settlement();
        for i in 0..self.heights.len() {
            let place = if i == 0 { "under the lowest block".to_string() } else { format!("on block {i}") };
            let quantity = format!("mean force {place} over the weight above");
            findings.add(name, &quantity, found.means[i] / self.above(i), exact(1.0, "equilibrium in the mean"));
            let quantity = format!("mean settlement of block {} over that of a column", i + 1);
            findings.add(name, &quantity, found.settlement[i] / settlement[i], exact(1.0, "an elastic column"));
        }
        findings.add(name, "largest way sideways over the width", found.sideways / self.width, exact(0.0, "symmetry"));
        let kinetic = "largest kinetic energy of the last tenth over the largest";
        findings.add(name, kinetic, found.kinetic, None);
        let books = &found.books;
        findings.add(name, "energy lost in contact over the work of gravity", books.loss / books.energy, None);
        findings.add(name, "closure of the energy ledger over the largest energy", books.closure / books.energy, None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_in_blocks_settles_as_one_in_one_piece() {
        let blocks = Column { heights: vec![0.5; 4], weights: vec![1.0; 4], width: 2.0, modulus: 10.0 };
        let whole = Column { heights: vec![2.0], weights: vec![4.0], width: 2.0, modulus: 10.0 };
        let mean = blocks.settlement().iter().sum::<f64>() / 4.0;
        assert!((mean - whole.settlement()[0]).abs() < 1e-15);
        assert_eq!((blocks.above(0), blocks.above(3)), (8.0, 2.0));
    }
}
