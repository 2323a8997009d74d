//! Two elastic bodies that collide in flight: what the scheme conserves, what symmetry demands, and what the
//! impact costs.

use fisura::dynamics::updated_frame::field::DiscreteField;
use fisura::scene::Scene;

use super::{Books, center, chart, curve, dot, exact, label, largest, run, sample_is_due};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

pub(in super::super) fn offers(_case: &Case, scenes: &[CaseScene]) -> crate::study::Offered {
    let held = &[
        "drift of the momentum over that of one body",
        "drift of the angular momentum over momentum times distance of one body",
        "velocities, departure from the mirror image over the speed",
        "centres, departure from the mirror image over their distance",
        "kinetic energies, difference over the energy at t = 0",
        "energy lost in contact and transfers, without friction, over the energy at t = 0",
    ];
    let bare = &[
        "share of the angular momentum that spins the bodies in the end",
        "closure of the energy ledger over the energy at t = 0",
        "rebound: velocity of separation over that of approach",
        "kinetic energy in the end over that at t = 0",
        "elastic energy in the end over the energy at t = 0",
        "loss of the transfers over the energy at t = 0",
        "energy lost in contact over the energy at t = 0",
        "energy lost to friction over the energy at t = 0",
        "largest decrease of the friction loss in a step over the energy at t = 0",
    ];
    Ok(crate::study::Offers::of_scenes(scenes, held, bare))
}

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = vec![];
    for CaseScene { name, scene, .. } in scenes {
        let found = collide(scene)?;
        found.add(scene, name, &mut findings);
        let stem = format!("{}-energies", series_stem(case, name));
        for (energy, column) in [("kinetic", "kinetic"), ("elastic", "elastic"), ("lost in contact", "contact_loss")] {
            curves.push(curve(&label(name, energy), &stem, ["time_s", column], CurveStyle::Line));
        }
        findings.series.push((stem, found.energies));
    }
    findings.figures.push(chart(
        case,
        "energies",
        "Energies over that at t = 0",
        "",
        ["time (s)", "energy over that at t = 0"],
        curves,
    ));
    Ok(findings)
}

/// What a collision gave.
struct Collision {
    books: Books,
    /// Momentum of the first body at t = 0, kg m/s, and its angular momentum about the middle between the
    /// bodies, kg m²/s.
    momentum: f64,
    angular_momentum: f64,
    /// Largest difference of mirrored velocities over the speed, of mirrored centres over their distance at t
    /// = 0, and of the kinetic energies of the bodies over their sum at t = 0.
    mirror: [f64; 3],
    /// Mean velocities of both bodies in the end, m/s.
    exit: [[f64; 2]; 2],
    /// Kinetic and elastic energy in the end and loss of the transfers over the energy at t = 0.
    left: [f64; 3],
    /// Angular momentum of the bodies about their own centres in the end, over the angular momentum at t = 0.
    own_spin: f64,
    /// Energies over that at t = 0.
    energies: Table,
}

fn collide(scene: &Scene) -> Result<Collision, StudyError> {
    if scene.bodies.len() != 2 {
        return Err(StudyError::Other("this study takes two bodies".into()));
    }
    let mut found = Collision {
        books: Books::default(),
        momentum: f64::NAN,
        angular_momentum: f64::NAN,
        mirror: [0.0; 3],
        exit: [[f64::NAN; 2]; 2],
        left: [f64::NAN; 3],
        own_spin: f64::NAN,
        energies: Table::new(&["time_s", "kinetic", "elastic", "contact_loss"]),
    };
    let mut start: Option<[[f64; 2]; 2]> = None;
    run(scene, &mut |simulation, frame| {
        let [one, two] = frame.fields() else { return };
        found.books.step(frame);
        let sample = sample_is_due(simulation).then(|| simulation.sample());
        if let Some(sample) = &sample {
            found.books.enter(sample);
        }
        let (centers, velocities) = ([one, two].map(center), [one, two].map(velocity));
        if start.is_none() {
            start = Some(centers);
            let momentum = one.momentum();
            found.momentum = dot(momentum, momentum).sqrt();
            let middle = [0, 1].map(|d| 0.5 * (centers[0][d] + centers[1][d]));
            let arm = [0, 1].map(|d| centers[0][d] - middle[d]);
            found.angular_momentum = super::cross(arm, momentum).abs();
        }
        let initial = found.books.initial();
        let [a, b] = start.unwrap_or_default();
        let (speed, apart) = (found.momentum / one.mass(), (b[0] - a[0]).abs());
        let kinetic = [one, two].map(kinetic);
        let now = [
            largest([velocities[0][0] + velocities[1][0], velocities[0][1] - velocities[1][1]]) / speed,
            largest([centers[0][0] + centers[1][0] - a[0] - b[0], centers[0][1] - centers[1][1] - a[1] + b[1]]) / apart,
            (kinetic[0] - kinetic[1]).abs() / initial,
        ];
        found.mirror = [0, 1, 2].map(|i| super::larger(found.mirror[i], now[i]));
        found.exit = velocities;
        if let Some(sample) = sample {
            found.left =
                [sample.kinetic, sample.elastic, sample.transfer_loss.unwrap_or(f64::NAN)].map(|e| e / initial);
            let orbital: f64 = [(one, 0), (two, 1)].map(|(f, i)| super::cross(centers[i], f.momentum())).iter().sum();
            found.own_spin = sample.angular_momentum - orbital;
            let loss = found.books.loss / initial;
            found.energies.push(&[frame.time(), found.left[0], found.left[1], loss]);
        }
    })?;
    Ok(found)
}

/// Mean velocity of a body, half a step back, m/s.
fn velocity(field: &DiscreteField) -> [f64; 2] {
    field.momentum().map(|p| p / field.mass())
}

/// Kinetic energy of the points of a body, over its density and thickness.
fn kinetic(field: &DiscreteField) -> f64 {
    let density = field.mass() / field.points().iter().map(|p| p.volume).sum::<f64>();
    0.5 * density * field.points().iter().map(|p| p.volume * dot(p.velocity, p.velocity)).sum::<f64>()
}

impl Collision {
    fn add(&self, scene: &Scene, name: &str, findings: &mut Findings) {
        let books = &self.books;
        let initial = books.initial();
        let zero = |source: &str| exact(0.0, source);
        let momentum = books.momentum / self.momentum;
        findings.add(name, "drift of the momentum over that of one body", momentum, zero("action and reaction"));
        // Of a head-on collision there is none; the product of momentum and distance is what can be lost.
        let size = self.momentum * distance(scene);
        let angular = books.angular_momentum / size;
        let quantity = "drift of the angular momentum over momentum times distance of one body";
        findings.add(name, quantity, angular, zero("forces act at one place"));
        let spin = self.own_spin / (2.0 * self.angular_momentum);
        findings.add(name, "share of the angular momentum that spins the bodies in the end", spin, None);
        let source = "the collision of mirrored bodies";
        findings.add(name, "velocities, departure from the mirror image over the speed", self.mirror[0], zero(source));
        findings.add(
            name,
            "centres, departure from the mirror image over their distance",
            self.mirror[1],
            zero(source),
        );
        findings.add(name, "kinetic energies, difference over the energy at t = 0", self.mirror[2], zero(source));
        findings.add(name, "closure of the energy ledger over the energy at t = 0", books.closure / initial, None);
        let [one, two] = self.exit;
        let before = [0, 1].map(|i| scene.bodies[i].velocity);
        let rebound = (two[0] - one[0]) / (before[0][0] - before[1][0]);
        findings.add(name, "rebound: velocity of separation over that of approach", rebound, None);
        let [kinetic, elastic, transfer] = self.left;
        findings.add(name, "kinetic energy in the end over that at t = 0", kinetic, None);
        findings.add(name, "elastic energy in the end over the energy at t = 0", elastic, None);
        findings.add(name, "loss of the transfers over the energy at t = 0", transfer, None);
        findings.add(name, "energy lost in contact over the energy at t = 0", books.loss / initial, None);
        let lost = (books.loss + books.transfer - books.friction) / initial;
        let quantity = "energy lost in contact and transfers, without friction, over the energy at t = 0";
        findings.add(name, quantity, lost, zero("elastic bodies"));
        findings.add(name, "energy lost to friction over the energy at t = 0", books.friction / initial, None);
        let decrease = books.friction_decrease / initial;
        findings.add(name, "largest decrease of the friction loss in a step over the energy at t = 0", decrease, None);
    }
}

/// Half the distance of the middles of two bodies, m.
fn distance(scene: &Scene) -> f64 {
    let middle = |i: usize| {
        let (low, high) = scene.bodies[i].shape.bounding_box();
        [0, 1].map(|d| 0.5 * (low[d] + high[d]))
    };
    let (a, b) = (middle(0), middle(1));
    0.5 * (b[0] - a[0]).hypot(b[1] - a[1])
}
