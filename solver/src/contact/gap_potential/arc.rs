//! The boundary of a body as cubics through places and tangents, and the place nearest to another one.

use crate::linear_algebra::extremes::{around, larger};
use crate::linear_algebra::vectors::dot;
use crate::scene::Layout;
use crate::splines::quadrature::Rule;

/// Gauss points of an arc.
const POINTS: usize = 4;
/// Parts with as many each of an arc of a rigid body near a corner of another body: corners that dig into it
/// are smaller than a span, and with fewer points a floor without friction brakes a body that slides on one.
const RIGID_PARTS: usize = 8;
/// Cosine of the angle between arcs that follow each other up to which there is a corner between them.
pub(crate) const CORNER: f64 = 0.9;
/// Square of the distance of their ends, in lengths of an arc, from which on they are of different lines.
const APART: f64 = 0.25;
/// Divisions of an arc whose ends are looked at for the nearest place: a crushed corner bends its arcs far.
const LOOKS: usize = 16;
/// Corrections of that place, and what is near enough, in arcs.
const CORRECTIONS: usize = 100;
const CLOSE: f64 = 1e-13;

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
    /// Position on the boundary, m.
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

    /// Position on the arc at the parameter t from 0 to 1, m.
    pub(crate) fn position(&self, t: f64) -> [f64; 2] {
        let [c0, c1, c2, c3] = self.powers;
        [0, 1].map(|d| c0[d] + t * (c1[d] + t * (c2[d] + t * c3[d])))
    }

    /// Outward unit normal at t.
    pub(crate) fn normal(&self, t: f64) -> [f64; 2] {
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

    /// The Gauss points of `rule` on the arc, with the lengths that they stand for at t = 0.
    pub(crate) fn places<'a>(&'a self, rule: &'a Rule) -> impl Iterator<Item = BoundaryPlace> + 'a {
        let place = |(&t, &length)| BoundaryPlace { position: self.position(t), normal: self.normal(t), length };
        rule.points.iter().zip(&self.lengths).map(place)
    }

    /// The same arc after a rigid motion, by what that does to positions and to directions.
    pub(crate) fn moved(&self, place: impl Fn([f64; 2]) -> [f64; 2], turn: impl Fn([f64; 2]) -> [f64; 2]) -> Self {
        let [c0, c1, c2, c3] = self.powers;
        Self { powers: [place(c0), turn(c1), turn(c2), turn(c3)], ..*self }
    }

    /// Its ends, and between them the other two corners of the polygon that controls it, m.
    pub(crate) fn control_polygon(&self) -> [[f64; 2]; 4] {
        let ends = [self.position(0.0), self.position(1.0)];
        let [s, t] = [self.tangent(0.0), self.tangent(1.0)];
        let inner = [[0, 1].map(|d| ends[0][d] + s[d] / 3.0), [0, 1].map(|d| ends[1][d] - t[d] / 3.0)];
        [ends[0], inner[0], inner[1], ends[1]]
    }

    /// Lower left and upper right corner of a box around it, m.
    pub(crate) fn bounds(&self) -> [[f64; 2]; 2] {
        around(self.control_polygon().map(|x| [x, x]))
    }

    /// From a place at t to a position, m.
    fn to(&self, position: [f64; 2], t: f64) -> [f64; 2] {
        let x = self.position(t);
        [0, 1].map(|d| position[d] - x[d])
    }

    /// t at the place nearest to a position, m.
    fn nearest(&self, position: [f64; 2]) -> f64 {
        let square = |t: f64| dot(self.to(position, t), self.to(position, t));
        let squares: [f64; LOOKS + 1] = std::array::from_fn(|i| square(i as f64 / LOOKS as f64));
        let is_least = |i: &usize| {
            let [before, after] = [i.checked_sub(1), Some(i + 1)].map(|at| at.and_then(|at| squares.get(at)));
            [before, after].into_iter().flatten().all(|other| squares[*i] <= *other)
        };
        let places = (0..=LOOKS).filter(is_least).map(|i| self.nearest_between(position, i));
        places.reduce(|best, t| if square(t) < square(best) { t } else { best }).unwrap_or(0.0)
    }

    /// The same beside the division of this number: Newton's method, and halves of what is left where its
    /// steps do not shrink.
    fn nearest_between(&self, position: [f64; 2], number: usize) -> f64 {
        let mut t = number as f64 / LOOKS as f64;
        let [mut low, mut high] = [-1.0, 1.0].map(|side| (t + side / LOOKS as f64).clamp(0.0, 1.0));
        let mut last = high - low;
        for _ in 0..CORRECTIONS {
            let (apart, tangent) = (self.to(position, t), self.tangent(t));
            let slope = -dot(apart, tangent);
            *(if slope > 0.0 { &mut high } else { &mut low }) = t;
            let newton = t - slope / (dot(tangent, tangent) - dot(apart, self.curvature(t)));
            let shrinks = (newton - t).abs() <= 0.5 * last && (low..=high).contains(&newton);
            let next = if shrinks { newton } else { 0.5 * (low + high) };
            last = (next - t).abs();
            t = next;
            if last <= CLOSE {
                break;
            }
        }
        t
    }
}

/// Boundary of a body now.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    /// Arcs of the boundary, in their order along it.
    pub arcs: Vec<Arc>,
    /// Lower left and upper right corner of a box around each arc, m.
    pub boxes: Vec<[[f64; 2]; 2]>,
    /// κ of the body, Pa/m; infinite if it is rigid.
    pub spring: f64,
}

impl Outline {
    /// These arcs, of a body with this κ, Pa/m.
    pub(crate) fn new(arcs: Vec<Arc>, spring: f64) -> Self {
        Self { boxes: arcs.iter().map(Arc::bounds).collect(), arcs, spring }
    }

    /// Places of its corners, m, and where a closed line begins.
    pub(crate) fn corners(&self) -> Vec<[f64; 2]> {
        let before = self.arcs.iter().cycle().skip(self.arcs.len().saturating_sub(1));
        let turns = |(before, arc): &(&Arc, &Arc)| {
            let [apart, tangent] = [before.to(arc.position(0.0), 1.0), arc.tangent(0.0)];
            dot(apart, apart) > APART * dot(tangent, tangent) || dot(before.normal(1.0), arc.normal(0.0)) <= CORNER
        };
        before.zip(&self.arcs).filter(turns).map(|(_, arc)| arc.position(0.0)).collect()
    }

    /// Number, t and place of the points of an arc that look for another body, by the first of two [`rules`];
    /// within a distance (m) of corners by the second one, whose numbers come after those of the first.
    pub(crate) fn places<'a>(
        &'a self,
        number: usize,
        [few, many]: &'a [Rule; 2],
        corners: &[[f64; 2]],
        reach: f64,
    ) -> impl Iterator<Item = (usize, f64, BoundaryPlace)> + use<'a> {
        let (arc, [low, high]) = (&self.arcs[number], self.boxes[number]);
        let is_near = |corner: &[f64; 2]| (0..2).all(|d| (low[d] - reach..=high[d] + reach).contains(&corner[d]));
        let is_divided = corners.iter().any(is_near);
        let (rule, first) = if is_divided { (many, POINTS) } else { (few, 0) };
        rule.points.iter().zip(&rule.weights).enumerate().map(move |(at, (&t, weight))| {
            let [x, y] = arc.tangent(t);
            let length = if is_divided { weight * x.hypot(y) } else { arc.lengths[at] };
            (first + at, t, BoundaryPlace { position: arc.position(t), normal: arc.normal(t), length })
        })
    }

    /// The numbers of the arcs whose boxes meet a region.
    pub(crate) fn within(&self, [low, high]: [[f64; 2]; 2]) -> impl Iterator<Item = usize> + '_ {
        let meets = move |(_, [own_low, own_high]): &(usize, &[[f64; 2]; 2])| {
            (0..2).all(|d| own_high[d] >= low[d] && own_low[d] <= high[d])
        };
        self.boxes.iter().enumerate().filter(meets).map(|(number, _)| number)
    }
}

/// Gauss rule for integrals along an arc of a body that deforms.
pub(crate) fn rule() -> Rule {
    Rule::new(Layout::Gauss, POINTS)
}

/// Rules along an arc: with few points, and with many for arcs of rigid bodies near corners.
pub(crate) fn rules() -> [Rule; 2] {
    let rule = rule();
    let part = |x: f64, number: usize| (number as f64 + x) / RIGID_PARTS as f64;
    let points = (0..RIGID_PARTS).flat_map(|number| rule.points.iter().map(move |x| part(*x, number))).collect();
    let weights = (0..RIGID_PARTS).flat_map(|_| rule.weights.iter().map(|weight| part(*weight, 0))).collect();
    [rule, Rule { points, weights }]
}

/// The nearest place of a boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Closest {
    /// Distance of the place from the given position, m.
    pub distance: f64,
    /// Position on the boundary, m.
    pub position: [f64; 2],
    /// Unit vector towards it.
    pub direction: [f64; 2],
    /// Number of its arc, and t on it: they move with the material.
    pub label: (usize, f64),
}

/// The place nearest to a position, m, among those of some arcs that count by their labels.
pub(crate) fn nearest(
    position: [f64; 2],
    outline: &Outline,
    among: impl Iterator<Item = usize>,
    counts: impl Fn((usize, f64)) -> bool,
) -> Option<Closest> {
    let mut best: Option<Closest> = None;
    for number in among {
        let ([low, high], arc) = (outline.boxes[number], &outline.arcs[number]);
        let beside = [0, 1].map(|d| larger(0.0, larger(low[d] - position[d], position[d] - high[d])));
        if best.is_some_and(|best| dot(beside, beside) > best.distance * best.distance) {
            continue;
        }
        let t = arc.nearest(position);
        let (place, label) = (arc.position(t), (number, t));
        let apart = [0, 1].map(|d| place[d] - position[d]);
        let distance = apart[0].hypot(apart[1]);
        if best.is_none_or(|best| distance < best.distance) && counts(label) {
            best = Some(Closest { distance, position: place, direction: apart.map(|x| x / distance), label });
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_place_of_an_arc_that_bends_far_is_found() {
        // A crushed corner: its end goes in by several times the distance of its beginning.
        let arc = Arc::new([[0.0, 0.0], [-1.0, -1.0]], [[4.0, 1.0], [-4.0, -2.0]], &rule());
        let outline = Outline::new(vec![arc], 1.0);
        let distance = |t: f64, x: [f64; 2]| {
            let place = arc.position(t);
            (place[0] - x[0]).hypot(place[1] - x[1])
        };
        for i in 0..40 {
            for j in 0..40 {
                let x = [-1.5 + 0.06 * f64::from(i), -1.5 + 0.06 * f64::from(j)];
                let found = nearest(x, &outline, 0..1, |_| true).unwrap().distance;
                let is_nearest = |k: i32| found < distance(f64::from(k) / 4000.0, x) + 1e-9;
                assert!((0..=4000).all(is_nearest), "{x:?}: {found}");
            }
        }
    }
}
