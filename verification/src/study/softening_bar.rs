//! A cohesive crack in a bar that is pulled apart slowly, against its law of softening (Wu 2017).
//!
//! The stress s of a slender bar is the same everywhere, and its length grows by u. With the phase field c of
//! the solver s = E u/∫ 1/g dx, which drives by H = s²/(2 E g²): both are solved for in turn until s stays.
//! The opening is w = u − s L/E. The law is that of the [localised solution](crate::exact::cohesive). Near
//! the middle d falls by |x|/b; a stress that belongs to d* nearer to 1 than 2 h/b is not resolved by spans.

use fisura::linear_algebra::lane::Lane;
use fisura::material::degradation::FractureModel;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::PhaseField;
use fisura::scene::{CrackModel, Fracture, Material};
use fisura::splines::patch::Patch;

use super::charts::{chart, curve};
use super::scene::series_stem;
use super::{Case, CaseScene, Findings, StudyError, exact, other};
use crate::exact::cohesive::CohesiveLaw;
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::record::{CurveStyle, Figure};

/// Number of elongations: damage that an iteration makes too large stays, so they are small. Every so many
/// are a row.
const STEPS: usize = 400;
const ROW: usize = 4;
/// By how much the middle is driven more, so that the crack has a place: half of that of the strength.
const IMPERFECTION: f64 = 0.01;
/// Least opening at which stresses are compared, of Gc/ft.
const OPEN: f64 = 0.02;
/// Change of the stress that ends the iterations, over the strength; and most of them.
const SETTLED: f64 = 1e-6;
const MOST_ITERATIONS: usize = 3000;

pub(super) fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let stem = series_stem(case, "bar");
    let mut tables = Vec::new();
    for scene in scenes {
        let quantities = [
            ("largest stress over the strength", exact(1.0, "the tensile strength")),
            ("stress, largest difference from the law over the strength, where spans resolve it", None),
            ("surface energy of the broken bar over Gc", exact(1.0, "a cohesive crack in the limit of small spans")),
        ];
        findings.measure(&scene.name, quantities, || {
            let bar = Bar::new(scene)?;
            let (table, strength, energy) = bar.pull()?;
            let [openings, stresses, law] = [0, 1, 2].map(|column| table.columns[column].iter().copied());
            let resolved = bar.law.stress(1.0 - bar.span / bar.fracture.length_scale);
            let rows = openings.zip(stresses.zip(law)).filter(|(opening, (_, law))| *opening > OPEN && *law > resolved);
            let error = largest(rows.map(|(_, (found, law))| (found - law).abs()));
            tables.push((stem.clone(), table));
            Ok([strength, error, energy])
        })?;
    }
    findings.figures.push(figure(case, &stem));
    findings.series.extend(tables.into_iter().take(1));
    Ok(())
}

/// A bar along x that cracks in its middle: lengths in m, the tensile strength in Pa.
struct Bar<'a> {
    scene: &'a CaseScene,
    material: &'a Material,
    fracture: &'a Fracture,
    strength: f64,
    law: CohesiveLaw,
    length: f64,
    height: f64,
    span: f64,
}

impl<'a> Bar<'a> {
    fn new(scene: &'a CaseScene) -> Result<Self, StudyError> {
        let body = &scene.scene.bodies[0];
        let material = &scene.scene.materials[&body.material];
        let fracture = material.fracture.as_ref().ok_or_else(|| other("the material has no fracture"))?;
        let CrackModel::PfCzm { tensile_strength, .. } = fracture.model else {
            return Err(other("the study is of model = \"pf-czm\""));
        };
        let law = CohesiveLaw::of(material).ok_or_else(|| other("the material has no fracture"))?;
        let (low, high) = body.shape.bounding_box();
        let [length, height] = [0, 1].map(|d| high[d] - low[d]);
        let span = largest(scene.scene.mesh.knots[0].windows(2).map(|ends| ends[1] - ends[0]));
        Ok(Self { scene, material, fracture, strength: tensile_strength, law, length, height, span })
    }

    /// Stress against opening beside the law, the largest stress over the strength, and the surface energy in
    /// the end over Gc.
    fn pull(&self) -> Result<(Table, f64, f64), StudyError> {
        let scene = &self.scene.scene;
        let lattice = Lattice::new(&Patch::new(&scene.mesh), &scene.bodies[0]);
        let model = FractureModel::of(self.material);
        let model = model.ok_or_else(|| other("the material has no fracture"))?;
        let mut field = PhaseField::new(&lattice, model, &scene.solver);
        let drive = self.drive(&lattice);
        let unit = self.fracture.critical_energy_release_rate / self.strength;
        let law = self.law.softening();
        let mut table = Table::new(&["opening_over_unit", "stress_over_strength", "law"]);
        let elastic = self.strength * self.length / self.material.young_modulus;
        let mut strength = 0.0;
        for step in 0..=STEPS {
            let part = step as f64 / STEPS as f64;
            let elongation = 0.97 * elastic + (self.law.furthest() * unit - 0.97 * elastic) * part * part;
            let mut stress = f64::NAN;
            for iteration in 0.. {
                if iteration == MOST_ITERATIONS {
                    return Err(other("the stress of the bar does not settle"));
                }
                let before = stress;
                let kept = degradation(&lattice, &field, &model);
                stress = self.material.young_modulus * elongation / self.compliance(&lattice, &kept);
                if (stress - before).abs() <= SETTLED * self.strength {
                    break;
                }
                let at_rest = 0.5 * stress * stress / self.material.young_modulus;
                let history =
                    drive.iter().zip(&kept).map(|(drive, g)| drive.zip(*g, |drive, g| drive * at_rest / (g * g)));
                let history: Vec<Lane> = history.collect();
                field.solve(&lattice, &history).map_err(other)?;
            }
            strength = larger(strength, stress / self.strength);
            let opening = (elongation - stress * self.length / self.material.young_modulus) / unit;
            if step % ROW == 0 {
                table.push(&[opening, stress / self.strength, interpolated(&law, opening)]);
            }
        }
        let mut energy = 0.0;
        lattice.for_each_point(|batch, lane, _, weight| {
            let (phase, slope) = lattice.interpolate(batch, field.control_values());
            energy += weight * model.surface_energy(phase, slope)[lane];
        });
        energy /= self.fracture.critical_energy_release_rate * self.height;
        Ok((table, strength, energy))
    }

    /// ∫ 1/g dx (m) of a degradation g at the points.
    fn compliance(&self, lattice: &Lattice, kept: &[Lane]) -> f64 {
        let of = |(batch, g): (usize, &Lane)| lattice.weights_of(batch).zip(*g, |weight, g| weight / g).sum();
        kept.iter().enumerate().map(of).sum::<f64>() / self.height
    }

    /// What the driving energy of every point is multiplied by.
    fn drive(&self, lattice: &Lattice) -> Vec<Lane> {
        let mut drive = vec![Lane::ZERO; lattice.batches()];
        lattice.for_each_point(|batch, lane, [x, _], _| {
            let from_middle = (x - 0.5 * self.length) / (2.0 * self.fracture.length_scale);
            drive[batch][lane] = 1.0 + IMPERFECTION * (-from_middle * from_middle).exp();
        });
        drive
    }
}

/// g at the points, 1 where a batch has none.
fn degradation(lattice: &Lattice, field: &PhaseField, model: &FractureModel) -> Vec<Lane> {
    let of_batch = |batch| {
        let g = model.degradation(lattice.interpolate(batch, field.control_values()).0);
        g.zip(lattice.weights_of(batch), |g, weight| if weight > 0.0 { g } else { 1.0 })
    };
    (0..lattice.batches()).map(of_batch).collect()
}

/// Stress over ft at an opening.
fn interpolated(curve: &[[f64; 2]], opening: f64) -> f64 {
    let at = curve.partition_point(|[w, _]| *w < opening);
    match (at.checked_sub(1).and_then(|below| curve.get(below)), curve.get(at)) {
        (Some([w0, s0]), Some([w1, s1])) => s0 + (s1 - s0) * (opening - w0) / (w1 - w0),
        (None, _) => 1.0,
        (_, None) => larger(0.0, curve[curve.len() - 1][1]),
    }
}

fn figure(case: &Case, stem: &str) -> Figure {
    let columns = |column| ["opening_over_unit", column];
    let curves = vec![
        curve("law of softening", stem, columns("law"), CurveStyle::Reference),
        curve("phase field", stem, columns("stress_over_strength"), CurveStyle::Markers),
    ];
    let caption = "Stress over the strength against the opening of a cohesive crack in a slender bar.";
    let axes = ["opening over Gc/ft", "stress over ft"];
    chart(case, "bar", "Cohesive crack in a bar", caption, axes, curves)
}
