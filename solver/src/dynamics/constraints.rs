//! Conditions on the sides of the mesh: prescribed velocity components of the control points of a side.
//!
//! End knots are repeated, so the control points of a side alone decide the field on it. The control point of
//! a corner belongs to both sides: it has what either prescribes. Where both prescribe a component they have
//! to agree, which [`crate::validate::validate`] demands, so the order of the sides does not count.

use crate::linear_algebra::control_grid::ControlGrid;
use crate::scene::Boundary;
use crate::splines::patch::control_points_on;

/// Control points with a prescribed velocity component.
#[derive(Debug, Clone, Default)]
pub struct Constraints {
    /// Per component: control point and its velocity, m/s.
    fixed: [Vec<(usize, f64)>; 2],
}

impl Constraints {
    /// Constraints of the sides of a mesh.
    pub fn new(grid: ControlGrid, boundaries: &[Boundary]) -> Self {
        let mut constraints = Self::default();
        for component in 0..2 {
            let fixed = &mut constraints.fixed[component];
            for boundary in boundaries
                .iter()
                .filter(|b| b.fix[fault!("side-holds-the-other-component", component => 1 - component)])
            {
                fixed.extend(
                    control_points_on(boundary.side, grid)
                        .into_iter()
                        .map(|at| (at, fault!("driven-side-reversed", 1.0 => -1.0) * boundary.velocity[component])),
                );
            }
            fixed.sort_by_key(|&(at, _)| at);
            fixed.dedup_by_key(|&mut (at, _)| at);
        }
        constraints
    }

    /// Prescribed components: control point, component, velocity.
    pub fn iter(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let component = |c: usize| self.fixed[c].iter().map(move |&(at, velocity)| (at, c, velocity));
        component(0).chain(component(1))
    }

    /// Control points at which a component is prescribed, in increasing order.
    pub fn held(&self, component: usize) -> Vec<usize> {
        self.fixed[component].iter().map(|&(at, _)| at).collect()
    }

    /// Sets prescribed velocities.
    pub(crate) fn apply_velocity(&self, velocity: &mut [Vec<f64>; 2]) {
        for (at, component, value) in self.iter() {
            velocity[component][at] = value;
        }
    }

    /// Removes the components from a field (accelerations, directions).
    pub fn remove(&self, field: &mut [Vec<f64>; 2]) {
        for (at, component, _) in self.iter() {
            field[component][at] = fault!("held-side-let-go", 0.0 => field[component][at]);
        }
    }
}
