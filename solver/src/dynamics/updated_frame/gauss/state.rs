//! What a checkpoint keeps of the spans, and how it follows the part of the patch.

use super::SpanQuadrature;
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::updated_frame::grid::NodalFields;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::splines::patch::Patch;

impl SpanQuadrature {
    /// Stores or takes up what steps change: with it the next step is the same bit by bit.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive, points: usize) -> Result<(), StateError> {
        let Self {
            displacement,
            acceleration,
            velocity,
            point_acceleration,
            boundary,
            fit,
            inertia,
            since_relaxation,
            ..
        } = self;
        let fields = displacement.iter_mut().chain(acceleration).chain([velocity]);
        fields.flatten().try_for_each(|field| archive.list(field))?;
        boundary.places().try_for_each(|places| archive.list(places))?;
        point_acceleration.resize(points, [0.0; 2]);
        archive.list(point_acceleration)?;
        fit.exchange(archive)?;
        inertia.exchange(archive)?;
        archive.value(since_relaxation)
    }

    /// The same body on another part of the patch, by control columns and rows.
    pub(crate) fn follow(&mut self, from: ControlGrid, patch: &Patch, nodes: &NodalFields, shift: [isize; 2]) {
        let mut moved = Self::on(patch, nodes, self.boundary.clone(), self.moduli, self.density);
        let to = patch.control_grid();
        let old = self.displacement.iter().chain(&self.acceleration).chain([&self.velocity]);
        let new = moved.displacement.iter_mut().chain(&mut moved.acceleration).chain([&mut moved.velocity]);
        old.zip(new).for_each(|(old, new)| relocate(old, from, new, to, shift));
        moved.since_relaxation = self.since_relaxation;
        moved.springs = self.springs;
        *self = moved;
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let fields = 9 * 2 * 8 * self.force[0].len();
        let systems = self.fit.bytes() + self.inertia.bytes();
        fields + systems + self.gauss.bytes() + self.point_acceleration.len() * size_of::<[f64; 2]>()
    }
}

/// Values of the control points that both parts have.
fn relocate(old: &VectorField, from: ControlGrid, new: &mut VectorField, to: ControlGrid, shift: [isize; 2]) {
    for at in to.indices() {
        let column = to.column_of(at) as isize + shift[0];
        let row = to.row_of(at) as isize + shift[1];
        if (0..from.columns as isize).contains(&column) && (0..from.rows as isize).contains(&row) {
            let there = from.index(column as usize, row as usize);
            (0..2).for_each(|c| new[c][at] = old[c][there]);
        }
    }
}
