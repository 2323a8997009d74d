//! Fragments: a body that is cracked through becomes bodies with nodal fields of their own, that part, meet
//! and rub on each other.
//!
//! The connected components of the intact points ([`pieces`](super::pieces)) that are large enough for a
//! field of their own become fragments. Each takes its points with all they carry, its part of the
//! boundary, and faces along the crack ([`crate::contact::crack_faces`]). Its phase field begins with the
//! control values of the body and is solved for on the fragment alone. Mass and momentum are those of the
//! points, so both are kept. The energy on the grid is not: velocities no longer average over the crack,
//! and no phase field spans it. That change is a loss of its own
//! ([`TransferLosses::partition`](super::losses::TransferLosses)).

use super::field::DiscreteField;
use super::part::spans_around;
use super::pieces::{Pieces, SEPARATED, spacing};
use crate::contact::crack_faces::{Faces, Place};
use crate::dynamics::failure::Failure;
use crate::particles::points::Point;
use crate::phase_field::PhaseFieldCounts;

/// Steps between checks of the bodies: a crack grows by a few spans in them.
pub(super) const CHECK_INTERVAL: usize = 16;
/// Area of the smallest fragment, in squares of a span: fewer points have no field of their own.
const LEAST_SPANS: f64 = 9.0;

impl DiscreteField {
    /// Its fragments, if it is cracked through; the first takes over its ledger and what its solver counted.
    pub(super) fn part(&self, dt: f64) -> Result<Option<Vec<Self>>, Failure> {
        let Some(fracture) = self.fracture.as_ref().filter(|fracture| fracture.least_phase < SEPARATED) else {
            return Ok(None);
        };
        let least_area = LEAST_SPANS * self.patch.shortest_span().powi(2);
        let Some(pieces) = Pieces::find(&self.points, &fracture.points, least_area) else { return Ok(None) };
        let parts = (0..pieces.count).map(|piece| self.fragment(&pieces, piece, dt));
        let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
        let kept: f64 = parts.iter().map(|part| part.stored(dt)).sum();
        let first = &mut parts[0];
        (first.ledger, first.losses) = (self.ledger, self.losses);
        first.losses.partition += fault!("partition-unbooked", self.stored(dt) - kept => 0.0);
        first.ledger.transfer_loss = first.losses.sum();
        first.fracture.iter_mut().for_each(|part| part.field.counts = part.field.counts.plus(fracture.field.counts));
        Ok(Some(parts))
    }

    /// The fragment of one piece, with an empty ledger.
    fn fragment(&self, pieces: &Pieces, piece: u32, dt: f64) -> Result<Self, Failure> {
        let mut part = self.piece(pieces, piece)?;
        let own = |place| pieces.at(place) == piece;
        part.sides.iter_mut().for_each(|side| side.keep(own));
        part.edges.iter_mut().for_each(|edges| edges.keep(piece == 0, own));
        part.hold_sides();
        if let Some(fracture) = &mut part.fracture {
            fracture.field.counts = PhaseFieldCounts::default();
        }
        part.crack_and_stress()?;
        part.rebuild_grid()?;
        part.travelled = f64::INFINITY; // its critical step is another
        if let Some(surface) = &self.surface {
            let place = |(at, point): (usize, &Point)| Place {
                position: point.position,
                volume: point.volume,
                own: pieces.of(at) == piece,
            };
            let places: Vec<Place> = self.points.iter().enumerate().map(place).collect();
            let faces = Faces::new(&places, spacing(&self.points));
            part.surface = Some(surface.of_fragment(own, &faces));
            part.expect_motion(dt);
        }
        Ok(part)
    }

    /// The field of one piece, sorted, with nodal fields of zeros and an empty ledger.
    pub(super) fn piece(&self, pieces: &Pieces, piece: u32) -> Result<Self, Failure> {
        let mut part = self.clone();
        part.keep(|at| pieces.of(at) == piece);
        part.occupy(&spans_around(&self.whole, &part.points)?);
        part.sort()?;
        part.begin_ledger();
        Ok(part)
    }

    /// Begins with a ledger of zeros: there was no step yet.
    pub(super) fn begin_ledger(&mut self) {
        (self.ledger, self.losses) = Default::default();
    }

    /// Energy that its ledger closes on, J/m.
    fn stored(&self, dt: f64) -> f64 {
        self.sample(dt, &self.nodes.acceleration).stored()
    }

    /// Keeps some of the points; they are to be sorted anew.
    fn keep(&mut self, keeps: impl Fn(usize) -> bool) {
        fn some<T>(items: &mut Vec<T>, keeps: impl Fn(usize) -> bool) {
            let mut number = 0..;
            items.retain(|_| number.next().is_some_and(&keeps));
            items.shrink_to_fit();
        }
        some(&mut self.points, &keeps);
        self.fracture.iter_mut().for_each(|fracture| some(&mut fracture.points, &keeps));
        self.affine.iter_mut().for_each(|affine| some(&mut affine.gradients, &keeps));
        self.deformation.iter_mut().for_each(|gradients| some(gradients, &keeps));
    }

    /// Makes room for some number of points, whatever they are.
    pub(super) fn make_room(&mut self, count: usize) {
        fn room<T: Copy>(items: &mut Vec<T>, count: usize) {
            items.resize(count, items[0]);
        }
        room(&mut self.points, count);
        self.fracture.iter_mut().for_each(|fracture| room(&mut fracture.points, count));
        self.affine.iter_mut().for_each(|affine| room(&mut affine.gradients, count));
        self.deformation.iter_mut().for_each(|gradients| room(gradients, count));
    }
}
