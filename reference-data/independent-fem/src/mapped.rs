//! Problems on meshes of quadrilaterals: a pre-strained strip, a ring under a pressure pulse, a plate with
//! two holes that stop a crack.

use crate::material::{Material, Surface};
use crate::mesh::extend;
use crate::quad_body::{QuadBody, Split};
use crate::quads::{Hole, Quads};
use crate::random::Toughness;

/// Which problem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Problem {
    /// Upper half of 40 × 8 mm between grips that hold both components, crack of 8 mm.
    Strip,
    /// Whole ring, 80 to 150 mm, pressure 400 MPa exp(−t/100 us).
    Ring,
    /// 140 × 70 mm, hole, slot, second hole.
    Arrest,
}

/// A run.
#[derive(Debug, Clone, Copy)]
pub struct Mapped {
    /// See [`Problem`].
    pub problem: Problem,
    /// Element size where it cracks, m.
    pub h: f64,
    /// Length b of AT1, m.
    pub b: f64,
    /// Whether it cracks.
    pub cracks: bool,
    /// Gc over 1 + 3 h/(8 b), what a crack of AT1 costs on elements of size h (Bourdin et al. 2008), where
    /// they have that size: it lowers the strength, too.
    pub mesh_toughness: bool,
    /// Seed of the random toughness of the ring; the same everywhere without one.
    pub seed: Option<u64>,
    /// Time at the end, and between samples, s.
    pub end: f64,
    /// See [`Self::end`].
    pub interval: f64,
}

/// Time (s), work of loads and driven sides, kinetic, elastic, fracture energy (J/m), tip (m).
pub type Row = [f64; 7];

/// A speed (m/s) or a pressure (Pa) against time (s).
type Course = fn(f64) -> f64;

/// Node lines from zero on: the ends of the parts and the sizes of their spans.
fn lines(parts: &[(f64, f64)]) -> Vec<f64> {
    let mut lines = vec![0.0];
    parts.iter().for_each(|&(end, size)| extend(&mut lines, end, size));
    lines
}

/// Node lines between two ends, from `fine` at one of them on: each interval is a fifth longer than the one
/// before, up to `most`. The ends and sizes of the parts, from the lower end to the upper one.
fn growing(fine: f64, coarse: f64, size: f64, most: f64) -> Vec<(f64, f64)> {
    let mut sizes = vec![size];
    let length = (coarse - fine).abs();
    while sizes.iter().sum::<f64>() < length {
        sizes.push((1.2 * sizes[sizes.len() - 1]).min(most));
    }
    let scale = length / sizes.iter().sum::<f64>();
    if coarse < fine {
        sizes.reverse();
    }
    let mut end = fine.min(coarse);
    let part = |size: f64| {
        end += scale * size;
        (end, scale * size)
    };
    sizes.into_iter().map(part).collect()
}

impl Mapped {
    fn material(&self, young: f64, poisson: f64, density: f64, toughness: f64) -> Material {
        let elastic = Material::new(young, poisson, true);
        Material { density, toughness, length_scale: 0.5 * self.b, surface: Surface::At1, ..elastic }
    }

    /// Gc over that of the material where elements have the size h.
    fn relative_toughness(&self) -> f64 {
        if self.mesh_toughness { 1.0 / (1.0 + 0.375 * self.h / self.b) } else { 1.0 }
    }

    fn strip(&self) -> QuadBody {
        let x = lines(&[(0.04, self.h)]);
        let y = lines(&[(1e-3, self.h), (4e-3, 2.0 * self.h)]);
        let material = self.material(32e9, 0.2, 2450.0, 3.0);
        let (of_mesh, mesh) = (self.relative_toughness(), Quads::between(&x, &y));
        let toughness = |[_, y]: [f64; 2]| if y < 1e-3 { of_mesh } else { 1.0 };
        let mut body = QuadBody::new(mesh, material, Split::Spectral, toughness);
        for (n, [x, y]) in body.mesh.nodes.clone().into_iter().enumerate() {
            let seeded = y == 0.0 && x <= 8e-3 + 1e-9;
            body.held[n] = [y == 4e-3, y == 4e-3 || (y == 0.0 && !seeded)];
            body.displacement[n][1] = 0.66e-6 * y / 4e-3;
            if seeded {
                body.c[n] = 0.0;
            }
        }
        body
    }

    fn ring(&self) -> QuadBody {
        let around = (std::f64::consts::TAU * 0.115 / self.h / 8.0).round() as usize * 8;
        let mesh = Quads::ring(0.08, 0.15, [(0.07 / self.h).round() as usize, around]);
        let field = self.seed.map(|seed| Toughness { modulus: 10.0, correlation: 5e-3, seed });
        let material = self.material(210e9, 0.3, 7850.0, 20e3);
        let of_mesh = self.relative_toughness();
        QuadBody::new(mesh, material, Split::Rankine, |place| of_mesh * field.map_or(1.0, |field| field.at(place)))
    }

    fn arrest(&self) -> QuadBody {
        let (h, most) = (self.h, 1.5e-3);
        let x = lines(
            &[
                vec![(27e-3, most)],
                vec![(63e-3, most)],
                growing(74e-3, 63e-3, h, most),
                vec![(76e-3, h), (95e-3, h)],
                growing(95e-3, 104e-3, h, most),
                vec![(140e-3, most)],
            ]
            .concat(),
        );
        let y = lines(
            &[
                vec![(17e-3, most)],
                growing(33.2e-3, 17e-3, h, most),
                vec![(34.75e-3, h), (35.25e-3, h), (35.8e-3, h), (36e-3, 1.2 * h)],
                growing(36e-3, 53e-3, 1.5 * h, most),
                vec![(64e-3, most), (70e-3, most)],
            ]
            .concat(),
        );
        let mut mesh = Quads::between(&x, &y);
        mesh.cut(&x, &y, Hole { centre: [45e-3, 35e-3], radius: 15e-3, half: 18e-3, layers: 6 });
        mesh.cut(&x, &y, Hole { centre: [90e-3, 50e-3], radius: 11.5e-3, half: 14e-3, layers: 8 });
        let slot = |[x, y]: [f64; 2]| {
            // the rays of the first hole narrow the slot within its square
            let half = 0.25e-3 * ((x - 45e-3) / 18e-3).clamp(0.0, 1.0);
            x > 45e-3 && x < 75e-3 && (y - 35e-3).abs() < half
        };
        let material = self.material(2.4e9, 0.42, 1180.0, 267.0);
        let of_mesh = self.relative_toughness();
        let is_fine = |[x, y]: [f64; 2]| (74e-3..104e-3).contains(&x) && (33.2e-3..36e-3).contains(&y);
        let toughness = |place| if is_fine(place) { of_mesh } else { 1.0 };
        let mut body = QuadBody::new(mesh.without(slot), material, Split::Rankine, toughness);
        for (n, [x, y]) in body.mesh.nodes.clone().into_iter().enumerate() {
            let side = (x == 0.0 || (x - 140e-3).abs() < 1e-9) && (y - 35e-3).abs() < 20e-3 + 1e-9;
            body.held[n][0] = side;
        }
        body
    }

    /// Steps to the end; the rows sampled.
    pub fn run(&self, mut sampled: impl FnMut(Row)) {
        let still: Course = |_| 0.0;
        let smooth: Course = |time| {
            let s = (time / 0.5e-6).clamp(0.0, 1.0);
            10.0 * s * s * (3.0 - 2.0 * s)
        };
        let pulse: Course = |time| 400e6 * (-time / 100e-6).exp() * (1.0 - (-(time / 2e-6).powi(2)).exp());
        let (mut body, drive, pressure, start) = match self.problem {
            Problem::Strip => (self.strip(), still, still, [0.0; 2]),
            Problem::Ring => (self.ring(), still, pulse, [0.0; 2]),
            Problem::Arrest => (self.arrest(), smooth, still, [75e-3, 35e-3]),
        };
        let driven: Vec<usize> =
            (0..body.mass.len()).filter(|&n| body.held[n][0] && body.mesh.nodes[n][0] == 0.0).collect();
        let bore: Vec<[usize; 2]> = match self.problem {
            Problem::Ring => body.mesh.boundary().into_iter().filter(|side| inner(&body, *side)).collect(),
            _ => Vec::new(),
        };
        let critical = 2.0 / body.largest_frequency();
        let per_sample = (self.interval / (0.9 * critical)).ceil() as usize;
        let dt = self.interval / per_sample as f64;
        if self.problem == Problem::Strip {
            // each solve reaches two rows of elements further from the seed
            body.deform();
            (0..100).for_each(|_| body.crack());
            body.relax(dt, 1e-8);
        }
        let (mut work, mut last) = (0.0, [0.0; 2]); // power of loads and drive of the step before
        for n in 0..=(self.end / dt).round() as usize {
            let time = n as f64 * dt;
            body.deform();
            if n > 0 && self.cracks {
                body.crack();
            }
            body.evaluate();
            let kick = if n == 0 { 0.5 * dt } else { dt };
            let loads = press(&bore, &body.mesh, pressure(time));
            loads.iter().for_each(|&(n, load)| (0..2).for_each(|d| body.force[n][d] += load[d]));
            // power of the loads over both half steps; that of a driven side from its reaction
            let next = drive(time + 0.5 * dt);
            let acceleration = (next - last[1]) / kick;
            let reaction: f64 = driven.iter().map(|&n| body.mass[n] * acceleration - body.force[n][0]).sum();
            let power = |body: &QuadBody, after: f64| {
                loads
                    .iter()
                    .map(|&(n, load)| {
                        (0..2)
                            .map(|d| load[d] * (body.velocity[n][d] + after * body.force[n][d] / body.mass[n]))
                            .sum::<f64>()
                    })
                    .sum::<f64>()
            };
            if n > 0 {
                work += 0.5 * dt * (power(&body, 0.0) + last[1] * reaction);
            }
            if n % per_sample == 0 {
                let [kinetic, elastic, fracture] = body.energies(kick);
                let of_driven: f64 = driven.iter().map(|&n| 0.5 * body.mass[n] * last[1] * next).sum();
                let own: f64 = driven.iter().map(|&n| 0.5 * body.mass[n] * last[1] * last[1]).sum();
                let [x, y] = body.tip(start).unwrap_or([f64::NAN; 2]);
                sampled([time, work, kinetic + of_driven - own, elastic, fracture, x, y]);
            }
            work += 0.5 * dt * (power(&body, kick) + next * reaction);
            driven.iter().for_each(|&n| body.velocity[n][0] = next);
            body.kick(kick, dt);
            last = [reaction, next];
        }
    }
}

/// Whether a side lies on the bore of the ring.
fn inner(body: &QuadBody, side: [usize; 2]) -> bool {
    side.iter().all(|&n| body.mesh.nodes[n][0].hypot(body.mesh.nodes[n][1]) < 0.1)
}

/// Forces of a pressure on sides that have the body on their left.
fn press(sides: &[[usize; 2]], mesh: &Quads, pressure: f64) -> Vec<(usize, [f64; 2])> {
    let force = |&[a, b]: &[usize; 2]| {
        let [from, to] = [mesh.nodes[a], mesh.nodes[b]];
        [-0.5 * pressure * (to[1] - from[1]), 0.5 * pressure * (to[0] - from[0])]
    };
    sides.iter().flat_map(|side| side.map(|n| (n, force(side)))).collect()
}
