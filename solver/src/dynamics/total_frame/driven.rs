//! Sides that are driven.

use crate::dynamics::constraints::Constraints;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};

/// Control points that are driven, and room for the forces there.
#[derive(Debug, Clone)]
pub(super) struct DrivenSides {
    /// Control point, component, velocity (m/s).
    pub points: Vec<(usize, usize, f64)>,
    /// Mass times acceleration, and loads that vary in space if there are any, N/m.
    pub inertia: VectorField,
    pub forced: Option<VectorField>,
}

impl DrivenSides {
    /// None if no side moves.
    pub(super) fn new(constraints: &Constraints, grid: ControlGrid) -> Option<Box<Self>> {
        let points: Vec<_> = constraints.iter().filter(|(_, _, value)| *value != 0.0).collect();
        (!points.is_empty()).then(|| Box::new(Self { points, inertia: [grid.zeros(), grid.zeros()], forced: None }))
    }
}
