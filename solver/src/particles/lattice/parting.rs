//! Which control points a slit or a gap parts.
//!
//! The points in the support of a function are a graph: neighbours are joined unless a slit or a gap of the
//! body lies between them. Where the graph falls into components, the function is parted and has one control
//! point for each. Points of a span that belong to the same components of all its functions are a *group*. A
//! span that the boundary cuts has its points of tables in the graph too: they join others, and belong to no
//! group.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::cut_batch::CutPoint;
use super::gaps::Gaps;
use super::sheets::{FunctionIndex, Sheets};
use super::{Lattice, Row, STRIP_ROWS};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::Lane;
use crate::scene::shape::{Segment, cross};

/// Number of a point: those of tables column by column, and behind them those of cut spans.
type PointIndex = usize;
/// Columns and rows from a point of a table to half of its neighbours; the others have it ahead of them.
const AHEAD: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];
/// Bit of a point that exists, beside those of its neighbours ahead.
const EXISTS: u8 = 1 << AHEAD.len();
/// Points of a neighbouring span that a point of a cut span may be joined to, the nearest first.
const TRIED: usize = 4;

/// Points of a span that belong to the same components of all its functions.
struct Group {
    /// First control point of the span.
    first: FunctionIndex,
    /// Row of spans.
    row: usize,
    places: Vec<PointIndex>,
    /// Component of every function of the span; none of one that is whole.
    functions: Vec<(FunctionIndex, Option<usize>)>,
    /// The patch itself is 0.
    sheet: usize,
}

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
        self.sheets = Some(Box::new(found));
        windows
    }

    /// Adds rows without points up to the end of a strip.
    pub(super) fn fill_strip(&mut self, copied: &mut Vec<usize>) {
        let last = self.rows.len() - 1;
        while !self.rows.len().is_multiple_of(STRIP_ROWS) {
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
        let (Some(factor), Some(sheets)) = (&mut self.factor, &mut self.sheets) else { return };
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
    fn span_columns(&self) -> Vec<(usize, usize)> {
        self.tiles.iter().enumerate().flat_map(|(tile, t)| (0..t.count).map(move |lane| (tile, lane))).collect()
    }

    /// Batch and lane of a point of a table.
    fn batch_of(&self, columns: &[(usize, usize)], point: PointIndex) -> (usize, usize) {
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

/// The points of a lattice and which neighbours are joined.
struct PointGraph<'a> {
    lattice: &'a Lattice,
    /// Tile and lane of every column of spans.
    columns: Vec<(usize, usize)>,
    /// Columns and rows of points of tables.
    size: [usize; 2],
    /// First functions of the columns and rows of spans.
    firsts: [Vec<usize>; 2],
    /// Of every point of a table: whether it exists, and to which neighbours ahead it is joined.
    links: Vec<u8>,
    /// Points of the spans that the boundary cuts, and where those of a span begin and end.
    cut: &'a [CutPoint],
    cut_spans: BTreeMap<FunctionIndex, Range<usize>>,
    /// What points of cut spans are joined to, both ways.
    joined_to_cut: BTreeMap<PointIndex, Vec<PointIndex>>,
}

/// The component of every point in the support of a function.
type Components = BTreeMap<PointIndex, usize>;

impl<'a> PointGraph<'a> {
    /// Neighbours are joined unless the step between them crosses one of the `slits` (m) or a gap.
    fn new(lattice: &'a Lattice, slits: &[Segment], gaps: &Gaps<'_>, cut: &'a [CutPoint]) -> Self {
        let columns = lattice.span_columns();
        let size = [columns.len() * lattice.points[0], lattice.patch_rows * lattice.points[1]];
        let firsts = [
            columns.iter().map(|&(tile, lane)| lattice.tiles[tile].first + lane).collect(),
            lattice.rows[..lattice.patch_rows].iter().map(|row| row.first).collect(),
        ];
        let mut cut_spans: BTreeMap<FunctionIndex, Range<usize>> = BTreeMap::new();
        for (number, point) in cut.iter().enumerate() {
            cut_spans.entry(point.first).or_insert(number..number).end = number + 1;
        }
        let (links, joined_to_cut) = (vec![0; size[0] * size[1]], BTreeMap::new());
        let mut graph = Self { lattice, columns, size, firsts, links, cut, cut_spans, joined_to_cut };
        for point in 0..graph.links.len() {
            let (batch, lane) = lattice.batch_of(&graph.columns, point);
            if lattice.weights_of(batch)[lane] > 0.0 {
                graph.links[point] = EXISTS;
            }
        }
        let is_free = |graph: &Self, points: [PointIndex; 2]| {
            let step = points.map(|point| graph.position(point));
            let slit = slits.iter().any(|slit| fault!("slit-bridged", cross(step, *slit) => false));
            !slit && !gaps.bar(step, points.map(|point| graph.first(point)))
        };
        for point in 0..graph.links.len() {
            for (bit, next) in graph.ahead(point) {
                if graph.exists(point) && graph.exists(next) && is_free(&graph, [point, next]) {
                    graph.links[point] |= 1 << bit;
                }
            }
        }
        graph.join_cut_spans(is_free);
        graph
    }

    /// Joins every point of a cut span to a near one of each neighbouring span, and the points of a span to
    /// each other, where no step between them is barred.
    fn join_cut_spans(&mut self, is_free: impl Fn(&Self, [PointIndex; 2]) -> bool) {
        let tables = self.links.len();
        for (first, range) in self.cut_spans.clone() {
            let mut parts: Vec<usize> = range.clone().collect(); // which points are joined within the span
            for number in range.clone() {
                for other in range.start..number {
                    let [old, new] = [number, other].map(|number| parts[number - range.start]);
                    if old != new && is_free(self, [tables + number, tables + other]) {
                        parts.iter_mut().filter(|part| **part == old).for_each(|part| *part = new);
                        self.join(tables + number, tables + other);
                    }
                }
                for span in self.near_spans(first) {
                    let near = self.nearest_of(span, tables + number).into_iter().flatten();
                    let free = near.map(|(_, point)| point).find(|point| is_free(self, [tables + number, *point]));
                    if let Some(point) = free {
                        self.join(tables + number, point);
                    }
                }
            }
        }
    }

    /// Points of a span with their distances (m) from another point, the nearest first.
    fn nearest_of(&self, span: FunctionIndex, from: PointIndex) -> [Option<(f64, PointIndex)>; TRIED] {
        let [x, y] = self.position(from);
        let mut nearest = [None; TRIED];
        for point in self.points_of(span).filter(|point| *point != from) {
            let to = self.position(point);
            let mut next = Some(((to[0] - x).hypot(to[1] - y), point));
            for place in &mut nearest {
                if place.is_none_or(|(distance, _)| next.is_some_and(|(other, _)| other < distance)) {
                    std::mem::swap(place, &mut next);
                }
            }
        }
        nearest
    }

    fn join(&mut self, a: PointIndex, b: PointIndex) {
        self.joined_to_cut.entry(a).or_default().push(b);
        self.joined_to_cut.entry(b).or_default().push(a);
    }

    /// First functions of a span and of its neighbours, by the first function of the span.
    fn near_spans(&self, first: FunctionIndex) -> Vec<FunctionIndex> {
        let [columns, rows] = [0, 1].map(|d| {
            let at = self.firsts[d].partition_point(|other| *other < first[d]);
            &self.firsts[d][at.saturating_sub(1)..(at + 2).min(self.firsts[d].len())]
        });
        columns.iter().flat_map(|column| rows.iter().map(move |row| [*column, *row])).collect()
    }

    /// The points of a span, given by its first function.
    fn points_of(&self, first: FunctionIndex) -> impl Iterator<Item = PointIndex> + '_ {
        let [columns, rows] = [0, 1].map(|d| {
            let at = self.firsts[d].partition_point(|other| *other < first[d]) * self.lattice.points[d];
            at..at + self.lattice.points[d]
        });
        let of_tables = columns.flat_map(move |i| rows.clone().map(move |j| i * self.size[1] + j));
        let cut = self.cut_spans.get(&first).cloned().unwrap_or_default();
        of_tables.filter(|point| self.exists(*point)).chain(cut.map(|number| self.links.len() + number))
    }

    fn exists(&self, point: PointIndex) -> bool {
        self.links[point] & EXISTS != 0
    }

    fn position(&self, point: PointIndex) -> [f64; 2] {
        if let Some(number) = point.checked_sub(self.links.len()) {
            return self.cut[number].point.0;
        }
        let (batch, lane) = self.lattice.batch_of(&self.columns, point);
        self.lattice.position(batch, lane)
    }

    /// The point of a table a step from another one, forwards or backwards, if there is one.
    fn step(&self, point: PointIndex, [columns, rows]: [isize; 2]) -> Option<PointIndex> {
        let (i, j) = (point / self.size[1], point % self.size[1]);
        let (i, j) = (i.checked_add_signed(columns)?, j.checked_add_signed(rows)?);
        (i < self.size[0] && j < self.size[1]).then_some(i * self.size[1] + j)
    }

    /// Neighbours ahead of a point of a table, each with its bit.
    fn ahead(&self, point: PointIndex) -> impl Iterator<Item = (usize, PointIndex)> + use<> {
        AHEAD.map(|step| self.step(point, step)).into_iter().enumerate().filter_map(|(bit, next)| Some((bit, next?)))
    }

    /// Points that a point is joined to.
    fn joined(&self, point: PointIndex) -> impl Iterator<Item = PointIndex> + '_ {
        let linked = |bit: usize, from: PointIndex| self.links[from] & (1 << bit) != 0;
        let steps = AHEAD.into_iter().enumerate().filter(move |_| point < self.links.len());
        let in_tables = steps.flat_map(move |(bit, [columns, rows])| {
            let ahead = self.step(point, [columns, rows]).filter(|_| linked(bit, point));
            let behind = self.step(point, [-columns, -rows]).filter(|behind| linked(bit, *behind));
            ahead.into_iter().chain(behind)
        });
        in_tables.chain(self.joined_to_cut.get(&point).into_iter().flatten().copied())
    }

    /// First control point of the span of a point.
    fn first(&self, point: PointIndex) -> FunctionIndex {
        if let Some(number) = point.checked_sub(self.links.len()) {
            return self.cut[number].first;
        }
        let at = [point / self.size[1], point % self.size[1]];
        [0, 1].map(|d| self.firsts[d][at[d] / self.lattice.points[d]])
    }

    /// Functions of a span, given by its first one.
    fn functions(&self, [column, row]: FunctionIndex) -> impl Iterator<Item = FunctionIndex> + use<> {
        let [p, q] = self.lattice.degree;
        (row..=row + q).flat_map(move |row| (column..=column + p).map(move |column| [column, row]))
    }

    /// Spans that the boundary cuts, or with a point whose step to a neighbour is barred, by their first
    /// functions.
    fn barred_spans(&self) -> BTreeSet<FunctionIndex> {
        let mut spans: BTreeSet<FunctionIndex> = self.cut_spans.keys().copied().collect();
        for point in 0..self.links.len() {
            for (bit, next) in self.ahead(point) {
                let either = self.exists(point) || self.exists(next);
                if either && self.links[point] & (1 << bit) == 0 {
                    spans.extend([point, next].map(|point| self.first(point)));
                }
            }
        }
        spans
    }

    /// First functions of the spans in the support of a function.
    fn support(&self, function: FunctionIndex) -> impl Iterator<Item = FunctionIndex> + '_ {
        let [columns, rows] = [0, 1].map(|d| {
            let before = |function: usize| self.firsts[d].partition_point(|first| *first < function);
            &self.firsts[d][before(function[d].saturating_sub(self.lattice.degree[d]))..before(function[d] + 1)]
        });
        columns.iter().flat_map(move |column| rows.iter().map(move |row| [*column, *row]))
    }

    /// Components of the support of a function, if there are several.
    fn components(&self, function: FunctionIndex) -> Option<Components> {
        let spans: BTreeSet<FunctionIndex> = self.support(function).collect();
        let mut found = Components::new();
        let mut count = 0;
        for start in spans.iter().flat_map(|span| self.points_of(*span)) {
            if found.contains_key(&start) {
                continue;
            }
            let mut open = vec![start];
            while let Some(point) = open.pop() {
                if let Entry::Vacant(entry) = found.entry(point) {
                    entry.insert(count);
                    open.extend(self.joined(point).filter(|next| spans.contains(&self.first(*next))));
                }
            }
            count += 1;
        }
        (count > 1).then_some(found)
    }

    /// Groups of the points in all spans that have a parted function.
    fn groups(&self) -> Vec<Group> {
        let near: BTreeSet<FunctionIndex> =
            self.barred_spans().into_iter().flat_map(|first| self.functions(first)).collect();
        let parted: BTreeMap<FunctionIndex, Components> =
            near.into_iter().filter_map(|function| Some((function, self.components(function)?))).collect();
        let points: BTreeSet<PointIndex> = parted.values().flat_map(Components::keys).copied().collect();
        let mut groups: BTreeMap<(FunctionIndex, Vec<Option<usize>>), Vec<PointIndex>> = BTreeMap::new();
        for point in points {
            let of = |function| parted.get(&function).map(|parts: &Components| parts[&point]);
            let first = self.first(point);
            if point >= self.links.len() || !self.cut_spans.contains_key(&first) {
                groups.entry((first, self.functions(first).map(of).collect())).or_default().push(point);
            }
        }
        let group = |((first, components), places): ((FunctionIndex, Vec<_>), Vec<PointIndex>)| Group {
            first,
            row: self.firsts[1].partition_point(|row| *row < first[1]),
            functions: self.functions(first).zip(components).collect(),
            places,
            sheet: 0,
        };
        groups.into_iter().map(group).collect()
    }
}
