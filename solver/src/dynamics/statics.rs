//! Elastostatics on the operators of the time step: `(K + s M) u = f` with displacements prescribed where
//! velocities are.
//!
//! The stiffness is read off the body's own internal forces: columns far enough apart do not overlap, so
//! `2 (2 p + 1)(2 q + 1)` sweeps give all of them. It serves verification; scenes are dynamic.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

use crate::dynamics::total_frame::TotalFrame;
use crate::linear_algebra::control_grid::VectorField;
use crate::transfer::sweep::StripForces;

/// The stiffness of an undamaged body in the total frame, factored.
#[derive(Debug)]
pub struct StaticSolver<'a> {
    frame: &'a TotalFrame,
    shift: f64,
    /// Control point and component of each unknown.
    free: Vec<(usize, usize)>,
    factor: Llt<usize, f64>,
}

impl<'a> StaticSolver<'a> {
    /// Factors the stiffness, plus `shift` (1/s²) times the mass, on the components that no boundary holds;
    /// `None` if it is not positive definite: the body is not held against rigid motions by boundaries or a
    /// shift, or has too few points. Conditions on edges of the body are not known to it.
    pub fn new(frame: &'a TotalFrame, shift: f64) -> Option<Self> {
        let free = frame.free_components();
        let grid = frame.lattice.grid;
        let mut number = [vec![usize::MAX; grid.len()], vec![usize::MAX; grid.len()]];
        for (n, &(at, component)) in free.iter().enumerate() {
            number[component][at] = n;
        }
        let [p, q] = frame.lattice.degree;
        let reach = [2 * p + 1, 2 * q + 1];
        let mut triplets = Vec::new();
        let mut image = [grid.zeros(), grid.zeros()];
        let mut strips = frame.strip_forces.clone();
        for colour in 0..2 * reach[0] * reach[1] {
            let (component, i, j) = (colour % 2, colour / 2 % reach[0], colour / 2 / reach[0]);
            let mut probe = [grid.zeros(), grid.zeros()];
            let of_colour = |at: &usize| grid.column_of(*at) % reach[0] == i && grid.row_of(*at) % reach[1] == j;
            for at in grid.indices().filter(of_colour).filter(|&at| number[component][at] != usize::MAX) {
                probe[component][at] = 1.0;
            }
            shifted_forces(frame, shift, &probe, &mut strips, &mut image);
            for &(at, c) in &free {
                // The only control point of the colour within p columns and q rows.
                let near = |place: usize, colour: usize, reach: usize| {
                    let ahead = (colour + reach - place % reach) % reach;
                    if ahead <= reach / 2 { Some(place + ahead) } else { (place + ahead).checked_sub(reach) }
                };
                let (column, row) = (near(grid.column_of(at), i, reach[0]), near(grid.row_of(at), j, reach[1]));
                let (Some(column), Some(row)) = (column, row) else { continue };
                if column >= grid.columns || row >= grid.rows {
                    continue;
                }
                let (n, m) = (number[c][at], number[component][grid.index(column, row)]);
                if m != usize::MAX && n >= m {
                    triplets.push(Triplet::new(n, m, image[c][at]));
                }
            }
        }
        let matrix = SparseColMat::try_new_from_triplets(free.len(), free.len(), &triplets).ok()?;
        let factor = matrix.sp_cholesky(Side::Lower).ok()?;
        Some(Self { frame, shift, free, factor })
    }

    /// Displacement (m) under nodal forces per unit thickness (N/m); at the components that boundaries hold
    /// it is that of `prescribed`.
    pub fn solve(&self, forces: &VectorField, prescribed: &VectorField) -> VectorField {
        let grid = self.frame.lattice.grid;
        let mut displacement = prescribed.clone();
        for &(at, component) in &self.free {
            displacement[component][at] = 0.0;
        }
        let mut image = [grid.zeros(), grid.zeros()];
        shifted_forces(self.frame, self.shift, &displacement, &mut self.frame.strip_forces.clone(), &mut image);
        let right = |&(at, component): &(usize, usize)| forces[component][at] - image[component][at];
        let mut solution = Mat::from_fn(self.free.len(), 1, |n, _| right(&self.free[n]));
        self.factor.solve_in_place(solution.as_mut());
        for (n, &(at, component)) in self.free.iter().enumerate() {
            displacement[component][at] = solution[(n, 0)];
        }
        displacement
    }
}

/// Writes the nodal forces `(K + s M) u` (N/m) of a displacement u (m) to `out`; `shift` is s, 1/s².
fn shifted_forces(frame: &TotalFrame, shift: f64, u: &VectorField, strips: &mut StripForces, out: &mut VectorField) {
    frame.elastic_forces(u, strips, out);
    if shift != 0.0 {
        let mut inertia = frame.lattice.grid.zeros();
        for component in 0..2 {
            frame.mass.multiply(&u[component], &mut inertia);
            out[component].iter_mut().zip(&inertia).for_each(|(f, m)| *f += shift * m);
        }
    }
}
