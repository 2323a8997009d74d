//! Material points of a body as a lattice of span tiles.
//!
//! Every span of the body holds the same pattern of points, so positions, shape functions and weights factor into one
//! table per column of spans and one per row: nothing is stored per point but what the physics changes. Spans are
//! handled eight at a time, one per lane of a [`Lane`] (a *tile*), and rows of spans in *strips* of fixed height. Sums
//! are formed strip by strip, so they do not depend on the number of threads.
//!
//! A rectangle cuts the spans at its edges exactly; of other shapes the points of a span that lie inside are kept.
//!
//! On a patch with a geometry the lattice is one of parameters, and each point has a [`MappedPoint`]. A rational field is a
//! quotient of two spline fields, `u = A/W` with `A = Σ N_a w_a u_a` and `W = Σ N_b w_b`, so that sums still factor:
//!
//! ```text
//! ∂u/∂ξ_d = (∂A/∂ξ_d − A ∂W/∂ξ_d / W)/W,   ∂u/∂x_j = Σ_d ∂u/∂ξ_d ∂ξ_d/∂x_j
//! ```

use rayon::prelude::*;

use crate::lane::{LANES, Lane};
use crate::nurbs::{MAX_FUNCTIONS, NurbsPatch};
use crate::patch::{ControlGrid, Patch};
use crate::quadrature::Rule;
use crate::scene::{Body, Layout, Shape};
use crate::spline::{MAX_ORDER, SplineSpace};

/// Rows of spans in a strip; at least the highest degree, so that only neighbouring strips share control points.
const STRIP_ROWS: usize = 8;

/// Eight neighbouring columns of spans.
#[derive(Debug, Clone)]
pub struct Tile {
    /// First control column of lane 0; lane l begins at `first + l`.
    pub first: usize,
    /// Spans in use; the lanes beyond have zero weight.
    pub count: usize,
    /// Values of the basis functions: point a, function k at `a * order + k`.
    pub value: Vec<Lane>,
    /// Their derivatives, 1/m.
    pub derivative: Vec<Lane>,
    /// Weights of the points, m.
    pub weight: Vec<Lane>,
    /// Positions of the points, m.
    pub position: Vec<Lane>,
}

/// One row of spans.
#[derive(Debug, Clone)]
pub struct Row {
    /// First control row.
    pub first: usize,
    /// Values of the basis functions: point b, function k at `[b][k]`.
    pub value: Vec<[f64; MAX_ORDER]>,
    /// Their derivatives, 1/m.
    pub derivative: Vec<[f64; MAX_ORDER]>,
    /// Weights of the points, m.
    pub weight: Vec<f64>,
    /// Positions of the points, m.
    pub position: Vec<f64>,
}

/// Material points of one body, in reference positions.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Degree in x and y.
    pub degree: [usize; 2],
    /// Points per span in x and y.
    pub points: [usize; 2],
    /// Their layout.
    pub layout: Layout,
    /// Tiles of columns.
    pub tiles: Vec<Tile>,
    /// Rows of spans.
    pub rows: Vec<Row>,
    /// What the geometry of the patch adds; absent over a rectangle.
    pub mapping: Option<Box<Mapping>>,
    /// What the product of the weights of both directions is multiplied by, per batch: 0 where there is no point, and the
    /// determinant of the Jacobian where there is a geometry; absent if it is 1 everywhere.
    factor: Option<Vec<Lane>>,
}

/// Points of a patch with a geometry.
#[derive(Debug, Clone)]
pub struct Mapping {
    /// Weights of the control points, as a field.
    pub weights: Vec<f64>,
    /// One entry per batch.
    pub points: Vec<MappedPoint>,
}

/// The weight function W and the geometry map at a batch of points.
#[derive(Debug, Clone, Copy)]
pub struct MappedPoint {
    /// 1/W.
    pub inverse_weight: Lane,
    /// `∂W/∂ξ_d / W`.
    pub weight_slope: [Lane; 2],
    /// `[∂ξ/∂x, ∂ξ/∂y, ∂η/∂x, ∂η/∂y]`, 1/m.
    pub inverse_jacobian: [Lane; 4],
    /// Position, m.
    pub position: [Lane; 2],
}

impl MappedPoint {
    const ZERO: Self = Self {
        inverse_weight: Lane::ZERO,
        weight_slope: [Lane::ZERO; 2],
        inverse_jacobian: [Lane::ZERO; 4],
        position: [Lane::ZERO; 2],
    };

    /// Value and physical gradient of a rational field from the sum `A` and its parametric slopes.
    #[inline(always)]
    pub fn field(&self, sum: Lane, slopes: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let value = sum * self.inverse_weight;
        let [u, v] = [0, 1].map(|d| slopes[d] * self.inverse_weight - value * self.weight_slope[d]);
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        (value, [u * ux + v * vx, u * uy + v * vy])
    }

    /// The adjoint of [`Self::field`] for a force and a stress: factors of the spline and of its two parametric slopes.
    #[inline(always)]
    pub fn adjoint(&self, force: Lane, [x, y]: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        let [u, v] = [(x * ux + y * uy) * self.inverse_weight, (x * vx + y * vy) * self.inverse_weight];
        (force * self.inverse_weight - u * self.weight_slope[0] - v * self.weight_slope[1], [u, v])
    }
}

/// Shape functions and physical gradients (1/m) of a batch of points, function n = l (p + 1) + k.
#[derive(Debug, Clone, Copy)]
pub struct BatchFunctions {
    /// Values.
    pub value: [Lane; MAX_FUNCTIONS],
    /// Gradients.
    pub gradient: [[Lane; 2]; MAX_FUNCTIONS],
}

/// Span indices and the part of each span that belongs to the body, along one direction.
struct Columns {
    first: usize,
    value: Vec<[f64; MAX_ORDER]>,
    derivative: Vec<[f64; MAX_ORDER]>,
    weight: Vec<f64>,
    position: Vec<f64>,
}

impl Lattice {
    /// The points of `body` on `patch`.
    pub fn new(patch: &Patch, body: &Body) -> Self {
        let (low, high) = match patch.geometry {
            None => body.shape.bounding_box(),
            Some(_) => Shape::Patch.bounding_box(), // a lattice of parameters
        };
        let clip = matches!(body.shape, Shape::Rectangle { .. }) && patch.geometry.is_none();
        let [x, y] = [0, 1].map(|d| {
            let rule = Rule::new(body.layout, body.particles_per_cell[d]);
            columns(&patch.spaces[d], &rule, low[d], high[d], clip)
        });
        let degree = [0, 1].map(|d| patch.spaces[d].degree());
        let rows = y
            .into_iter()
            .map(|c| Row {
                first: c.first,
                value: c.value,
                derivative: c.derivative,
                weight: c.weight,
                position: c.position,
            })
            .collect();
        let mut lattice = Self {
            grid: patch.control_grid(),
            degree,
            points: body.particles_per_cell,
            layout: body.layout,
            tiles: tiles(&x, degree[0] + 1),
            rows,
            mapping: None,
            factor: None,
        };
        if let Some(geometry) = &patch.geometry {
            lattice.map_by(geometry);
        }
        if !(clip || body.shape == Shape::Patch) {
            lattice.keep_inside(&body.shape);
        }
        lattice
    }

    /// Evaluates weight function and geometry map at every point.
    fn map_by(&mut self, patch: &NurbsPatch) {
        let mut weights = self.grid.zeros();
        for (at, weight) in self.grid.indices().zip(patch.weights()) {
            weights[at] = *weight;
        }
        let mut points = vec![MappedPoint::ZERO; self.batches()];
        let mut determinants = vec![Lane::ZERO; self.batches()];
        for batch in 0..self.batches() {
            let (_, tile, _, _) = self.unbatch(batch);
            for lane in 0..self.tiles[tile].count {
                let parameters = self.position(batch, lane);
                let Some(span) = patch.find_span(parameters) else { continue };
                let image = patch.map(&patch.shape_functions(span, parameters));
                let weight = patch.weight_function(span, parameters);
                let [[xu, xv], [yu, yv]] = image.jacobian;
                let determinant = image.determinant();
                determinants[batch][lane] = determinant;
                let point = &mut points[batch];
                point.inverse_weight[lane] = 1.0 / weight.value;
                for d in 0..2 {
                    point.weight_slope[d][lane] = weight.gradient[d] / weight.value;
                    point.position[d][lane] = image.position[d];
                }
                for (entry, value) in point.inverse_jacobian.iter_mut().zip([yv, -xv, -yu, xu]) {
                    entry[lane] = value / determinant;
                }
            }
        }
        self.mapping = Some(Box::new(Mapping { weights, points }));
        self.factor = Some(determinants);
    }

    /// Takes away the points outside a shape.
    fn keep_inside(&mut self, shape: &Shape) {
        let mut factor = self.factor.take().unwrap_or_else(|| vec![Lane::splat(1.0); self.batches()]);
        for (batch, factor) in factor.iter_mut().enumerate() {
            for lane in 0..LANES {
                if !shape.contains(self.position(batch, lane)) {
                    factor[lane] = 0.0;
                }
            }
        }
        self.factor = Some(factor);
    }

    /// Points in a span.
    pub fn points_per_span(&self) -> usize {
        self.points[0] * self.points[1]
    }

    /// Batches (one point in each of eight spans) in the lattice; point state has this many [`Lane`]s.
    pub fn batches(&self) -> usize {
        self.rows.len() * self.tiles.len() * self.points_per_span()
    }

    /// Batches in a full strip: point state is cut into chunks of this length.
    pub fn strip_batches(&self) -> usize {
        STRIP_ROWS * self.tiles.len() * self.points_per_span()
    }

    /// Number of strips.
    pub fn strips(&self) -> usize {
        self.rows.len().div_ceil(STRIP_ROWS)
    }

    /// Rows of spans in a strip.
    pub fn strip_rows(&self, strip: usize) -> std::ops::Range<usize> {
        strip * STRIP_ROWS..((strip + 1) * STRIP_ROWS).min(self.rows.len())
    }

    /// Control rows a strip contributes to.
    pub fn strip_control_rows(&self, strip: usize) -> std::ops::Range<usize> {
        let rows = self.strip_rows(strip);
        self.rows[rows.start].first..self.rows[rows.end - 1].first + self.degree[1] + 1
    }

    /// Batch index of row of spans, tile, and point (a, b) in the span.
    #[inline(always)]
    pub fn batch(&self, row: usize, tile: usize, b: usize, a: usize) -> usize {
        ((row * self.tiles.len() + tile) * self.points[1] + b) * self.points[0] + a
    }

    /// Row of spans, tile, and point (b, a) of a batch.
    pub fn unbatch(&self, batch: usize) -> (usize, usize, usize, usize) {
        let (rest, a) = (batch / self.points[0], batch % self.points[0]);
        let (rest, b) = (rest / self.points[1], rest % self.points[1]);
        (rest / self.tiles.len(), rest % self.tiles.len(), b, a)
    }

    /// Weights (m²) of a batch; zero where there is no point.
    #[inline(always)]
    pub fn weight(&self, row: usize, tile: usize, b: usize, a: usize) -> Lane {
        let weight = self.tiles[tile].weight[a] * self.rows[row].weight[b];
        match &self.factor {
            None => weight,
            Some(factor) => weight * factor[self.batch(row, tile, b, a)],
        }
    }

    /// Weights of eight control points from index `at` of a field on; 1 over a rectangle.
    #[inline(always)]
    pub fn weights(&self, at: usize) -> Lane {
        self.mapping.as_ref().map_or(Lane::splat(1.0), |mapping| Lane::load(&mapping.weights, at))
    }

    /// Shape functions of a batch; those of lane l belong to control points l columns further than those of lane 0.
    pub fn shape_functions(&self, batch: usize) -> BatchFunctions {
        let (row_index, tile_index, b, a) = self.unbatch(batch);
        let (row, tile) = (&self.rows[row_index], &self.tiles[tile_index]);
        let [kx, ky] = self.degree.map(|p| p + 1);
        let mut functions =
            BatchFunctions { value: [Lane::ZERO; MAX_FUNCTIONS], gradient: [[Lane::ZERO; 2]; MAX_FUNCTIONS] };
        for l in 0..ky {
            for k in 0..kx {
                let (n, x, dx) = (l * kx + k, tile.value[a * kx + k], tile.derivative[a * kx + k]);
                functions.value[n] = x * row.value[b][l];
                functions.gradient[n] = [dx * row.value[b][l], x * row.derivative[b][l]];
                if let Some(mapping) = &self.mapping {
                    let weight = Lane::load(&mapping.weights, self.grid.index(tile.first + k, row.first + l));
                    let [u, v] = functions.gradient[n].map(|g| g * weight);
                    let rational = mapping.points[batch].field(functions.value[n] * weight, [u, v]);
                    (functions.value[n], functions.gradient[n]) = rational;
                }
            }
        }
        functions
    }

    /// `Σ_p V_p f_p N_I(x_p)` of a density at the points, as a field; `density` gets batch, lane and position.
    pub fn integrate(&self, density: impl Fn(usize, usize, [f64; 2]) -> f64 + Sync) -> Vec<f64> {
        let mut out = self.grid.zeros();
        self.add_integral(&mut [&mut out], |batch, lane, position| ([density(batch, lane, position)], [[0.0; 2]]));
        out
    }

    /// Adds `Σ_p V_p (f_p N_I + s_p · grad N_I)` to fields; `density` gives f and s of each field for a batch, lane and
    /// position.
    pub fn add_integral<const F: usize>(
        &self,
        out: &mut [&mut Vec<f64>; F],
        density: impl Fn(usize, usize, [f64; 2]) -> ([f64; F], [[f64; 2]; F]) + Sync,
    ) {
        let [kx, ky] = self.degree.map(|p| p + 1);
        let of_batch = |batch: usize| {
            let (row, tile, b, a) = self.unbatch(batch);
            let weight = self.weight(row, tile, b, a);
            let (mut force, mut stress) = ([Lane::ZERO; F], [[Lane::ZERO; 2]; F]);
            for lane in (0..self.tiles[tile].count).filter(|&lane| weight[lane] > 0.0) {
                let (f, s) = density(batch, lane, self.position(batch, lane));
                for i in 0..F {
                    force[i][lane] = f[i];
                    for d in 0..2 {
                        stress[i][d][lane] = s[i][d];
                    }
                }
            }
            (weight, force, stress)
        };
        let densities: Vec<_> = (0..self.batches()).into_par_iter().map(of_batch).collect();
        for (batch, (weight, force, stress)) in densities.into_iter().enumerate() {
            let (row_index, tile_index, _, _) = self.unbatch(batch);
            let (row, tile) = (&self.rows[row_index], &self.tiles[tile_index]);
            let functions = self.shape_functions(batch);
            for l in 0..ky {
                for k in 0..kx {
                    let (value, [x, y]) = (functions.value[l * kx + k], functions.gradient[l * kx + k]);
                    for i in 0..F {
                        let share = (force[i] * value + stress[i][0] * x + stress[i][1] * y) * weight;
                        share.add_to(out[i], self.grid.index(tile.first + k, row.first + l));
                    }
                }
            }
        }
    }

    /// Position of the point of a batch in a lane, m.
    pub fn position(&self, batch: usize, lane: usize) -> [f64; 2] {
        if let Some(mapping) = &self.mapping {
            return mapping.points[batch].position.map(|x| x[lane]);
        }
        let (row, tile, b, a) = self.unbatch(batch);
        [self.tiles[tile].position[a][lane], self.rows[row].position[b]]
    }

    /// Every point: batch, lane, position (m) and weight (m²).
    pub fn for_each_point(&self, mut f: impl FnMut(usize, usize, [f64; 2], f64)) {
        for batch in 0..self.batches() {
            let (row, tile, b, a) = self.unbatch(batch);
            let weight = self.weight(row, tile, b, a);
            for lane in 0..LANES {
                if weight[lane] > 0.0 {
                    f(batch, lane, self.position(batch, lane), weight[lane]);
                }
            }
        }
    }

    /// Number of material points.
    pub fn count(&self) -> usize {
        let mut count = 0;
        self.for_each_point(|_, _, _, _| count += 1);
        count
    }
}

/// Tables of the spans that meet `[low, high]`.
fn columns(space: &SplineSpace, rule: &Rule, low: f64, high: f64, clip: bool) -> Vec<Columns> {
    let meets = |left: f64, right: f64| {
        let sliver = 1e-12 * (right - left);
        right.min(high) - left.max(low) > sliver
    };
    let spans = space.spans().iter().enumerate().filter(|(_, s)| meets(s.left, s.right));
    spans
        .map(|(index, span)| {
            let (left, right) = if clip { (span.left.max(low), span.right.min(high)) } else { (span.left, span.right) };
            let position: Vec<f64> = rule.points.iter().map(|t| left + t * (right - left)).collect();
            let shapes: Vec<_> = position.iter().map(|&x| space.shape_functions(index, x)).collect();
            Columns {
                first: span.first,
                value: shapes.iter().map(|s| s.value).collect(),
                derivative: shapes.iter().map(|s| s.derivative).collect(),
                weight: rule.weights.iter().map(|w| w * (right - left)).collect(),
                position,
            }
        })
        .collect()
}

/// Groups columns whose first control columns follow each other into tiles of at most [`LANES`].
fn tiles(columns: &[Columns], order: usize) -> Vec<Tile> {
    let mut tiles: Vec<Tile> = Vec::new();
    for column in columns {
        let points = column.weight.len();
        let fits = |tile: &Tile| tile.count < LANES && tile.first + tile.count == column.first;
        if !tiles.last().is_some_and(fits) {
            tiles.push(Tile {
                first: column.first,
                count: 0,
                value: vec![Lane::ZERO; points * order],
                derivative: vec![Lane::ZERO; points * order],
                weight: vec![Lane::ZERO; points],
                position: vec![Lane::ZERO; points],
            });
        }
        let tile = tiles.last_mut().expect("just pushed");
        let lane = tile.count;
        tile.count += 1;
        for a in 0..points {
            for k in 0..order {
                tile.value[a * order + k][lane] = column.value[a][k];
                tile.derivative[a * order + k][lane] = column.derivative[a][k];
            }
            tile.weight[a][lane] = column.weight[a];
            tile.position[a][lane] = column.position[a];
        }
    }
    tiles
}
