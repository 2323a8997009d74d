//! Tables of shape functions, weights and positions: along one direction, and of eight points side by side of
//! a span that the boundary cuts.
//!
//! On a patch with a geometry the lattice is one of parameters, and each point has a [`MappedPoint`]. A
//! rational field is a quotient of two spline fields, `u = A/W` with `A = Σ N_a w_a u_a` and
//! `W = Σ N_b w_b`, so that sums still factor:
//!
//! ```text
//! ∂u/∂ξ_d = (∂A/∂ξ_d − A ∂W/∂ξ_d / W)/W,   ∂u/∂x_j = Σ_d ∂u/∂ξ_d ∂ξ_d/∂x_j
//! ```

use super::cut::PointBox;
use super::sheets::FunctionIndex;
use crate::linear_algebra::lane::{LANES, Lane};
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;
use crate::splines::spline::{MAX_ORDER, SplineSpace};

/// Eight neighbouring columns of spans.
#[derive(Debug, Clone)]
pub struct Tile {
    /// First control column of lane 0; lane l begins at `first + l`.
    pub first: usize,
    /// Spans in use; the lanes beyond have zero weight.
    pub count: usize,
    /// Values of the basis functions: point a, function k at `a * order + k`.
    pub value: Vec<Lane>,
    /// Their derivatives, 1/m or 1/unit of the knots.
    pub derivative: Vec<Lane>,
    /// Weights of the points, m or unit of the knots.
    pub weight: Vec<Lane>,
    /// Positions of the points, m or unit of the knots.
    pub position: Vec<Lane>,
}

/// One row of spans: shape functions in y, weights and positions of its points.
#[derive(Debug, Clone)]
pub struct Row {
    /// Control row of the first shape function; function k belongs to row `first + k`.
    pub first: usize,
    /// Rows by which that lies behind the one of the patch: not 0 in a sheet.
    pub lift: usize,
    /// Values of the basis functions: point b, function k at `[b][k]`.
    pub value: Vec<[f64; MAX_ORDER]>,
    /// Their derivatives, 1/m or 1/unit of the knots.
    pub derivative: Vec<[f64; MAX_ORDER]>,
    /// Weights of the points, m or unit of the knots.
    pub weight: Vec<f64>,
    /// Positions of the points, m or unit of the knots.
    pub position: Vec<f64>,
}

/// Part `[left, right]` of a body along one direction, and the points of a rule there.
pub(super) struct Along<'a> {
    pub space: &'a SplineSpace,
    pub rule: Rule,
    pub low: f64,
    pub high: f64,
    /// Whether spans are cut at both ends.
    pub clip: bool,
}

impl Along<'_> {
    /// Index and ends of what belongs to the body of every span that meets it.
    pub(super) fn spans(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let meets = |left: f64, right: f64| {
            let sliver = 1e-12 * (right - left);
            right.min(self.high) - left.max(self.low) > sliver
        };
        let spans = self.space.spans().iter().enumerate().filter(move |(_, s)| meets(s.left, s.right));
        spans.map(|(index, s)| {
            (index, if self.clip { [s.left.max(self.low), s.right.min(self.high)] } else { [s.left, s.right] })
        })
    }

    /// Position and weight of the points between two ends.
    pub(super) fn points(&self, [left, right]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
        self.rule.between(left, right)
    }

    /// Tables of the spans.
    pub(super) fn columns(&self) -> Vec<Row> {
        let column = |(index, ends): (usize, [f64; 2])| {
            let (position, weight): (Vec<f64>, Vec<f64>) = self.points(ends).unzip();
            let shapes: Vec<_> = position.iter().map(|&x| self.space.shape_functions(index, x)).collect();
            Row {
                first: self.space.spans()[index].first,
                lift: 0,
                value: shapes.iter().map(|s| s.value).collect(),
                derivative: shapes.iter().map(|s| s.derivative).collect(),
                weight,
                position,
            }
        };
        self.spans().map(column).collect()
    }
}

/// Groups columns whose first control columns follow each other into tiles of at most [`LANES`].
pub(super) fn tiles(columns: &[Row], order: usize) -> Vec<Tile> {
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

/// Points of a patch with a geometry.
#[derive(Debug, Clone)]
pub(crate) struct Mapping {
    /// Weights of the control points, as a field.
    pub weights: Vec<f64>,
    /// One entry per batch.
    pub points: Vec<MappedPoint>,
}

impl Mapping {
    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * self.weights.len() + size_of::<MappedPoint>() * self.points.len()
    }
}

/// The weight function W and the geometry map at a batch of points.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct MappedPoint {
    /// Inverse 1/W of the weight function.
    pub inverse_weight: Lane,
    /// Logarithmic derivatives `∂W/∂ξ_d / W` of the weight function in both parameters, 1/unit of the knots.
    pub weight_slope: [Lane; 2],
    /// `[∂ξ/∂x, ∂ξ/∂y, ∂η/∂x, ∂η/∂y]`, 1/m.
    pub inverse_jacobian: [Lane; 4],
    /// Positions of the points at t = 0 in x and in y, m.
    pub position: [Lane; 2],
}

impl MappedPoint {
    /// Value and physical gradient of a rational field from the sum `A` and its parametric slopes.
    #[inline(always)]
    pub(crate) fn field(&self, sum: Lane, slopes: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let value = sum * self.inverse_weight;
        let [u, v] = [0, 1].map(|d| slopes[d] * self.inverse_weight - value * self.weight_slope[d]);
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        (value, [u * ux + v * vx, u * uy + v * vy])
    }

    /// The adjoint of [`Self::field`] for a force and a stress: factors of the spline and of its two
    /// parametric slopes.
    #[inline(always)]
    pub(crate) fn adjoint(&self, force: Lane, [x, y]: [Lane; 2]) -> (Lane, [Lane; 2]) {
        let [ux, uy, vx, vy] = self.inverse_jacobian;
        let [u, v] = [(x * ux + y * uy) * self.inverse_weight, (x * vx + y * vy) * self.inverse_weight];
        (force * self.inverse_weight - u * self.weight_slope[0] - v * self.weight_slope[1], [u, v])
    }
}

/// A point of a span that the boundary cuts.
pub(super) struct CutPoint {
    /// Column and row of the span.
    pub span: [usize; 2],
    /// Column and row of its first function.
    pub first: FunctionIndex,
    /// Position and box, m.
    pub point: PointBox,
    /// Rows by which its control points lie behind those of the patch.
    pub lift: usize,
}

impl CutPoint {
    /// The points of a span.
    pub(super) fn of_span(patch: &Patch, span: [usize; 2], points: Vec<PointBox>) -> impl Iterator<Item = Self> {
        let first = first_function(patch, span);
        points.into_iter().map(move |point| Self { span, first, point, lift: 0 })
    }
}

/// Eight points of one span.
#[derive(Debug, Clone, Default)]
pub(crate) struct CutBatch {
    /// Column and row of the first function of the span.
    pub first: FunctionIndex,
    /// Rows by which its control points lie behind those of the patch.
    pub lift: usize,
    /// Weights, m²; zero where there is no point.
    pub weight: Lane,
    /// Positions of the points at t = 0 in x and in y, m.
    pub position: [Lane; 2],
    /// Values of the basis functions in x and in y.
    pub value: [[Lane; MAX_ORDER]; 2],
    /// Their derivatives, 1/m.
    pub derivative: [[Lane; MAX_ORDER]; 2],
}

impl CutBatch {
    /// Batches of the points of a span.
    pub(super) fn of_span(
        patch: &Patch,
        span: [usize; 2],
        lift: usize,
        points: &[PointBox],
    ) -> impl Iterator<Item = Self> {
        let first = first_function(patch, span);
        points.chunks(LANES).map(move |points| {
            let mut batch = Self { first, lift, ..Self::default() };
            for lane in 0..LANES {
                let (position, [width, height]) = points.get(lane).copied().unwrap_or((points[0].0, [0.0; 2]));
                batch.weight[lane] = width * height;
                for d in 0..2 {
                    let functions = patch.spaces[d].shape_functions(span[d], position[d]);
                    batch.position[d][lane] = position[d];
                    for k in 0..MAX_ORDER {
                        batch.value[d][k][lane] = functions.value[k];
                        batch.derivative[d][k][lane] = functions.derivative[k];
                    }
                }
            }
            batch
        })
    }
}

/// Column and row of the first function of a span.
pub(super) fn first_function(patch: &Patch, span: [usize; 2]) -> FunctionIndex {
    [0, 1].map(|d| patch.spaces[d].spans()[span[d]].first)
}
