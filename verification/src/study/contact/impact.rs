//! Head-on impact of two bars of one material, the first and shorter one at speed V, the other at rest (nu =
//! 0).
//!
//! Both ends move at V/2 while two waves of stress `rho c V/2` run along the bars. The one in the shorter bar
//! comes back from its free end after `2 L1/c` and brings it to rest; the force ends, and the longer bar
//! leaves with the mean velocity `V L1/L2`: a coefficient of restitution of `L1/L2`, though no energy is lost
//! (Goldsmith, Impact, 1960, section 2.1).

use std::collections::BTreeMap;

use fisura::material::elasticity::ElasticModuli;
use fisura::particles::spans::largest_spans;
use fisura::scene::{Scene, Transfer};

use super::{Books, run, sample_is_due, sum};
use crate::output::history::Table;
use crate::record::{CurveStyle, Reference};
use crate::study::charts::{chart, curve};
use crate::study::orders::{Convergence, Curve, Level, Norm, Refined};
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other};

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let mut curves = vec![];
    let mut meshes: BTreeMap<String, Vec<Level>> = BTreeMap::new();
    for CaseScene { name, scene, .. } in scenes {
        let bars = Bars::of(scene)?;
        let found = findings.compute(|| bars.collide(scene))?;
        bars.add(found.as_ref(), name, findings);
        let stem = format!("{}-force", series_stem(case, name));
        curves.push(curve(name, &stem, COLUMNS, CurveStyle::Line));
        findings.series.extend(found.as_ref().map(|found| (stem, bars.table(found))));
        meshes.entry(group(scene)).or_default().push(Level {
            h: largest_spans(&scene.mesh)[0],
            unknowns: scene.mesh.knots[0].len(),
            seconds: 0.0,
            errors: found.map_or(vec![f64::NAN; 2], |found| vec![bars.exit_error(&found), found.loss]),
        });
    }
    let stem = format!("{}-rectangle", series_stem(case, ""));
    findings.series.push((stem.clone(), rectangle()));
    curves.push(curve("closed form", &stem, COLUMNS, CurveStyle::Reference));
    let caption =
        "Sum of the forces of contact over rho c V/2 per area; the closed form is a rectangle of length 2 L1/c.";
    let axes = ["(t − t of the closing gap) c/L1", "force over rho c V/2"];
    findings.figures.push(chart(case, "force", "Force of contact", caption, axes, curves));
    convergence(case, meshes).add_to(findings);
    Ok(())
}

/// Meshes from which on there are orders.
const MESHES: usize = 3;
/// Columns of the forces.
const COLUMNS: [&str; 2] = ["time_c_over_l1", "force_over_plateau"];
const NORMS: [&str; 2] = ["error of the exit velocities", "energy lost in contact"];
/// Orders of theory, one for each of `NORMS`.
const ORDERS: [Option<f64>; 2] = [Some(2.0 / 3.0), Some(1.0)];

/// Runs that differ in the mesh only.
fn group(scene: &Scene) -> String {
    let transfer = match scene.analysis.transfer {
        Transfer::Flip => String::new(),
        other => format!(", {}", format!("{other:?}").to_uppercase()),
    };
    format!("p={}{transfer}", scene.mesh.degree[0])
}

/// Errors against h where there are three meshes.
fn convergence(case: &Case, meshes: BTreeMap<String, Vec<Level>>) -> Convergence {
    let norm = |quantity: &&str| Norm { quantity: quantity.to_string(), unit: "1".into(), floor: 0.0 };
    let studied = meshes.into_iter().filter(|(_, levels)| levels.len() >= MESHES);
    Convergence {
        title: case.label.clone(),
        caption: "Mean velocities after the impact, and energy lost in contact, over V and over the energy at t = 0.".into(),
        theory: "a front in a bar of lumped mass is (h² L)^(1/3) wide; what the impact of two end masses loses is their share"
            .into(),
        refined: Refined::Mesh { dimensions: 1 },
        norms: NORMS.iter().map(norm).collect(),
        curves: studied.map(|(name, levels)| Curve { name, levels, orders: ORDERS.to_vec() }).collect(),
        ..Convergence::of(case)
    }
}

/// The closed form as a line.
fn rectangle() -> Table {
    let rows = [[-0.25, 0.0], [0.0, 0.0], [0.0, 1.0], [2.0, 1.0], [2.0, 0.0], [2.5, 0.0]];
    Table::of_rows(&COLUMNS, rows)
}

/// Two bars along x before their impact, and the closed form of its force.
struct Bars {
    /// Lengths of the first and the second bar along x, m.
    lengths: [f64; 2],
    /// Distance between the bars along x at t = 0, m.
    gap: f64,
    /// Closing velocity, m/s.
    speed: f64,
    /// Speed of dilatational waves in the bars, m/s.
    wave: f64,
    /// Force of the plateau per unit thickness, N/m.
    plateau: f64,
}

/// What a collision gave.
struct Collision {
    /// Mean velocities of the bars in the end over V.
    exit: [f64; 2],
    /// Time between rise and fall of the force through half the plateau, s.
    duration: f64,
    /// Mean force over the middle half of the contact, over that of the plateau.
    plateau: f64,
    /// Loss in contact over the energy at t = 0.
    loss: f64,
    books: Books,
    /// Momentum of the first bar at t = 0, kg m/s.
    momentum: f64,
    /// Time (s) and force (N/m) after every step.
    forces: Vec<[f64; 2]>,
}

impl Bars {
    fn of(scene: &Scene) -> Result<Self, StudyError> {
        let [one, two] = scene.bodies.as_slice() else {
            return Err(other("this study needs two bars"));
        };
        let material = &scene.materials[&one.material];
        let wave = ElasticModuli::new(material, scene.analysis.plane).dilatational_speed(material.density);
        let speed = one.velocity[0] - two.velocity[0];
        let [(low, high), (left, right)] = [one, two].map(|body| body.shape.bounding_box());
        let plateau = 0.5 * material.density * wave * speed * (high[1] - low[1]);
        Ok(Self { lengths: [high[0] - low[0], right[0] - left[0]], gap: left[0] - high[0], speed, wave, plateau })
    }

    /// Duration of the contact, s.
    fn duration(&self) -> f64 {
        2.0 * self.lengths[0] / self.wave
    }

    /// Time at which the gap is closed, s.
    fn closing(&self) -> f64 {
        self.gap / self.speed
    }

    /// Mean velocity of the second bar in the end, over V.
    fn leaving(&self) -> f64 {
        self.lengths[0] / self.lengths[1]
    }

    /// Larger error of the exit velocities, over V.
    fn exit_error(&self, found: &Collision) -> f64 {
        super::largest([found.exit[0], found.exit[1] - self.leaving()])
    }

    fn collide(&self, scene: &Scene) -> Result<Collision, StudyError> {
        let (mut forces, mut books, mut momentum, mut exit) = (vec![], Books::default(), f64::NAN, [f64::NAN; 2]);
        run(scene, &mut |simulation| {
            let force = sum(&simulation.contact_forces())[0];
            forces.push([simulation.time(), force]);
            if sample_is_due(simulation) {
                books.enter(&simulation.sample());
            }
            let momenta = simulation.momenta();
            exit = [0, 1].map(|i| momenta[i].1[0] / momenta[i].0 / self.speed);
            if simulation.steps() == 0 {
                momentum = momenta[0].1[0];
            }
        })?;
        let middle = self.closing() + 0.5 * self.duration();
        let inner = forces.iter().filter(|[t, _]| (t - middle).abs() <= 0.25 * self.duration());
        let (count, total) = inner.fold((0.0, 0.0), |(n, sum), [_, force]| (n + 1.0, sum + force));
        let plateau = total / count / self.plateau;
        let duration = width(&forces, 0.5 * self.plateau);
        let loss = books.loss / books.initial();
        Ok(Collision { exit, duration, plateau, loss, books, momentum, forces })
    }

    fn add(&self, found: Option<&Collision>, name: &str, findings: &mut Findings) {
        let equal = self.leaving() == 1.0;
        let source = if equal { "equal bars exchange their velocities" } else { "restitution L1/L2" };
        let mut add = |quantity: &str, value: &dyn Fn(&Collision) -> f64, reference: Option<Reference>| {
            findings.add(name, quantity, found.map(value), reference);
        };
        add("velocity of the first bar after the impact over V", &|found| found.exit[0], exact(0.0, source));
        let leaving = exact(self.leaving(), source);
        add("velocity of the second bar after the impact over V", &|found| found.exit[1], leaving);
        let restitution = |found: &Collision| found.exit[1] - found.exit[0];
        add("coefficient of restitution", &restitution, exact(self.leaving(), "L1/L2"));
        let duration = |found: &Collision| found.duration / self.duration();
        add("duration of the contact over 2 L1/c", &duration, exact(1.0, "two passages of a wave"));
        let force = exact(1.0, "rho c V/2 per area");
        add("mean force in the middle half of the contact over rho c V/2", &|found| found.plateau, force);
        add("energy lost in contact over the energy at t = 0", &|found| found.loss, exact(0.0, "an elastic impact"));
        add("drift of the momentum over that of one bar", &|found| found.books.momentum / found.momentum, None);
        let closure = |found: &Collision| found.books.closure / found.books.initial();
        add("closure of the energy ledger over the energy at t = 0", &closure, None);
    }

    /// Force against time, both in units of the closed form, from a little before the contact to a little
    /// after.
    fn table(&self, found: &Collision) -> Table {
        let scaled = |[t, force]: &[f64; 2]| [(t - self.closing()) * self.wave / self.lengths[0], force / self.plateau];
        let rows = found.forces.iter().map(scaled);
        Table::of_rows(&COLUMNS, rows.filter(|[t, _]| (-0.25..=2.5).contains(t)))
    }
}

/// Time between the first rise through a level and the last fall through it.
fn width(rows: &[[f64; 2]], level: f64) -> f64 {
    let crossing = |pair: &[[f64; 2]]| {
        let [[t0, f0], [t1, f1]] = [pair[0], pair[1]];
        t0 + (level - f0) / (f1 - f0) * (t1 - t0)
    };
    let rise = rows.windows(2).find(|pair| pair[0][1] < level && pair[1][1] >= level).map(crossing);
    let fall = rows.windows(2).rfind(|pair| pair[0][1] >= level && pair[1][1] < level).map(crossing);
    rise.zip(fall).map_or(f64::NAN, |(rise, fall)| fall - rise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_width_of_a_pulse_is_that_at_the_level() {
        let rows = [[0.0, 0.0], [1.0, 2.0], [2.0, 2.0], [3.0, 0.5], [4.0, 2.0], [5.0, 0.0]];
        assert!((width(&rows, 1.0) - 4.0).abs() < 1e-15);
        assert!(width(&rows, 3.0).is_nan());
        assert!(width(&rows[..3], 1.0).is_nan(), "a force that never ends has no duration");
    }
}
