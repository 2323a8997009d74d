//! How a lattice is made: tables, spans that the boundary cuts, and copies along slits and gaps.

use super::cut::{EdgesInSpans, Rules};
use super::cut_batch::{CutPoint, first_function};
use super::gaps::Gaps;
use super::tables::tiles;
use super::{Lattice, STRIP_ROWS, cut, directions, fills_lattice};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::scene::edges::BoundaryEdge;
use crate::scene::shape::Segment;
use crate::scene::{Body, Crack, Shape};
use crate::splines::patch::Patch;

impl Lattice {
    /// The points of `body` on `patch`; spans that its boundary or a slit cuts have points of their own.
    pub fn new(patch: &Patch, body: &Body) -> Self {
        Self::in_strips(patch, body, STRIP_ROWS)
    }

    /// As [`Self::new`], with so many rows of spans in a strip.
    pub(crate) fn in_strips(patch: &Patch, body: &Body, strip_rows: usize) -> Self {
        let mut lattice = Self { strip_rows, ..Self::of_tables(patch, body) };
        let mapped = patch.geometry.is_some();
        let fills = fills_lattice(mapped, &body.shape);
        let slits: Vec<Segment> = body.slits().flat_map(Crack::segments).collect();
        let mut gaps = if fills { Gaps::None } else { Gaps::Of(&body.shape) };
        if !fills {
            lattice.keep_inside(&body.shape);
        }
        let mut cut = Vec::new();
        if !mapped && (!fills || !slits.is_empty()) {
            let mut edges = cut::edges_in_spans(body.shape.edges(), &patch.spaces);
            let lines = slits.iter().copied().map(BoundaryEdge::Line).collect();
            let by_slits = cut::edges_in_spans(fault!("slits-cut-no-spans", lines => Vec::new()), &patch.spaces);
            if fills {
                edges.retain(|span, _| by_slits.contains_key(span)); // its tables end at the others
            }
            cut.extend(cut_points(patch, body, [&edges, &by_slits], Rules::exact(&patch.spaces, most(body))));
            if !fills && body.shape.all_edges_bound() {
                let of_function = |(span, edges)| (first_function(patch, span), edges);
                gaps = Gaps::Between(edges.into_iter().map(of_function).collect());
            }
        }
        if !fills || !slits.is_empty() {
            lattice.part(&slits, &gaps, &mut cut);
            let shape = (!fills).then(|| body.shape.clone());
            lattice.sheets.iter_mut().for_each(|sheets| (sheets.slits, sheets.shape) = (slits.clone(), shape.clone()));
        }
        if !cut.is_empty() {
            lattice.append_cut(patch, cut);
        }
        lattice.find_occupied();
        lattice
    }

    /// Every point of the tables.
    fn of_tables(patch: &Patch, body: &Body) -> Self {
        let [x, rows] = directions(body, &patch.spaces, patch.geometry.is_some()).map(|along| along.columns());
        let degree = [0, 1].map(|d| patch.spaces[d].degree());
        let mut lattice = Self {
            grid: patch.control_grid(),
            patch_grid: patch.control_grid(),
            degree,
            points: body.particles_per_cell,
            layout: body.layout,
            tiles: tiles(&x, degree[0] + 1),
            patch_rows: rows.len(),
            strip_rows: STRIP_ROWS,
            rows,
            mapping: None,
            factor: None,
            occupied: None,
            sheets: None,
            cut: Vec::new(),
        };
        if let Some(geometry) = &patch.geometry {
            lattice.map_by(geometry);
        }
        lattice
    }

    /// Finds which strips have points in which tiles.
    fn find_occupied(&mut self) {
        self.occupied = self.factor.as_ref().map(|factor| {
            let points = self.points_per_span();
            let holds = |(strip, tile): (usize, usize)| {
                let mut first = self.strip_rows(strip).map(|row| self.batch(row, tile, 0, 0));
                first.any(|at| factor[at..at + points].iter().any(|factor| factor.0.iter().any(|&f| f > 0.0)))
            };
            let tiles = self.tiles.len();
            (0..self.table_strips()).flat_map(|strip| (0..tiles).map(move |tile| (strip, tile))).map(holds).collect()
        });
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
}

/// The points in the spans that the boundary of a body cuts, or a slit.
fn cut_points<'a>(
    patch: &'a Patch,
    body: &'a Body,
    edges: [&'a EdgesInSpans; 2],
    rules: Rules,
) -> impl Iterator<Item = CutPoint> + 'a {
    let spans = cut::cut_spans(&body.shape, edges, &patch.spaces, rules);
    spans.flat_map(move |(span, points)| CutPoint::of_span(patch, span, points))
}

/// Points per span and direction: the larger number.
fn most(body: &Body) -> usize {
    body.particles_per_cell[0].max(body.particles_per_cell[1])
}
