//! The power of driven sides.

use super::TotalFrame;
use crate::dynamics::constraints::Constraints;
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};

/// Control points that are driven, and room for the forces there.
#[derive(Debug, Clone)]
pub(super) struct DrivenSides {
    /// Control point, component, velocity (m/s).
    points: Vec<(usize, usize, f64)>,
    /// Mass times acceleration, and loads that vary in space, N/m.
    inertia: VectorField,
    forced: VectorField,
}

impl DrivenSides {
    /// None if no side moves.
    pub(super) fn new(constraints: &Constraints, grid: ControlGrid) -> Option<Box<Self>> {
        let points: Vec<_> = constraints.iter().filter(|(_, _, value)| *value != 0.0).collect();
        let zeros = || [grid.zeros(), grid.zeros()];
        (!points.is_empty()).then(|| Box::new(Self { points, inertia: zeros(), forced: zeros() }))
    }
}

impl TotalFrame {
    /// Reaction times velocity of the driven control points, W/m: internal and inertial minus external force.
    pub(super) fn power_of_driven_sides(&mut self) -> f64 {
        let Self { driven: Some(driven), mass, acceleration, internal, loads, gravity, time, .. } = self else {
            return 0.0;
        };
        let DrivenSides { points, inertia, forced } = &mut **driven;
        for component in 0..2 {
            mass.multiply(&acceleration[component], &mut inertia[component]);
        }
        if let Some(loads) = &self.forced {
            forced.iter_mut().for_each(|forced| forced.fill(0.0));
            loads.add_to(forced);
        }
        let mut power = 0.0;
        for &(at, component, value) in &*points {
            let loads = loads.iter().flat_map(|load| load.forces.iter().map(|f| (load.factor(*time), f)));
            let applied: f64 = loads.filter(|(_, f)| f.0 == at).map(|(factor, f)| factor * f.1[component]).sum();
            let external = applied + forced[component][at] + gravity[component] * mass.row_sums()[at];
            power += value * (internal[component][at] + inertia[component][at] - external);
        }
        power
    }
}
