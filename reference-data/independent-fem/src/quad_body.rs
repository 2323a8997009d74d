//! A body of quadrilaterals that cracks by AT1: central differences, and in every step the phase field of
//! least energy between zero and the last one.

use rayon::prelude::*;

use crate::material::{Material, larger};
use crate::quads::{GaussPoint, Quads, gauss_points};

/// What drives the crack, and what it degrades.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Split {
    /// The tensile part of Miehe et al. drives and is degraded.
    Spectral,
    /// The largest principal stress drives, ⟨σ1⟩²/(2 E); everything is degraded.
    Rankine,
}

/// Residual of the phase field over its right-hand side.
const TOLERANCE: f64 = 1e-6;

/// State and constants of the body.
#[derive(Debug)]
pub struct QuadBody {
    /// Its mesh.
    pub mesh: Quads,
    /// Displacements of the nodes, m.
    pub displacement: Vec<[f64; 2]>,
    /// Velocities half a step before the displacements, m/s.
    pub velocity: Vec<[f64; 2]>,
    /// Forces of stresses and loads, N/m.
    pub force: Vec<[f64; 2]>,
    /// Masses of the nodes, kg/m.
    pub mass: Vec<f64>,
    /// Components that are held, or that move with a velocity that is given.
    pub held: Vec<[bool; 2]>,
    /// Phase field at the nodes, 1 where intact.
    pub c: Vec<f64>,
    material: Material,
    split: Split,
    young: f64,
    /// Toughness at the Gauss points over that of the material.
    toughness: Vec<[f64; 4]>,
    points: Vec<[GaussPoint; 4]>,
    /// Elements of each node, as 4 e + corner.
    around: Vec<Vec<usize>>,
    /// Strains at the Gauss points, and what drives the crack there, J/m³.
    strains: Vec<[[f64; 3]; 4]>,
    drive: Vec<[f64; 4]>,
    of_corners: Vec<[[f64; 2]; 4]>,
}

/// Kinetic, elastic and fracture energy, J/m.
pub type Energies = [f64; 3];

impl QuadBody {
    /// At rest and intact; the toughness is `factor` of the place times that of the material.
    pub fn new(mesh: Quads, material: Material, split: Split, factor: impl Fn([f64; 2]) -> f64) -> Self {
        let corners = |element: &[usize; 4]| element.map(|n| mesh.nodes[n]);
        let points: Vec<[GaussPoint; 4]> = mesh.elements.iter().map(|e| gauss_points(corners(e))).collect();
        let place = |e: usize, point: &GaussPoint| {
            let corners = corners(&mesh.elements[e]);
            [0, 1].map(|d| (0..4).map(|k| point.values[k] * corners[k][d]).sum())
        };
        let factors = |(e, of): (usize, &[GaussPoint; 4])| of.map(|point| factor(place(e, &point)));
        let toughness = points.iter().enumerate().map(factors).collect();
        let mut mass = vec![0.0; mesh.nodes.len()];
        let mut around = vec![Vec::new(); mesh.nodes.len()];
        for (e, element) in mesh.elements.iter().enumerate() {
            for (k, &n) in element.iter().enumerate() {
                around[n].push(4 * e + k);
                mass[n] += points[e].iter().map(|point| material.density * point.area * point.values[k]).sum::<f64>();
            }
        }
        let nodes = mesh.nodes.len();
        let (shear, lambda) = (material.mu, material.lambda);
        Self {
            displacement: vec![[0.0; 2]; nodes],
            velocity: vec![[0.0; 2]; nodes],
            force: vec![[0.0; 2]; nodes],
            held: vec![[false; 2]; nodes],
            c: vec![1.0; nodes],
            mass,
            material,
            split,
            young: 4.0 * shear * (lambda + shear) / (lambda + 2.0 * shear), // in plane stress
            toughness,
            strains: vec![[[0.0; 3]; 4]; points.len()],
            drive: vec![[0.0; 4]; points.len()],
            of_corners: vec![[[0.0; 2]; 4]; points.len()],
            points,
            around,
            mesh,
        }
    }

    fn strain(&self, e: usize, point: &GaussPoint) -> [f64; 3] {
        let mut strain = [0.0; 3];
        for (&n, [x, y]) in self.mesh.elements[e].iter().zip(point.slopes) {
            let [ux, uy] = self.displacement[n];
            strain[0] += x * ux;
            strain[1] += y * uy;
            strain[2] += y * ux + x * uy;
        }
        strain
    }

    fn crack_at(&self, e: usize, point: &GaussPoint) -> f64 {
        (0..4).map(|k| point.values[k] * self.c[self.mesh.elements[e][k]]).sum()
    }

    fn driving(&self, strain: [f64; 3]) -> f64 {
        match self.split {
            Split::Spectral => self.material.tensile_energy(strain),
            Split::Rankine => {
                let [xx, yy, xy] = self.material.stress(strain, 1.0);
                let largest = larger(0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy), 0.0);
                largest * largest / (2.0 * self.young)
            }
        }
    }

    fn stress(&self, strain: [f64; 3], g: f64) -> [f64; 3] {
        match self.split {
            Split::Spectral => self.material.stress(strain, g),
            Split::Rankine => self.material.stress(strain, 1.0).map(|stress| g * stress),
        }
    }

    /// Strains of the present displacements.
    pub fn deform(&mut self) {
        let mut strains = std::mem::take(&mut self.strains);
        strains.par_iter_mut().enumerate().for_each(|(e, strains)| {
            *strains = std::array::from_fn(|k| self.strain(e, &self.points[e][k]));
        });
        self.strains = strains;
    }

    /// Forces of the stresses; what was in `force` goes.
    pub fn evaluate(&mut self) {
        let mut of_corners = std::mem::take(&mut self.of_corners);
        of_corners.par_iter_mut().enumerate().for_each(|(e, corners)| {
            *corners = [[0.0; 2]; 4];
            for (point, strain) in self.points[e].iter().zip(self.strains[e]) {
                let g = self.material.degradation(self.crack_at(e, point));
                let [xx, yy, xy] = self.stress(strain, g).map(|stress| stress * point.area);
                for (force, [x, y]) in corners.iter_mut().zip(point.slopes) {
                    force[0] -= xx * x + xy * y;
                    force[1] -= xy * x + yy * y;
                }
            }
        });
        let around = &self.around;
        self.force.par_iter_mut().enumerate().for_each(|(n, force)| {
            let shares = around[n].iter().map(|&k| of_corners[k / 4][k % 4]);
            *force = shares.fold([0.0; 2], |sum, share| [sum[0] + share[0], sum[1] + share[1]]);
        });
        self.of_corners = of_corners;
    }

    /// Velocities and displacements after a step; components that are held keep their velocity.
    pub fn kick(&mut self, kick: f64, dt: f64) {
        for n in 0..self.mass.len() {
            for d in 0..2 {
                if !self.held[n][d] {
                    self.velocity[n][d] += kick * self.force[n][d] / self.mass[n];
                }
                self.displacement[n][d] += dt * self.velocity[n][d];
            }
        }
    }

    /// Bound of the angular frequencies of the intact body: the largest of an element by itself, with its
    /// mass at the corners, 1/s.
    pub fn largest_frequency(&self) -> f64 {
        let of_element = |points: &[GaussPoint; 4]| {
            let mass: [f64; 4] =
                std::array::from_fn(|k| points.iter().map(|p| self.material.density * p.area * p.values[k]).sum());
            let mut u: [[f64; 2]; 4] = [[1.0, 0.6], [-0.9, 0.7], [0.8, -1.0], [-0.5, -0.4]];
            let mut largest: f64 = 0.0;
            for _ in 0..60 {
                let mut next = [[0.0; 2]; 4];
                for point in points {
                    let slope = |d: usize, of: usize| (0..4).map(|k| point.slopes[k][d] * u[k][of]).sum::<f64>();
                    let strain = [slope(0, 0), slope(1, 1), slope(1, 0) + slope(0, 1)];
                    let [xx, yy, xy] = self.material.stress(strain, 1.0).map(|stress| stress * point.area);
                    for (next, [x, y]) in next.iter_mut().zip(point.slopes) {
                        next[0] += xx * x + xy * y;
                        next[1] += xy * x + yy * y;
                    }
                }
                next.iter_mut().zip(mass).for_each(|(next, mass)| *next = next.map(|force| force / mass));
                let norm = |of: &[[f64; 2]; 4]| of.as_flattened().iter().map(|u| u * u).sum::<f64>().sqrt();
                largest = norm(&next) / norm(&u);
                u = next.map(|u| u.map(|u| u / norm(&next)));
            }
            largest
        };
        self.points.par_iter().map(of_element).reduce(|| 0.0, f64::max).sqrt()
    }

    /// The phase field of least energy for the present displacements, below the last one. Elements count that
    /// are damaged or driven beyond the threshold of damage, and two rows of elements about them.
    ///
    /// # Panics
    /// If no set of held nodes is found.
    pub fn crack(&mut self) {
        let mut drive = std::mem::take(&mut self.drive);
        let beyond = |e: usize, drive: &[f64; 4]| {
            let [local, factor, _] = self.material.crack_equation();
            (0..4).any(|k| local + factor * drive[k] / self.toughness[e][k] > 1.0)
                || self.mesh.elements[e].iter().any(|&n| self.c[n] < 1.0)
        };
        let counted: Vec<usize> = drive
            .par_iter_mut()
            .enumerate()
            .filter_map(|(e, drive)| {
                *drive = self.strains[e].map(|strain| self.driving(strain));
                beyond(e, drive).then_some(e)
            })
            .collect();
        self.drive = drive;
        if counted.is_empty() {
            return;
        }
        let nodes_of = |elements: &[usize]| sorted(elements.iter().flat_map(|&e| self.mesh.elements[e]).collect());
        let elements_of =
            |nodes: &[usize]| sorted(nodes.iter().flat_map(|&n| &self.around[n]).map(|k| k / 4).collect());
        let nodes = nodes_of(&elements_of(&nodes_of(&counted)));
        let elements = elements_of(&nodes);
        self.settle(&nodes, &elements);
    }

    fn settle(&mut self, nodes: &[usize], elements: &[usize]) {
        let mut number = vec![usize::MAX; self.c.len()];
        nodes.iter().enumerate().for_each(|(k, &n)| number[n] = k);
        let (matrices, loads): (Vec<_>, Vec<_>) = elements.par_iter().map(|&e| self.of_element(e)).unzip();
        let corners: Vec<[usize; 4]> = elements.iter().map(|&e| self.mesh.elements[e].map(|n| number[n])).collect();
        let bound: Vec<f64> = nodes.iter().map(|&n| self.c[n]).collect();
        let mut load = vec![0.0; nodes.len()];
        let mut diagonal = vec![0.0; nodes.len()];
        for (e, corners) in corners.iter().enumerate() {
            for (k, &n) in corners.iter().enumerate().filter(|(_, n)| **n != usize::MAX) {
                load[n] += loads[e][k];
                diagonal[n] += matrices[e][k][k];
            }
        }
        // corners beyond the nodes are intact and stay so
        let product = |x: &[f64], outside: f64| {
            let mut out = vec![0.0; x.len()];
            for (matrix, corners) in matrices.iter().zip(&corners) {
                let x = corners.map(|n| if n == usize::MAX { outside } else { x[n] });
                for (k, &n) in corners.iter().enumerate().filter(|(_, n)| **n != usize::MAX) {
                    out[n] += (0..4).map(|l| matrix[k][l] * x[l]).sum::<f64>();
                }
            }
            out
        };
        let mut x = bound.clone();
        let scaled = |r: &[f64]| r.iter().zip(&diagonal).map(|(r, d)| r * r / d).sum::<f64>().sqrt();
        let limit = TOLERANCE * scaled(&load);
        for _ in 0..200 {
            let mut residual: Vec<f64> = load.iter().zip(product(&x, 1.0)).map(|(b, ax)| b - ax).collect();
            let free: Vec<bool> = (0..x.len())
                .map(|k| !((residual[k] >= 0.0 && x[k] >= bound[k]) || (residual[k] <= 0.0 && x[k] <= 0.0)))
                .collect();
            residual.iter_mut().zip(&free).for_each(|(r, free)| *r *= f64::from(u8::from(*free)));
            if scaled(&residual) <= limit {
                nodes.iter().zip(&x).for_each(|(&n, x)| self.c[n] = *x);
                return;
            }
            let mut direction: Vec<f64> = residual.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
            let mut squared = scaled(&residual).powi(2);
            while squared.sqrt() > 0.3 * limit {
                let mut image = product(&direction, 0.0);
                image.iter_mut().zip(&free).for_each(|(q, free)| *q *= f64::from(u8::from(*free)));
                let alpha = squared / direction.iter().zip(&image).map(|(p, q)| p * q).sum::<f64>();
                x.iter_mut().zip(&direction).for_each(|(x, p)| *x += alpha * p);
                residual.iter_mut().zip(&image).for_each(|(r, q)| *r -= alpha * q);
                let next = scaled(&residual).powi(2);
                let beta = next / squared;
                squared = next;
                for k in 0..direction.len() {
                    direction[k] = residual[k] / diagonal[k] + beta * direction[k];
                }
            }
            x.iter_mut().zip(&bound).for_each(|(x, bound)| *x = x.clamp(0.0, *bound));
        }
        panic!("no set of held nodes was found");
    }

    /// Matrix and right-hand side of the phase field of an element.
    fn of_element(&self, e: usize) -> ([[f64; 4]; 4], [f64; 4]) {
        let [local, drive, diffusion] = self.material.crack_equation();
        let (mut matrix, mut load) = ([[0.0; 4]; 4], [0.0; 4]);
        for (k, point) in self.points[e].iter().enumerate() {
            let surface = self.toughness[e][k] * point.area;
            let product = local * surface + drive * self.drive[e][k] * point.area;
            for i in 0..4 {
                load[i] += surface * point.values[i];
                for j in 0..4 {
                    let dot: f64 = (0..2).map(|d| point.slopes[i][d] * point.slopes[j][d]).sum();
                    matrix[i][j] += product * point.values[i] * point.values[j] + diffusion * surface * dot;
                }
            }
        }
        (matrix, load)
    }

    /// Energies; the kinetic one from the velocities before and after the next kick.
    pub fn energies(&self, kick: f64) -> Energies {
        let kinetic = |n: usize| {
            let gain = |d: usize| if self.held[n][d] { 0.0 } else { kick * self.force[n][d] / self.mass[n] };
            (0..2).map(|d| 0.5 * self.mass[n] * self.velocity[n][d] * (self.velocity[n][d] + gain(d))).sum::<f64>()
        };
        let (mut elastic, mut fracture) = (0.0, 0.0);
        for (e, points) in self.points.iter().enumerate() {
            for (k, point) in points.iter().enumerate() {
                let strain = self.strains[e][k];
                let c = self.crack_at(e, point);
                let stress = self.stress(strain, self.material.degradation(c));
                elastic += 0.5 * point.area * (0..3).map(|k| stress[k] * strain[k]).sum::<f64>();
                let corners = self.mesh.elements[e].map(|n| self.c[n]);
                let slope = [0, 1].map(|d| (0..4).map(|k| point.slopes[k][d] * corners[k]).sum::<f64>());
                let density = self.material.crack_density(c, slope[0] * slope[0] + slope[1] * slope[1]);
                fracture += point.area * self.toughness[e][k] * density;
            }
        }
        [(0..self.mass.len()).map(kinetic).sum(), elastic, fracture]
    }

    /// Moves, and stops whenever the kinetic energy falls, until it is `part` of the elastic one: the state
    /// at rest.
    pub fn relax(&mut self, dt: f64, part: f64) {
        let mut last = 0.0;
        loop {
            self.deform();
            self.evaluate();
            // from a standstill the velocity is one half a step later
            self.kick(if last == 0.0 { 0.5 * dt } else { dt }, dt);
            let squared = |v: &[f64; 2]| v[0] * v[0] + v[1] * v[1];
            let kinetic: f64 = self.velocity.iter().zip(&self.mass).map(|(v, m)| 0.5 * m * squared(v)).sum();
            if kinetic < last {
                self.velocity.fill([0.0; 2]);
                if last < part * self.energies(0.0)[1] {
                    return;
                }
                last = 0.0;
            } else {
                last = kinetic;
            }
        }
    }

    /// The place farthest from `start` where c is 0.05, on sides of elements, m.
    pub fn tip(&self, start: [f64; 2]) -> Option<[f64; 2]> {
        let broken = crate::crack::BROKEN;
        let distance = |p: &[f64; 2]| (p[0] - start[0]).hypot(p[1] - start[1]);
        let sides = self.mesh.elements.iter().flat_map(|e| (0..4).map(|k| [e[k], e[(k + 1) % 4]]));
        let crossings = sides.filter(|[a, b]| {
            self.c[*a] < broken && self.c[*b] >= broken || self.c[*a] >= broken && self.c[*b] < broken
        });
        crossings
            .map(|[a, b]| {
                let part = (broken - self.c[a]) / (self.c[b] - self.c[a]);
                [0, 1].map(|d| self.mesh.nodes[a][d] + part * (self.mesh.nodes[b][d] - self.mesh.nodes[a][d]))
            })
            .max_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

fn sorted(mut numbers: Vec<usize>) -> Vec<usize> {
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}
