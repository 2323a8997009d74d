//! The split of the energy where principal strains are equal, nearly equal, of either sign, or at the ends of
//! what numbers hold.
//!
//! A strain is made of principal strains e1 ≥ e2 and a direction φ, so that its tensile part
//! `Σ ⟨e_i⟩ n_i n_iᵀ` is known without an eigenvalue being solved for; the map from a strain to its tensile
//! part has the Lipschitz constant one, so that round-off of the strain is all the error there may be. Then
//! the same motion is run twice, at strains of 1e-3 and at 2^−560 (3e-169) times that: as long as nothing
//! breaks, the equations do not know the size of the motion, and every velocity has to scale, bit by bit but
//! for what the phase field of the larger one gives way. Hencky strain is held against logarithms of
//! stretches.

use std::f64::consts::TAU;

use fisura::linear_algebra::lane::Lane;
use fisura::material::hencky::hencky_strain;
use fisura::material::split::tensile_strain;
use fisura::scene::{Boundary, Fracture, Mesh, Scene, Side};

use super::{logarithmic, total_frame};
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::scene::plain::PlainScene;
use crate::study::charts::curve;
use crate::study::random::Random;
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other};

/// Draws two principal strains.
type Family = fn(&mut Random) -> [f64; 2];

const FAMILIES: [(&str, Family); 7] = [
    ("generic", |r| [r.between(-1.0, 1.0), r.between(-1.0, 1.0)]),
    ("equal, tensile", |r| [r.between(0.0, 1.0); 2]),
    ("equal, compressive", |r| [r.between(-1.0, 0.0); 2]),
    ("1e-15 apart", |r| {
        let e = r.between(-1.0, 1.0);
        [e, e * (1.0 + 1e-15)]
    }),
    ("1e-10 apart", |r| {
        let e = r.between(-1.0, 1.0);
        [e, e * (1.0 + 1e-10)]
    }),
    ("nearly zero and of either sign", |r| [1e-12 * r.between(-1.0, 1.0), r.between(-1.0, 1.0)]),
    ("strains of 1e-170", |r| [1e-170 * r.between(-1.0, 1.0), 1e-170 * r.between(-1.0, 1.0)]),
];

/// Strains of a family.
const DRAWN: usize = 2000;
/// Size of the small motion over that of the large one.
const SMALL: f64 = 2.649_825_291_116_8e-169; // 2^-560
const STEPS: usize = 400;

pub(in super::super) fn study(case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for (name, draw) in FAMILIES {
        let quantity = ("tensile strain, largest error over the strain", exact(0.0, "from principal strains"));
        findings.measure(name, [quantity], || {
            let mut random = Random::scrambled(7);
            let mut worst = 0.0_f64;
            for _ in 0..DRAWN {
                let principal = draw(&mut random);
                worst = larger(worst, error(principal, TAU * random.unit()));
            }
            Ok([worst])
        })?;
    }
    let quantity = ("Hencky strain, largest error", exact(0.0, "ln λ"));
    findings.measure("stretches from 1e-12 to 1000", [quantity], || Ok([hencky_error()]))?;
    let found = findings.compute(scaled_runs)?;
    let (table, difference) = found.map_or((Table::default(), None), |(table, difference)| (table, Some(difference)));
    let quantity = "velocities at strains 3e-169 times as large, largest difference after scaling";
    findings.add("run", quantity, difference, exact(0.0, "homogeneous of degree one"));
    let stem = series_stem(case, "scaled");
    let curves = [("strains of 1e-3", "large"), ("3e-169 times that, scaled", "small")];
    let curves = curves.map(|(label, column)| curve(label, &stem, ["step", column], CurveStyle::Line));
    let caption = "A block held at its left side and set in motion: largest velocity, spectral split.";
    let axes = ["step", "largest velocity over that at t = 0"];
    let title = "The same motion, small and smaller";
    findings.figures.push(logarithmic(case, "scaled", title, caption, axes, curves.into()));
    findings.series.push((stem, table));
    Ok(())
}

/// Largest component of the error of the tensile part over the larger principal strain.
fn error([e1, e2]: [f64; 2], direction: f64) -> f64 {
    let (sine, cosine) = direction.sin_cos();
    let tensor = |a: f64, b: f64| {
        [a * cosine * cosine + b * sine * sine, a * sine * sine + b * cosine * cosine, (a - b) * sine * cosine]
    };
    let (found, _) = tensile_strain(tensor(e1, e2).map(Lane::splat));
    let expected = tensor(e1.max(0.0), e2.max(0.0));
    largest((0..3).map(|i| (found[i][0] - expected[i]).abs())) / e1.abs().max(e2.abs())
}

/// Largest error of the Hencky strain of stretches λ along and across a direction, `Σ ln λ_i n_i n_iᵀ`, over
/// the largest |ln λ|.
fn hencky_error() -> f64 {
    let mut random = Random::scrambled(11);
    let mut worst = 0.0_f64;
    for draw in 0..DRAWN {
        let size = if draw % 2 == 0 { 10f64.powf(random.between(-12.0, -1.0)) } else { random.between(0.1, 1000.0) };
        let stretches = [size * random.unit(), size * random.unit()]; // less one
        let (sine, cosine) = (TAU * random.unit()).sin_cos();
        let tensor = |[a, b]: [f64; 2]| {
            [a * cosine * cosine + b * sine * sine, a * sine * sine + b * cosine * cosine, (a - b) * sine * cosine]
        };
        let [xx, yy, xy] = tensor(stretches);
        let logarithms = stretches.map(f64::ln_1p);
        let (found, expected) = (hencky_strain(&[[xx, xy], [xy, yy]]), tensor(logarithms));
        let scale = largest(logarithms.map(f64::abs));
        worst = larger(worst, largest((0..3).map(|i| (found[i] - expected[i]).abs())) / scale);
    }
    worst
}

/// Largest velocity of both runs step by step, and the largest difference of velocities over the largest
/// velocity.
fn scaled_runs() -> Result<(Table, f64), StudyError> {
    let mut runs = [total_frame(&block(1.0))?, total_frame(&block(SMALL))?];
    let dt = 0.8 * runs[0].critical_step();
    let mut table = Table::new(&["step", "large", "small"]);
    let (mut worst, mut first) = (0.0_f64, 0.0_f64);
    for step in 1..=STEPS {
        crate::watch::check()?;
        for run in &mut runs {
            run.step(dt).map_err(|_| other("the phase field did not converge"))?;
        }
        let [large, small] = runs.each_ref().map(|run| run.velocity.iter().flatten());
        let fastest = largest(runs[0].velocity.iter().flatten().map(|v| v.abs()));
        let fastest_small = largest(runs[1].velocity.iter().flatten().map(|v| v.abs())) / SMALL;
        first = if step == 1 { fastest } else { first };
        worst = larger(worst, largest(large.zip(small).map(|(a, b)| (a - b / SMALL).abs())) / first);
        table.push(&[step as f64, fastest / first, fastest_small / first]);
    }
    Ok((table, worst))
}

/// A block held at its left side whose speed strains it by about `size` times 1e-3; it is far too tough to
/// crack.
fn block(size: f64) -> Scene {
    let mut plain = PlainScene::unit(Mesh::uniform([2; 2], [0.0; 2], [2.0, 1.0], [8, 4]), 0.3);
    plain.material.fracture = Some(Fracture::at2(1e12, 0.25));
    let mut scene = plain.scene();
    scene.bodies[0].velocity = [1e-3 * size, 3e-4 * size];
    scene.boundaries = vec![Boundary::fixed(Side::Left, [true; 2])];
    scene
}
