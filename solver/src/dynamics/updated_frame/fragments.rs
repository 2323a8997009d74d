//! Fragments: a body that is cracked through becomes bodies with nodal fields of their own, that part, meet
//! and rub on each other.
//!
//! Intact points hang together along chains of short steps ([`pieces`]). Each group that is large enough for a
//! field of its own becomes a fragment: it takes its points with all they carry, its part of the boundary, and
//! faces along the crack ([`crate::contact::crack_faces`]). Its phase field begins with the control values of
//! the body and is solved for on the fragment alone. Mass and momentum are those of the points, so both are
//! kept. The energy on the grid is not: velocities no longer average over the crack, and no phase field spans
//! it. That change is a loss of its own ([`TransferLosses::partition`](super::losses::TransferLosses)).

mod pieces;

use super::UpdatedFrame;
use super::field::DiscreteField;
use super::part::spans_around;
use crate::checkpoint::{Archive, StateError};
use crate::contact::crack_faces::{Faces, Place};
use crate::dynamics::failure::Failure;
use pieces::{Pieces, SEPARATED, spacing};

/// Steps from one look at the bodies to the next: a crack grows by a few spans in them.
const STEPS_BETWEEN_LOOKS: usize = 16;
/// Area of the smallest fragment, in squares of a span: fewer points have no field of their own.
const LEAST_SPANS: f64 = 9.0;

/// What the fields of the bodies are fragments of.
#[derive(Debug, Clone)]
pub(super) struct Fragments {
    /// Number of the body of each field; the first fields are one of each.
    bodies: Vec<usize>,
    /// Steps since the bodies were looked at.
    steps: usize,
}

impl Fragments {
    /// Of bodies in one piece each.
    pub(super) fn new(bodies: usize) -> Self {
        Self { bodies: (0..bodies).collect(), steps: 0 }
    }

    /// Whether it is time for a look, one step later.
    fn look(&mut self) -> bool {
        self.steps = (self.steps + 1) % STEPS_BETWEEN_LOOKS;
        self.steps == 0
    }
}

impl UpdatedFrame {
    /// Number of the body that a field is of, or is a fragment of.
    pub(super) fn body_of(&self, field: usize) -> usize {
        self.fragments.as_ref().map_or(field, |fragments| fragments.bodies[field])
    }

    /// How many fields there are, if bodies may fall into fragments.
    pub(super) fn count_fragments(&self) -> Option<usize> {
        self.fragments.as_ref().map(|_| self.fields.len())
    }

    /// From time to time, parts the bodies that are cracked through; `dt` is the step in use, s.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    pub(super) fn part_now_and_then(&mut self, dt: f64) -> Result<(), Failure> {
        if self.fragments.as_mut().is_some_and(Fragments::look) { self.part_bodies(dt) } else { Ok(()) }
    }

    /// Parts the bodies whose seeds cut them through.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    pub(super) fn part_at_start(&mut self) -> Result<(), Failure> {
        self.part_bodies(0.0)?;
        self.fields.iter_mut().for_each(DiscreteField::begin_ledger);
        Ok(())
    }

    /// Parts the bodies that are cracked through.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    fn part_bodies(&mut self, dt: f64) -> Result<(), Failure> {
        let Self { fields, contact, fragments: Some(fragments), .. } = self else { return Ok(()) };
        for at in 0..fields.len() {
            let Some(mut parts) = fields[at].part(dt)? else { continue };
            fragments.bodies.resize(fragments.bodies.len() + parts.len() - 1, fragments.bodies[at]);
            fields.extend(parts.drain(1..));
            fields.splice(at..=at, parts);
            if let Some(contact) = contact {
                contact.forget_impulses();
            }
        }
        Ok(())
    }

    /// Stores or takes up which fields there are, with as many points each.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange_fragments(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { fields, fragments: Some(fragments), .. } = self else { return Ok(()) };
        let bodies = fragments.bodies.iter().copied().max().map_or(0, |last| last + 1);
        let mut points: Vec<usize> = fields.iter().map(|field| field.points.len()).collect();
        archive.value(&mut fragments.steps)?;
        archive.value(&mut fragments.bodies)?;
        archive.value(&mut points)?;
        if archive.is_reader() {
            let all: usize = fields.iter().map(|field| field.points.len()).sum();
            let first = fragments.bodies.iter().take(bodies).copied().eq(0..bodies);
            let known = fragments.bodies.iter().all(|body| *body < bodies);
            let kept = points.iter().try_fold(0_usize, |sum, count| sum.checked_add(*count)) == Some(all);
            if !first || !known || !kept || points.len() != fragments.bodies.len() || points.contains(&0) {
                return Err(StateError("the state is of another scene: its fragments are not of these bodies".into()));
            }
            let whole = fields[..bodies].to_vec();
            *fields = fragments.bodies.iter().map(|body| whole[*body].clone()).collect();
            fields.iter_mut().zip(points).for_each(|(field, count)| field.make_room(count));
        }
        Ok(())
    }
}

impl DiscreteField {
    /// Its fragments, the first with its ledger, if it is cracked through.
    fn part(&self, dt: f64) -> Result<Option<Vec<Self>>, Failure> {
        let Some(fracture) = self.fracture.as_ref().filter(|fracture| fracture.least_phase < SEPARATED) else {
            return Ok(None);
        };
        let least_area = LEAST_SPANS * self.patch.shortest_span().powi(2);
        let Some(pieces) = Pieces::find(&self.points, &fracture.points, least_area) else { return Ok(None) };
        let parts = (0..pieces.count()).map(|piece| self.fragment(&pieces, piece, dt));
        let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
        let kept: f64 = parts.iter().map(|part| part.stored(dt)).sum();
        let first = &mut parts[0];
        (first.ledger, first.losses) = (self.ledger, self.losses);
        first.losses.partition += fault!("partition-unbooked", self.stored(dt) - kept => 0.0);
        first.ledger.transfer_loss = first.losses.sum();
        Ok(Some(parts))
    }

    /// The fragment of one piece, with an empty ledger.
    fn fragment(&self, pieces: &Pieces, piece: u32, dt: f64) -> Result<Self, Failure> {
        let mut part = self.clone();
        part.keep(|at| pieces.of(at) == piece);
        part.occupy(&spans_around(&self.whole, &part.points)?);
        part.sort()?;
        if let Some(fracture) = &mut part.fracture {
            fracture.field.forget_counts();
        }
        part.crack_and_stress()?;
        part.find_accelerations();
        part.begin_ledger();
        part.travelled = f64::INFINITY; // its critical step is another
        if let Some(surface) = &self.surface {
            let place = |(at, point): (usize, &crate::particles::points::Point)| Place {
                position: point.position,
                volume: point.volume,
                own: pieces.of(at) == piece,
            };
            let places: Vec<Place> = self.points.iter().enumerate().map(place).collect();
            let faces = Faces::new(&places, spacing(&self.points));
            part.surface = Some(surface.of_fragment(|place| pieces.at(place) == piece, &faces));
            part.expect_motion(dt);
        }
        Ok(part)
    }

    /// Begins with a ledger of zeros: there was no step yet.
    fn begin_ledger(&mut self) {
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
        }
        some(&mut self.points, &keeps);
        self.fracture.iter_mut().for_each(|fracture| some(&mut fracture.points, &keeps));
        self.affine.iter_mut().for_each(|affine| some(&mut affine.gradients, &keeps));
        self.deformation.iter_mut().for_each(|gradients| some(gradients, &keeps));
    }

    /// Makes room for some number of points, whatever they are.
    fn make_room(&mut self, count: usize) {
        fn room<T: Copy>(items: &mut Vec<T>, count: usize) {
            items.resize(count, items[0]);
        }
        room(&mut self.points, count);
        self.fracture.iter_mut().for_each(|fracture| room(&mut fracture.points, count));
        self.affine.iter_mut().for_each(|affine| room(&mut affine.gradients, count));
        self.deformation.iter_mut().for_each(|gradients| room(gradients, count));
    }
}
