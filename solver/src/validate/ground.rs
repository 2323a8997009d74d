//! What several checks ask of the mesh.

use crate::particles::spans::{lengths_of_chords, lengths_of_spans};
use crate::scene::{Mesh, Shape};
use crate::splines::nurbs::NurbsPatch;
use crate::splines::spline::SplineSpace;

/// What several checks ask of the mesh, found once: a general patch is not made for every body and crack.
pub(super) struct Ground<'a> {
    pub mesh: &'a Mesh,
    pub is_sound: bool,
    /// The geometry, if the mesh has one that is sound.
    pub patch: Option<NurbsPatch>,
    /// Smallest and largest span of that, m.
    pub patch_spans: [f64; 2],
    /// Spline spaces of both directions, if the mesh is sound.
    pub spaces: Option<[SplineSpace; 2]>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(mesh: &'a Mesh, is_sound: bool, patch: Option<NurbsPatch>) -> Self {
        let patch_spans = patch.as_ref().map_or([f64::INFINITY, 0.0], lengths_of_chords);
        let spaces = is_sound.then(|| [0, 1].map(|d| SplineSpace::new(mesh.degree[d], &mesh.knots[d])));
        Self { mesh, is_sound, patch, patch_spans, spaces }
    }

    /// Smallest and largest span under a shape, m.
    pub(super) fn span_lengths(&self, shape: &Shape) -> [f64; 2] {
        if self.patch.is_some() { self.patch_spans } else { lengths_of_spans(self.mesh, shape) }
    }
}
