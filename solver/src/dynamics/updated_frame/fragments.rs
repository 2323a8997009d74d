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
//!
//! The nodal fields of a body cover a part of the patch: the spans its points are in, and a margin.

use std::ops::Range;

use super::UpdatedFrame;
use super::field::DiscreteField;
use super::grid::NodalFields;
use super::held_sides::constraints;
use super::pieces::{Pieces, SEPARATED, spacing};
use super::velocity_transfer::VelocityTransfer;
use crate::checkpoint::{Archive, StateError};
use crate::contact::crack_faces::{Faces, Place};
use crate::dynamics::failure::Failure;
use crate::particles::points::{Cells, OutsidePatch, Point};
use crate::phase_field::PhaseFieldCounts;
use crate::splines::patch::Patch;

/// Steps between checks of the bodies: a crack grows by a few spans in them.
pub(super) const CHECK_INTERVAL: usize = 16;

/// Area of the smallest fragment, in squares of a span: fewer points have no field of their own.
const LEAST_SPANS: f64 = 9.0;

/// Spans around those with points, so that the part need not follow every step.
const MARGIN: usize = 4;

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

    /// Moves the part of the patch to where the points are, and sorts them. Nodal fields are rebuilt at every
    /// step; the phase field moves with the part.
    ///
    /// # Errors
    /// A point outside the patch.
    pub(super) fn follow(&mut self) -> Result<(), OutsidePatch> {
        let spans = spans_around(&self.whole, &self.points)?;
        self.occupy(&spans);
        self.cells.sort(&self.patch, &mut self.points)
    }

    /// Spans of the patch that the part consists of.
    pub(super) fn covered_spans(&self) -> [Range<usize>; 2] {
        [0, 1].map(|d| {
            let (whole, part) = (self.whole.spaces[d].spans(), self.patch.spaces[d].spans());
            let first = whole.partition_point(|span| span.left < part[0].left);
            first..first + part.len()
        })
    }

    /// Whether a point is in an outermost span of the part where the patch goes on: its domain may reach
    /// further.
    pub(super) fn reaches_beyond(&self) -> bool {
        let covered = self.covered_spans();
        let inner = [0, 1].map(|d| {
            let spans = self.patch.spaces[d].spans();
            let left = if covered[d].start > 0 { spans[0].right } else { f64::NEG_INFINITY };
            let ends = covered[d].end == self.whole.spaces[d].spans().len();
            left..if ends { f64::INFINITY } else { spans[spans.len() - 1].left }
        });
        self.points.iter().any(|point| (0..2).any(|d| !inner[d].contains(&point.position[d])))
    }

    /// Makes some spans of the patch the part; the points are to be sorted anew.
    pub(super) fn occupy(&mut self, spans: &[Range<usize>; 2]) {
        let (patch, origin) = (self.whole.part(spans), origin(&self.whole, spans));
        let constraints = constraints(&self.whole, &patch, origin, &self.sides);
        let shift = [0, 1].map(|d| origin[d] as isize - self.origin[d] as isize);
        self.nodes = NodalFields::new(&patch, constraints);
        self.velocity_transfer = VelocityTransfer::new(patch.control_grid(), self.velocity_transfer.transfer);
        if let Some(affine) = &mut self.affine {
            affine.follow(&patch);
        }
        if let Some(fracture) = &mut self.fracture {
            fracture.relocate(&patch, shift);
        }
        (self.patch, self.origin) = (patch, origin);
        self.cells = Cells::default();
    }
}

impl UpdatedFrame {
    /// Area of every field (m²), if bodies may fall into fragments.
    pub(super) fn fragment_areas(&self) -> Option<Vec<f64>> {
        let area = |field: &DiscreteField| field.points.iter().map(|point| point.volume).sum();
        self.fragments.as_ref().map(|_| self.fields.iter().map(area).collect())
    }

    /// Parts the bodies that are cracked through, where a check is due; `dt` is the step in use, s.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    pub(super) fn part_if_due(&mut self, dt: f64) -> Result<(), Failure> {
        let is_due = self.fragments.as_mut().is_some_and(|steps| {
            *steps = (*steps + 1) % CHECK_INTERVAL;
            *steps == 0
        });
        if is_due { self.part_bodies(dt) } else { Ok(()) }
    }

    /// Parts the bodies whose seeds cut them through.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    pub(super) fn part_at_start(&mut self) -> Result<(), Failure> {
        self.part_bodies(0.0)?;
        if self.fragments.is_some() {
            self.fields.iter_mut().for_each(DiscreteField::begin_ledger);
        }
        Ok(())
    }

    /// Parts the bodies that are cracked through.
    ///
    /// # Errors
    /// If the phase field of a fragment does not converge.
    fn part_bodies(&mut self, dt: f64) -> Result<(), Failure> {
        let Self { fields, contact, bodies, fragments: Some(_), .. } = self else { return Ok(()) };
        for at in 0..fields.len() {
            let Some(mut parts) = fields[at].part(dt)? else { continue };
            bodies.resize(bodies.len() + parts.len() - 1, bodies[at]);
            fields.extend(parts.drain(1..));
            fields.splice(at..=at, parts);
            if let Some(contact) = contact {
                contact.last.clear(); // the bodies are numbered anew
            }
        }
        Ok(())
    }

    /// Stores or takes up which fields there are, with as many points each.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange_fragments(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { fields, bodies, fragments: Some(fragments), .. } = self else { return Ok(()) };
        let count = bodies.iter().copied().max().map_or(0, |last| last + 1);
        let mut points: Vec<usize> = fields.iter().map(|field| field.points.len()).collect();
        archive.value(fragments)?;
        archive.value(bodies)?;
        archive.value(&mut points)?;
        if archive.is_reader() {
            let all: usize = fields.iter().map(|field| field.points.len()).sum();
            let first = bodies.iter().take(count).copied().eq(0..count);
            let known = bodies.iter().all(|body| *body < count);
            let kept = points.iter().try_fold(0_usize, |sum, count| sum.checked_add(*count)) == Some(all);
            if !first || !known || !kept || points.len() != bodies.len() || points.contains(&0) {
                return Err(StateError::of_another_scene("its fragments are not fragments of these bodies"));
            }
            let whole = fields[..count].to_vec();
            *fields = bodies.iter().map(|body| whole[*body].clone()).collect();
            fields.iter_mut().zip(points).for_each(|(field, count)| field.make_room(count));
        }
        Ok(())
    }
}

/// Spans with points in each direction, and the margin.
///
/// # Errors
/// A point outside the patch.
pub(crate) fn spans_around(whole: &Patch, points: &[Point]) -> Result<[Range<usize>; 2], OutsidePatch> {
    let mut ends = [[usize::MAX, 0]; 2];
    for point in points {
        for d in 0..2 {
            let span = whole.spaces[d].find_span(point.position[d]).ok_or(OutsidePatch(point.position))?;
            ends[d] = [ends[d][0].min(span), ends[d][1].max(span)];
        }
    }
    Ok([0, 1].map(|d| {
        let [first, last] = ends[d];
        first.saturating_sub(MARGIN)..(last + 1 + MARGIN).min(whole.spaces[d].spans().len())
    }))
}

/// First control column and row of a part.
pub(crate) fn origin(whole: &Patch, spans: &[Range<usize>; 2]) -> [usize; 2] {
    [0, 1].map(|d| whole.spaces[d].spans()[spans[d].start].first)
}
