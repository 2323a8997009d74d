//! A block or a disc on a rigid plane that is not level.
//!
//! With g_n and g_s the parts of gravity into the plane and down the slope, and Coulomb friction mu:
//!
//! ```text
//! block    a = max(g_s − mu g_n, 0)
//! disc     a = 2/3 g_s,          alpha = a/R              if g_s <= 3 mu g_n: it rolls
//!          a = g_s − mu g_n,     alpha = 2 mu g_n/R       otherwise: it slips
//! ```
//!
//! A body that starts in touch with the plane when gravity begins to act vibrates about this motion, and
//! loses touch now and then. Accelerations are therefore slopes of straight lines through the origin, fitted
//! to the velocity of the centre of mass and to the spin of the points, `Σ m r × v/Σ m r²`, at all steps.

use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::dynamics::updated_frame::field::DiscreteField;
use fisura::scene::{Scene, Shape};

use super::{Books, center, chart, cross, curve, dot, exact, run, sample_is_due};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

/// Rows of a series.
const ROWS: usize = 200;

pub(in super::super) fn offers(_case: &Case, scenes: &[CaseScene]) -> crate::study::Offered {
    let mut offers = crate::study::Offers::default();
    for CaseScene { name, scene, .. } in scenes {
        let slope = Slope::of(scene)?;
        if slope.acceleration() > 0.0 {
            offers.held(name, ["acceleration down the slope over the closed form"]);
        } else {
            offers.held(
                name,
                [
                    "acceleration down the slope over that without friction",
                    "creep down the slope over the length of the body",
                ],
            );
        }
        offers.held(
            name,
            slope.spin().map(|spin| match spin > 0.0 {
                true => "angular acceleration over the closed form",
                false => "angular acceleration times diameter over the acceleration",
            }),
        );
        offers.held(name, ["velocity out of the plane in the end over that of free fall"]);
        offers.bare(
            name,
            [
                "energy that friction took over the largest energy",
                "largest decrease of it in a step over the largest energy",
                "closure of the energy ledger over the largest energy",
            ],
        );
    }
    Ok(offers)
}

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = vec![];
    for CaseScene { name, scene, .. } in scenes {
        let slope = Slope::of(scene)?;
        let found = slope.descend(scene)?;
        slope.add(&found, name, &mut findings);
        let stem = format!("{}-velocity", series_stem(case, name));
        curves.push(curve(name, &stem, ["time_s", "velocity_m_per_s"], CurveStyle::Line));
        curves.push(curve(
            &format!("{name}, closed form"),
            &stem,
            ["time_s", "closed_form_m_per_s"],
            CurveStyle::Reference,
        ));
        let mut table = Table::new(&["time_s", "velocity_m_per_s", "closed_form_m_per_s"]);
        let every = found.velocities.len().div_ceil(ROWS).max(1);
        found.velocities.iter().step_by(every).for_each(|[t, v]| table.push(&[*t, *v, slope.acceleration() * t]));
        findings.series.push((stem, table));
    }
    let axes = ["time (s)", "velocity of the centre of mass (m/s)"];
    findings.figures.push(chart(case, "velocity", "Velocity down the slope", "", axes, curves));
    Ok(findings)
}

/// A body on a plane.
struct Slope {
    /// Unit vectors: out of the plane, and down the slope.
    normal: [f64; 2],
    down: [f64; 2],
    /// Gravity into the plane and down the slope, m/s².
    gravity: [f64; 2],
    friction: f64,
    /// Radius of a disc, m.
    radius: Option<f64>,
    /// Length of the body, m.
    length: f64,
}

/// What a run gave.
struct Descent {
    /// Acceleration down the slope, m/s², and angular acceleration in the sense of rolling down, rad/s².
    acceleration: f64,
    spin: f64,
    /// Velocity out of the plane in the end, m/s.
    out: f64,
    /// Way of the centre of mass down the slope, m.
    way: f64,
    books: Books,
    /// Time (s) and velocity down the slope (m/s) after every step.
    velocities: Vec<[f64; 2]>,
}

impl Slope {
    fn of(scene: &Scene) -> Result<Self, StudyError> {
        let bodies = || scene.bodies.iter();
        let (Some(body), Some(floor)) = (bodies().find(|b| !b.rigid), bodies().find(|b| b.rigid)) else {
            return Err(StudyError::Other("this study takes a body and a rigid floor".into()));
        };
        let (low, high) = body.shape.bounding_box();
        let middle = [0, 1].map(|d| 0.5 * (low[d] + high[d]));
        let normal = facing(&floor.shape, middle).ok_or_else(|| StudyError::Other("the floor has no edge".into()))?;
        let g = scene.analysis.gravity;
        let along = [-normal[1], normal[0]];
        let down = if dot(g, along) >= 0.0 { along } else { along.map(|x| -x) };
        let radius = if let Shape::Disk { radius, .. } = body.shape { Some(radius) } else { None };
        let friction = scene.contact.as_ref().map_or(0.0, |contact| contact.friction);
        let gravity = [-dot(g, normal), dot(g, down)];
        Ok(Self { normal, down, gravity, friction, radius, length: high[0] - low[0] })
    }

    fn rolls(&self) -> bool {
        self.radius.is_some() && self.gravity[1] <= 3.0 * self.friction * self.gravity[0]
    }

    /// Acceleration of the closed form, m/s².
    fn acceleration(&self) -> f64 {
        let [into, along] = self.gravity;
        if self.rolls() { 2.0 / 3.0 * along } else { (along - self.friction * into).max(0.0) }
    }

    /// Angular acceleration of the closed form, rad/s².
    fn spin(&self) -> Option<f64> {
        let radius = self.radius?;
        let surface = if self.rolls() { self.acceleration() } else { 2.0 * self.friction * self.gravity[0] };
        Some(surface / radius)
    }

    fn descend(&self, scene: &Scene) -> Result<Descent, StudyError> {
        let start = |frame: &UpdatedFrame| center(&frame.fields()[0]);
        let (mut first, mut spins) = (None, vec![]);
        let mut found = Descent {
            acceleration: f64::NAN,
            spin: f64::NAN,
            out: f64::NAN,
            way: f64::NAN,
            books: Books::default(),
            velocities: vec![],
        };
        run(scene, &mut |simulation, frame| {
            let (field, step) = (&frame.fields()[0], simulation.plan().step);
            let (time, mass, middle) = (frame.time(), field.mass(), center(field));
            let first = *first.get_or_insert_with(|| start(frame));
            found.way = dot([0, 1].map(|d| middle[d] - first[d]), self.down);
            found.books.step(frame);
            if sample_is_due(simulation) {
                found.books.enter(&simulation.sample());
            }
            // The velocities of the points are half a step back.
            let momentum = field.momentum();
            if simulation.steps() > 0 {
                let back = time - 0.5 * step;
                found.velocities.push([back, dot(momentum, self.down) / mass]);
                spins.push([back, cross(self.normal, self.down) * spin(field, middle)]);
                found.out = dot(momentum, self.normal) / mass;
            }
        })?;
        (found.acceleration, found.spin) = (slope_through_origin(&found.velocities), slope_through_origin(&spins));
        Ok(found)
    }

    fn add(&self, found: &Descent, name: &str, findings: &mut Findings) {
        let down = found.acceleration;
        let expected = self.acceleration();
        if expected > 0.0 {
            let quantity = "acceleration down the slope over the closed form";
            findings.add(name, quantity, down / expected, exact(1.0, "Newton and Coulomb"));
        } else {
            let zero = || exact(0.0, "friction holds the block");
            findings.add(
                name,
                "acceleration down the slope over that without friction",
                down / self.gravity[1],
                zero(),
            );
            findings.add(name, "creep down the slope over the length of the body", found.way / self.length, zero());
        }
        if let Some(spin) = self.spin() {
            if spin > 0.0 {
                let over = found.spin / spin;
                findings.add(name, "angular acceleration over the closed form", over, exact(1.0, "Newton and Coulomb"));
            } else {
                let over = found.spin * self.length / self.gravity[1];
                let quantity = "angular acceleration times diameter over the acceleration";
                findings.add(name, quantity, over, exact(0.0, "no friction turns it"));
            }
        }
        let time = found.velocities.last().map_or(f64::NAN, |[time, _]| *time);
        let out = found.out / (self.gravity[0] * time);
        findings.add(name, "velocity out of the plane in the end over that of free fall", out, exact(0.0, "it stays"));
        let books = &found.books;
        let scale = books.energy;
        findings.add(name, "energy that friction took over the largest energy", books.friction / scale, None);
        findings.add(
            name,
            "largest decrease of it in a step over the largest energy",
            books.friction_decrease / scale,
            None,
        );
        findings.add(name, "closure of the energy ledger over the largest energy", books.closure / scale, None);
    }
}

/// Angular velocity of the points of a body about a position (m), rad/s.
fn spin(field: &DiscreteField, about: [f64; 2]) -> f64 {
    let mean = field.momentum().map(|p| p / field.mass());
    let parts = field.points().iter().map(|p| {
        let arm = [0, 1].map(|d| p.position[d] - about[d]);
        let velocity = [0, 1].map(|d| p.velocity[d] - mean[d]);
        [p.volume * cross(arm, velocity), p.volume * dot(arm, arm)]
    });
    let [moment, inertia] = parts.fold([0.0; 2], |[a, b], [x, y]| [a + x, b + y]);
    moment / inertia
}

/// Slope of the straight line through the origin that is nearest to points (t, y).
fn slope_through_origin(rows: &[[f64; 2]]) -> f64 {
    rows.iter().map(|[t, y]| t * y).sum::<f64>() / rows.iter().map(|[t, _]| t * t).sum::<f64>()
}

/// Outward unit normal of the edge of a floor that is nearest to a position (m).
fn facing(floor: &Shape, position: [f64; 2]) -> Option<[f64; 2]> {
    let corners = match floor {
        Shape::Rectangle { min, max } => vec![*min, [max[0], min[1]], *max, [min[0], max[1]]],
        Shape::Polygon { points } => points.clone(),
        _ => return None,
    };
    let side = |[a, b]: [[f64; 2]; 2]| {
        let along = [b[0] - a[0], b[1] - a[1]];
        let offset = [position[0] - a[0], position[1] - a[1]];
        let t = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
        let away = [0, 1].map(|d| offset[d] - t * along[d]);
        let length = dot(along, along).sqrt();
        let normal = [along[1] / length, -along[0] / length];
        // The position is outside: the normal points to it, however the corners are ordered.
        let normal = if dot(normal, away) >= 0.0 { normal } else { normal.map(|x| -x) };
        (dot(away, away), normal)
    };
    let edges = (0..corners.len()).map(|i| [corners[i], corners[(i + 1) % corners.len()]]);
    edges.map(side).min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, normal)| normal)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slope(friction: f64, radius: Option<f64>) -> Slope {
        let gravity = [8.0, 6.0];
        Slope { normal: [0.0, 1.0], down: [1.0, 0.0], gravity, friction, radius, length: 1.0 }
    }

    #[test]
    fn the_closed_forms_meet_where_a_disc_begins_to_slip() {
        let limit = 0.25; // 6 = 3 · 0.25 · 8
        let (rolling, slipping) = (slope(limit + 1e-9, Some(0.5)), slope(limit - 1e-9, Some(0.5)));
        assert!(rolling.rolls() && !slipping.rolls());
        assert!((rolling.acceleration() - slipping.acceleration()).abs() < 1e-7);
        assert!((rolling.spin().unwrap() - slipping.spin().unwrap()).abs() < 1e-6);
        assert_eq!(slope(0.0, Some(0.5)).spin(), Some(0.0));
        assert_eq!((slope(0.5, None).acceleration(), slope(1.0, None).acceleration()), (2.0, 0.0));
    }

    #[test]
    fn a_line_through_the_origin_ignores_ripples() {
        let rows: Vec<[f64; 2]> =
            (0..1000).map(|i| i as f64 * 1e-3).map(|t| [t, 3.0 * t + 0.01 * (300.0 * t).sin()]).collect();
        assert!((slope_through_origin(&rows) - 3.0).abs() < 1e-3);
    }

    #[test]
    fn the_floor_faces_the_body_whatever_the_order_of_its_corners() {
        let mut points = vec![[0.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
        for _ in 0..2 {
            let normal = facing(&Shape::Polygon { points: points.clone() }, [0.6, 0.7]).unwrap();
            assert!((normal[0] - 0.5_f64.sqrt()).abs() < 1e-15 && (normal[1] - 0.5_f64.sqrt()).abs() < 1e-15);
            points.reverse();
        }
        let floor = Shape::Rectangle { min: [-1.0, -1.0], max: [1.0, 0.0] };
        assert_eq!(facing(&floor, [0.1, 0.2]), Some([0.0, 1.0]));
    }
}
