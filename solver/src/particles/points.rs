//! Material points that move, and their order: sorted by the span they are in.
//!
//! Points of one span follow each other in memory (a [`Cell`]), and so do the cells of four neighbouring rows
//! of spans (a [`Strip`]). Sums run over strips in a fixed order, whatever the number of threads. Sorting is
//! stable and only needed once some point has left its span.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::material::hencky::Gradient;
use crate::splines::patch::Patch;
use crate::splines::spline::{MAX_DEGREE, MeanFunctions, SplineSpace};

/// Rows of spans in a strip: two more than the highest degree, so that every second strip has control points
/// of its own.
const STRIP_ROWS: usize = MAX_DEGREE + 2;

/// What every material point carries.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Present position, m.
    pub position: [f64; 2],
    /// Velocity half a step before the present time, m/s; at t = 0 the initial one.
    pub velocity: [f64; 2],
    /// Displacement so far, m, added up on its own: positions minus first positions would lose digits.
    pub displacement: [f64; 2],
    /// Strain `[xx, yy, xy]`: linear, or Hencky's with finite kinematics.
    pub strain: [f64; 3],
    /// Stress of the degraded material `[xx, yy, xy]`, Pa; Kirchhoff's with finite kinematics.
    pub stress: [f64; 3],
    /// Volume at t = 0 per unit thickness, m².
    pub volume: f64,
    /// Width over height of its domain at t = 0.
    pub aspect: f64,
    /// Half the width and half the height of its domain now, m.
    pub half_width: [f64; 2],
    /// Where the middle of the domain is from the point, which is its centre of mass, m.
    pub offset: [f64; 2],
}

/// What a point of a fracturing body carries besides.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FracturePoint {
    /// History energy H, J/m³.
    pub history: f64,
    /// Phase field c at the point, 1 where intact and 0 where broken.
    pub phase: f64,
    /// `c (H − psi+)`, J/m³.
    pub excess: f64,
    /// Strain of the last step.
    pub strain_increment: [f64; 3],
    /// Displacement of the last step, m.
    pub moved: [f64; 2],
    /// Slope of the energy of the phase field where the point is, as it moves through that, J/m⁴.
    pub slope: [f64; 2],
}

/// The points of one span.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Index of the span in x and y, from the lower left corner of the patch.
    pub span: [usize; 2],
    /// First control column and row of its shape functions.
    pub first: [usize; 2],
    /// Indices of the points in the span, in the order sorted by span.
    pub points: Range<usize>,
}

/// The cells of neighbouring rows of spans.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Number of the strip, counted from the bottom of the patch.
    pub index: usize,
    /// Indices of the cells of the strip in [`Cells::cells`].
    pub cells: Range<usize>,
    /// Indices of the points in the strip, in the order sorted by span.
    pub points: Range<usize>,
    /// Control rows that the domains of its points reach.
    pub control_rows: Range<usize>,
}

/// Order of the points.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    /// Spans with points, row by row.
    pub cells: Vec<Cell>,
    /// Strips with points, from the bottom.
    pub strips: Vec<Strip>,
    spans: [usize; 2],
    /// Start of the points of each span of the patch, and the end of the last.
    starts: Vec<usize>,
    keys: Vec<u32>,
}

/// A point that is no longer on the patch, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OutsidePatch(pub [f64; 2]);

impl Point {
    /// Position at t = 0, m, to the round-off of the position now.
    pub fn reference(&self) -> [f64; 2] {
        [0, 1].map(|d| self.position[d] - self.displacement[d])
    }

    /// A point at rest with a domain of a width and a height, m.
    pub(crate) fn at_rest(position: [f64; 2], [width, height]: [f64; 2]) -> Self {
        let aspect = fault!("domain-of-equal-sides", width / height => 1.0);
        let (volume, half_width) = (width * height, [0.5 * width, 0.5 * height]);
        Self { position, volume, aspect, half_width, ..Self::default() }
    }

    /// Deforms the domain: a box with the second moments of what `F = I + displacement` makes of it.
    #[inline(always)]
    pub(crate) fn deform_domain(&mut self, displacement: &Gradient) {
        let squares = [self.volume * self.aspect, self.volume / self.aspect];
        for d in 0..2 {
            let mut row = fault!("domain-of-t-0", displacement[d] => [0.0; 2]);
            row[d] += 1.0;
            self.half_width[d] = 0.5 * (row[0] * row[0] * squares[0] + row[1] * row[1] * squares[1]).sqrt();
        }
    }

    /// Means of the shape functions in x and y over the domain, which lies in a cell and reaches over at most
    /// one knot in each direction; `order` is p + 1. Ends are looked at if `ENDS`.
    #[inline(always)]
    pub fn mean_functions<const ENDS: bool>(
        &self,
        patch: &Patch,
        cell: &Cell,
        order: [usize; 2],
    ) -> [MeanFunctions; 2] {
        let mean = |d: usize| {
            // The slope of linear functions jumps with the offset.
            let domain = [self.half_width[d], if order[d] > 2 { self.offset[d] } else { 0.0 }];
            patch.spaces[d].mean_functions::<ENDS>(cell.span[d], self.position[d], domain, order[d])
        };
        [mean(0), mean(1)]
    }
}

impl Cells {
    /// Sorts `points` by span. What else belongs to the points follows by [`Self::reorder`].
    ///
    /// # Errors
    /// A point outside the patch; the order is then undefined.
    pub(crate) fn sort(&mut self, patch: &Patch, points: &mut [Point]) -> Result<(), OutsidePatch> {
        self.spans = [0, 1].map(|d| patch.spaces[d].spans().len());
        self.find_keys(patch, points)?;
        self.count();
        self.reorder(points);
        self.list_cells(patch);
        Ok(())
    }

    /// Brings what belongs to the points, one item each, from their order before the last [`Self::sort`] into
    /// that after it.
    pub(crate) fn reorder<T: Copy>(&self, items: &mut [T]) {
        let unsorted = items.to_vec();
        let mut next = self.starts.clone();
        for (item, key) in unsorted.iter().zip(&self.keys) {
            let at = &mut next[*key as usize];
            items[*at] = *item;
            *at += 1;
        }
    }

    /// Whether a span has points.
    pub(crate) fn is_occupied(&self, [i, j]: [usize; 2]) -> bool {
        let key = j * self.spans[0] + i;
        self.starts[key] < self.starts[key + 1]
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let lists = self.cells.len() * size_of::<Cell>() + self.strips.len() * size_of::<Strip>();
        lists + 8 * self.starts.len() + 4 * self.keys.len()
    }

    /// Number of the span of each point; the last order says where to look first.
    fn find_keys(&mut self, patch: &Patch, points: &[Point]) -> Result<(), OutsidePatch> {
        let Self { cells, keys, .. } = self;
        keys.clear();
        let [x, y] = &patch.spaces;
        let mut locate = |point: &Point, [i, j]: [usize; 2]| {
            let spans = find_span_near(x, point.position[0], i).zip(find_span_near(y, point.position[1], j));
            let (i, j) = spans.ok_or(OutsidePatch(point.position))?;
            keys.push((j * x.spans().len() + i) as u32);
            Ok(())
        };
        if cells.is_empty() {
            return points.iter().try_for_each(|point| locate(point, [0, 0]));
        }
        cells.iter().try_for_each(|cell| points[cell.points.clone()].iter().try_for_each(|p| locate(p, cell.span)))
    }

    fn count(&mut self) {
        let Self { starts, keys, spans, .. } = self;
        starts.clear();
        starts.resize(spans[0] * spans[1] + 1, 0);
        for key in keys.iter() {
            starts[*key as usize + 1] += 1;
        }
        for span in 1..starts.len() {
            starts[span] += starts[span - 1];
        }
    }

    fn list_cells(&mut self, patch: &Patch) {
        let Self { cells, strips, starts, spans, .. } = self;
        let [x, y] = [0, 1].map(|d| patch.spaces[d].spans());
        let order = patch.spaces[1].degree() + 1;
        let control_rows = patch.spaces[1].dimension();
        cells.clear();
        strips.clear();
        for index in 0..spans[1].div_ceil(STRIP_ROWS) {
            let rows = index * STRIP_ROWS..((index + 1) * STRIP_ROWS).min(spans[1]);
            let first_cell = cells.len();
            for (j, i) in rows.clone().flat_map(|j| (0..spans[0]).map(move |i| (j, i))) {
                let points = starts[j * spans[0] + i]..starts[j * spans[0] + i + 1];
                if !points.is_empty() {
                    cells.push(Cell { span: [i, j], first: [x[i].first, y[j].first], points });
                }
            }
            if cells.len() > first_cell {
                strips.push(Strip {
                    index,
                    cells: first_cell..cells.len(),
                    points: starts[rows.start * spans[0]]..starts[rows.end * spans[0]],
                    control_rows: y[rows.start].first.saturating_sub(1)
                        ..(y[rows.end - 1].first + order + 1).min(control_rows),
                });
            }
        }
    }
}

/// The span of `x`, looked for from a neighbour on.
fn find_span_near(space: &SplineSpace, x: f64, near: usize) -> Option<usize> {
    let spans = space.spans();
    let holds = |i: &usize| spans.get(*i).is_some_and(|s| s.left <= x && x < s.right);
    [near, near + 1, near.wrapping_sub(1)].into_iter().find(holds).or_else(|| space.find_span(x))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    fn at(x: f64, y: f64) -> Point {
        Point::at_rest([x, y], [x, 1.0])
    }

    #[test]
    fn points_come_in_the_order_of_their_spans_and_keep_what_belongs_to_them() {
        let patch = Patch::new(&Mesh::uniform([2, 2], [0.0; 2], [3.0, 9.0], [3, 9]));
        let mut points = vec![at(2.5, 8.5), at(0.5, 0.5), at(0.6, 0.5), at(1.5, 0.2), at(0.5, 4.0), at(3.0, 9.0)];
        let mut fracture: Vec<_> =
            points.iter().map(|p| FracturePoint { history: p.volume, ..Default::default() }).collect();
        let mut cells = Cells::default();
        for _ in 0..2 {
            cells.sort(&patch, &mut points).unwrap();
            cells.reorder(&mut fracture);
            let spans: Vec<_> = cells.cells.iter().map(|c| (c.span, c.points.clone())).collect();
            assert_eq!(spans, [([0, 0], 0..2), ([1, 0], 2..3), ([0, 4], 3..4), ([2, 8], 4..6)]);
            assert_eq!(
                cells.strips.iter().map(|s| (s.index, s.points.clone())).collect::<Vec<_>>(),
                [(0, 0..4), (1, 4..6)]
            );
            assert_eq!(cells.strips[1].control_rows, 5..11);
            assert!(points.iter().zip(&fracture).all(|(p, f)| p.volume == f.history));
            assert!(cells.is_occupied([1, 0]) && !cells.is_occupied([1, 1]));
        }
        points[0].position = [-0.1, 0.5];
        assert_eq!(cells.sort(&patch, &mut points), Err(OutsidePatch([-0.1, 0.5])));
    }
}
