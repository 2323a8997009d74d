//! Points of a NURBS patch by plain sums over its basis, without the lattice, and what sweep and assembly are
//! given to be compared with them.

use fisura::linear_algebra::control_grid::ControlGrid;
use fisura::linear_algebra::lane::Lane;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::PointCoefficients;
use fisura::scene::Body;
use fisura::splines::nurbs::{NurbsPatch, RationalFunctions};
use fisura::splines::quadrature::Rule;
use fisura::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};
use fisura::transfer::sweep::{StripForces, sweep};

use super::Random;

/// A point as the NURBS patch sees it, without the lattice.
pub struct PlainPoint {
    pub batch: usize,
    pub lane: usize,
    pub position: [f64; 2],
    pub weight: f64,
    pub functions: RationalFunctions,
    pub gradients: Vec<[f64; 2]>,
}

impl PlainPoint {
    pub fn interpolate(&self, grid: ControlGrid, field: &[f64]) -> (f64, [f64; 2]) {
        let mut result = (0.0, [0.0; 2]);
        for (n, at, value) in self.terms(grid) {
            result.0 += value * field[at];
            for d in 0..2 {
                result.1[d] += self.gradients[n][d] * field[at];
            }
        }
        result
    }

    /// Number of a function, its control point in fields, and its value.
    pub fn terms(&self, grid: ControlGrid) -> impl Iterator<Item = (usize, usize, f64)> {
        let f = &self.functions;
        let at = move |control: usize| grid.index(control % grid.columns, control / grid.columns);
        (0..f.count).map(move |n| (n, at(f.control[n]), f.value[n]))
    }
}

/// Every point of every span by the rule of a body, and the place of its numbers in the lattice.
pub fn plain_points(patch: &NurbsPatch, lattice: &Lattice, body: &Body) -> Vec<PlainPoint> {
    let rules = [0, 1].map(|d| Rule::new(body.layout, body.particles_per_cell[d]));
    let lanes: Vec<(usize, usize)> =
        lattice.tiles.iter().enumerate().flat_map(|(tile, t)| (0..t.count).map(move |lane| (tile, lane))).collect();
    let [x, y] = patch.spaces();
    let mut points = Vec::new();
    for (j, t) in y.spans().iter().enumerate() {
        for (i, s) in x.spans().iter().enumerate() {
            for b in 0..body.particles_per_cell[1] {
                for a in 0..body.particles_per_cell[0] {
                    let parameters =
                        [s.left + rules[0].points[a] * s.length(), t.left + rules[1].points[b] * t.length()];
                    let functions = patch.shape_functions([i, j], parameters);
                    let image = patch.map(&functions);
                    let area = rules[0].weights[a] * s.length() * rules[1].weights[b] * t.length();
                    let (tile, lane) = lanes[i];
                    points.push(PlainPoint {
                        batch: lattice.batch(j, tile, b, a),
                        lane,
                        position: image.position,
                        weight: area * image.determinant(),
                        gradients: functions.physical_gradients(&image)[..functions.count].to_vec(),
                        functions,
                    });
                }
            }
        }
    }
    points
}

/// Largest magnitude; not a number if one value is not.
pub fn largest(values: &[f64]) -> f64 {
    values.iter().map(|v| v.abs()).max_by(f64::total_cmp).unwrap_or(0.0)
}

/// Asserts that two fields differ by at most `tolerance` of the largest entry; prints nothing when they do.
pub fn assert_close(name: &str, seen: &[f64], expected: &[f64], tolerance: f64) {
    let scale = largest(expected);
    assert!(scale > 0.0, "{name}: nothing to compare");
    let error = largest(&seen.iter().zip(expected).map(|(a, b)| a - b).collect::<Vec<f64>>());
    assert!(error <= tolerance * scale, "{name}: differs by {:.3e} of the largest", error / scale);
}

/// Records what it is given and answers with a stress of its own making, per strip.
struct Recorder<const EVERY_STEP: bool> {
    values: Vec<(usize, Lane, PointValues)>,
}

impl<const EVERY_STEP: bool> PointKernel for Recorder<EVERY_STEP> {
    const DISPLACEMENT: bool = true;
    const PHASE: bool = true;
    const PHASE_GRADIENT: bool = true;
    const STRESS: bool = true;
    const EVERY_STEP: bool = EVERY_STEP;

    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress {
        self.values.push((at, weight, *values));
        let [xx, xy, yx, yy] = stress_of(values.gradient);
        Stress { xx, xy, yx, yy }
    }
}

/// Not symmetric, so that no mixed-up component goes unseen.
pub fn stress_of(g: [Lane; 4]) -> [Lane; 4] {
    [
        g[0] * 2.0 + g[3] * 0.3 + g[1] * 0.7,
        g[1] * 1.1 + g[2] * 0.6 - g[0] * 0.2,
        g[2] * 0.8 - g[1] * 0.5 + g[3] * 0.4,
        g[3] * 1.7 - g[0] * 0.4 + g[2] * 0.9,
    ]
}

/// The second of two sweeps, which must not see what the first left behind: per batch weight and values, and
/// the assembled forces.
pub fn swept<const EVERY_STEP: bool>(lattice: &Lattice, fields: Fields) -> (Vec<(Lane, PointValues)>, [Vec<f64>; 2]) {
    let mut strips = StripForces::new(lattice);
    let mut kernels = Vec::new();
    for _ in 0..2 {
        kernels = (0..lattice.strips()).map(|_| Recorder::<EVERY_STEP> { values: Vec::new() }).collect();
        sweep(lattice, fields, &mut kernels, Some(&mut strips));
    }
    let mut at_batch = vec![None; lattice.batches()];
    for (strip, kernel) in kernels.iter().enumerate() {
        for &(at, weight, values) in &kernel.values {
            let batch = strip * lattice.strip_batches() + at;
            assert!(at_batch[batch].replace((weight, values)).is_none(), "a batch is visited twice");
        }
    }
    let mut forces = [lattice.grid.zeros(), lattice.grid.zeros()];
    strips.assemble(lattice.grid.stride, &mut forces);
    (at_batch.into_iter().map(|b| b.expect("every batch is visited")).collect(), forces)
}

/// A coefficient per point; every `skip`-th span, counted within batches, has none.
pub struct PerPoint {
    pub values: Vec<Lane>,
    skip: Option<usize>,
    per_span: usize,
}

impl PerPoint {
    pub fn new(lattice: &Lattice, skip: Option<usize>) -> Self {
        let mut random = Random::new(3);
        let mut lane = || Lane([0.0; 8].map(|_| 1.5 + random.next()));
        let values = (0..lattice.batches()).map(|_| lane()).collect();
        Self { values, skip, per_span: lattice.points_per_span() }
    }

    /// Never the first.
    pub fn skips(&self, first: usize) -> bool {
        self.skip.is_some_and(|skip| first / self.per_span % skip == skip - 1)
    }
}

impl PointCoefficients for PerPoint {
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for (i, weight) in weights.iter().enumerate() {
            out[i] = self.values[first + i] * *weight;
        }
        !self.skips(first)
    }
}
