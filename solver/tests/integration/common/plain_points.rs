//! Points of a NURBS patch by plain sums over its basis, without the lattice.

use fisura::linear_algebra::control_grid::ControlGrid;
use fisura::particles::lattice::Lattice;
use fisura::scene::Body;
use fisura::splines::nurbs::{NurbsPatch, RationalFunctions};
use fisura::splines::quadrature::Rule;

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
