//! Material points of a body as a lattice of span tiles.
//!
//! Every span of the body holds the same pattern of points, so positions, shape functions and weights factor
//! into one table per column of spans and one per row: nothing is stored per point but what the physics
//! changes. Spans are handled eight at a time, one per lane of a [`Lane`] (a *tile*), and rows of spans in
//! *strips* of fixed height. Sums are formed strip by strip, so they do not depend on the number of threads.
//!
//! A rectangle cuts the spans at its edges; a span that the boundary of another shape cuts has points of its
//! own ([`cut`]), in batches behind those of the tables ([`strips`]). Slits add rows for the points that
//! use copies of control points ([`parting`]). On a patch with a geometry the lattice is one of parameters,
//! in the unit of the knots, and has a [`Mapping`].

pub(crate) mod build;
mod cut;
mod evaluate;
mod parting;
mod point_graph;
mod sheets;
mod strips;
mod tables;
mod tips;

pub(crate) use sheets::Sheets;
pub(crate) use tables::{CutBatch, MappedPoint, Mapping, Row, Tile};

use std::ops::Range;

use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Crack, Layout, Shape};
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;
use crate::splines::spline::{MAX_FUNCTIONS, SplineSpace};
use cut::Rules;
use tables::Along;

/// Rows of spans in a strip; at least the highest degree, so that only neighbouring strips share control
/// points.
pub(crate) const STRIP_ROWS: usize = 8;

/// Material points of one body, in reference positions.
#[derive(Debug, Clone)]
pub struct Lattice {
    /// Layout of the control points, copies included.
    pub grid: ControlGrid,
    /// Layout of the control points of the patch: those of the phase field.
    pub patch_grid: ControlGrid,
    /// Polynomial degree of the splines in x and y.
    pub degree: [usize; 2],
    /// Points per span in x and y.
    pub points: [usize; 2],
    /// Arrangement of the points in a span.
    pub layout: Layout,
    /// Columns of spans from the left, in tiles of up to eight.
    pub tiles: Vec<Tile>,
    /// Rows of spans, those of sheets last.
    pub rows: Vec<Row>,
    pub(crate) patch_rows: usize,
    /// Rows of spans in a strip.
    strip_rows: usize,
    /// What the geometry of the patch adds; absent over a rectangle.
    pub(crate) mapping: Option<Box<Mapping>>,
    /// What the product of the weights of both directions is multiplied by, per batch: 0 where there is no
    /// point, and the determinant of the Jacobian where there is a geometry; absent if it is 1 everywhere.
    factor: Option<Vec<Lane>>,
    /// Whether a strip has points in a tile, strip by strip; absent if every one does.
    occupied: Option<Vec<bool>>,
    pub(crate) sheets: Sheets,
    /// Points of the spans that the boundary cuts.
    cut: Vec<CutBatch>,
}

/// Shape functions and physical gradients (1/m) of a batch of points, function n = l (p + 1) + k.
#[derive(Debug, Clone, Copy)]
pub struct BatchFunctions {
    /// Values of the functions at the points.
    pub value: [Lane; MAX_FUNCTIONS],
    /// Their physical gradients, 1/m.
    pub gradient: [[Lane; 2]; MAX_FUNCTIONS],
}

/// A coordinate of material points along one direction, m or unit of the knots.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AxisPoint {
    /// Coordinate x or y, m; a parameter in the unit of the knots on a patch with a geometry.
    pub position: f64,
    /// The length it stands for.
    pub weight: f64,
    /// Length of the span it lies in.
    pub span: f64,
}

/// Coordinates of the points of `body` along both directions of a patch with these spaces; parameters if they
/// are `mapped`. Unless [`fills_lattice`], the points are those of all pairs that lie in the shape, but for
/// spans that its boundary cuts.
pub(crate) fn point_axes(body: &Body, spaces: &[SplineSpace; 2], mapped: bool) -> [Vec<AxisPoint>; 2] {
    let axis = |along: Along<'_>| {
        let mut points = Vec::new();
        for (index, ends) in along.spans() {
            let span = along.space.spans()[index].length();
            points.extend(along.points(ends).map(|(position, weight)| AxisPoint { position, weight, span }));
        }
        points
    };
    directions(body, spaces, mapped).map(axis)
}

/// Whether no point of a lattice lies outside the shape.
pub(crate) fn fills_lattice(mapped: bool, shape: &Shape) -> bool {
    *shape == Shape::Patch || (!mapped && matches!(shape, Shape::Rectangle { .. }))
}

/// Whether the boundary of a body, if it is no rectangle, or a slit cuts spans of a patch over a rectangle.
pub(crate) fn cuts_spans(body: &Body, spaces: &[SplineSpace; 2]) -> bool {
    let shape = &body.shape;
    let edges = if fills_lattice(false, shape) { Vec::new() } else { shape.edges() };
    let slits = body.slits().flat_map(Crack::segments).map(BoundaryEdge::Line).collect();
    let [edges, slits] = [edges, slits].map(|edges| cut::edges_in_spans(edges, spaces));
    cut::cut_spans(shape, [&edges, &slits], spaces, Rules::exact(spaces, 1)).next().is_some()
}

/// The box around a body, with its rule, along both directions. A rectangle cuts spans, unless the lattice is
/// one of parameters.
fn directions<'a>(body: &Body, spaces: &'a [SplineSpace; 2], mapped: bool) -> [Along<'a>; 2] {
    let shape = if mapped { &Shape::Patch } else { &body.shape };
    let (low, high) = shape.bounding_box();
    let clip = matches!(shape, Shape::Rectangle { .. });
    [0, 1].map(|d| {
        let rule = Rule::new(body.layout, body.particles_per_cell[d]);
        Along { space: &spaces[d], rule, low: low[d], high: high[d], clip }
    })
}

impl Lattice {
    /// Moves forces at copies of control points to their originals.
    pub(crate) fn fold(&self, forces: &mut VectorField) {
        forces.iter_mut().for_each(|component| self.sheets.fold(component));
    }

    /// Whether a strip has points in a tile.
    #[inline(always)]
    pub(crate) fn is_occupied(&self, strip: usize, tile: usize) -> bool {
        self.occupied.as_ref().is_none_or(|occupied| occupied[strip * self.tiles.len() + tile])
    }

    /// Its points in some tiles of the patch alone, without those of sheets and of cut spans.
    pub(crate) fn on_tiles(&self, occupied: &[bool]) -> Self {
        let mut part = Self { cut: Vec::new(), occupied: None, ..self.clone() };
        let mut all = occupied.to_vec();
        all.resize(part.table_strips() * part.tiles.len(), false);
        part.occupied = Some(all);
        part
    }

    /// Places in a row of a field that the points of a strip may see; none if it has no points.
    pub(crate) fn columns_of_strip(&self, strip: usize) -> Option<Range<usize>> {
        let Some(occupied) = self.occupied.as_ref().filter(|_| strip < self.table_strips()) else {
            return Some(0..self.grid.stride);
        };
        let tiles = self.tiles.iter().zip(&occupied[strip * self.tiles.len()..]);
        let mut first = tiles.filter(|(_, occupied)| **occupied).map(|(tile, _)| self.grid.index(tile.first, 0));
        let start = first.next()?;
        let last = first.next_back().unwrap_or(start);
        Some(start..(last + LANES + self.degree[0]).min(self.grid.stride))
    }

    /// Whether a cell of the tables or of cut spans has points.
    pub(crate) fn is_cell_occupied(&self, cell: usize) -> bool {
        let (row, tile) = (cell / self.tiles.len(), cell % self.tiles.len());
        row >= self.rows.len() || self.is_occupied(row / self.strip_rows, tile)
    }

    /// Takes the points of strips of the patch away, or back, tile by tile: `occupied` goes strip by strip.
    pub(crate) fn occupy(&mut self, occupied: &[bool]) {
        let number = self.table_strips() * self.tiles.len();
        self.occupied.get_or_insert_with(|| vec![true; number])[..occupied.len()].copy_from_slice(occupied);
    }

    /// A field on all control points as one on those of the patch, to which copies add.
    pub(crate) fn onto_patch(&self, field: Vec<f64>) -> Vec<f64> {
        self.sheets.onto_patch(self.patch_grid, field)
    }

    /// A field on the control points of the patch with its copies.
    pub(crate) fn with_copies(&self, mut field: Vec<f64>) -> Vec<f64> {
        self.sheets.extend(self.patch_grid, &mut field);
        field
    }

    /// Coordinates (m) of the control points, copies included.
    pub fn control_positions(&self, patch: &Patch) -> VectorField {
        patch.control_positions().map(|component| self.with_copies(component))
    }

    /// Whether the span whose first function has the control point `first` has material on the side of the
    /// slits of a position, m.
    pub(crate) fn has_side(&self, first: usize, position: [f64; 2]) -> bool {
        self.sheets.has_side(self.cell(first), position)
    }

    /// Column and row of a control point of the patch.
    fn cell(&self, at: usize) -> [usize; 2] {
        [self.patch_grid.column_of(at), self.patch_grid.row_of(at)]
    }

    /// The control point that stands for one of the patch at a position (m), in the span whose first function
    /// has the control point `first`.
    pub(crate) fn control_point(&self, at: usize, first: usize, position: [f64; 2]) -> usize {
        self.sheets.original(at + self.lift(first, position))
    }

    /// Distance in fields of the control points of a position (m) from those of the patch, in the span whose
    /// first function has the control point `first`.
    pub(crate) fn lift(&self, first: usize, position: [f64; 2]) -> usize {
        self.sheets.lift(self.cell(first), position) * self.grid.stride
    }

    /// Number of points in a whole span: points in x times points in y.
    pub fn points_per_span(&self) -> usize {
        self.points[0] * self.points[1]
    }

    /// Batches in a full strip: point state is cut into chunks of this length.
    pub fn strip_batches(&self) -> usize {
        self.strip_rows * self.tiles.len() * self.points_per_span()
    }

    /// Number of strips of tables; those of cut spans follow.
    pub(crate) fn table_strips(&self) -> usize {
        self.rows.len().div_ceil(self.strip_rows)
    }

    /// Number of strips of the patch; those of sheets follow.
    pub(crate) fn patch_strips(&self) -> usize {
        self.patch_rows.div_ceil(self.strip_rows)
    }

    /// Rows of spans in a strip.
    pub(crate) fn strip_rows(&self, strip: usize) -> Range<usize> {
        strip * self.strip_rows..((strip + 1) * self.strip_rows).min(self.rows.len())
    }

    /// Control rows of the patch that a strip contributes to.
    pub(crate) fn strip_patch_rows(&self, strip: usize) -> Range<usize> {
        if strip >= self.table_strips() {
            return self.cut_control_rows(strip, |_| 0);
        }
        let rows = self.strip_control_rows(strip);
        let lift = self.rows[self.strip_rows(strip).start].lift;
        rows.start - lift..rows.end - lift
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

    /// Weights (m²) of a batch; zero where there is no point.
    pub fn weights_of(&self, batch: usize) -> Lane {
        if let Some(cut) = self.cut_batch(batch) {
            return cut.weight;
        }
        let (row, tile, b, a) = self.unbatch(batch);
        if self.is_occupied(row / self.strip_rows, tile) { self.weight(row, tile, b, a) } else { Lane::ZERO }
    }

    /// Weights of eight control points from index `at` of a field on; 1 over a rectangle.
    #[inline(always)]
    pub fn weights(&self, at: usize) -> Lane {
        self.mapping.as_ref().map_or(Lane::splat(1.0), |mapping| Lane::load(&mapping.weights, at))
    }

    /// Every point: batch, lane, position (m) and weight (m²).
    pub fn for_each_point(&self, mut f: impl FnMut(usize, usize, [f64; 2], f64)) {
        for batch in 0..self.batches() {
            let weight = self.weights_of(batch);
            for lane in 0..LANES {
                if weight[lane] > 0.0 {
                    f(batch, lane, self.position(batch, lane), weight[lane]);
                }
            }
        }
    }

    /// Heap memory of what is kept per point, bytes.
    pub fn bytes(&self) -> usize {
        let mapping = self.mapping.as_ref().map_or(0, |mapping| mapping.bytes());
        let cut = size_of::<CutBatch>() * self.cut.len();
        cut + mapping + self.factor.as_ref().map_or(0, |factor| size_of::<Lane>() * factor.len())
    }

    /// Number of material points.
    pub fn count(&self) -> usize {
        let mut count = 0;
        self.for_each_point(|_, _, _, _| count += 1);
        count
    }
}
