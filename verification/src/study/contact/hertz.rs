//! Discs pressed together, or on a rigid plane, against Hertz's contact of cylinders in plane strain:
//!
//! ```text
//! a = sqrt(4 F R/(pi E*)),     p(s) = p0 sqrt(1 − (s/a)²),     p0 = 2 F/(pi a),
//! 1/R = 1/R1 + 1/R2,           1/E* = (1 − nu1²)/E1 + (1 − nu2²)/E2,
//! ```
//!
//! and on the axis under the contact the stress `−p0/sqrt(1 + (z/a)²)` at the depth z (Johnson, Contact
//! Mechanics, 1985, sections 4.2 and 4.1). The force F per unit thickness is the sum of the forces of
//! contact. Everything else is measured where it acts: the half width from the second moment of the forces
//! across the contact (a²/4 for a semi-ellipse), the peak pressure from the forces on the middle quarter of
//! the contact, the stress at points under it. Forces at single segments are not unique, and bunch: only what
//! they are together over a span, which is where control points take them up, means something. So every force
//! is spread over a span to each side for the pressure. A force that varies while a wave passes some spans is
//! vibration, which Hertz's contact is without, so F is a running mean over that time. All are means over the
//! steps in which F is close to its largest.

use std::f64::consts::PI;

use fisura::Simulation;
use fisura::contact::impulse::ContactForce;
use fisura::material::elasticity::ElasticModuli;
use fisura::output::inspection::PointState;
use fisura::particles::spans::smallest_span;
use fisura::scene::{Body, Plane, Scene, Shape};

use super::{Books, dot, larger, run, sample_is_due, sum};
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::study::charts::{chart, curve};
use crate::study::scene::series_stem;
use crate::study::{Case, CaseScene, Findings, StudyError, exact, other};

/// Share of the largest force above which a step counts.
const NEAR_THE_TOP: f64 = 0.97;
/// Steps from one look at the points under the contact to the next.
const BETWEEN_LOOKS: usize = 4;
/// Spans that a wave passes in the time over which the force is averaged.
const PASSED: f64 = 8.0;
/// Bins across the contact, and the half width they cover, in a.
const BINS: usize = 40;
/// Columns of the pressure.
const COLUMNS: [&str; 2] = ["s_over_a", "pressure_over_p0"];
const COVERED: f64 = 1.25;
/// Half width of the strip for the peak pressure, in a.
const MIDDLE: f64 = 0.25;
/// Half width and depth of the region in which points show the stress under the contact, in a.
const UNDER: [f64; 2] = [0.125, 0.5];

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let mut curves = vec![];
    let mut series = vec![];
    for CaseScene { name, scene, .. } in scenes {
        let one = || exact(1.0, "Hertz");
        let quantities = [
            ("half width of the contact over Hertz's", one()),
            ("peak pressure from the forces in the middle over Hertz's", one()),
            ("stress of points under the contact over Hertz's", one()),
            ("momentum less the impulses of contact over the momentum", exact(0.0, "Newton")),
            ("points across half the width", None),
            ("half width over R", None),
            ("half width over the shortest span", None),
            ("share of the contact that is seen after the largest force", None),
            ("closure of the energy ledger over the energy at t = 0", None),
        ];
        let stem = format!("{}-pressure", series_stem(case, name));
        let label = if name.is_empty() { "measured" } else { name };
        curves.push(curve(label, &stem, COLUMNS, CurveStyle::Markers));
        findings.measure(name, quantities, || {
            let found = Hertz::of(scene)?.press(scene)?;
            series.push((stem, found.pressure()));
            Ok(found.numbers())
        })?;
    }
    findings.series.extend(series);
    let stem = format!("{}-ellipse", series_stem(case, ""));
    findings.series.push((stem.clone(), ellipse()));
    curves.push(curve("Hertz", &stem, COLUMNS, CurveStyle::Reference));
    let caption =
        "Forces of contact per length near the largest force, in units of Hertz's half width and peak pressure.";
    let axes = ["place across the contact over a", "pressure over p0"];
    findings.figures.push(chart(case, "pressure", "Pressure across the contact", caption, axes, curves));
    Ok(())
}

/// Hertz's semi-ellipse as a line.
fn ellipse() -> Table {
    let angles = (0..=100).map(|i| PI * (f64::from(i) / 100.0 - 1.0));
    Table::of_rows(&COLUMNS, angles.map(|angle| [angle.cos(), -angle.sin().min(0.0)]))
}

/// Mean of `sqrt(1 − s²)` over |s| < `half`.
fn mean_of_ellipse(half: f64) -> f64 {
    0.5 * ((1.0 - half * half).sqrt() + half.asin() / half)
}

/// Bodies in contact as Hertz sees them.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Hertz {
    /// Effective radius R, m, and effective modulus E*, Pa, of the two bodies.
    radius: f64,
    modulus: f64,
    /// Shortest span, m, and length of a boundary segment, m.
    span: f64,
    segment: f64,
    /// Time over which the force is averaged, s.
    memory: f64,
}

impl Hertz {
    fn of(scene: &Scene) -> Result<Self, StudyError> {
        let curvature = |body: &Body| if let Shape::Disk { radius, .. } = body.shape { 1.0 / radius } else { 0.0 };
        let compliance = |body: &Body| {
            let material = &scene.materials[&body.material];
            if body.rigid { 0.0 } else { (1.0 - material.poisson_ratio.powi(2)) / material.young_modulus }
        };
        if scene.bodies.len() != 2 || scene.analysis.plane != Plane::Strain {
            return Err(other("this study needs two bodies in plane strain"));
        }
        let total = |part: &dyn Fn(&Body) -> f64| scene.bodies.iter().map(part).sum::<f64>();
        let points = scene.bodies[0].particles_per_cell[0] as f64;
        let span = smallest_span(&scene.mesh);
        let material = &scene.materials[&scene.bodies[0].material];
        let wave = ElasticModuli::new(material, scene.analysis.plane).dilatational_speed(material.density);
        Ok(Self {
            radius: 1.0 / total(&curvature),
            modulus: 1.0 / total(&compliance),
            span,
            segment: span / points,
            memory: PASSED * span / wave,
        })
    }

    /// Half width under a force (N/m), m.
    fn half_width(&self, force: f64) -> f64 {
        (4.0 * force * self.radius / (PI * self.modulus)).sqrt()
    }

    /// Peak pressure under a force (N/m), Pa.
    fn peak(&self, force: f64) -> f64 {
        (force * self.modulus / (PI * self.radius)).sqrt()
    }

    fn press(self, scene: &Scene) -> Result<Pressed, StudyError> {
        let mut found = Pressed {
            hertz: self,
            forces: vec![],
            moments: vec![],
            balance: 0.0,
            momentum: f64::NAN,
            books: Books::default(),
        };
        let (mut expected, mut mean) = ([0.0; 2], 0.0);
        run(scene, &mut |simulation| {
            let step = simulation.plan().step;
            let (forces, (_, momentum)) = (simulation.contact_forces(), simulation.momenta()[0]);
            if simulation.steps() == 0 {
                (expected, found.momentum) = (momentum, dot(momentum, momentum).sqrt());
            }
            let off = [0, 1].map(|d| momentum[d] - expected[d]);
            found.balance = larger(found.balance, dot(off, off).sqrt());
            let kick = if simulation.steps() == 0 { 0.5 * step } else { step };
            let total = sum(&forces);
            expected = [0, 1].map(|d| expected[d] - kick * total[d]);
            if sample_is_due(simulation) {
                found.books.enter(&simulation.sample());
            }
            mean += (step / self.memory).min(1.0) * (dot(total, total).sqrt() - mean);
            if !forces.is_empty() {
                found.forces.push(mean);
                if simulation.steps().is_multiple_of(BETWEEN_LOOKS) {
                    found.moments.push(self.look(&forces, mean, simulation));
                }
            }
        })?;
        Ok(found)
    }

    /// What the forces, of which the sum has this mean (N/m), and the points under them show.
    fn look(&self, forces: &[ContactForce], force: f64, simulation: &Simulation) -> Moment {
        let total = sum(forces);
        let now = dot(total, total).sqrt();
        let normal = total.map(|f| f / now);
        let along = [-normal[1], normal[0]];
        let (half, peak) = (self.half_width(force), self.peak(force));
        let mean = |value: &dyn Fn(&ContactForce) -> f64| {
            forces.iter().map(|f| dot(f.force, normal) * value(f)).sum::<f64>() / now
        };
        let middle = [0, 1].map(|d| mean(&|f| f.position[d]));
        let place = |position: [f64; 2], direction| dot([0, 1].map(|d| position[d] - middle[d]), direction);
        let square = mean(&|f| place(f.position, along).powi(2));
        let mut bins = [0.0; BINS];
        for f in forces {
            let (s, reach) = (place(f.position, along) / half, self.span / half);
            spread(&mut bins, [s - reach, s + reach], dot(f.force, normal) / (peak * half));
        }
        let (mut stress, mut count) = (0.0, 0);
        simulation.for_each_point(&mut |PointState { body, present, stress: [xx, yy, xy], .. }| {
            let (s, z) = (place(present, along) / half, place(present, normal) / half);
            if body == 0 && s.abs() < UNDER[0] && z.abs() < UNDER[1] {
                let traction = [xx * normal[0] + xy * normal[1], xy * normal[0] + yy * normal[1]];
                stress -= dot(traction, normal) * (1.0 + z * z).sqrt() / peak;
                count += 1;
            }
        });
        Moment { force, square: square * now / force, bins, stress: stress / f64::from(count) }
    }
}

/// Adds a share of `amount` to every bin that `[from, to]` (in a) overlaps, as an amount per length.
fn spread(bins: &mut [f64; BINS], [from, to]: [f64; 2], amount: f64) {
    let width = 2.0 * COVERED / BINS as f64;
    for (i, bin) in bins.iter_mut().enumerate() {
        let left = i as f64 * width - COVERED;
        let overlap = (to.min(left + width) - from.max(left)).max(0.0);
        *bin += amount * overlap / (to - from) / width;
    }
}

/// What is seen at a step.
struct Moment {
    /// Running mean of the force of contact, N/m.
    force: f64,
    /// Mean square of the place across the contact times the present force over the mean, m².
    square: f64,
    /// Pressure over p0 across the contact.
    bins: [f64; BINS],
    /// Stress under the contact over Hertz's.
    stress: f64,
}

/// Forces, pressures and balances that were measured during a run.
struct Pressed {
    hertz: Hertz,
    /// Means of the force in every step with contact, N/m.
    forces: Vec<f64>,
    moments: Vec<Moment>,
    /// Largest difference between the momentum of the body and the impulses on it, kg m/s.
    balance: f64,
    momentum: f64,
    books: Books,
}

impl Pressed {
    /// Mean over the steps in which the force is close to its largest.
    fn mean(&self, value: impl Fn(&Moment) -> f64) -> f64 {
        let top = self.moments.iter().map(|m| m.force).fold(0.0, larger);
        let near = self.moments.iter().filter(|m| m.force >= NEAR_THE_TOP * top);
        let (count, total) = near.fold((0.0, 0.0), |(n, sum), m| (n + 1.0, sum + value(m)));
        total / count
    }

    /// Whether the force has its largest value well inside the run.
    fn share_after_the_top(&self) -> f64 {
        let top = self.forces.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        top.map_or(f64::NAN, |(index, _)| 1.0 - (index + 1) as f64 / self.forces.len() as f64)
    }

    fn pressure(&self) -> Table {
        let width = 2.0 * COVERED / BINS as f64;
        let row = |i: usize| [(i as f64 + 0.5) * width - COVERED, self.mean(|m| m.bins[i])];
        Table::of_rows(&COLUMNS, (0..BINS).map(row))
    }

    /// The numbers of the study, in its order.
    fn numbers(&self) -> [f64; 9] {
        let hertz = &self.hertz;
        let measured = (4.0 * self.mean(|m| m.square)).sqrt();
        let expected = self.mean(|m| hertz.half_width(m.force).powi(2)).sqrt();
        let width = 2.0 * COVERED / BINS as f64;
        let inner = (0..BINS).filter(|i| ((*i as f64 + 0.5) * width - COVERED).abs() < MIDDLE);
        let (count, total) = inner.fold((0.0, 0.0), |(n, sum), i| (n + 1.0, sum + self.mean(|m| m.bins[i])));
        let [segments, radii, spans] = [hertz.segment, hertz.radius, hertz.span].map(|length| expected / length);
        [
            measured / expected,
            total / count / mean_of_ellipse(MIDDLE),
            self.mean(|m| m.stress),
            self.balance / self.momentum,
            segments,
            radii,
            spans,
            self.share_after_the_top(),
            self.books.closure / self.books.initial(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_semi_ellipse_carries_the_force_and_has_its_second_moment() {
        let hertz = Hertz { radius: 0.3, modulus: 50.0, span: 0.1, segment: 0.1, memory: 1.0 };
        let force = 0.7;
        let (a, p0) = (hertz.half_width(force), hertz.peak(force));
        assert!((0.5 * PI * a * p0 - force).abs() < 1e-14);
        assert!((mean_of_ellipse(1.0) - 0.25 * PI).abs() < 1e-15 && (mean_of_ellipse(1e-4) - 1.0).abs() < 1e-8);
        let (mut bins, n) = ([0.0; BINS], 2000);
        for i in 0..n {
            let s = 2.0 * (i as f64 + 0.5) / n as f64 - 1.0;
            spread(&mut bins, [s - 1e-3, s + 1e-3], (1.0 - s * s).sqrt() * 2.0 / n as f64);
        }
        let width = 2.0 * COVERED / BINS as f64;
        for (i, bin) in bins.iter().enumerate() {
            let s = (i as f64 + 0.5) * width - COVERED;
            if s.abs() < 0.9 {
                assert!((bin - (1.0 - s * s).sqrt()).abs() < 2e-2, "{s}: {bin}");
            } else if s.abs() > 1.05 {
                assert_eq!(*bin, 0.0);
            }
        }
        assert!((bins.iter().sum::<f64>() * width - 0.5 * PI).abs() < 1e-4);
    }
}
