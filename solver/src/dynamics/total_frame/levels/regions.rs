//! Which part of the mesh each level has, in tiles of spans, which of its functions are in use, and what it
//! takes over from the coarser level where it begins to have points.

use std::ops::Range;

use super::super::TotalFrame;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::interface::Interface;
use crate::linear_algebra::lane::LANES;
use crate::particles::lattice::{Lattice, STRIP_ROWS};
use crate::scene::Crack;

/// Phase field below which the mesh is refined: the stress of AT2 under a uniform strain is largest there.
const REFINED_BELOW: f64 = 0.75;

/// The same of a model with a threshold, whose crack ends where c is 1.
const INTACT: f64 = 0.99;

/// Spans of the coarser level around what is refined that are refined with it. With two, three levels took 1
/// to 2 % too little work in the benchmark of the plate; with four and eight they did not.
const MARGIN: usize = 4;

/// Rows of spans in a tile of a level that can be refined: half of those in a strip of the finest.
pub(super) const ROWS: usize = STRIP_ROWS / 2;

/// The tiles of each level, but for the finest, that are refined: strip by strip.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Regions {
    pub refined: Vec<Vec<bool>>,
    /// Number of tiles in a strip, for each level but the finest.
    columns: Vec<usize>,
}

/// Functions of a level.
#[derive(Debug, Clone)]
pub(super) struct Functions {
    /// Those with a support that lies wholly in the part of this level and of finer ones.
    pub whole: Vec<bool>,
    /// Those with a support that lies wholly in the part of finer ones.
    pub covered: Vec<bool>,
    /// Those that reach into the part of this level or of finer ones.
    pub known: Vec<bool>,
}

impl Functions {
    /// Whether a function has a value of its own.
    pub(super) fn is_own(&self, at: usize) -> bool {
        self.whole[at] && !self.covered[at]
    }

    /// Whether a function is that of the coarser level by knot insertion.
    pub(super) fn is_between(&self, at: usize) -> bool {
        self.known[at] && !self.whole[at]
    }

    /// Whether the points of the level may see a function.
    pub(super) fn is_in_use(&self, at: usize) -> bool {
        self.known[at] && !self.covered[at]
    }
}

impl Regions {
    /// Nothing is refined.
    pub(super) fn new(frames: &[TotalFrame]) -> Self {
        let coarser = || frames[..frames.len() - 1].iter().map(|frame| &frame.lattice);
        Self {
            refined: coarser().map(|lattice| vec![false; lattice.patch_strips() * lattice.tiles.len()]).collect(),
            columns: coarser().map(|lattice| lattice.tiles.len()).collect(),
        }
    }

    /// Whether a span of a level lies in a part where finer ones have points.
    pub(super) fn is_refined(&self, level: usize, [i, j]: [usize; 2]) -> bool {
        let tile = |columns: &usize| j / ROWS * columns + i / LANES;
        self.columns.get(level).is_some_and(|columns| self.refined[level][tile(columns)])
    }

    /// Whether a span of a level lies in a part where this level or finer ones have points.
    pub(super) fn holds(&self, level: usize, [i, j]: [usize; 2]) -> bool {
        level == 0 || self.is_refined(level - 1, [i / 2, j / 2])
    }

    /// Which tiles of a level have points, strip by strip of its lattice.
    pub(super) fn occupied(&self, level: usize, lattice: &Lattice) -> Vec<bool> {
        let rows = if level < self.columns.len() { ROWS } else { STRIP_ROWS };
        let all = (0..lattice.patch_strips()).flat_map(|strip| (0..lattice.tiles.len()).map(move |tile| (strip, tile)));
        let first_span = |(strip, tile)| [tile * LANES, strip * rows];
        all.map(first_span).map(|span| self.holds(level, span) && !self.is_refined(level, span)).collect()
    }

    /// Refines the tiles along slits and the ways of driven cracks.
    pub(super) fn mark_along(&mut self, cracks: &[&Crack], frames: &[TotalFrame]) {
        for level in 0..self.columns.len() {
            let [x, y] = frames[level].patch.spaces.each_ref().map(|space| space.spans());
            for (j, i) in (0..y.len()).flat_map(|j| (0..x.len()).map(move |i| (j, i))) {
                let center = [0.5 * (x[i].left + x[i].right), 0.5 * (y[j].left + y[j].right)];
                let (size, diagonal) = (x[i].length().max(y[j].length()), x[i].length().hypot(y[j].length()));
                if cracks.iter().any(|crack| crack.distance(center) < 0.5 * diagonal + MARGIN as f64 * size) {
                    self.mark(level, [i..i + 1, j..j + 1]);
                }
            }
        }
    }

    /// Refines the tiles where a crack is, and next to it; whether there are new ones.
    pub(super) fn mark_cracks(&mut self, frames: &[TotalFrame]) -> bool {
        let mut any = false;
        for level in 0..self.columns.len() {
            let spans = frames[level].patch.spaces.each_ref().map(|space| space.spans().len());
            for (frame, halvings) in frames[level..].iter().zip(0..) {
                let Some(fracture) = &frame.fracture else { continue };
                let (grid, degree) = (frame.lattice.patch_grid, frame.lattice.degree);
                let phase = fracture.field.control_values();
                let below = if fracture.has_threshold() { INTACT } else { REFINED_BELOW };
                for at in fracture.field.taking_part().flatten().filter(|&at| phase[at] < below) {
                    let place = [grid.column_of(at), grid.row_of(at)];
                    let around = [0, 1].map(|d| {
                        // The span in the middle of its support, or two.
                        let [first, last] = [degree[d].div_ceil(2), degree[d] / 2]
                            .map(|half| (place[d].saturating_sub(half) >> halvings).min(spans[d] - 1));
                        first.saturating_sub(MARGIN)..(last + MARGIN + 1).min(spans[d])
                    });
                    any |= self.mark(level, around);
                }
            }
        }
        any
    }

    /// Refines the tiles where the energy nears the threshold of a model that has one, and a span beside;
    /// whether there are new ones.
    pub(super) fn mark_driven(&mut self, frames: &[TotalFrame]) -> bool {
        let mut any = false;
        for (level, TotalFrame { lattice, fracture, patch, .. }) in frames[..self.columns.len()].iter().enumerate() {
            let Some((awake, history)) = fracture.as_ref().and_then(|f| Some((f.field.awake()?, &f.history))) else {
                continue;
            };
            let spans = patch.spaces.each_ref().map(|space| space.spans().len());
            let around = |at: usize, size: usize, d: usize| at.saturating_sub(1)..(at + size + 1).min(spans[d]);
            let tiles = lattice.tiles.len();
            for cell in awake.near_the_threshold(lattice, history) {
                any |= self.mark(level, [around(cell % tiles * LANES, LANES, 0), around(cell / tiles, 1, 1)]);
            }
        }
        any
    }

    /// Refines the tiles of some spans of a level, and those of coarser levels that they lie in; whether
    /// there are new ones.
    fn mark(&mut self, level: usize, [i, j]: [Range<usize>; 2]) -> bool {
        let mut any = false;
        let tiles = |range: Range<usize>, size: usize| range.start / size..range.end.div_ceil(size);
        for (row, column) in tiles(j, ROWS).flat_map(|row| tiles(i.clone(), LANES).map(move |column| (row, column))) {
            if !std::mem::replace(&mut self.refined[level][row * self.columns[level] + column], true) {
                any = true;
                if level > 0 {
                    let [i, j] = [column * LANES / 2, row * ROWS / 2];
                    self.mark(level - 1, [i..i + 1, j..j + 1]);
                }
            }
        }
        any
    }

    /// The functions of every level.
    pub(super) fn functions(&self, frames: &[TotalFrame]) -> Vec<Functions> {
        let of_level = |(level, frame): (usize, &TotalFrame)| {
            let [whole, known] = over_supports(frame, |span| self.holds(level, span));
            let [covered, _] = over_supports(frame, |span| self.is_refined(level, span));
            Functions { whole, covered, known }
        };
        frames.iter().enumerate().map(of_level).collect()
    }
}

/// For each function of a level whether `holds` is true in all spans of its support, and in any of them.
fn over_supports(frame: &TotalFrame, holds: impl Fn([usize; 2]) -> bool) -> [Vec<bool>; 2] {
    let (grid, degree): (ControlGrid, _) = (frame.lattice.patch_grid, frame.lattice.degree);
    let [nx, ny] = frame.patch.spaces.each_ref().map(|space| space.spans().len());
    let support =
        |function: usize, degree: usize, spans: usize| function.saturating_sub(degree)..(function + 1).min(spans);
    let mut counts = vec![0; grid.columns * ny]; // of the spans of a row that hold, in a support
    for row in 0..ny {
        let held: Vec<bool> = (0..nx).map(|column| holds([column, row])).collect();
        for column in 0..grid.columns {
            counts[row * grid.columns + column] = support(column, degree[0], nx).filter(|&i| held[i]).count();
        }
    }
    let (mut all, mut any) = (vec![false; grid.len()], vec![false; grid.len()]);
    for at in grid.indices() {
        let (column, rows) = (grid.column_of(at), support(grid.row_of(at), degree[1], ny));
        let count: usize = rows.clone().map(|j| counts[j * grid.columns + column]).sum();
        (all[at], any[at]) = (count == rows.len() * support(column, degree[0], nx).len(), count > 0);
    }
    [all, any]
}

/// Copies displacement, velocity and phase field to some functions of the finer level.
pub(super) fn copy_fields(functions: &Interface, coarse: &TotalFrame, fine: &mut TotalFrame) {
    for d in 0..2 {
        functions.spread(&coarse.displacement[d], &mut fine.displacement[d]);
        functions.spread(&coarse.velocity[d], &mut fine.velocity[d]);
    }
    if let (Some(coarse), Some(fine)) = (&coarse.fracture, &mut fine.fracture) {
        fine.field.take_values(&coarse.field, |coarse, fine| functions.spread(coarse, fine));
    }
}

/// Copies the history of points of a level to those of the next in tiles that are refined now, and were not
/// before: each takes that of the nearest one.
pub(super) fn copy_points(level: usize, [before, now]: [&Regions; 2], coarse: &TotalFrame, fine: &mut TotalFrame) {
    let (from, TotalFrame { lattice, fracture, .. }) = (&coarse.lattice, fine);
    let (Some(coarse), Some(fine)) = (&coarse.fracture, fracture) else { return };
    let is_fresh = |span: [usize; 2]| now.is_refined(level, span) && !before.is_refined(level, span);
    for (row, tile) in (0..lattice.patch_rows).flat_map(|row| (0..lattice.tiles.len()).map(move |tile| (row, tile))) {
        for lane in (0..lattice.tiles[tile].count).filter(|lane| is_fresh([(tile * LANES + lane) / 2, row / 2])) {
            for (b, a) in (0..lattice.points[1]).flat_map(|b| (0..lattice.points[0]).map(move |a| (b, a))) {
                let at = lattice.batch(row, tile, b, a);
                let from = nearest_point(from, lattice, [row, tile, b, a], lane);
                fine.history[at][lane] = coarse.history[from.0][from.1];
            }
        }
    }
}

/// Batch and lane of the point of a lattice that is nearest to one of the next finer lattice.
fn nearest_point(coarse: &Lattice, fine: &Lattice, [row, tile, b, a]: [usize; 4], lane: usize) -> (usize, usize) {
    let column = (tile * LANES + lane) / 2;
    let (coarse_tile, coarse_lane) = (column / LANES, column % LANES);
    let nearest = |count: usize, distance: &dyn Fn(usize) -> f64| {
        (0..count).min_by(|one, other| distance(*one).total_cmp(&distance(*other))).unwrap_or(0)
    };
    let (x, y) = (fine.tiles[tile].position[a][lane], fine.rows[row].position[b]);
    let position = &coarse.tiles[coarse_tile].position;
    let a = nearest(coarse.points[0], &|a| (position[a][coarse_lane] - x).abs());
    let b = nearest(coarse.points[1], &|b| (coarse.rows[row / 2].position[b] - y).abs());
    (coarse.batch(row / 2, coarse_tile, b, a), coarse_lane)
}
