//! What a level takes over from the coarser one where it begins to have points.

use super::super::TotalFrame;
use super::regions::Regions;
use crate::linear_algebra::interface::Interface;
use crate::linear_algebra::lane::LANES;
use crate::particles::lattice::Lattice;

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
