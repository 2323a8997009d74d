//! How far bodies approach each other in a step, and how deep they may be in each other. Contact looks at
//! gaps once per step: what closes more than a span between two looks is through before it is seen. Bodies
//! that slide along each other, turn in each other or part are not.

use thiserror::Error;

use super::outline::{ShapeIntegrals, perimeter, without_patch};
use super::surface::{Center, Surface};
use crate::linear_algebra::extremes::{larger, largest, smaller};
use crate::particles::spans::smallest_span;
use crate::scene::{Body, Frame, Mesh, Scene};

/// Most spans by which bodies that meet approach each other in a step.
pub(crate) const MOST: f64 = 0.5;
/// A gap that could close in the coming step is one within this many of the displacements of the last step:
/// speeds change.
pub(crate) const AHEAD: f64 = 1.25;
/// Segments into which a boundary is cut to find its outward speed. That of a polygon is largest at a corner,
/// where a segment ends; of a circle cut in so many, whose own is zero, 1 % of the speed at the rim is found.
const SEGMENTS: f64 = 256.0;
/// Relative round-off of places and speeds at the start.
const ROUND_OFF: f64 = 1e-9;

/// Boundaries whose contact cannot be followed.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum NotFollowed {
    /// Bodies that are about to meet approach each other too far in a step.
    #[error(
        "bodies that are about to meet approach each other by {spans:.3} spans in a step, and contact follows {MOST}"
    )]
    TooFast {
        /// Middle of a boundary segment that approaches another body, m.
        place: [f64; 2],
        /// By how much they approach in a step, in spans.
        spans: f64,
    },
    /// A boundary that is deeper in another body than contact follows.
    #[error("a boundary is {spans:.3} spans deep in another body, and contact follows {follows:.3} there")]
    TooDeep {
        /// Place on the boundary that lies in the other body, m.
        place: [f64; 2],
        /// Depth of that place in the other body, in lengths of the shortest span.
        spans: f64,
        /// Depth that contact follows there, in spans.
        follows: f64,
    },
}

/// A body as it begins to move.
struct Moving<'a> {
    body: &'a Body,
    bounds: [[f64; 2]; 2],
    /// Largest speed with which its boundary moves outwards as it turns and stretches, m/s; that of a disc
    /// that turns hardly does.
    turning: f64,
    /// Smallest and largest factor of its velocities in time.
    factors: [f64; 2],
}

impl<'a> Moving<'a> {
    fn new(scene: &Scene, body: &'a Body) -> Self {
        let mesh = &scene.mesh;
        let (low, high) = without_patch(&body.shape, mesh).bounding_box();
        let turning = if body.is_translated() { 0.0 } else { outward_speed(mesh, body) };
        let factors = body.time.range(scene.analysis.end_time);
        Self { body, bounds: [low, high], turning: turning * largest(factors.map(f64::abs)), factors }
    }

    /// Bound of the speed, m/s, at which it comes nearer to another body; zero for bodies that lie beside
    /// each other, with boxes that do not close on each other.
    fn approach(&self, other: &Self) -> f64 {
        let courses = self.factors.into_iter().flat_map(|own| other.factors.map(|others| [own, others]));
        largest(courses.map(|factors| self.approach_with(other, factors)))
    }

    /// The same, with a factor of the velocity of each.
    fn approach_with(&self, other: &Self, [own, others]: [f64; 2]) -> f64 {
        let relative = [0, 1].map(|d| others * other.body.velocity[d] - own * self.body.velocity[d]);
        let turning = self.turning + other.turning;
        let most = relative[0].hypot(relative[1]) + turning;
        let beside = |d: usize| {
            let ([low, high], [other_low, other_high]) = (self.bounds, other.bounds);
            let touching = ROUND_OFF * (high[d] - low[d] + other_high[d] - other_low[d]);
            let is_ahead = other_low[d] >= high[d] - touching && turning - relative[d] <= ROUND_OFF * most;
            let is_behind = low[d] >= other_high[d] - touching && turning + relative[d] <= ROUND_OFF * most;
            is_ahead || is_behind
        };
        if beside(0) || beside(1) { 0.0 } else { most }
    }
}

/// Largest speed, m/s, with which the boundary of a body moves outwards as that turns and stretches about its
/// centroid.
fn outward_speed(mesh: &Mesh, body: &Body) -> f64 {
    let shape = without_patch(&body.shape, mesh);
    let surface = Surface::with_spacing(mesh, body, perimeter(&shape) / SEGMENTS);
    let center = ShapeIntegrals::new(&shape).centroid;
    let speeds = (0..surface.segments.len() as u32).flat_map(|segment| {
        let Center { normal, .. } = surface.center(segment);
        surface.ends(segment).map(|end| {
            let arm = [0, 1].map(|d| end[d] - center[d]);
            let [x, y] = body.relative_velocity(arm);
            x * normal[0] + y * normal[1]
        })
    });
    speeds.fold(0.0, larger)
}

/// Longest step, s, in which no two bodies of a scene with contact approach each other by more than [`MOST`]
/// spans, and in the total frame by as much of half a thin body, by the velocities they begin with; infinite
/// without contact.
pub(crate) fn longest_step(scene: &Scene) -> f64 {
    if scene.contact.is_none() {
        return f64::INFINITY;
    }
    let bodies: Vec<Moving> = scene.bodies.iter().map(|body| Moving::new(scene, body)).collect();
    let speeds = pairs(&bodies).filter(|(a, b)| !(a.body.rigid && b.body.rigid)).map(|(a, b)| a.approach(b));
    let mut followed = smallest_span(&scene.mesh);
    if scene.analysis.frame == Frame::Total {
        let half = |body: &Body| {
            let ShapeIntegrals { area, length, .. } = ShapeIntegrals::new(&without_patch(&body.shape, &scene.mesh));
            area / length // half the thickness of a strip, half the radius of a disc
        };
        followed = scene.bodies.iter().map(half).fold(followed, smaller);
    }
    MOST * followed / largest(speeds)
}

fn pairs<'b, 'a>(bodies: &'b [Moving<'a>]) -> impl Iterator<Item = (&'b Moving<'a>, &'b Moving<'a>)> {
    bodies.iter().enumerate().flat_map(move |(i, a)| bodies[i + 1..].iter().map(move |b| (a, b)))
}

/// The names of two rigid bodies of a scene that may approach each other, if there are such.
pub(crate) fn rigid_bodies_that_approach(scene: &Scene) -> Option<[&str; 2]> {
    let rigid = scene.bodies.iter().filter(|body| body.rigid);
    let bodies: Vec<Moving> = rigid.map(|body| Moving::new(scene, body)).collect();
    pairs(&bodies).find(|(a, b)| a.approach(b) > 0.0).map(|(a, b)| [a, b].map(|moving| moving.body.name.as_str()))
}
