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
