//! The phase-field equation `(local + factor H) c − diffusion div grad c = 1`: what drives it and its
//! solution, without bounds (AT2) or below the last field (AT1).

use rayon::prelude::*;

use crate::bounded;
use crate::element::{self, Gauss, HIGH, LOW};
use crate::gradients::{ConjugateGradients, Stop};
use crate::material::{Material, Surface, larger};
use crate::mesh::Mesh;
use crate::stencil::{Stencil, TILE_ROWS, row};

/// Phase field and history of a mesh.
#[derive(Debug)]
pub struct PhaseField {
    /// Nodal values; 1 where intact.
    pub c: Vec<f64>,
    previous: Vec<f64>,
    /// c between two solves.
    between: Vec<f64>,
    /// What drives the crack at the Gauss points: per row of elements, four rows of numbers. J/m³.
    pub history: Vec<f64>,
    /// AT1: what c may not exceed, besides its last value.
    pub bound: Vec<f64>,
    /// The row of elements without height among those of the displacements, if there is one; c has none.
    pub gap: Option<usize>,
    /// Lumped volumes, m².
    volumes: Vec<f64>,
    /// Added to the diagonal of the lowest row of nodes, where c is to be zero.
    penalty: f64,
    matrix: Stencil,
    solver: ConjugateGradients,
    right: Vec<f64>,
    scaled: Vec<f64>,
    widths: Vec<f64>,
    inverse_widths: Vec<f64>,
    heights: Vec<f64>,
    stride: usize,
    material: Material,
}

/// Entries of an element matrix: corners with themselves, along the edges, across.
struct ElementMatrix {
    corners: [f64; 4],
    lower: f64,
    upper: f64,
    left: f64,
    right: f64,
    across: f64,
}

impl PhaseField {
    /// An intact body.
    pub fn new(mesh: &Mesh, material: Material, threads: usize) -> Self {
        let (stride, nodal) = (mesh.stride(), mesh.nodal());
        let mut c = nodal.clone();
        c.chunks_exact_mut(stride).for_each(|row| row[1..stride - 1].fill(1.0));
        Self {
            previous: c.clone(),
            between: c.clone(),
            bound: c.clone(),
            gap: None,
            c,
            history: vec![0.0; mesh.rows() * 4 * stride],
            volumes: mesh.volumes(),
            penalty: 0.0,
            matrix: Stencil::new(&nodal, stride),
            solver: ConjugateGradients::new(&nodal, stride, threads),
            right: nodal.clone(),
            scaled: nodal,
            inverse_widths: mesh.widths().iter().map(|width| 1.0 / width).collect(),
            widths: mesh.widths(),
            heights: mesh.heights(),
            stride,
            material,
        }
    }

    /// Takes the tensile energy of the displacements, or the largest so far (AT2).
    pub fn remember(&mut self, ux: &[f64], uy: &[f64]) {
        let (stride, material, gap) = (self.stride, self.material, self.gap);
        if material.surface == Surface::At1 {
            self.history.fill(0.0);
        }
        let (inverse_widths, heights) = (&self.inverse_widths[..stride], &self.heights);
        self.history.par_chunks_mut(4 * stride).enumerate().for_each(|(j, history)| {
            let lower = if gap.is_some_and(|gap| j >= gap) { j + 1 } else { j };
            let lower_upper = |u| [&row(u, lower, stride)[..stride], &row(u, lower + 1, stride)[..stride]];
            let ([xl, xu], [yl, yu]) = (lower_upper(ux), lower_upper(uy));
            let inverse_height = 1.0 / heights[j];
            let (first, second) = history.split_at_mut(2 * stride);
            let ((h0, h1), (h2, h3)) = (first.split_at_mut(stride), second.split_at_mut(stride));
            let (h2, h3) = (&mut h2[..stride], &mut h3[..stride]);
            for i in 1..stride - 2 {
                let (ux, uy) = ([xl[i], xl[i + 1], xu[i], xu[i + 1]], [yl[i], yl[i + 1], yu[i], yu[i + 1]]);
                let [e0, e1, e2, e3] = element::strains(ux, uy, inverse_widths[i], inverse_height);
                h0[i] = larger(material.tensile_energy(e0), h0[i]);
                h1[i] = larger(material.tensile_energy(e1), h1[i]);
                h2[i] = larger(material.tensile_energy(e2), h2[i]);
                h3[i] = larger(material.tensile_energy(e3), h3[i]);
            }
        });
    }

    /// Solves for c from what drives it; gives the iterations.
    pub fn solve(&mut self, stop: Stop) -> usize {
        self.assemble();
        match self.material.surface {
            Surface::At2 => self.solve_freely(stop),
            Surface::At1 => self.solve_below(stop.tolerance),
        }
    }

    /// The least energy below the last field, and the bound becomes what was found.
    fn solve_below(&mut self, tolerance: f64) -> usize {
        self.matrix.scale_to_unit_diagonal();
        let scale = &self.matrix.scale;
        let unscaled = |(value, scale): (&f64, &f64)| value * scale;
        let scaled = |(value, scale): (&f64, &f64)| if *scale > 0.0 { value / scale } else { 0.0 }; // guards
        let bound: Vec<f64> = self.bound.iter().zip(scale).map(scaled).collect();
        self.scaled.copy_from_slice(&bound);
        self.right = self.volumes.iter().zip(scale).map(unscaled).collect();
        let iterations = bounded::solve(&self.matrix, self.stride, &self.right, &bound, &mut self.scaled, tolerance);
        let found = self.scaled.iter().zip(scale).map(unscaled);
        self.c.iter_mut().zip(found).for_each(|(c, found)| *c = found);
        self.bound.copy_from_slice(&self.c);
        iterations
    }

    /// The solution without bounds, from an extrapolation in time.
    fn solve_freely(&mut self, stop: Stop) -> usize {
        self.matrix.diagonal[1..self.stride - 1].iter_mut().for_each(|d| *d += self.penalty);
        self.matrix.scale_to_unit_diagonal();
        let stride = self.stride;
        let arrays = (
            self.right.par_chunks_mut(stride),
            self.scaled.par_chunks_mut(stride),
            self.previous.par_chunks_mut(stride),
            self.c.par_chunks(stride),
            self.volumes.par_chunks(stride),
            self.matrix.scale.par_chunks(stride),
        );
        arrays.into_par_iter().for_each(|(right, scaled, previous, c, volumes, scale)| {
            for i in 1..stride - 1 {
                right[i] = volumes[i] * scale[i];
                scaled[i] = (2.0 * c[i] - previous[i]) / scale[i];
                previous[i] = c[i];
            }
        });
        let iterations = self.solver.solve(&self.matrix, &self.right, &mut self.scaled, stop);
        let rows = self.c.par_chunks_mut(stride).zip(self.scaled.par_chunks(stride));
        rows.zip(self.matrix.scale.par_chunks(stride)).for_each(|((c, scaled), scale)| {
            for i in 1..stride - 1 {
                c[i] = scaled[i] * scale[i];
            }
        });
        iterations
    }

    /// The field `part` of the interval between solves after the last: it goes on as it did before, but falls
    /// no further than to zero.
    pub fn gone_on(&mut self, part: f64) -> &[f64] {
        let both = self.c.par_chunks(self.stride).zip(self.previous.par_chunks(self.stride));
        self.between.par_chunks_mut(self.stride).zip(both).for_each(|(between, (c, previous))| {
            for ((between, c), previous) in between.iter_mut().zip(c).zip(previous) {
                *between = larger(c + part * (c - previous), c.min(0.0));
            }
        });
        &self.between
    }

    /// Solves from the start to `tolerance`, and takes the solution for the one before as well.
    pub fn settle(&mut self, tolerance: f64) {
        self.solve(Stop { tolerance, tiles: false, most: 20_000 });
        self.previous.copy_from_slice(&self.c);
    }

    /// Holds c at zero on the lowest row of nodes.
    pub fn break_lowest_row(&mut self) {
        self.penalty = 1e6;
    }

    /// Tile of node rows by tile: what the rows of elements above and below each give.
    fn assemble(&mut self) {
        let stride = self.stride;
        let equation = self.material.crack_equation();
        let (widths, heights, history) = ([&self.widths, &self.inverse_widths], &self.heights, &self.history);
        let matrix = &mut self.matrix;
        let size = TILE_ROWS * stride;
        let arrays = (
            matrix.diagonal.par_chunks_mut(size),
            matrix.east.par_chunks_mut(size),
            matrix.north.par_chunks_mut(size),
            matrix.north_east.par_chunks_mut(size),
            matrix.north_west.par_chunks_mut(size),
        );
        arrays.into_par_iter().enumerate().for_each(|(tile, (diagonal, east, north, north_east, north_west))| {
            let first = tile * TILE_ROWS;
            let rows = diagonal.len() / stride;
            let mut elements = ElementRow::new(stride);
            let mut below = ElementRow::new(stride);
            if let Some(e) = first.checked_sub(1) {
                below.fill(row(history, e, 4 * stride), widths, heights[e], equation);
            }
            for k in 0..rows {
                match heights.get(first + k) {
                    Some(height) => {
                        let history = row(history, first + k, 4 * stride);
                        elements.fill(history, widths, *height, equation);
                    }
                    None => elements = ElementRow::new(stride), // above the body
                }
                let of_row = k * stride..(k + 1) * stride;
                elements.gather(&below, &mut diagonal[of_row.clone()], &mut east[of_row.clone()]);
                elements.couple(&mut north[of_row.clone()], &mut north_east[of_row.clone()], &mut north_west[of_row]);
                std::mem::swap(&mut elements, &mut below);
            }
        });
    }
}

/// Matrices of a row of elements; the guards are zero.
struct ElementRow([Vec<f64>; 9]);

impl ElementRow {
    fn new(stride: usize) -> Self {
        Self(std::array::from_fn(|_| vec![0.0; stride]))
    }

    /// Matrices from the history at four Gauss points per element.
    fn fill(&mut self, history: &[f64], [widths, inverse]: [&Vec<f64>; 2], height: f64, equation: [f64; 3]) {
        let [local, factor, diffusion] = equation;
        let n = widths.len();
        let (widths, inverse) = (&widths[..n], &inverse[..n]);
        let inverse_height = 1.0 / height;
        let at = |point: usize| &history[point * n..(point + 1) * n];
        let (h0, h1, h2, h3) = (at(0), at(1), at(2), at(3));
        let [ll, lr, ul, ur, lower, upper, left, right, across] = self.0.each_mut().map(|values| &mut values[..n]);
        for i in 1..n - 2 {
            let volume = 0.25 * widths[i] * height;
            let reaction = [h0[i], h1[i], h2[i], h3[i]].map(|h| volume * (local + factor * h));
            let matrix =
                element_matrix(reaction, diffusion * height * inverse[i], diffusion * widths[i] * inverse_height);
            [ll[i], lr[i], ul[i], ur[i]] = matrix.corners;
            (lower[i], upper[i], left[i], right[i]) = (matrix.lower, matrix.upper, matrix.left, matrix.right);
            across[i] = matrix.across;
        }
    }

    /// Diagonal and couplings along the row of nodes between these elements and those `below`.
    fn gather(&self, below: &Self, diagonal: &mut [f64], east: &mut [f64]) {
        let n = diagonal.len();
        let [ll, lr, _, _, lower, ..] = self.0.each_ref().map(|values| &values[..n]);
        let [_, _, ul, ur, _, upper, ..] = below.0.each_ref().map(|values| &values[..n]);
        let east = &mut east[..n];
        for i in 1..n - 1 {
            diagonal[i] = ll[i] + lr[i - 1] + ul[i] + ur[i - 1];
            east[i] = lower[i] + upper[i];
        }
    }

    /// Couplings with the row of nodes above.
    fn couple(&self, north: &mut [f64], north_east: &mut [f64], north_west: &mut [f64]) {
        let n = north.len();
        let [_, _, _, _, _, _, left, right, across] = self.0.each_ref().map(|values| &values[..n]);
        let (north_east, north_west) = (&mut north_east[..n], &mut north_west[..n]);
        for i in 1..n - 1 {
            north[i] = left[i] + right[i - 1];
            north_east[i] = across[i];
            north_west[i] = across[i - 1];
        }
    }
}

/// Matrix of an element with the reactions at its Gauss points and the conductances along x and y.
#[inline(always)]
fn element_matrix([m0, m1, m2, m3]: Gauss<f64>, along_x: f64, along_y: f64) -> ElementMatrix {
    let (high, low, mixed) = (HIGH * HIGH, LOW * LOW, HIGH * LOW);
    let (a0, b0, c0) = (high * m0 + low * m1, low * m0 + high * m1, mixed * (m0 + m1));
    let (a1, b1, c1) = (high * m2 + low * m3, low * m2 + high * m3, mixed * (m2 + m3));
    let own = (along_x + along_y) / 3.0;
    let (edge_x, edge_y) = (along_y / 6.0 - along_x / 3.0, along_x / 6.0 - along_y / 3.0);
    ElementMatrix {
        corners: [high * a0 + low * a1, high * b0 + low * b1, low * a0 + high * a1, low * b0 + high * b1]
            .map(|mass| mass + own),
        lower: high * c0 + low * c1 + edge_x,
        upper: low * c0 + high * c1 + edge_x,
        left: mixed * (a0 + a1) + edge_y,
        right: mixed * (b0 + b1) + edge_y,
        across: mixed * (c0 + c1) - (along_x + along_y) / 6.0,
    }
}
