//! Central differences in time with a lumped mass; forces of the degraded stress and of tractions.

use rayon::prelude::*;

use crate::element;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::stencil::{TILE_ROWS, dot, row};

/// Displacements, velocities and what acts on the nodes.
#[derive(Debug)]
pub struct Dynamics {
    /// Displacements along x and y, m.
    pub displacement: [Vec<f64>; 2],
    /// Velocities half a step before the displacements, m/s.
    pub velocity: [Vec<f64>; 2],
    /// Tractions, N per metre of thickness.
    pub traction: [Vec<f64>; 2],
    /// Inverse mass; zero where a component is held and beside the nodes. m/kg.
    pub mobility: [Vec<f64>; 2],
    /// Mass, kg per metre of thickness.
    mass: Vec<f64>,
    force: [Vec<f64>; 2],
    /// Nodes of a row and of the next one, of a gap of no height, that move as one.
    tied: Vec<[usize; 2]>,
    widths: Vec<f64>,
    inverse_widths: Vec<f64>,
    heights: Vec<f64>,
    stride: usize,
    material: Material,
}

/// Energies, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default)]
pub struct Energies {
    /// ½ m v(n − ½) · v(n + ½).
    pub kinetic: f64,
    /// Degraded elastic energy.
    pub elastic: f64,
    /// Fracture energy.
    pub fracture: f64,
    /// Work of the tractions, which do not change in time.
    pub work: f64,
}

impl Dynamics {
    /// At rest, without tractions, nothing held.
    pub fn new(mesh: &Mesh, material: Material) -> Self {
        let nodal = || [mesh.nodal(), mesh.nodal()];
        let mass: Vec<f64> = mesh.volumes().iter().map(|volume| material.density * volume).collect();
        let mobility: Vec<f64> = mass.iter().map(|mass| if *mass > 0.0 { 1.0 / mass } else { 0.0 }).collect();
        Self {
            displacement: nodal(),
            velocity: nodal(),
            traction: nodal(),
            mobility: [mobility.clone(), mobility],
            mass,
            force: nodal(),
            tied: Vec::new(),
            inverse_widths: mesh.widths().iter().map(|width| 1.0 / width).collect(),
            widths: mesh.widths(),
            heights: mesh.heights(),
            stride: mesh.stride(),
            material,
        }
    }

    /// Forces −∫ B^T sigma of the present displacements, degraded by the phase field `c`.
    pub fn evaluate(&mut self, c: &[f64]) {
        let size = TILE_ROWS * self.stride;
        let [mut fx, mut fy] = std::mem::take(&mut self.force);
        let tiles = fx.par_chunks_mut(size).zip(fy.par_chunks_mut(size)).enumerate();
        tiles.for_each(|(tile, (fx, fy))| self.forces_of_tile(tile * TILE_ROWS, c, fx, fy));
        self.force = [fx, fy];
        for force in &mut self.force {
            for &[lower, upper] in &self.tied {
                let sum = force[lower] + force[upper];
                (force[lower], force[upper]) = (sum, sum);
            }
        }
    }

    /// Makes pairs of nodes of the two rows of a gap move as one.
    pub fn tie(&mut self, pairs: Vec<[usize; 2]>) {
        for &[lower, upper] in &pairs {
            let mobility = 1.0 / (self.mass[lower] + self.mass[upper]);
            for axis in &mut self.mobility {
                (axis[lower], axis[upper]) = (mobility, mobility);
            }
        }
        self.tied = pairs;
    }

    /// Force on a node along an axis, without tractions, N per metre of thickness.
    pub fn force(&self, axis: usize, node: usize) -> f64 {
        self.force[axis][node]
    }

    /// Mass of a node, kg per metre of thickness.
    pub fn mass(&self, node: usize) -> f64 {
        self.mass[node]
    }

    /// Forces on the rows of nodes from `first` on.
    fn forces_of_tile(&self, first: usize, c: &[f64], fx: &mut [f64], fy: &mut [f64]) {
        let stride = self.stride;
        let mut elements = CornerForces::new(stride);
        fx.fill(0.0);
        fy.fill(0.0);
        let rows = fx.len() / stride;
        for e in first.saturating_sub(1)..(first + rows).min(self.heights.len()) {
            if self.heights[e] == 0.0 {
                continue; // the gap of a slit
            }
            elements.fill(self, e, c);
            for (force, [ll, lr, ul, ur]) in [(&mut *fx, elements.x()), (&mut *fy, elements.y())] {
                if e >= first {
                    add_pairs(&mut force[(e - first) * stride..(e - first + 1) * stride], ll, lr);
                }
                if e + 1 < first + rows {
                    add_pairs(&mut force[(e + 1 - first) * stride..(e + 2 - first) * stride], ul, ur);
                }
            }
        }
    }

    /// Velocities `dt` later by the present forces, then displacements by `drift`.
    pub fn kick(&mut self, dt: f64, drift: f64) {
        for axis in 0..2 {
            let arrays = (
                self.velocity[axis].par_chunks_mut(self.stride),
                self.displacement[axis].par_chunks_mut(self.stride),
                self.force[axis].par_chunks(self.stride),
                self.traction[axis].par_chunks(self.stride),
                self.mobility[axis].par_chunks(self.stride),
            );
            arrays.into_par_iter().for_each(|(velocity, displacement, force, traction, mobility)| {
                let n = velocity.len();
                let (displacement, force) = (&mut displacement[..n], &force[..n]);
                let (traction, mobility) = (&traction[..n], &mobility[..n]);
                for i in 0..n {
                    velocity[i] += dt * mobility[i] * (force[i] + traction[i]);
                    displacement[i] += drift * velocity[i];
                }
            });
        }
    }

    /// Energies at the present displacements, whose forces are known; `dt` as in the kick to come.
    pub fn energies(&self, dt: f64, c: &[f64]) -> Energies {
        let by_row = |j: usize| {
            let (kinetic, work) = self.of_nodes(j, dt);
            let solid = self.heights.get(j).is_some_and(|height| *height > 0.0);
            let (elastic, fracture) = if solid { self.of_elements(j, c) } else { (0.0, 0.0) };
            Energies { kinetic, elastic, fracture, work }
        };
        let rows: Vec<Energies> = (0..=self.heights.len()).into_par_iter().map(by_row).collect();
        rows.iter().fold(Energies::default(), |sum, row| Energies {
            kinetic: sum.kinetic + row.kinetic,
            elastic: sum.elastic + row.elastic,
            fracture: sum.fracture + row.fracture,
            work: sum.work + row.work,
        })
    }

    /// Kinetic energy and work of the tractions of a row of nodes.
    fn of_nodes(&self, j: usize, dt: f64) -> (f64, f64) {
        let mass = row(&self.mass, j, self.stride);
        let (mut kinetic, mut work) = (0.0, 0.0);
        for axis in 0..2 {
            let of = |values: &'_ [Vec<f64>; 2], i: usize| values[axis][j * self.stride + i];
            for (i, mass) in mass.iter().enumerate() {
                let before = of(&self.velocity, i);
                let gain = dt * of(&self.mobility, i) * (of(&self.force, i) + of(&self.traction, i));
                kinetic += 0.5 * mass * before * (before + gain);
            }
            work += dot(row(&self.traction[axis], j, self.stride), row(&self.displacement[axis], j, self.stride));
        }
        (kinetic, work)
    }

    /// Elastic and fracture energy of a row of elements.
    fn of_elements(&self, j: usize, c: &[f64]) -> (f64, f64) {
        let (m, height) = (&self.material, self.heights[j]);
        let (mut elastic, mut fracture) = (0.0, 0.0);
        for i in 1..self.stride - 2 {
            let corners = |values: &[f64]| self.corners(values, j, i);
            let (ux, uy, c) = (corners(&self.displacement[0]), corners(&self.displacement[1]), corners(c));
            let (width, weight) = (self.widths[i], 0.25 * self.widths[i] * height);
            let strains = element::strains(ux, uy, 1.0 / width, 1.0 / height);
            let (along, up) = element::slopes(c, 1.0 / width, 1.0 / height);
            for (point, (strain, c)) in strains.into_iter().zip(element::interpolate(c)).enumerate() {
                let (slope_x, slope_y) = (along[point / 2], up[point % 2]);
                elastic += weight * (m.degradation(c) * m.tensile_energy(strain) + m.compressive_energy(strain));
                fracture += weight * m.crack_density(c, slope_x * slope_x + slope_y * slope_y);
            }
        }
        (elastic, fracture)
    }

    fn corners(&self, values: &[f64], j: usize, i: usize) -> [f64; 4] {
        let (lower, upper) = (row(values, j, self.stride), row(values, j + 1, self.stride));
        [lower[i], lower[i + 1], upper[i], upper[i + 1]]
    }
}

/// Forces of a row of elements on their corners, along x and along y; the guards are zero.
struct CornerForces([Vec<f64>; 8]);

impl CornerForces {
    fn new(stride: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; stride]))
    }

    fn x(&self) -> [&[f64]; 4] {
        std::array::from_fn(|corner| self.0[corner].as_slice())
    }

    fn y(&self) -> [&[f64]; 4] {
        std::array::from_fn(|corner| self.0[4 + corner].as_slice())
    }

    /// Row `e` of elements.
    fn fill(&mut self, of: &Dynamics, e: usize, c: &[f64]) {
        let n = of.stride;
        let pair = |values| [&row(values, e, n)[..n], &row(values, e + 1, n)[..n]];
        let ([xl, xu], [yl, yu]) = (pair(&of.displacement[0]), pair(&of.displacement[1]));
        let ([cl, cu], widths, inverse) = (pair(c), &of.widths[..n], &of.inverse_widths[..n]);
        let (material, height) = (of.material, of.heights[e]);
        let inverse_height = 1.0 / height;
        let [x0, x1, x2, x3, y0, y1, y2, y3] = self.0.each_mut().map(|values| &mut values[..n]);
        for i in 1..n - 2 {
            let (ux, uy) = ([xl[i], xl[i + 1], xu[i], xu[i + 1]], [yl[i], yl[i + 1], yu[i], yu[i + 1]]);
            let [e0, e1, e2, e3] = element::strains(ux, uy, inverse[i], inverse_height);
            let [c0, c1, c2, c3] = element::interpolate([cl[i], cl[i + 1], cu[i], cu[i + 1]]);
            let stress = |strain, c| material.stress(strain, material.degradation(c));
            let stresses = [stress(e0, c0), stress(e1, c1), stress(e2, c2), stress(e3, c3)];
            let (fx, fy) = element::forces(stresses, widths[i], height);
            [x0[i], x1[i], x2[i], x3[i]] = fx;
            [y0[i], y1[i], y2[i], y3[i]] = fy;
        }
    }
}

/// Adds what each element gives to its left and right corner.
fn add_pairs(force: &mut [f64], left: &[f64], right: &[f64]) {
    let n = force.len();
    let (left, right) = (&left[..n], &right[..n]);
    for i in 1..n - 1 {
        force[i] += left[i] + right[i - 1];
    }
}
