//! The state of the bodies in the updated frame: what the points and surfaces carry. Order and nodal fields
//! follow from it.

use super::field::DiscreteField;
use super::{UpdatedFrame, views};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::failure::Failure;

impl UpdatedFrame {
    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.exchange_fragments(archive)?;
        let Self { patch: _, fields, bodies: _, contact, fragments: _, thickness: _, recorded: _ } = self;
        fields.iter_mut().try_for_each(|field| field.exchange(archive))?;
        if let Some(contact) = contact {
            contact.exchange(archive)?;
            if archive.is_reader() && fields[0].time() > 0.0 {
                contact.move_rigid(fields[0].time());
                contact.find(&views(fields)).map_err(StateError::of_another_scene)?;
            }
        }
        Ok(())
    }
}

impl DiscreteField {
    fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let mut spans = self.covered_spans();
        archive.value(&mut spans)?;
        if archive.is_reader() {
            let inside =
                (0..2).all(|d| spans[d].start < spans[d].end && spans[d].end <= self.whole.spaces[d].spans().len());
            if !inside {
                return Err(StateError::of_another_scene("a body lies outside the mesh"));
            }
            self.occupy(&spans);
        }
        self.exchange_points(archive)?;
        if archive.is_reader() {
            self.rebuild().map_err(StateError::of_another_scene)?;
        }
        self.exchange_sums(archive)
    }

    /// What points and surfaces carry.
    fn exchange_points(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { sides, edges, points, affine, deformation, loads, forcing, surface, fracture, .. } = self;
        if forcing.is_some() {
            return Err(StateError("loads that only the program knows cannot be stored".to_string()));
        }
        archive.value(&mut self.time)?;
        archive.value(&mut self.at_start)?;
        archive.value(&mut self.last_step)?;
        archive.value(&mut self.crack_start)?;
        archive.list(points)?;
        affine.iter_mut().try_for_each(|affine| archive.list(&mut affine.gradients))?;
        deformation.iter_mut().try_for_each(|gradients| archive.list(gradients))?;
        loads.iter_mut().try_for_each(|load| load.exchange(archive))?;
        sides.iter_mut().try_for_each(|side| side.exchange(archive))?;
        edges.iter_mut().try_for_each(|edges| edges.exchange(archive))?;
        surface.iter_mut().try_for_each(|surface| surface.exchange(archive))?;
        fracture.iter_mut().try_for_each(|fracture| fracture.exchange(archive))
    }

    /// Order of the points, spans of the surface points, nodal fields.
    fn rebuild(&mut self) -> Result<(), Failure> {
        // They are sorted already: the order of all else stays.
        self.cells.sort(&self.patch, &mut self.points)?;
        self.hold_sides();
        self.rebuild_grid()
    }

    fn exchange_sums(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { elastic_energy, stress_work, ledger, losses, travelled, .. } = self;
        [elastic_energy, stress_work, travelled].into_iter().try_for_each(|sum| archive.value(sum))?;
        archive.value(ledger)?;
        archive.value(losses)
    }
}
