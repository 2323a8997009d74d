//! Stiffness of the undamaged body at the present positions, for the critical step.

use super::field::DiscreteField;
use super::transfer::walk;
use super::velocity_transfer::stable_fraction;
use super::windows::{Window, control_values, in_cell, scatter, zeros};
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::{Vectorised, dispatch};
use crate::material::elasticity::ElasticModuli;
use crate::particles::points::{Cell, Point};
use crate::splines::patch::Patch;

impl DiscreteField {
    /// Critical time step of the body, undamaged or broken, at the present positions, s; infinite if nothing
    /// can move.
    pub fn critical_step(&self) -> f64 {
        let frequency = highest_frequency(&mut PointStiffness::new(self));
        let stiffening = self.fracture.as_ref().map_or(1.0, |fracture| fracture.model.stiffening(&self.moduli));
        stable_fraction() / frequency / stiffening.sqrt()
    }
}

/// `K x` on the components that accelerate, per unit thickness.
#[derive(Debug)]
pub(crate) struct PointStiffness<'a> {
    frame: &'a DiscreteField,
    free: Vec<(usize, usize)>,
    masses: Vec<f64>,
    field: [Vec<f64>; 2],
    image: [Vec<f64>; 2],
}

impl<'a> PointStiffness<'a> {
    /// Operator of the present grid of `frame`.
    pub(crate) fn new(frame: &'a DiscreteField) -> Self {
        let nodes = frame.nodes();
        let free = nodes.free();
        let masses = free.iter().map(|&(at, _)| nodes.mass[at]).collect();
        let zeros = || [nodes.grid.zeros(), nodes.grid.zeros()];
        Self { frame, masses, free, field: zeros(), image: zeros() }
    }
}

impl StiffnessOperator for PointStiffness<'_> {
    fn size(&self) -> usize {
        self.masses.len()
    }

    fn divide_by_mass(&mut self, x: &[f64], out: &mut [f64]) {
        for ((out, x), mass) in out.iter_mut().zip(x).zip(&self.masses) {
            *out = x / mass;
        }
    }

    fn stiffness(&mut self, x: &[f64], out: &mut [f64]) {
        self.set(x);
        self.find_forces();
        self.forces(out);
    }
}

impl PointStiffness<'_> {
    /// Takes the displacements of the free components.
    pub(super) fn set(&mut self, x: &[f64]) {
        for (&(at, component), x) in self.free.iter().zip(x) {
            self.field[component][at] = *x;
        }
    }

    /// The forces of the displacements.
    pub(super) fn find_forces(&mut self) {
        self.image.iter_mut().for_each(|field| field.fill(0.0));
        let (frame, field) = (self.frame, self.field.each_ref().map(|f| &f[..]));
        let grid = frame.nodes().grid;
        let [x, y] = &mut self.image;
        scatter(&frame.cells().strips, [x, y], [grid.stride; 2], |strip, window| {
            dispatch(ElasticForces {
                patch: frame.patch(),
                grid,
                moduli: frame.moduli(),
                cells: &frame.cells().cells[strip.cells.clone()],
                points: frame.points(),
                field,
                window,
            });
        });
    }

    /// Those on the free components.
    pub(super) fn forces(&self, out: &mut [f64]) {
        for (&(at, component), out) in self.free.iter().zip(out) {
            *out = self.image[component][at];
        }
    }
}

struct ElasticForces<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    moduli: ElasticModuli,
    cells: &'a [Cell],
    points: &'a [Point],
    field: [&'a [f64]; 2],
    window: Window<'a, 2>,
}

impl Vectorised for ElasticForces<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        walk!(self, FMA)
    }
}

impl ElasticForces<'_> {
    #[inline(always)]
    fn walk(mut self, kx: usize, ky: usize) {
        let ElasticModuli { lambda, mu, .. } = self.moduli;
        let [x, y] = self.field;
        for cell in self.cells {
            let local = control_values([x, y, x, y], self.grid, cell, kx, ky);
            let mut parts = zeros::<4>();
            for point in &self.points[cell.points.clone()] {
                let functions = point.mean_functions(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let mut gradient = [0.0; 4]; // by y, and by x
                for l in 0..=ky {
                    let first = in_cell(&functions, l, kx);
                    let mut row = [0.0; 4];
                    for k in 0..=kx {
                        let along = [sx.value[k], sx.value[k], sx.derivative[k], sx.derivative[k]];
                        for c in 0..4 {
                            row[c] += along[c] * local[first + k][c];
                        }
                    }
                    let across = [sy.derivative[l], sy.derivative[l], sy.value[l], sy.value[l]];
                    for c in 0..4 {
                        gradient[c] += across[c] * row[c];
                    }
                }
                let [uxy, uyy, uxx, uyx] = gradient;
                let spherical = lambda * (uxx + uyy);
                let stress = [spherical + 2.0 * mu * uxx, spherical + 2.0 * mu * uyy, mu * (uxy + uyx)];
                let [xx, yy, xy] = stress.map(|s| s * point.volume);
                for l in 0..=ky {
                    let (n, d) = (sy.value[l], sy.derivative[l]);
                    let across = [xy * d, yy * d, xx * n, xy * n];
                    let first = in_cell(&functions, l, kx);
                    for k in 0..=kx {
                        let along = [sx.value[k], sx.value[k], sx.derivative[k], sx.derivative[k]];
                        for c in 0..4 {
                            parts[first + k][c] += along[c] * across[c];
                        }
                    }
                }
            }
            let forces = parts.map(|[x, y, by_x, by_y]| [x + by_x, y + by_y]);
            self.window.add(self.grid, cell, &forces, kx, ky);
        }
    }
}
