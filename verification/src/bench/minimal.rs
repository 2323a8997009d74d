//! The yardstick: an explicit elastic step in the fewest lines that are still reasonable.
//!
//! Uniform splines of degree 2 or 3 on an unbounded grid, points sorted by span, small strains, FLIP, one
//! thread, one record per point and one per node, loops of constant length. No open knots, no boundary
//! conditions, no loads, no fracture, no ledger, and functions at the points, not means over their domains:
//! what a step of the solver costs beyond this is the price of its features. It pulls as the total frame
//! does: see the test in [`super::stages`].

use fisura::material::elasticity::ElasticModuli;
use fisura::particles::points::Point;
use fisura::scene::Mesh;

/// Most functions per direction.
const MOST: usize = 4;

#[derive(Debug, Clone, Copy)]
struct Particle {
    position: [f64; 2],
    velocity: [f64; 2],
    strain: [f64; 3],
    stress: [f64; 3],
    volume: f64,
}

/// What a node gathers, then velocity and acceleration in the place of momentum and force.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    mass: f64,
    momentum: [f64; 2],
    force: [f64; 2],
}

/// Values and slopes of the functions over a span.
type Splines = ([f64; MOST], [f64; MOST]);

/// A body of points and its grid.
#[derive(Debug, Clone)]
pub struct Minimal<const P: usize> {
    origin: [f64; 2],
    span: f64,
    columns: usize,
    particles: Vec<Particle>,
    /// Number of the span of each point.
    spans: Vec<usize>,
    nodes: Vec<Node>,
    moduli: ElasticModuli,
    density: f64,
    started: bool,
}

/// Values of the uniform splines of degree P over a span and their slopes, at `t` in [0, 1).
#[inline(always)]
fn splines<const P: usize>(t: f64) -> Splines {
    const { assert!(P == 2 || P == 3, "uniform splines of degree 2 and 3") };
    let s = 1.0 - t;
    if P == 2 {
        ([0.5 * s * s, 0.5 + t * s, 0.5 * t * t, 0.0], [-s, 1.0 - 2.0 * t, t, 0.0])
    } else {
        let (second, third) = ((3.0 * t - 6.0) * t * t + 4.0, (3.0 * s - 6.0) * s * s + 4.0);
        let slopes = [-0.5 * s * s, (1.5 * t - 2.0) * t, (2.0 - 1.5 * s) * s, 0.5 * t * t];
        ([s * s * s / 6.0, second / 6.0, third / 6.0, t * t * t / 6.0], slopes)
    }
}

impl<const P: usize> Minimal<P> {
    /// Points in the inner spans of an equal mesh, sorted by span.
    pub fn new(mesh: &Mesh, points: &[Point], moduli: ElasticModuli, density: f64) -> Self {
        let functions = mesh.knots.each_ref().map(|knots| knots.len() - P - 1);
        let spans = functions.map(|n| n - P);
        let particle = |p: &Point| Particle {
            position: p.position,
            velocity: p.velocity,
            strain: p.strain,
            stress: p.stress,
            volume: p.volume,
        };
        let mut minimal = Self {
            origin: mesh.origin(),
            span: (mesh.end()[0] - mesh.origin()[0]) / spans[0] as f64,
            columns: functions[0],
            particles: points.iter().map(particle).collect(),
            spans: vec![0; points.len()],
            nodes: vec![Node::default(); functions[0] * functions[1]],
            moduli,
            density,
            started: false,
        };
        minimal.sort();
        minimal.points_to_grid();
        minimal
    }

    /// Number of material points.
    pub fn count(&self) -> usize {
        self.particles.len()
    }

    /// Acceleration of a node, m/s².
    pub fn acceleration(&self, column: usize, row: usize) -> [f64; 2] {
        self.nodes[row * self.columns + column].force
    }

    /// Accelerations of the body under a displacement of its nodes at the reference positions, m/s².
    pub fn strain_by(&mut self, displacement: impl Fn(usize, usize) -> [f64; 2]) {
        for index in 0..self.particles.len() {
            let (first, [x, y]) = self.functions(index);
            let mut gradient = [[0.0; 2]; 2];
            for l in 0..=P {
                for k in 0..=P {
                    let u = displacement((first + k) % self.columns, first / self.columns + l);
                    let slope = [x.1[k] * y.0[l] / self.span, x.0[k] * y.1[l] / self.span];
                    (0..2).for_each(|i| (0..2).for_each(|j| gradient[i][j] += u[i] * slope[j]));
                }
            }
            let [[xx, xy], [yx, yy]] = gradient;
            let particle = &mut self.particles[index];
            particle.strain = [xx, yy, 0.5 * (xy + yx)];
            particle.stress = stress(&self.moduli, particle.strain);
        }
        self.points_to_grid();
    }

    /// One step of `dt` seconds.
    pub fn step(&mut self, dt: f64) {
        let kick = if self.started { dt } else { 0.5 * dt };
        self.started = true;
        if self.grid_to_points(dt, kick) {
            self.sort();
        }
        self.points_to_grid();
    }

    /// First node and shape functions of a point.
    #[inline(always)]
    fn functions(&self, index: usize) -> (usize, [Splines; 2]) {
        let (position, span) = (self.particles[index].position, self.spans[index]);
        let at = [span % self.columns, span / self.columns];
        (span, [0, 1].map(|d| splines::<P>((position[d] - self.origin[d]) / self.span - at[d] as f64)))
    }

    /// Velocity, position, strain and stress; whether a point left its span.
    fn grid_to_points(&mut self, dt: f64, kick: f64) -> bool {
        let mut left = false;
        let inverse = 1.0 / self.span;
        for index in 0..self.particles.len() {
            let (first, [x, y]) = self.functions(index);
            let (mut moved, mut gained, mut gradient) = ([0.0; 2], [0.0; 2], [[0.0; 2]; 2]);
            for l in 0..=P {
                let row = &self.nodes[first + l * self.columns..][..P + 1];
                for k in 0..=P {
                    let (n, gx, gy) = (x.0[k] * y.0[l], x.1[k] * y.0[l], x.0[k] * y.1[l]);
                    for d in 0..2 {
                        let v = row[k].momentum[d] + kick * row[k].force[d];
                        moved[d] += n * v;
                        gained[d] += n * kick * row[k].force[d];
                        gradient[d][0] += gx * v;
                        gradient[d][1] += gy * v;
                    }
                }
            }
            let particle = &mut self.particles[index];
            for d in 0..2 {
                particle.velocity[d] += gained[d];
                particle.position[d] += dt * moved[d];
            }
            let [[xx, xy], [yx, yy]] = gradient.map(|row| row.map(|g| g * dt * inverse));
            particle.strain[0] += xx;
            particle.strain[1] += yy;
            particle.strain[2] += 0.5 * (xy + yx);
            particle.stress = stress(&self.moduli, particle.strain);
            let at = [0, 1].map(|d| ((particle.position[d] - self.origin[d]) * inverse) as usize);
            left |= at[1] * self.columns + at[0] != self.spans[index];
        }
        left
    }

    /// Mass, velocity and acceleration of the nodes.
    fn points_to_grid(&mut self) {
        self.nodes.fill(Node::default());
        let inverse = 1.0 / self.span;
        for index in 0..self.particles.len() {
            let (first, [x, y]) = self.functions(index);
            let particle = self.particles[index];
            let mass = self.density * particle.volume;
            let [xx, yy, xy] = particle.stress.map(|s| -s * particle.volume * inverse);
            for l in 0..=P {
                let row = &mut self.nodes[first + l * self.columns..][..P + 1];
                for k in 0..=P {
                    let (n, gx, gy) = (x.0[k] * y.0[l], x.1[k] * y.0[l], x.0[k] * y.1[l]);
                    row[k].mass += mass * n;
                    for d in 0..2 {
                        row[k].momentum[d] += mass * n * particle.velocity[d];
                    }
                    row[k].force[0] += xx * gx + xy * gy;
                    row[k].force[1] += xy * gx + yy * gy;
                }
            }
        }
        for node in self.nodes.iter_mut().filter(|node| node.mass > 0.0) {
            for d in 0..2 {
                node.momentum[d] /= node.mass;
                node.force[d] /= node.mass;
            }
        }
    }

    /// Brings the points into the order of their spans.
    fn sort(&mut self) {
        let span = |p: &Particle| {
            let at = [0, 1].map(|d| ((p.position[d] - self.origin[d]) / self.span) as usize);
            at[1] * self.columns + at[0]
        };
        let mut sorted: Vec<(usize, Particle)> = self.particles.iter().map(|p| (span(p), *p)).collect();
        sorted.sort_by_key(|(span, _)| *span);
        (self.spans, self.particles) = sorted.into_iter().unzip();
    }
}

/// Linear elasticity, Pa.
#[inline(always)]
fn stress(moduli: &ElasticModuli, [xx, yy, xy]: [f64; 3]) -> [f64; 3] {
    let (spherical, twice) = (moduli.lambda * (xx + yy), 2.0 * moduli.mu);
    [spherical + twice * xx, spherical + twice * yy, twice * xy]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check<const P: usize>() {
        for t in [0.0, 0.2, 0.7, 0.99] {
            let (value, slope) = splines::<P>(t);
            let (sum, slopes): (f64, f64) = (value.iter().sum(), slope.iter().sum());
            assert!((sum - 1.0).abs() <= 1e-15 && slopes.abs() <= 1e-15);
            let ahead = splines::<P>(t + 1e-6).0;
            (0..=P).for_each(|k| assert!(((ahead[k] - value[k]) / 1e-6 - slope[k]).abs() <= 1e-5, "{k} at {t}"));
        }
    }

    #[test]
    fn splines_sum_to_one_and_slopes_are_theirs() {
        check::<2>();
        check::<3>();
    }
}
