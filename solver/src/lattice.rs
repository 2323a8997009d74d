//! Material points of a body as a lattice of span tiles.
//!
//! Every span of the body holds the same pattern of points, so positions, shape functions and weights factor into one
//! table per column of spans and one per row: nothing is stored per point but what the physics changes. Spans are
//! handled eight at a time, one per lane of a [`Lane`] (a *tile*), and rows of spans in *strips* of fixed height. Sums
//! are formed strip by strip, so they do not depend on the number of threads.
//!
//! A rectangle cuts the spans at its edges exactly; of other shapes the points of a span that lie inside are kept.

use crate::lane::{LANES, Lane};
use crate::patch::{ControlGrid, Patch};
use crate::quadrature::Rule;
use crate::scene::{Body, Shape};
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
    /// Tiles of columns.
    pub tiles: Vec<Tile>,
    /// Rows of spans.
    pub rows: Vec<Row>,
    /// Which points exist, 1 or 0 per batch and lane; absent if all do.
    mask: Option<Vec<Lane>>,
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
        let (low, high) = body.shape.bounding_box();
        let clip = matches!(body.shape, Shape::Rectangle { .. });
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
            tiles: tiles(&x, degree[0] + 1),
            rows,
            mask: None,
        };
        if !clip {
            lattice.mask = Some(lattice.mask_of(&body.shape));
        }
        lattice
    }

    fn mask_of(&self, shape: &Shape) -> Vec<Lane> {
        let inside = |batch: usize, lane: usize| f64::from(u8::from(shape.contains(self.position(batch, lane))));
        (0..self.batches())
            .map(|batch| {
                let mut lanes = Lane::ZERO;
                for lane in 0..LANES {
                    lanes[lane] = inside(batch, lane);
                }
                lanes
            })
            .collect()
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
        match &self.mask {
            None => weight,
            Some(mask) => weight * mask[self.batch(row, tile, b, a)],
        }
    }

    /// Position of the point of a batch in a lane, m.
    pub fn position(&self, batch: usize, lane: usize) -> [f64; 2] {
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
