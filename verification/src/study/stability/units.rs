//! The same plate in metres, seconds and kilograms, and in millimetres, seconds and tonnes.
//!
//! Numbers of the scene change by factors of 10^3 to 10^12; forces (N) stay, lengths are 10³ times as large,
//! so energies are 10³ times as large (mJ). Everything has to agree after scaling but for round-off. The
//! energy is held against the closed form of the work of a traction on a wave as well, which an error common
//! to both would not pass.

use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::scene::{Boundary, Crack, Fracture, Material, Mesh, Scene, Shape, Side, TimeFactor, Traction};

use crate::extremes::largest;
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::scene::plain::PlainScene;
use crate::study::charts::{chart, curve};
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, samples};

/// Thickness, m: neither one metre nor one millimetre.
const THICKNESS: f64 = 2.5e-3;
const SAMPLES: usize = 20;

/// How many of a unit make one of SI.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    mass: f64,
}

const METRE_KILOGRAM: Units = Units { length: 1.0, mass: 1.0 };
const MILLIMETRE_TONNE: Units = Units { length: 1e3, mass: 1e-3 };

impl Units {
    fn stress(self) -> f64 {
        self.mass / self.length
    }
    fn energy(self) -> f64 {
        self.mass * self.length * self.length
    }
}

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let mut curves = Vec::new();
    let stem = series_stem(case, "energies");
    let mut table = Table::new(&["sample"]);
    table.columns = vec![(0..=SAMPLES).map(|i| i as f64).collect()];
    for (name, cracked) in [("elastic", false), ("cracking", true)] {
        let run = |units: Units| findings.compute(|| samples(&mut Simulation::new(&plate(units, cracked))?));
        let (si, millimetre) = (run(METRE_KILOGRAM)?, run(MILLIMETRE_TONNE)?);
        let factor = MILLIMETRE_TONNE.energy();
        for (quantity, value) in [
            ("kinetic energy", (|s| s.kinetic) as fn(&Sample) -> f64),
            ("elastic energy", |s| s.elastic),
            ("external work", |s| s.external_work),
            ("fracture energy", |s| s.fracture.as_ref().map_or(0.0, |f| f.energy)),
        ] {
            if cracked || quantity != "fracture energy" {
                let difference = si.as_ref().zip(millimetre.as_ref()).map(|(si, millimetre)| {
                    let scale = largest(si.iter().map(|s| value(s).abs()));
                    largest(si.iter().zip(millimetre).map(|(a, b)| (value(a) - value(b) / factor).abs())) / scale
                });
                let quantity = format!("{quantity} in other units, largest difference over the largest");
                findings.add(name, &quantity, difference, exact(0.0, "the same body"));
            }
        }
        for (units, samples, factor) in [("m, kg", &si, 1.0), ("mm, t", &millimetre, factor)] {
            let column = format!("{name}_{}", if factor == 1.0 { "si" } else { "mm" });
            curves.push(curve(&format!("{name}, {units}"), &stem, ["sample", &column], CurveStyle::Line));
            table.names.push(column);
            table.columns.push(samples.iter().flatten().map(|s| s.elastic / factor).collect());
        }
        if !cracked {
            // A traction t on the side of length L drives a wave with the velocity t/(rho c): work t² L d
            // T/(rho c) per side.
            let speed = (32e9 * 0.8 / (1.2 * 0.6) / 2450.0_f64).sqrt();
            let work = |last: &Sample| 2.0 * 1e12 * 4e-3 * THICKNESS * last.time / (2450.0 * speed);
            let last = si.as_ref().and_then(|si| si.last());
            let ratio = last.map(|last| last.external_work / work(last));
            let source = exact(1.0, "t² A T/(rho c) on two sides of plane waves");
            findings.add(name, "external work over that of plane waves", ratio, source);
        }
    }
    let axes = ["sample", "elastic energy (J)"];
    let caption = "The same plate in metres and kilograms and in millimetres and tonnes, scaled back.";
    findings.figures.push(chart(case, "energies", "Elastic energy in two systems of units", caption, axes, curves));
    findings.series.push((stem, table));
    Ok(())
}

/// A glass plate, 4 mm × 8 mm, between rollers left and right, pulled at top and bottom by 1 MPa for a
/// microsecond; or with a crack, by 8 MPa for two.
fn plate(units: Units, cracked: bool) -> Scene {
    let [width, height] = [4e-3, 8e-3].map(|x| x * units.length);
    let fracture =
        cracked.then_some(Fracture::at2(3.0 * units.energy() / units.length.powi(2), 0.25e-3 * units.length));
    let material = Material {
        young_modulus: 32e9 * units.stress(),
        poisson_ratio: 0.2,
        density: 2450.0 * units.mass / units.length.powi(3),
        fracture,
    };
    let mut scene = PlainScene::free(Mesh::uniform([2; 2], [0.0; 2], [width, height], [16, 32]), material, 3).scene();
    scene.analysis.thickness = THICKNESS * units.length;
    scene.analysis.end_time = if cracked { 2e-6 } else { 1e-6 };
    scene.output.samples = SAMPLES;
    let roller = |side| Boundary::fixed(side, [true, false]);
    scene.boundaries = if cracked { vec![] } else { vec![roller(Side::Left), roller(Side::Right)] };
    let stress = if cracked { 8e6 } else { 1e6 } * units.stress();
    let pull = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::default());
    let body = &mut scene.bodies[0];
    body.tractions = vec![pull(Side::Top, stress), pull(Side::Bottom, -stress)];
    body.shape = Shape::Rectangle { min: [0.0; 2], max: [width, height] };
    if cracked {
        body.cracks = vec![Crack::seed([0.0, 0.5 * height], [0.5 * width, 0.5 * height])];
    }
    scene
}
