//! How far bodies move past each other in a step. Contact looks at gaps once per step: what moves further than a span between
//! two looks is through before it is seen.

use crate::extremes::{larger, largest, smaller};
use crate::scene::{Body, Scene};
use crate::spans::smallest_span;

/// Most spans that bodies which meet move relative to each other in a step.
pub const MOST: f64 = 0.5;
/// A gap that could close in the coming step is one within this many of the ways of the last step: speeds change.
pub const AHEAD: f64 = 1.25;

/// Bodies that are about to meet move too far in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooFast {
    /// Between them, m.
    pub place: [f64; 2],
    /// Relative way in a step, in spans.
    pub spans: f64,
}

/// Least and largest way of vertices in each direction, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range([[f64; 2]; 2]);

impl Range {
    /// Of some ways, m.
    pub fn of(ways: impl Iterator<Item = [f64; 2]>) -> Self {
        Self(ways.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], way| {
            [[0, 1].map(|d| smaller(low[d], way[d])), [0, 1].map(|d| larger(high[d], way[d]))]
        }))
    }

    /// Bound of the relative way of two vertices, m; zero if there are none.
    pub fn past(&self, other: &Self) -> f64 {
        let along = |d: usize| (self.0[1][d] - other.0[0][d]).max(other.0[1][d] - self.0[0][d]).max(0.0);
        along(0).hypot(along(1))
    }
}

/// Longest step, s, in which no two bodies of a scene with contact move past each other by more than [`MOST`] spans, by the
/// velocities they begin with; infinite without contact.
pub fn longest_step(scene: &Scene) -> f64 {
    if scene.contact.is_none() {
        return f64::INFINITY;
    }
    // about the middle of the box around a body
    let spin = |body: &Body| {
        let (low, high) = body.shape.bounding_box();
        0.5 * body.angular_velocity.abs() * (high[0] - low[0]).hypot(high[1] - low[1])
    };
    let bodies = || scene.bodies.iter().enumerate();
    let pairs = bodies().flat_map(|(i, a)| bodies().skip(i + 1).map(move |(_, b)| (a, b)));
    let speeds = pairs.filter(|(a, b)| !(a.rigid && b.rigid)).map(|(a, b)| {
        let [x, y] = [0, 1].map(|d| a.velocity[d] - b.velocity[d]);
        x.hypot(y) + spin(a) + spin(b)
    });
    MOST * smallest_span(&scene.mesh) / largest(speeds)
}
