//! Stiffness of the undamaged body at the present positions, for the critical step.

use super::field::DiscreteField;
use super::transfer::walks;
use super::velocity_transfer::stable_fraction;
use super::windows::{Reach, Window, scatter};
use crate::contact::constraint::BoundaryFunctions;
use crate::contact::surface::Center;
use crate::dynamics::critical_step::{StiffnessOperator, highest_frequency};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::{Vectorised, dispatch};
use crate::linear_algebra::vectors::dot;
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
    /// Displacements of the control points, twice.
    field: Vec<[f64; 4]>,
    /// Their forces, in two parts.
    image: Vec<[f64; 4]>,
    /// Springs of a boundary that is not rigid: where, along which normal, and how stiff, Pa. Each is twice
    /// as stiff as the boundary: for two equal bodies that is what both feel of each other.
    springs: Vec<(BoundaryFunctions, [f64; 2], f64)>,
}

impl DiscreteField {
    /// Springs of the boundary, if it is not rigid.
    fn springs(&self) -> Vec<(BoundaryFunctions, [f64; 2], f64)> {
        let (Some(surface), Some(stiffness)) = (&self.surface, self.boundary_stiffness) else { return Vec::new() };
        let view = self.view();
        let spring = |Center { position, normal, length, .. }: Center| {
            Some((BoundaryFunctions::new(&view, position)?, normal, 2.0 * stiffness * length))
        };
        surface.centers().filter_map(spring).collect()
    }
}

impl<'a> PointStiffness<'a> {
    /// Operator of the present grid of `frame`.
    pub(crate) fn new(frame: &'a DiscreteField) -> Self {
        let nodes = &frame.nodes;
        let free = nodes.free();
        let masses = free.iter().map(|&(at, _)| nodes.mass[at]).collect();
        let zeros = vec![[0.0; 4]; nodes.grid.len()];
        Self { frame, masses, free, field: zeros.clone(), image: zeros, springs: frame.springs() }
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
        let Self { frame, free, field, image, springs, .. } = self;
        for (&(at, component), x) in free.iter().zip(x) {
            (field[at][component], field[at][component + 2]) = (*x, *x);
        }
        image.fill([0.0; 4]);
        let (grid, field) = (frame.nodes.grid, &field[..]);
        scatter(&frame.cells.strips, [&mut image[..]], [grid.stride], |strip, window| {
            dispatch(ElasticForces {
                patch: &frame.patch,
                grid,
                moduli: frame.moduli,
                cells: &frame.cells.cells[strip.cells.clone()],
                points: &frame.points,
                field,
                window,
            });
        });
        for (functions, normal, stiffness) in springs {
            let weights = functions.weights().iter();
            let moved: f64 = weights.clone().map(|&(at, w)| w * dot(*normal, [field[at][0], field[at][1]])).sum();
            for &(at, weight) in weights {
                (0..2).for_each(|d| image[at][d] += weight * *stiffness * moved * normal[d]);
            }
        }
        for (&(at, component), out) in free.iter().zip(out) {
            *out = image[at][component] + image[at][component + 2];
        }
    }
}

struct ElasticForces<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    moduli: ElasticModuli,
    cells: &'a [Cell],
    points: &'a [Point],
    field: &'a [[f64; 4]],
    window: Window<'a, [f64; 4], 1>,
}

walks!([] ElasticForces<'_> => ());

impl ElasticForces<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) {
        let ElasticModuli { lambda, mu, .. } = self.moduli;
        let Window { first_row, fields: [parts] } = &mut self.window;
        for cell in self.cells {
            for point in &self.points[cell.points.clone()] {
                let functions = point.mean_functions::<false>(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let mut gradient = [0.0; 4]; // by y, and by x
                let reach = Reach::new(self.grid, cell, &functions, [kx, ky], 0);
                for l in 0..reach.rows {
                    let mut row = [0.0; 4];
                    for (k, field) in self.field[reach.row(l)].iter().enumerate() {
                        let along = [sx.value[k], sx.value[k], sx.derivative[k], sx.derivative[k]];
                        for c in 0..4 {
                            row[c] += along[c] * field[c];
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
                let reach = Reach::new(self.grid, cell, &functions, [kx, ky], *first_row);
                for l in 0..reach.rows {
                    let (n, d) = (sy.value[l], sy.derivative[l]);
                    let across = [xy * d, yy * d, xx * n, xy * n];
                    for (k, part) in parts[reach.row(l)].iter_mut().enumerate() {
                        let along = [sx.value[k], sx.value[k], sx.derivative[k], sx.derivative[k]];
                        for c in 0..4 {
                            part[c] += along[c] * across[c];
                        }
                    }
                }
            }
        }
    }
}
