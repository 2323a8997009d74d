//! Sides of the mesh that hold material in the updated frame: control points of a side are fixed where the
//! material lies that was on the side at t = 0. What comes there later is free.

use super::grid::NodalFields;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Constraints;
use crate::dynamics::surface::smooth_parts;
use crate::particles::follower::Follower;
use crate::particles::points::OutsidePatch;
use crate::scene::{Body, Boundary, Edge, EdgeCondition, Hold, Shape, Side};
use crate::splines::patch::{Patch, control_points_on};

/// A side that holds a body at rest.
#[derive(Debug, Clone)]
pub(super) struct HeldSide {
    boundary: Boundary,
    /// Places of the material on the side; absent: all of the side is held.
    material: Option<Vec<Follower>>,
}

impl HeldSide {
    /// The side where a body lies on it at t = 0, if it does.
    pub(super) fn with_material(patch: &Patch, body: &Body, boundary: &Boundary) -> Option<Self> {
        let material = material_on(patch, body, boundary);
        let is_held = fault!("side-holds-across-a-gap", !material.is_empty() => true);
        let material = fault!("side-holds-across-a-gap", Some(material) => None);
        is_held.then(|| Self { boundary: boundary.clone(), material })
    }

    /// Keeps some of the places, by their positions (m).
    pub(super) fn keep(&mut self, keeps: impl Fn([f64; 2]) -> bool) {
        self.material.iter_mut().for_each(|places| places.retain(|place| keeps(place.position)));
    }

    /// Moves material that may slide along the side with the grid over `dt` seconds; whether some of it went
    /// on to other control points.
    ///
    /// # Errors
    /// A place with no material within one span of it.
    pub(super) fn follow(
        &mut self,
        patch: &Patch,
        nodes: &NodalFields,
        density: f64,
        dt: f64,
    ) -> Result<bool, OutsidePatch> {
        let along = self.boundary.side.along();
        let mut went_on = false;
        for place in self.material.iter_mut().flatten().filter(|_| self.boundary.fix != [true; 2]) {
            let reached = |place: &Follower| patch.spaces[along].first_function(place.position[along]);
            let before = reached(place);
            place.attach(patch, &nodes.inverse_mass, density)?;
            place.follow(patch, nodes.grid, &nodes.velocity, dt);
            went_on |= reached(place) != before;
        }
        Ok(went_on)
    }

    /// Control points that are held on a part of the patch.
    fn held(&self, part: &Patch) -> Vec<usize> {
        let (grid, side) = (part.control_grid(), self.boundary.side);
        let all = control_points_on(side, grid);
        let Some(places) = &self.material else { return all };
        let along = side.along();
        let space = &part.spaces[along];
        let mut reached = vec![false; all.len()];
        for first in places.iter().filter_map(|place| space.first_function(place.position[along])) {
            reached[first..=first + space.degree()].fill(true);
        }
        all.into_iter().zip(reached).filter_map(|(at, reached)| reached.then_some(at)).collect()
    }

    /// Stores or takes up where the material is.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.material.iter_mut().flatten().try_for_each(|place| archive.value(&mut place.position))
    }
}

/// Whether a body lies on a side, or on a part of it.
pub(crate) fn lies_on(patch: &Patch, body: &Body, boundary: &Boundary) -> bool {
    !material_on(patch, body, boundary).is_empty()
}

/// Places on a side, or on a part of it, where a body lies on it.
fn material_on(patch: &Patch, body: &Body, boundary: &Boundary) -> Vec<Follower> {
    let parts = smooth_parts(patch, body, &edge_of(patch, boundary));
    let places = parts.iter().flatten().filter(|point| body.shape.contains(point.inner));
    places.map(|point| Follower::new(point.position)).collect()
}

/// Whether a condition is one on control points of a side: all of the side is at rest, and material cannot
/// leave it.
pub(crate) fn is_fixed(boundary: &Boundary) -> bool {
    let (across, _) = boundary.side.axis();
    boundary.fix[across] && boundary.prescribed.is_at_rest() && boundary.part.is_none() && boundary.name.is_none()
}

/// A condition on a side as one on the edge of a body there.
pub(super) fn as_edge(patch: &Patch, boundary: &Boundary) -> EdgeCondition {
    EdgeCondition {
        name: boundary.name.clone(),
        edge: edge_of(patch, boundary),
        hold: Hold::Components(boundary.fix),
        prescribed: boundary.prescribed.clone(),
    }
}

/// The segment of a side, or of a part of it.
fn edge_of(patch: &Patch, boundary: &Boundary) -> Edge {
    let spans = [0, 1].map(|d| patch.spaces[d].spans());
    let whole = Shape::Rectangle { min: spans.map(|s| s[0].left), max: spans.map(|s| s[s.len() - 1].right) };
    let mut segment = whole.side(boundary.side).unwrap_or_default();
    if let Some(part) = boundary.part {
        let along = boundary.side.along();
        segment.iter_mut().zip(part).for_each(|(end, at)| end[along] = at);
    }
    Edge::Segment(segment)
}

/// What the sides hold on a part of the patch that begins at an [`origin`](super::fragments::origin).
pub(super) fn constraints(whole: &Patch, part: &Patch, origin: [usize; 2], sides: &[HeldSide]) -> Constraints {
    let reached = |side: Side| {
        let (d, upper) = side.axis();
        let [all, own] = [whole, part].map(|patch| patch.spaces[d].dimension());
        if upper { origin[d] + own == all } else { origin[d] == 0 }
    };
    let reached: Vec<&HeldSide> = sides.iter().filter(|side| reached(side.boundary.side)).collect();
    let boundaries: Vec<Boundary> = reached.iter().map(|side| side.boundary.clone()).collect();
    let held = |boundary: &Boundary| {
        let of = reached.iter().filter(|side| side.boundary == *boundary);
        of.flat_map(|side| side.held(part)).collect()
    };
    Constraints::new(&boundaries, held)
}
