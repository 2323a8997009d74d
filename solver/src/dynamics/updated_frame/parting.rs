//! Bodies of the updated frame that fall into fragments.

use super::UpdatedFrame;
use super::field::DiscreteField;
use super::fragments::CHECK_INTERVAL;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::failure::Failure;

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
