//! The test of Kalthoff and Winkler: the upper half of a plate with a slit, driven at a part of its left
//! edge.

use crate::crack;
use crate::dynamics::Dynamics;
use crate::gradients::Stop;
use crate::material::Material;
use crate::mesh::{Mesh, extend};
use crate::phase_field::PhaseField;

/// Side of the half plate, m.
const SIDE: f64 = 0.1;
/// Height and length of the slit, m.
const SLIT: [f64; 2] = [0.025, 0.05];
/// Velocity of the driven part below the slit, m/s, and the time over which it rises, s.
const VELOCITY: f64 = 16.5;
const RISE: f64 = 1e-6;
/// With grading, where short columns and rows begin and end, m: cracks stay between them up to 50 us.
/// Beside them elements are 2 h long for 6 mm, then 4 h.
const FINE: [[f64; 2]; 2] = [[0.044, 0.074], [0.019, 0.066]];
const BESIDE: f64 = 6e-3;

/// A run.
#[derive(Debug, Clone, Copy)]
pub struct Kalthoff {
    /// Element size at the crack, m.
    pub h: f64,
    /// Larger elements where the crack does not run.
    pub graded: bool,
    /// Elements by which the node at the tip of the slit lies ahead of the tip: with 0.23 a slit acts where
    /// it is drawn, judged by the energy of a plate in tension.
    pub tip_ahead: f64,
    /// What the plate is made of.
    pub material: Material,
    /// Residual of the phase field over its right-hand side; without one the plate does not crack.
    pub tolerance: Option<f64>,
    /// Most of the critical step of an element that a step may take.
    pub fraction: f64,
    /// Time at the end, and between samples, s.
    pub end: f64,
    /// See [`Self::end`].
    pub interval: f64,
    /// Threads of the solves for the phase field.
    pub threads: usize,
}

/// Time (s), work of the driven part, kinetic, elastic and fracture energy of the half plate (J/m), reaction
/// of the driven part (N/m), place of the tip (m; not a number before there is one).
pub type Row = [f64; 8];

/// Steel of the test; plane strain or plane stress.
pub fn steel(plane_stress: bool) -> Material {
    Material { density: 8000.0, ..Material::new(190e9, 0.3, plane_stress) }
}

impl Kalthoff {
    /// Node lines from 0 to the far side, one of them at `slit`.
    fn lines(&self, [from, to]: [f64; 2], slit: f64) -> Vec<f64> {
        let mut lines = vec![0.0];
        if !self.graded {
            extend(&mut lines, slit, self.h);
            extend(&mut lines, SIDE, self.h);
            return lines;
        }
        let parts = [(from - BESIDE, 4.0), (from, 2.0), (slit, 1.0), (to, 1.0), (to + BESIDE, 2.0), (SIDE, 4.0)];
        parts.into_iter().for_each(|(end, times)| extend(&mut lines, end, times * self.h));
        lines
    }

    /// Steps to the end; the rows sampled.
    pub fn run(&self) -> Vec<Row> {
        let material = self.material;
        let tip = SLIT[1] + self.tip_ahead * self.h;
        let x = self.lines(FINE[0], tip);
        let mut y = self.lines(FINE[1], SLIT[0]);
        let lines = x.len() - 1;
        let slit_row = y.partition_point(|y| *y < SLIT[0] - 1e-9);
        let whole = Mesh { x: x.clone(), y: y.clone() };
        y.insert(slit_row, y[slit_row]); // a row of elements without height
        let mesh = Mesh { x, y };
        let stride = mesh.stride();
        let mut field = PhaseField::new(&whole, material, self.threads);
        field.gap = Some(slit_row);
        // c has one row of nodes along the slit; the displacements have two
        let both = |c: &[f64]| [&c[..(slit_row + 1) * stride], &c[slit_row * stride..]].concat();
        let mut body = Dynamics::new(&mesh, material);
        let behind = (0..=lines).filter(|&i| mesh.x[i] >= tip - 1e-9);
        body.tie(behind.map(|i| [slit_row, slit_row + 1].map(|row| row * stride + i + 1)).collect());
        body.mobility[1][1..=lines + 1].fill(0.0);
        let driven: Vec<usize> = (0..=slit_row).map(|row| row * stride + 1).collect();
        driven.iter().for_each(|&node| body.mobility[0][node] = 0.0);

        let critical = material.critical_step(self.h);
        let per_sample = (self.interval / (self.fraction * critical) - 1e-9).ceil() as usize;
        let dt = self.interval / per_sample as f64;
        let mut c = both(&field.c);
        let velocity = |time: f64| VELOCITY * (time / RISE).clamp(0.0, 1.0);
        let (mut rows, mut work, mut last) = (Vec::new(), 0.0, [0.0; 2]); // reaction and velocity of the step before
        for n in 0..=(self.end / dt).round() as usize {
            let time = n as f64 * dt;
            if let Some(tolerance) = self.tolerance.filter(|_| n > 0) {
                field.remember(&body.displacement[0], &body.displacement[1]);
                field.solve(Stop { tolerance, tiles: true, most: 2000 });
                c = both(&field.c);
            }
            body.evaluate(&c);
            let next = velocity(time + 0.5 * dt);
            let acceleration = (next - last[1]) / if n == 0 { 0.5 * dt } else { dt };
            let reaction: f64 = driven.iter().map(|&node| body.mass(node) * acceleration - body.force(0, node)).sum();
            work += dt * last[1] * 0.5 * (last[0] + reaction);
            let kick = if n == 0 { 0.5 * dt } else { dt };
            if n % per_sample == 0 {
                let energies = body.energies(kick, &c);
                // the driven nodes have no mobility, so their gain is missing from the product of velocities
                let missing: f64 = driven.iter().map(|&node| 0.5 * body.mass(node) * last[1] * (next - last[1])).sum();
                let kinetic = if n == 0 { 0.0 } else { energies.kinetic + missing };
                let [tip_x, tip_y] = crack::farthest(&whole, &field.c, [SLIT[1], SLIT[0]]).unwrap_or([f64::NAN; 2]);
                rows.push([time, work, kinetic, energies.elastic, energies.fracture, reaction, tip_x, tip_y]);
            }
            driven.iter().for_each(|&node| body.velocity[0][node] = next);
            body.kick(kick, dt);
            last = [reaction, next];
        }
        rows
    }
}
