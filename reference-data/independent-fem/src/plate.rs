//! The impact-loaded plate: mesh, seeded crack or slit, tractions, steps and what is sampled.

use crate::crack::{self, Crack};
use crate::dynamics::{Dynamics, Energies};
use crate::element::{HIGH, LOW};
use crate::gradients::Stop;
use crate::material::{Material, Surface};
use crate::mesh::{CRACK, Grading, Mesh};
use crate::phase_field::PhaseField;

/// Factor B of the history that seeds the crack.
const SEED: f64 = 1000.0;

/// What is computed.
#[derive(Debug, Clone, Copy)]
pub struct Plate {
    /// Element size at the crack, m.
    pub h: f64,
    /// Larger elements away from the crack.
    pub grading: Option<Grading>,
    /// The whole plate, or its upper half with symmetry.
    pub whole: bool,
    /// A notch with free faces instead of a seeded crack; half plate only.
    pub slit: bool,
    /// No phase field: linear elasticity.
    pub frozen: bool,
    /// What it is made of.
    pub material: Material,
    /// Traction on the upper and lower edge from t = 0 on, Pa.
    pub traction: f64,
    /// Residual of the phase field over its right-hand side.
    pub tolerance: f64,
    /// Whether conjugate gradients leave out tiles that do not count.
    pub tiles: bool,
    /// Steps are shortened by this factor.
    pub divide: usize,
    /// Most of the critical step of an element that a step may take.
    pub fraction: f64,
    /// The phase field is solved for in every step whose number is a multiple of this.
    pub every: usize,
    /// Time at the end, s.
    pub end: f64,
    /// Time between samples, s.
    pub interval: f64,
    /// Number of threads.
    pub threads: usize,
}

/// The plate at one time; energies are those of the whole plate.
#[derive(Debug, Clone, Copy)]
pub struct Sample {
    /// Time of the sample, s.
    pub time: f64,
    /// J per metre of thickness.
    pub energies: Energies,
    /// Where the crack is.
    pub crack: Crack,
    /// Iterations per phase-field solve since the last sample.
    pub iterations: f64,
    /// Least and largest phase field.
    pub range: [f64; 2],
}

/// Numbers of a finished run.
#[derive(Debug, Clone, Copy)]
pub struct Totals {
    /// Number of time steps.
    pub steps: usize,
    /// Step, s.
    pub step: f64,
    /// Number of elements.
    pub elements: usize,
    /// Iterations of all phase-field solves.
    pub iterations: usize,
}

impl Plate {
    /// Steps to the end, and hands each sample to `take`.
    ///
    /// # Errors
    /// If numbers are not finite.
    pub fn run(&self, mut take: impl FnMut(&Mesh, &[f64], Sample)) -> Result<Totals, String> {
        let mesh = Mesh::plate(self.h, self.grading, self.whole);
        let mut field = PhaseField::new(&mesh, self.material, self.threads);
        let mut body = Dynamics::new(&mesh, self.material);
        self.load(&mesh, &mut body);
        if !self.slit {
            self.seed(&mesh, &mut field);
            field.settle(1e-12);
        }
        let critical = self.material.critical_step(mesh.smallest());
        let per_sample = (self.interval / (self.fraction * critical) - 1e-9).ceil() as usize * self.divide;
        let dt = self.interval / per_sample as f64;
        let steps = (self.end / dt).round() as usize;
        let stop = Stop { tolerance: self.tolerance, tiles: self.tiles, most: 2000 };
        let (mut iterations, mut since) = (0, 0);
        for n in 0..=steps {
            let between = n % self.every;
            if n > 0 && between == 0 && !self.frozen {
                field.remember(&body.displacement[0], &body.displacement[1]);
                let needed = field.solve(stop);
                iterations += needed;
                since += needed;
            }
            let c = if between == 0 { &field.c } else { field.gone_on(between as f64 / self.every as f64) };
            body.evaluate(c);
            let kick = if n == 0 { 0.5 * dt } else { dt };
            if n % per_sample == 0 {
                let solves = per_sample.min(n).max(1) as f64;
                let energies = self.of_the_whole(body.energies(kick, c), n == 0);
                let total = energies.elastic + energies.kinetic + energies.fracture;
                if !total.is_finite() {
                    return Err(format!("numbers are not finite at step {n}, t = {:.3e} s", n as f64 * dt));
                }
                let crack = crack::find(&mesh, c, self.whole);
                let range = range(c, &mesh);
                let time = n as f64 * dt;
                take(&mesh, c, Sample { time, energies, crack, iterations: since as f64 / solves, range });
                since = 0;
            }
            body.kick(kick, dt);
        }
        Ok(Totals { steps, step: dt, elements: mesh.columns() * mesh.rows(), iterations })
    }

    fn load(&self, mesh: &Mesh, body: &mut Dynamics) {
        let (stride, top) = (mesh.stride(), mesh.rows());
        for i in 0..mesh.x.len() {
            let before = if i > 0 { mesh.x[i] - mesh.x[i - 1] } else { 0.0 };
            let width = 0.5 * (before + mesh.x.get(i + 1).map_or(0.0, |next| next - mesh.x[i]));
            body.traction[1][top * stride + i + 1] = self.traction * width;
            if self.whole {
                body.traction[1][i + 1] = -self.traction * width;
            } else if !(self.slit && mesh.x[i] < CRACK - 1e-9) {
                body.mobility[1][i + 1] = 0.0;
            }
        }
    }

    /// AT1: c = 0 on the crack and one element beside it. AT2: history B Gc/(4 l0) (1 − d/w) at the distance
    /// d ≤ w from it, with w = l0 and at least two elements, since the faces of narrower ones hold together.
    fn seed(&self, mesh: &Mesh, field: &mut PhaseField) {
        if self.material.surface == Surface::At1 {
            let axis = if self.whole { mesh.rows() / 2 } else { 0 };
            let nodes = (0..mesh.x.len()).filter(|&i| mesh.x[i] <= CRACK + 1e-9);
            for row in axis.saturating_sub(1)..=axis + 1 {
                nodes.clone().for_each(|i| field.bound[row * mesh.stride() + i + 1] = 0.0);
            }
            return;
        }
        let (stride, l0) = (mesh.stride(), self.material.length_scale);
        let width = l0.max(2.0 * mesh.smallest());
        for j in 0..mesh.rows() {
            for point in 0..4 {
                for i in 0..mesh.columns() {
                    let at = |lines: &[f64], k: usize, high: bool| {
                        lines[k] + (lines[k + 1] - lines[k]) * if high { HIGH } else { LOW }
                    };
                    let (x, y) = (at(&mesh.x, i, point % 2 == 1), at(&mesh.y, j, point / 2 == 1));
                    let distance = (x - CRACK).max(0.0).hypot(y);
                    if distance <= width {
                        field.history[(4 * j + point) * stride + i + 1] =
                            SEED * self.material.toughness / (4.0 * l0) * (1.0 - distance / width);
                    }
                }
            }
        }
    }

    fn of_the_whole(&self, part: Energies, at_rest: bool) -> Energies {
        let factor = if self.whole { 1.0 } else { 2.0 };
        Energies {
            kinetic: if at_rest { 0.0 } else { factor * part.kinetic },
            elastic: factor * part.elastic,
            fracture: factor * part.fracture,
            work: factor * part.work,
        }
    }
}

fn range(c: &[f64], mesh: &Mesh) -> [f64; 2] {
    let nodes = c.chunks_exact(mesh.stride()).flat_map(|row| &row[1..=mesh.x.len()]);
    nodes.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, largest], c| [least.min(*c), largest.max(*c)])
}
