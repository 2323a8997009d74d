//! Contact of a body in the total frame: its boundary, and forces on it.

use super::TotalFrame;
use super::boundary::MaterialBoundary;
use crate::contact::gap_potential::arc::Outline;
use crate::contact::gap_potential::thin_parts::{OwnPairs, ThinParts};
use crate::contact::gap_potential::{GapForce, boundary_stiffness};
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::material_at;
use crate::dynamics::surface::SurfacePoint;
use crate::scene::{Body, Contact, Mesh};

impl TotalFrame {
    /// From now on the boundary may meet others.
    ///
    /// # Errors
    /// If there is no material at a part of the boundary.
    pub(super) fn expect_contact(&mut self, body: &Body, mesh: &Mesh, contact: &Contact) -> Result<(), Failure> {
        let Self { patch, lattice, mass, moduli, density, .. } = self;
        let functions = |point: &SurfacePoint| {
            let bare = Failure::BareBoundary { body: 0, place: point.position };
            material_at(patch, lattice, point, |at| mass.moves(at)).ok_or(bare)
        };
        let (shortest, stiffness) = (patch.shortest_span(), contact.stiffness.unwrap_or(Contact::SOFT));
        let stiffness = boundary_stiffness(stiffness, moduli, *density, shortest);
        let parameters = (shortest, stiffness, contact.friction > 0.0);
        self.boundary = Some(Box::new(MaterialBoundary::new((&body.shape, mesh), parameters, functions)?));
        Ok(())
    }

    /// Which parts of the boundary may meet each other.
    pub(super) fn own_pairs(&self) -> Option<OwnPairs> {
        let arcs = self.boundary.as_ref()?.arcs_at_rest();
        Some(OwnPairs::new(&arcs, |position| self.shape.contains(position)))
    }

    /// Where the body is thin.
    pub(super) fn thin_parts(&self) -> Option<ThinParts> {
        let arcs = self.boundary.as_ref()?.arcs_at_rest();
        Some(ThinParts::new(&arcs, self.patch.shortest_span(), |position| self.shape.contains(position)))
    }

    /// The boundary now, if it may meet others.
    pub(super) fn outline(&self) -> Option<Outline> {
        Some(self.boundary.as_ref()?.outline(&self.displacement))
    }

    /// Takes the force of a pair on this body, which is its `side`, until the accelerations are found.
    pub(super) fn push(&mut self, pair: &GapForce, side: usize) {
        let Self { boundary: Some(boundary), displacement, internal, .. } = self else { return };
        // Internal forces have the other sign.
        let sign = if side == 0 { fault!("gap-force-one-sided", 1.0 => 0.9) } else { -1.0 };
        let force = pair.force.map(|f| sign * f);
        let friction = pair.friction.unwrap_or_default().map(|f| sign * f);
        let sum = [0, 1].map(|d| force[d] + friction[d]);
        // Friction acts at the place of the second body: on the first as a force at its own, and a couple.
        let arm = [0, 1].map(|d| pair.places[1][d] - pair.places[side][d]);
        let couple = fault!("friction-without-its-couple", arm[0] * friction[1] - arm[1] * friction[0] => 0.0);
        let turning = if couple == 0.0 { [0.0; 2] } else { boundary.turning(pair.labels[side], couple, displacement) };
        boundary.push(pair.labels[side], sum, turning, internal);
    }
}
