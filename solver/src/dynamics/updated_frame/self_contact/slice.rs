//! What a slice of a body knows of the others, and how that moves.

use super::super::grid::NodalFields;
use crate::checkpoint::{Archive, StateError};
use crate::contact::view::Copies;
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::follower::Follower;
use crate::particles::points::Cells;
use crate::splines::patch::Patch;

/// What a slice knows of the body it is of.
#[derive(Debug, Clone, Default)]
pub(in crate::dynamics::updated_frame) struct Slice {
    /// Positions of points next to another slice, m, with the number of its field.
    pub seam: Vec<([f64; 2], usize)>,
    pub copies: Copies,
    /// Lumped mass with all slices, kg/m, and its inverse.
    pub mass: Vec<f64>,
    pub inverse_mass: Vec<f64>,
}

impl Slice {
    /// What contact sees of the control points: copies, masses and their inverses.
    pub(crate) fn joint(&self) -> (&Copies, &[f64], &[f64]) {
        (&self.copies, &self.mass, &self.inverse_mass)
    }

    /// Moves the marks with a velocity field (m/s) of the slice for `dt` seconds.
    pub(crate) fn follow(&mut self, on: (&Patch, &Cells, &NodalFields), velocity: &VectorField, dt: f64) {
        let (patch, cells, nodes) = on;
        for (place, _) in &mut self.seam {
            if let Some(mut mark) = Follower::nearest(*place, patch, cells) {
                mark.follow(patch, nodes.grid, velocity, dt);
                *place = fault!("seam-left-behind", mark.position => *place);
            }
        }
    }

    /// Stores or takes up the marks.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.seam.iter_mut().try_for_each(|(place, _)| archive.value(place))
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.seam[..]) + 16 * self.mass.len() + 32 * self.copies.len()
    }
}
