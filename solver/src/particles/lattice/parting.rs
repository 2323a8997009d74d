//! Which control points a slit or a gap parts.
//!
//! The points in the support of a function are a graph: neighbours are joined unless a slit or a gap of the
//! body lies between them. Where the graph falls into components, the function is parted and has one control
//! point for each. Points of a span that belong to the same components of all its functions are a *group*. A
//! span that the boundary cuts has its points of tables in the graph too: they join others, and belong to no
//! group.

use std::collections::{BTreeMap, BTreeSet};

use super::point_graph::{Group, PointGraph, PointIndex};
use super::sheets::{FunctionIndex, Gaps, Sheets};
use super::tables::CutPoint;
use super::{Lattice, Row};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::Lane;
use crate::scene::Crack;
use crate::scene::shape::Segment;
use crate::splines::patch::Patch;

/// Distance of the places on a slit at which its sides are compared, and of these sides from it, of the
/// shortest span.
const STEP: f64 = 0.2;
const BESIDE: f64 = 1e-6;

/// Rows of spans that a sheet takes over, and those that were added for it.
struct SheetRows {
    taken: usize,
    added: usize,
    lift: usize,
}

impl Lattice {
    /// Parts the control points along slits (m), and along gaps of the shape that are narrower than a
    /// support.
    pub(super) fn part(&mut self, slits: &[Segment], gaps: &Gaps<'_>, cut: &mut [CutPoint]) {
        let mut groups = PointGraph::new(self, slits, gaps, cut).groups();
        let sheets = choose_sheets(&mut groups);
        if sheets > 1 {
            groups.sort_by_key(|group| group.sheet);
            let windows = self.add_rows(&groups, sheets);
            self.move_points(&groups, &windows, cut);
        }
    }

    /// Whether a slit parts a function: whether any has two control points on its two sides.
    pub(crate) fn is_parted_by(&self, patch: &Patch, slit: &Crack) -> bool {
        let span = patch.shortest_span();
        slit.places(STEP * span).any(|[place, normal]| {
            let on_side = |side: f64| {
                let beside = [0, 1].map(|d| place[d] + side * BESIDE * span * normal[d]);
                let values = patch.functions_at(beside).map_or_else(Vec::new, |functions| functions.values);
                let first = values.first().map_or(0, |value| value.0);
                let point = |(at, _): (usize, f64)| (at, self.control_point(at, first, beside));
                values.into_iter().map(point).collect::<BTreeMap<_, _>>()
            };
            let [left, right] = [1.0, -1.0].map(on_side);
            left.iter().any(|(at, point)| right.get(at).is_some_and(|other| other != point))
        })
    }

    /// Adds rows of spans and of control points for every sheet.
    fn add_rows(&mut self, groups: &[Group], sheets: usize) -> Vec<SheetRows> {
        let mut found = Sheets::default();
        let mut windows = vec![SheetRows { taken: 0, added: 0, lift: 0 }];
        let old_batches = self.batches();
        let mut control_rows = self.grid.rows;
        let mut copied = Vec::new(); // row of spans that each added one copies
        for sheet in 1..sheets {
            self.fill_strip(&mut copied);
            let rows = groups.iter().filter(|group| group.sheet == sheet).map(|group| group.row);
            let (low, high) = rows.fold((usize::MAX, 0), |(low, high), row| (low.min(row), high.max(row)));
            let lift = control_rows - self.rows[low].first;
            windows.push(SheetRows { taken: low, added: self.rows.len(), lift });
            for row in low..=high {
                let Row { first, .. } = self.rows[row];
                self.rows.push(Row { first: first + lift, lift, ..self.rows[row].clone() });
                copied.push(row);
            }
            let end = self.rows[high].first + self.degree[1] + 1 + lift;
            found.rows.push((control_rows..end, lift));
            control_rows = end;
        }
        let factor = self.factor.get_or_insert_with(|| vec![Lane::splat(1.0); old_batches]);
        factor.resize(self.rows.len() * self.tiles.len() * self.points[0] * self.points[1], Lane::ZERO);
        if let Some(mapping) = &mut self.mapping {
            let in_row = old_batches / self.patch_rows;
            for row in copied {
                mapping.points.extend_from_within(row * in_row..(row + 1) * in_row);
            }
            found.extend(self.grid, &mut mapping.weights);
        }
        self.grid = ControlGrid::new(self.grid.columns, control_rows);
        self.sheets = found;
        windows
    }

    /// Adds rows without points up to the end of a strip.
    pub(super) fn fill_strip(&mut self, copied: &mut Vec<usize>) {
        let last = self.rows.len() - 1;
        while !self.rows.len().is_multiple_of(self.strip_rows) {
            self.rows.push(self.rows[last].clone());
            copied.push(0);
        }
    }

    /// Moves the points of groups to the rows of their sheets, and ties the copies of whole functions.
    fn move_points(&mut self, groups: &[Group], windows: &[SheetRows], cut: &mut [CutPoint]) {
        let columns = self.span_columns();
        let tables = columns.len() * self.points[0] * self.patch_rows * self.points[1];
        let mut moved = Vec::new();
        for group in groups {
            let SheetRows { taken, added, lift } = windows[group.sheet];
            for &place in &group.places {
                if let Some(number) = place.checked_sub(tables) {
                    cut[number].lift = lift;
                    continue;
                }
                let (batch, lane) = self.batch_of(&columns, place);
                let (row, tile, b, a) = self.unbatch(batch);
                moved.push((batch, self.batch(row + added - taken, tile, b, a), lane, group.first, lift));
            }
        }
        let positions: Vec<_> = moved.iter().map(|&(batch, _, lane, ..)| self.position(batch, lane)).collect();
        let Self { factor: Some(factor), sheets, .. } = self else { return };
        for ((old, new, lane, first, lift), position) in moved.into_iter().zip(positions) {
            sheets.points.entry(first).or_default().push((position, lift));
            factor[new][lane] = factor[old][lane];
            if old != new {
                factor[old][lane] = 0.0;
            }
        }
        let firsts: BTreeSet<FunctionIndex> = groups.iter().map(|group| group.first).collect();
        for point in cut.iter().filter(|point| firsts.contains(&point.first)) {
            sheets.points.entry(point.first).or_default().push((point.point.0, point.lift));
        }
        let mut owners = BTreeMap::new();
        for group in groups {
            for &([column, row], component) in &group.functions {
                let at = self.grid.index(column, row + windows[group.sheet].lift);
                let owner = match component {
                    None => self.grid.index(column, row),
                    Some(_) => *owners.entry(([column, row], component)).or_insert(at),
                };
                if owner != at {
                    sheets.ties.push((at, owner));
                }
            }
        }
        sheets.ties.sort_unstable();
        sheets.ties.dedup();
    }

    /// Tile and lane of every column of spans.
    pub(super) fn span_columns(&self) -> Vec<(usize, usize)> {
        self.tiles.iter().enumerate().flat_map(|(tile, t)| (0..t.count).map(move |lane| (tile, lane))).collect()
    }

    /// Batch and lane of a point of a table.
    pub(super) fn batch_of(&self, columns: &[(usize, usize)], point: PointIndex) -> (usize, usize) {
        let [nx, ny] = self.points;
        let (i, j) = (point / (self.patch_rows * ny), point % (self.patch_rows * ny));
        let (tile, lane) = columns[i / nx];
        (self.batch(j / ny, tile, j % ny, i % nx), lane)
    }
}

/// Puts every group on the first sheet on which no function would belong to two components; the number of
/// sheets.
fn choose_sheets(groups: &mut [Group]) -> usize {
    let mut taken: Vec<BTreeMap<FunctionIndex, Option<usize>>> = vec![BTreeMap::new()];
    for group in groups {
        let fits = |taken: &BTreeMap<FunctionIndex, Option<usize>>| {
            group
                .functions
                .iter()
                .all(|(function, component)| taken.get(function).is_none_or(|other| other == component))
        };
        group.sheet = taken.iter().position(fits).unwrap_or(taken.len());
        if group.sheet == taken.len() {
            taken.push(BTreeMap::new());
        }
        taken[group.sheet].extend(group.functions.iter().copied());
    }
    taken.len()
}
