//! What contact sees of a body: its boundary, where it has material, and how its control points answer.

use std::collections::BTreeSet;

use super::surface::Surface;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::particles::points::Cells;
use crate::splines::patch::Patch;

/// A body as contact sees it, at the present whole step.
#[derive(Debug, Clone, Copy)]
pub struct BodyView<'a> {
    /// The part of the patch its nodal fields cover.
    pub patch: &'a Patch,
    /// Spans with material points.
    pub cells: &'a Cells,
    /// Its boundary, if it may meet others.
    pub surface: Option<&'a Surface>,
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Inverse of the lumped mass, m/kg; zero where that is negligible.
    pub inverse_mass: &'a [f64],
    /// Density, kg/m³.
    pub density: f64,
    /// Control points and components whose velocity is prescribed.
    pub fixed: &'a BTreeSet<(usize, usize)>,
    /// Velocity half a step ago, m/s.
    pub velocity: &'a VectorField,
    /// Acceleration without contact, m/s².
    pub acceleration: &'a VectorField,
}

impl BodyView<'_> {
    /// Inverse masses with which the components of a control point answer to a force, m/kg: zero where the
    /// velocity is prescribed or the mass negligible.
    pub(crate) fn mobility(&self, at: usize) -> [f64; 2] {
        [0, 1].map(|c| if self.fixed.contains(&(at, c)) { 0.0 } else { self.inverse_mass[at] })
    }
}
