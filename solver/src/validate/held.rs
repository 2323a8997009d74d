//! What conditions on sides of the mesh and on edges of bodies prescribe, compared with each other.

use super::findings::Findings;
use crate::dynamics::surface::curve_of;
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Boundary, EdgeCondition, Hold, Mesh, Prescribed, Shape};

/// Distance within which two places are one, of the size of an edge.
const NEAR: f64 = 1e-9;

/// What is prescribed on a part of a curve, and by whom.
pub(super) struct Held<'a> {
    who: String,
    curve: BoundaryEdge,
    part: [f64; 2],
    hold: Hold,
    prescribed: &'a Prescribed,
}

impl<'a> Held<'a> {
    pub(super) fn on_edge(
        i: usize,
        EdgeCondition { edge, hold, prescribed, .. }: &'a EdgeCondition,
        body: &Body,
    ) -> Self {
        let (curve, part) = curve_of(body, edge);
        Self { who: format!("condition.{i}"), curve, part, hold: *hold, prescribed }
    }

    pub(super) fn on_side(i: usize, boundary: &'a Boundary, mesh: &Mesh) -> Self {
        let (min, max) = (mesh.origin(), mesh.end());
        let [mut a, mut b] = Shape::Rectangle { min, max }.side(boundary.side).unwrap_or_default();
        if let Some([from, to]) = boundary.part {
            let along = boundary.side.along();
            (a[along], b[along]) = (from, to);
        }
        Self {
            who: format!("boundary.{i}"),
            curve: BoundaryEdge::Line([a, b]),
            part: [0.0, 1.0],
            hold: Hold::Components(boundary.fix),
            prescribed: &boundary.prescribed,
        }
    }

    /// An error of the key if both prescribe the same component on a part, or, where they `join`, other
    /// motions of the place where they meet.
    pub(super) fn compare(&self, other: &Self, join: bool, key: &str, findings: &mut Findings) {
        if self.shares_component_with(other) && (self.overlaps(other) || other.overlaps(self)) {
            let message = format!("this motion is prescribed on a part of this edge by {} too", other.who);
            findings.error(format!("{key}.fix"), message, "remove one of the two");
        } else if let (Some(d), true) = (self.contradicts(other), join && (self.meets(other) || other.meets(self))) {
            let message = format!("{} prescribes another motion in {} where this edge ends", other.who, ["x", "y"][d]);
            let remedy = "give both the same motion, or leave a gap of a cell between them";
            findings.error(format!("{key}.fix"), message, remedy);
        }
    }

    fn shares_component_with(&self, other: &Self) -> bool {
        match [self.hold, other.hold] {
            [Hold::Components(a), Hold::Components(b)] => (0..2).any(|d| a[d] && b[d]),
            _ => true,
        }
    }

    /// A component to which both give different motions.
    fn contradicts(&self, other: &Self) -> Option<usize> {
        let [Hold::Components(a), Hold::Components(b)] = [self.hold, other.hold] else { return None };
        (0..2).find(|&d| a[d] && b[d] && self.prescribed.course(d) != other.prescribed.course(d))
    }

    /// Whether an end of it is on the other.
    fn meets(&self, other: &Self) -> bool {
        self.part.iter().any(|end| other.holds(self.curve.at(*end).0))
    }

    /// Whether more than places of it are on the other.
    fn overlaps(&self, other: &Self) -> bool {
        let [from, to] = self.part;
        let ends = other.part.map(|end| self.curve.place_of(other.curve.at(end).0));
        let ends = ends.into_iter().map(|place| self.curve.place_after(from, place));
        let mut places: Vec<f64> = ends.filter(|s| (from..=to).contains(s)).chain([from, to]).collect();
        places.sort_by(f64::total_cmp);
        let mut parts = places.windows(2).filter(|pair| pair[1] - pair[0] > NEAR * (to - from));
        parts.any(|pair| other.holds(self.curve.at(0.5 * (pair[0] + pair[1])).0))
    }

    /// Whether a position (m) is on it.
    fn holds(&self, position: [f64; 2]) -> bool {
        let [from, to] = self.part;
        let place = self.curve.place_after(from, self.curve.place_of(position));
        let [x, y] = self.curve.at(place).0;
        (from - NEAR..=to + NEAR).contains(&place)
            && (position[0] - x).hypot(position[1] - y) <= NEAR * self.curve.length()
    }
}
