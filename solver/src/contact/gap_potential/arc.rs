//! The boundary of a body as cubics through places and tangents, and the place nearest to another one.

use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::{dot, unit};
use crate::scene::Layout;
use crate::splines::quadrature::Rule;

/// Gauss points of an arc.
const POINTS: usize = 4;
/// Corrections of the nearest place, and what is near enough, in arcs.
const CORRECTIONS: usize = 20;
const CLOSE: f64 = 1e-13;
/// Distance of ends that are joined, in arcs.
const JOINED: f64 = 1e-6;

/// A step of a boundary as a cubic of t from 0 to 1; the body is to its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arc {
    /// Factors of the powers of t, m.
    powers: [[f64; 2]; 4],
    /// Lengths that its Gauss points stand for at t = 0, m.
    lengths: [f64; POINTS],
}

/// A place on a boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundaryPlace {
    /// m.
    pub position: [f64; 2],
    /// Outward unit normal.
    pub normal: [f64; 2],
    /// Length it stands for at t = 0, m.
    pub length: f64,
}

/// Shares of both ends, and of the tangents there, in the position at t of a cubic.
pub(crate) fn shares(t: f64) -> [f64; 4] {
    let turn = t * t * (3.0 - 2.0 * t);
    [1.0 - turn, turn, t * (1.0 - t).powi(2), t * t * (t - 1.0)]
}

/// Derivatives of [`shares`] by t.
pub(crate) fn tangent_shares(t: f64) -> [f64; 4] {
    let turn = 6.0 * t * (1.0 - t);
    [-turn, turn, (1.0 - t) * (1.0 - 3.0 * t), t * (3.0 * t - 2.0)]
}

impl Arc {
    /// From one end to the other at t = 0; tangents are derivatives with respect to t, m.
    pub(crate) fn new(ends: [[f64; 2]; 2], tangents: [[f64; 2]; 2], rule: &Rule) -> Self {
        let mut arc = Self { powers: Default::default(), lengths: Default::default() }.through(ends, tangents);
        for (at, (t, weight)) in rule.points.iter().zip(&rule.weights).enumerate() {
            let [tx, ty] = arc.tangent(*t);
            arc.lengths[at] = weight * tx.hypot(ty);
        }
        arc
    }

    /// The same material from one end to another.
    pub(crate) fn through(&self, [a, b]: [[f64; 2]; 2], [s, t]: [[f64; 2]; 2]) -> Self {
        let square = [0, 1].map(|d| 3.0 * (b[d] - a[d]) - 2.0 * s[d] - t[d]);
        let cube = [0, 1].map(|d| 2.0 * (a[d] - b[d]) + s[d] + t[d]);
        Self { powers: [a, s, square, cube], lengths: self.lengths }
    }

    /// Position at t, m.
    pub(crate) fn position(&self, t: f64) -> [f64; 2] {
        let [c0, c1, c2, c3] = self.powers;
        [0, 1].map(|d| c0[d] + t * (c1[d] + t * (c2[d] + t * c3[d])))
    }

    /// Outward unit normal at t.
    fn normal(&self, t: f64) -> [f64; 2] {
        let [tx, ty] = self.tangent(t);
        [ty, -tx].map(|x| x / tx.hypot(ty))
    }

    /// Derivative of the position by t, m.
    pub(crate) fn tangent(&self, t: f64) -> [f64; 2] {
        let [_, c1, c2, c3] = self.powers;
        [0, 1].map(|d| c1[d] + t * (2.0 * c2[d] + t * 3.0 * c3[d]))
    }

    fn curvature(&self, t: f64) -> [f64; 2] {
        let [_, _, c2, c3] = self.powers;
        [0, 1].map(|d| 2.0 * c2[d] + t * 6.0 * c3[d])
    }

    /// Its Gauss points.
    pub(crate) fn places<'a>(&'a self, rule: &'a Rule) -> impl Iterator<Item = BoundaryPlace> + 'a {
        let place = |(&t, &length)| BoundaryPlace { position: self.position(t), normal: self.normal(t), length };
        rule.points.iter().zip(&self.lengths).map(place)
    }

    /// The same arc after a rigid motion, by what that does to positions and to directions.
    pub(crate) fn moved(&self, place: impl Fn([f64; 2]) -> [f64; 2], turn: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let [c0, c1, c2, c3] = self.powers;
        Self { powers: [place(c0), turn(c1), turn(c2), turn(c3)], ..*self }
    }

    /// Lower left and upper right corner of a box around it, m.
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        let ends = [self.position(0.0), self.position(1.0)];
        let [s, t] = [self.tangent(0.0), self.tangent(1.0)];
        let inner = [[0, 1].map(|d| ends[0][d] + s[d] / 3.0), [0, 1].map(|d| ends[1][d] - t[d] / 3.0)];
        around(ends.into_iter().chain(inner).map(|x| [x, x]))
    }

    /// The place nearest to a position, m: t, and the square of the distance, m².
    fn nearest(&self, position: [f64; 2]) -> (f64, f64) {
        let from = |t: f64| {
            let x = self.position(t);
            [0, 1].map(|d| x[d] - position[d])
        };
        let [start, end] = [from(0.0), from(1.0)];
        let along = [0, 1].map(|d| end[d] - start[d]);
        let mut t = (-dot(start, along) / dot(along, along)).clamp(0.0, 1.0);
        for _ in 0..CORRECTIONS {
            let (apart, tangent) = (from(t), self.tangent(t));
            let slope = dot(apart, tangent);
            let curved = dot(tangent, tangent) + dot(apart, self.curvature(t));
            let next = (t - slope / larger(curved, 0.1 * dot(tangent, tangent))).clamp(0.0, 1.0);
            let change = (next - t).abs();
            t = next;
            if change <= CLOSE {
                break;
            }
        }
        let apart = from(t);
        (t, dot(apart, apart))
    }
}

/// Boundary of a body now.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    /// Its arcs.
    pub arcs: Vec<Arc>,
    /// Boxes around them.
    pub boxes: Vec<[[f64; 2]; 2]>,
    /// κ of the body, Pa/m; infinite if it is rigid.
    pub spring: f64,
}

impl Outline {
    /// These arcs, of a body with this κ, Pa/m.
    pub(crate) fn new(arcs: Vec<Arc>, spring: f64) -> Self {
        Self { boxes: arcs.iter().map(Arc::bounds).collect(), arcs, spring }
    }

    /// The numbers of the arcs whose boxes meet a region.
    pub(crate) fn within(&self, [low, high]: [[f64; 2]; 2]) -> impl Iterator<Item = usize> + '_ {
        let meets = move |(_, [own_low, own_high]): &(usize, &[[f64; 2]; 2])| {
            (0..2).all(|d| own_high[d] >= low[d] && own_low[d] <= high[d])
        };
        self.boxes.iter().enumerate().filter(meets).map(|(number, _)| number)
    }
}

/// The box around some boxes.
pub(crate) fn around(boxes: impl Iterator<Item = [[f64; 2]; 2]>) -> [[f64; 2]; 2] {
    boxes.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], [other_low, other_high]| {
        [[0, 1].map(|d| smaller(low[d], other_low[d])), [0, 1].map(|d| larger(high[d], other_high[d]))]
    })
}

/// Rule along an arc.
pub(crate) fn rule() -> Rule {
    Rule::new(Layout::Gauss, POINTS)
}

/// The nearest place of a boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closest {
    /// How deep the position is inside the body, m; negative outside.
    pub depth: f64,
    /// m.
    pub position: [f64; 2],
    /// Outward unit normal there.
    pub normal: [f64; 2],
    /// Number of its arc, and t on it: they move with the material.
    pub label: (usize, f64),
}

/// The place nearest to a position among some arcs of an outline.
pub(crate) fn nearest(position: [f64; 2], outline: &Outline, among: &[usize]) -> Option<Closest> {
    let mut best: Option<(f64, usize, f64)> = None;
    for &number in among {
        let ([low, high], arc) = (outline.boxes[number], &outline.arcs[number]);
        let beside = [0, 1].map(|d| larger(0.0, larger(low[d] - position[d], position[d] - high[d])));
        if best.is_some_and(|(least, ..)| dot(beside, beside) > least) {
            continue;
        }
        let (t, square) = arc.nearest(position);
        if best.is_none_or(|(least, ..)| square < least) {
            best = Some((square, number, t));
        }
    }
    let (square, number, t) = best?;
    let arc = &outline.arcs[number];
    let place = arc.position(t);
    let own = arc.normal(t);
    // At a corner neither normal tells inside from outside, but the mean of both does (Bærentzen & Aanæs
    // 2005, *Signed distance computation using the angle weighted pseudonormal*).
    let next = if t == 0.0 || t == 1.0 { beside(number, place, 1.0 - t, outline, among) } else { None };
    let normal = unit(next.map_or(own, |next| [0, 1].map(|d| own[d] + next[d])))?;
    let inside = dot([0, 1].map(|d| position[d] - place[d]), normal) < 0.0;
    let depth = if inside { square.sqrt() } else { -square.sqrt() };
    Some(Closest { depth, position: place, normal, label: (number, t) })
}

/// Normal of the arc that begins or ends, as t has it, where another one does not go on.
fn beside(number: usize, place: [f64; 2], t: f64, outline: &Outline, among: &[usize]) -> Option<[f64; 2]> {
    let joins = |arc: &Arc| {
        let apart = [0, 1].map(|d| arc.position(t)[d] - place[d]);
        let along = [0, 1].map(|d| arc.position(1.0 - t)[d] - place[d]);
        dot(apart, apart) <= JOINED * JOINED * dot(along, along)
    };
    let mut others = among.iter().filter(|other| **other != number).map(|other| &outline.arcs[*other]);
    others.find(|arc| joins(arc)).map(|arc| arc.normal(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn beside_an_acute_corner_is_outside() {
        // A body above the line y = 0, left of a line that leans to the left: a corner sharper than 90°.
        let corner = [0.0, 0.0];
        let below = Arc::new([[-1.0, 0.0], corner], [[1.0, 0.0]; 2], &rule());
        let beside = Arc::new([corner, [-0.1, 1.0]], [[-0.1, 1.0]; 2], &rule());
        let outline = Outline::new(vec![below, beside], 1.0);
        for order in [[0, 1], [1, 0]] {
            let depth = |position| nearest(position, &outline, &order).unwrap().depth;
            assert!(depth([0.5, 0.01]) < 0.0);
            assert!(depth([0.2, -0.5]) < 0.0);
            assert!((depth([-0.3, 0.1]) - 0.1).abs() < 1e-12);
        }
    }
}
