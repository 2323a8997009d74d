//! How a lattice is made: tables, the geometry map at points whose places are parameters, spans that the
//! boundary cuts, and copies along slits and gaps. Points of a body of the updated frame begin there too.

use std::collections::BTreeMap;

use super::cut::{EdgesInSpans, PointBox, Rules, cut_spans, edges_in_spans};
use super::sheets::{Gaps, Sheets};
use super::tables::{CutPoint, MappedPoint, Mapping, first_function, tiles};
use super::tips::lengthened;
use super::{Lattice, STRIP_ROWS, directions, fills_lattice};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::scene::edges::BoundaryEdge;
use crate::scene::{Body, Shape};
use crate::splines::nurbs::NurbsPatch;
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
        let slits = lengthened(patch, body);
        let mut gaps = if fills { Gaps::None } else { Gaps::Of(&body.shape) };
        if !fills {
            lattice.keep_inside(&body.shape);
        }
        let mut cut = Vec::new();
        if !mapped && (!fills || !slits.is_empty()) {
            let mut edges = edges_in_spans(body.shape.edges(), &patch.spaces);
            let lines = slits.iter().copied().map(BoundaryEdge::Line).collect();
            let by_slits = edges_in_spans(fault!("slits-cut-no-spans", lines => Vec::new()), &patch.spaces);
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
            (lattice.sheets.slits, lattice.sheets.shape) = (slits, (!fills).then(|| body.shape.clone()));
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
            sheets: Sheets::default(),
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

    /// Evaluates weight function and geometry map at every point.
    pub(super) fn map_by(&mut self, patch: &NurbsPatch) {
        let mut weights = self.grid.zeros();
        for (at, weight) in self.grid.indices().zip(patch.weights()) {
            weights[at] = fault!("rational-weights-ignored", *weight => 1.0);
        }
        let mut points = vec![MappedPoint::default(); self.batches()];
        let mut determinants = vec![Lane::ZERO; self.batches()];
        for batch in 0..self.batches() {
            let (_, tile, _, _) = self.unbatch(batch);
            for lane in 0..self.tiles[tile].count {
                let parameters = self.parameters(batch, lane);
                let Some(span) = patch.find_span(parameters) else { continue };
                let (image, weight) = patch.image(span, parameters);
                let [[xu, xv], [yu, yv]] = image.jacobian;
                let determinant = image.determinant();
                determinants[batch][lane] = fault!("jacobian-missing", determinant => 1.0);
                let point = &mut points[batch];
                point.inverse_weight[lane] = 1.0 / weight.value;
                for d in 0..2 {
                    point.weight_slope[d][lane] = weight.gradient[d] / weight.value;
                    point.position[d][lane] = image.position[d];
                }
                let [yu, xv] = fault!("inverse-map-transposed", [yu, xv] => [xv, yu]);
                for (entry, value) in point.inverse_jacobian.iter_mut().zip([yv, -xv, -yu, xu]) {
                    entry[lane] = value / determinant;
                }
            }
        }
        self.mapping = Some(Box::new(Mapping { weights, points }));
        self.factor = Some(determinants);
    }
}

/// The points in the spans that the boundary of a body cuts, or a slit.
fn cut_points<'a>(
    patch: &'a Patch,
    body: &'a Body,
    edges: [&'a EdgesInSpans; 2],
    rules: Rules,
) -> impl Iterator<Item = CutPoint> + 'a {
    let spans = cut_spans(&body.shape, edges, &patch.spaces, rules);
    spans.flat_map(move |(span, points)| CutPoint::of_span(patch, span, points))
}

/// Points per span and direction: the larger number.
fn most(body: &Body) -> usize {
    body.particles_per_cell[0].max(body.particles_per_cell[1])
}

/// The points of `body`, with their boxes. In a span that its boundary cuts there are fewer than the degree
/// needs, since they do not stay there.
pub(crate) fn moving_points(patch: &Patch, body: &Body) -> Vec<PointBox> {
    let (shape, spaces) = (&body.shape, &patch.spaces);
    let fills = fills_lattice(false, shape);
    let edges = if fills { EdgesInSpans::new() } else { edges_in_spans(shape.edges(), spaces) };
    let rules = Rules::Boxes(body.particles_per_cell);
    let cut: BTreeMap<_, _> = cut_spans(shape, [&edges, &EdgesInSpans::new()], spaces, rules).collect();
    let [columns, rows] = directions(body, spaces, false).map(|along| {
        let points_of = |(span, ends)| (span, along.points(ends).collect::<Vec<_>>());
        along.spans().map(points_of).collect::<Vec<_>>()
    });
    let mut points = Vec::new();
    for ((j, rows), (i, columns)) in rows.iter().flat_map(|row| columns.iter().map(move |column| (row, column))) {
        if let Some(cut) = cut.get(&[*i, *j]) {
            points.extend(cut);
        } else {
            let all = rows.iter().flat_map(|(y, v)| columns.iter().map(move |(x, w)| ([*x, *y], [*w, *v])));
            points.extend(all.filter(|(position, _)| fills || shape.contains(*position)));
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Layout, Mesh, Shape};

    #[test]
    fn boxes_stay_in_their_spans_do_not_overlap_and_have_the_area_of_the_body() {
        let patch = Patch::new(&Mesh::uniform([2; 2], [0.0; 2], [1.0; 2], [10; 2]));
        let disc = Shape::Disk { center: [0.51, 0.47], radius: 0.33 };
        let bar = Shape::Polygon { points: vec![[0.13, 0.21], [0.85, 0.47], [0.81, 0.64], [0.07, 0.38]] };
        for (shape, area, tolerance) in [
            (Shape::Rectangle { min: [0.13, 0.21], max: [0.68, 0.74] }, 0.55 * 0.53, 1e-14),
            (bar, 0.1371, 1e-12),
            (disc, std::f64::consts::PI * 0.33 * 0.33, 2e-3),
        ] {
            let body =
                Body { particles_per_cell: [2, 3], layout: Layout::Uniform, ..Body::at_rest("body", "soft", shape) };
            let boxes = moving_points(&patch, &body);
            let sum: f64 = boxes.iter().map(|(_, [width, height])| width * height).sum();
            assert!((sum / area - 1.0).abs() < tolerance, "{:?}: {sum} for {area}", body.shape);
            let ends = |(x, size): &PointBox, d: usize| [x[d] - 0.5 * size[d], x[d] + 0.5 * size[d]];
            for (n, one) in boxes.iter().enumerate() {
                for d in 0..2 {
                    let [left, right] = ends(one, d);
                    let span = (one.0[d] * 10.0).floor();
                    assert!(left > 0.1 * span - 1e-12 && right < 0.1 * (span + 1.0) + 1e-12, "{one:?}");
                }
                let apart = |other: &PointBox| {
                    (0..2).any(|d| {
                        let ([a, b], [left, right]) = (ends(one, d), ends(other, d));
                        b < left + 1e-12 || right < a + 1e-12
                    })
                };
                assert!(boxes[..n].iter().all(apart), "{one:?} overlaps another one");
            }
        }
    }
}
