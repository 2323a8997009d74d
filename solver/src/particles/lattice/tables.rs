//! Tables of shape functions, weights and positions along one direction.

use crate::linear_algebra::lane::{LANES, Lane};
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

/// One row of spans.
#[derive(Debug, Clone)]
pub struct Row {
    /// First control row.
    pub first: usize,
    /// Values of the basis functions: point b, function k at `[b][k]`.
    pub value: Vec<[f64; MAX_ORDER]>,
    /// Their derivatives, 1/m or 1/unit of the knots.
    pub derivative: Vec<[f64; MAX_ORDER]>,
    /// Weights of the points, m or unit of the knots.
    pub weight: Vec<f64>,
    /// Positions of the points, m or unit of the knots.
    pub position: Vec<f64>,
}

/// Span indices and the part of each span that belongs to the body, along one direction.
pub(super) struct Columns {
    pub first: usize,
    pub value: Vec<[f64; MAX_ORDER]>,
    pub derivative: Vec<[f64; MAX_ORDER]>,
    pub weight: Vec<f64>,
    pub position: Vec<f64>,
    /// Length of the whole span.
    pub length: f64,
}

/// Tables of the spans that meet `[low, high]`.
pub(super) fn columns(space: &SplineSpace, rule: &Rule, low: f64, high: f64, clip: bool) -> Vec<Columns> {
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
                length: span.length(),
            }
        })
        .collect()
}

/// Groups columns whose first control columns follow each other into tiles of at most [`LANES`].
pub(super) fn tiles(columns: &[Columns], order: usize) -> Vec<Tile> {
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
