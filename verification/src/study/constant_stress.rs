//! The patch test: a body under constant boundary tractions has that constant stress everywhere.
//!
//! The body, a rectangle or a whole patch, is loaded on its four sides with the tractions of a unit stress
//! (xx, yy and xy in turn), through its own surface points. The static equilibrium with the body's own
//! operators is solved densely with the three rigid motions held, and the stress is evaluated at the material
//! points. With points that integrate the products of gradients of shape functions exactly the error is
//! round-off; equally spaced cubics miss it at the open ends of the knot vector.

use fisura::dynamics::critical_step::StiffnessOperator;
use fisura::dynamics::loads::{NodalLoad, boundary_points};
use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::{Kinematics, Shape, Side, TimeFactor, Traction};
use nalgebra::DVector;

use super::{Case, CaseScene, Findings, StudyError, dense, other};
use crate::extremes::larger;

pub(super) fn study(_case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for scene in scenes {
        let quantities = ["xx", "yy", "xy"];
        let quantities = quantities.map(|name| (format!("constant stress {name}, largest error at a point"), None));
        findings.measure(&scene.name, quantities, || {
            let frame = TotalFrame::new(&scene.scene).map_err(|_| other("no equilibrium at rest"))?;
            let patch_test = PatchTest::new(&frame)?;
            let stresses = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            Ok(stresses.map(|stress| patch_test.largest_stress_error(scene, stress)))
        })?;
    }
    Ok(())
}

struct PatchTest<'a> {
    frame: &'a TotalFrame,
    degrees_of_freedom: Vec<(usize, usize)>,
    /// Which of them hold the rigid motions.
    held: [usize; 3],
    factor: nalgebra::Cholesky<f64, nalgebra::Dyn>,
}

impl<'a> PatchTest<'a> {
    fn new(frame: &'a TotalFrame) -> Result<Self, StudyError> {
        let mut operator = frame.stiffness_operator();
        let degrees_of_freedom = operator.free.clone();
        let n = degrees_of_freedom.len();
        let mut matrix = dense::matrix(n, |x, out| operator.stiffness(x, out))?;
        let grid = frame.lattice.grid;
        let corner = |column: usize, component: usize| {
            let wanted = (grid.index(column, 0), component);
            degrees_of_freedom.iter().position(|dof| *dof == wanted)
        };
        let held = [corner(0, 0), corner(0, 1), corner(grid.columns - 1, 1)];
        let [Some(a), Some(b), Some(c)] = held else {
            return Err(other("the body does not reach the lower corners of the mesh"));
        };
        for index in [a, b, c] {
            let diagonal = matrix[(index, index)];
            matrix.row_mut(index).fill(0.0);
            matrix.column_mut(index).fill(0.0);
            matrix[(index, index)] = diagonal;
        }
        let singular = || other("the stiffness is not positive definite: too few points per span");
        let factor = matrix.cholesky().ok_or_else(singular)?;
        Ok(Self { frame, degrees_of_freedom, held: [a, b, c], factor })
    }

    fn largest_stress_error(&self, scene: &CaseScene, stress: [f64; 3]) -> f64 {
        let solution = self.factor.solve(&self.load(scene, stress));
        let grid = self.frame.lattice.grid;
        let mut displacement = [grid.zeros(), grid.zeros()];
        for (value, &(at, component)) in solution.iter().zip(&self.degrees_of_freedom) {
            displacement[component][at] = *value;
        }
        let mut worst = 0.0_f64;
        self.frame.lattice.for_each_point(|_, _, position, _| {
            let found = self.frame.elastic_stress_at(&displacement, position);
            for (found, exact) in found.into_iter().zip(stress) {
                worst = larger(worst, (found - exact).abs());
            }
        });
        worst
    }

    /// Nodal forces of the tractions `sigma n` on the four sides, zero where rigid motions are held.
    fn load(&self, scene: &CaseScene, [xx, yy, xy]: [f64; 3]) -> DVector<f64> {
        let body = &scene.scene.bodies[0];
        let grid = self.frame.lattice.grid;
        let mut forces = [grid.zeros(), grid.zeros()];
        let sides =
            [(Side::Left, [-xx, -xy]), (Side::Right, [xx, xy]), (Side::Bottom, [-xy, -yy]), (Side::Top, [xy, yy])];
        for (side, stress) in sides {
            if body.shape == Shape::Patch {
                for point in boundary_points(&self.frame.patch, body, side) {
                    let [x, y] = point.normal.map(|n| n * point.length);
                    for &(at, value) in &point.functions.values {
                        forces[0][at] += value * (xx * x + xy * y);
                        forces[1][at] += value * (xy * x + yy * y);
                    }
                }
                continue;
            }
            let traction = Traction::on(side, stress, TimeFactor::default());
            let (space, moves) = ((&self.frame.patch, &self.frame.lattice), |at| self.frame.mass.moves(at));
            let load = NodalLoad::new(space, body, &traction, Kinematics::Small, moves);
            for (at, force) in load.expect("the sides of the body are carried by its points").forces {
                forces[0][at] += force[0];
                forces[1][at] += force[1];
            }
        }
        let value = |(index, &(at, component)): (usize, &(usize, usize))| {
            if self.held.contains(&index) { 0.0 } else { forces[component][at] }
        };
        DVector::from_iterator(self.degrees_of_freedom.len(), self.degrees_of_freedom.iter().enumerate().map(value))
    }
}
