//! Which control points a slit or a gap parts.
//!
//! The points in the support of a function are a graph: neighbours in the lattice are joined unless a slit or
//! a gap of the body lies between them. Where the graph falls into components, the function is parted and has
//! one control point for each. Points of a span that belong to the same components of all its functions are a
//! *group*.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::sheets::{FunctionIndex, Sheets};
use super::{Lattice, Row, STRIP_ROWS};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::lane::Lane;
use crate::scene::Shape;

/// Parts of a step at which it is looked for a gap.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

/// A straight part of a slit, m.
type Segment = [[f64; 2]; 2];
/// Column and row of a point among all points of the lattice.
type PointIndex = [usize; 2];
/// Component of the support of a function that each of its places belongs to.
type Components = BTreeMap<PointIndex, usize>;

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
    /// Parts the control points along slits, and along the gaps of a shape that are narrower than a support.
    pub(super) fn part(&mut self, segments: &[Segment], shape: Option<&Shape>) {
        let mut groups = PointGrid::new(self, segments, shape).groups();
        let sheets = choose_sheets(&mut groups);
        if sheets > 1 {
            groups.sort_by_key(|group| group.sheet);
            let windows = self.add_rows(&groups, sheets);
            self.move_points(&groups, &windows);
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
    fn fill_strip(&mut self, copied: &mut Vec<usize>) {
        let last = self.rows.len() - 1;
        while !self.rows.len().is_multiple_of(STRIP_ROWS) {
            self.rows.push(self.rows[last].clone());
            copied.push(0);
        }
    }

    /// Moves the points of groups to the rows of their sheets, and ties the copies of whole functions.
    fn move_points(&mut self, groups: &[Group], windows: &[SheetRows]) {
        let mut moved = Vec::new();
        {
            let grid = PointGrid::new(self, &[], None);
            for group in groups {
                let SheetRows { taken, added, lift } = windows[group.sheet];
                for &place in &group.places {
                    let (batch, lane) = grid.batch(place);
                    let (row, tile, b, a) = self.unbatch(batch);
                    moved.push((batch, self.batch(row + added - taken, tile, b, a), lane, group.first, lift));
                }
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

/// The points of a lattice as a grid, and the slits.
struct PointGrid<'a> {
    lattice: &'a Lattice,
    /// Tile and lane of every column of spans.
    columns: Vec<(usize, usize)>,
    segments: &'a [Segment],
    /// The body, if its boundary does not end on the lattice.
    shape: Option<&'a Shape>,
}

impl<'a> PointGrid<'a> {
    fn new(lattice: &'a Lattice, segments: &'a [Segment], shape: Option<&'a Shape>) -> Self {
        let tiles = lattice.tiles.iter().enumerate();
        let columns = tiles.flat_map(|(tile, t)| (0..t.count).map(move |lane| (tile, lane))).collect();
        Self { lattice, columns, segments, shape }
    }

    /// Row of spans, tile, point in the span and lane of a place.
    fn parts(&self, [i, j]: PointIndex) -> (usize, usize, usize, usize, usize) {
        let [nx, ny] = self.lattice.points;
        let (tile, lane) = self.columns[i / nx];
        (j / ny, tile, j % ny, i % nx, lane)
    }

    fn batch(&self, place: PointIndex) -> (usize, usize) {
        let (row, tile, b, a, lane) = self.parts(place);
        (self.lattice.batch(row, tile, b, a), lane)
    }

    fn position(&self, place: PointIndex) -> [f64; 2] {
        let (batch, lane) = self.batch(place);
        self.lattice.position(batch, lane)
    }

    fn exists(&self, place: PointIndex) -> bool {
        let (row, tile, b, a, lane) = self.parts(place);
        self.lattice.weight(row, tile, b, a)[lane] > 0.0
    }

    /// Whether neither a slit nor a gap lies between two places.
    fn joined(&self, a: PointIndex, b: PointIndex) -> bool {
        let [a, b] = [a, b].map(|place| self.position(place));
        let between = |t: f64| [0, 1].map(|d| a[d] + t * (b[d] - a[d]));
        let material = |shape: &Shape| BETWEEN.into_iter().all(|t| shape.contains(between(t)));
        let cut = self.segments.iter().any(|segment| cross([a, b], *segment));
        !fault!("slit-bridged", cut => false) && self.shape.is_none_or(material)
    }

    /// First control column of a column of spans.
    fn first_column(&self, column: usize) -> usize {
        let (tile, lane) = self.columns[column];
        self.lattice.tiles[tile].first + lane
    }

    /// Places in the spans whose functions include one.
    fn support(&self, [column, row]: FunctionIndex) -> [Range<usize>; 2] {
        let Lattice { degree: [p, q], points: [nx, ny], ref rows, patch_rows, .. } = *self.lattice;
        let range = |count: usize, first: &dyn Fn(usize) -> usize, at: usize, degree: usize, points: usize| {
            let numbers: Vec<usize> = (0..count).filter(|&n| (first(n)..=first(n) + degree).contains(&at)).collect();
            numbers.first().map_or(0..0, |low| low * points..(numbers[numbers.len() - 1] + 1) * points)
        };
        [
            range(self.columns.len(), &|n| self.first_column(n), column, p, nx),
            range(patch_rows, &|n| rows[n].first, row, q, ny),
        ]
    }

    /// Functions of the span of a place.
    fn functions(&self, [i, j]: PointIndex) -> impl Iterator<Item = FunctionIndex> + use<'a> {
        let [p, q] = self.lattice.degree;
        let [nx, ny] = self.lattice.points;
        let (column, row) = (self.first_column(i / nx), self.lattice.rows[j / ny].first);
        (row..=row + q).flat_map(move |row| (column..=column + p).map(move |column| [column, row]))
    }

    /// Places whose step to a neighbour is cut.
    fn cut_places(&self) -> BTreeSet<PointIndex> {
        let [nx, ny] = self.lattice.points;
        let [columns, rows] = [self.columns.len() * nx, self.lattice.patch_rows * ny];
        let mut cut = BTreeSet::new();
        for i in 0..columns {
            for j in 0..rows {
                let ahead = [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i + 1, j.wrapping_sub(1))];
                for next in ahead.into_iter().filter(|&(i, j)| i < columns && j < rows).map(|(i, j)| [i, j]) {
                    let exist = [[i, j], next].map(|place| self.exists(place));
                    if exist != [false; 2] && !(exist == [true; 2] && self.joined([i, j], next)) {
                        cut.extend([[i, j], next]);
                    }
                }
            }
        }
        cut
    }

    /// Components of the support of a function, if there are several.
    fn components(&self, function: FunctionIndex) -> Option<Components> {
        let [columns, rows] = self.support(function);
        let places = rows.flat_map(|j| columns.clone().map(move |i| [i, j]));
        let existing: BTreeSet<PointIndex> = places.filter(|&place| self.exists(place)).collect();
        let (mut components, mut count) = (Components::new(), 0);
        for &start in &existing {
            if components.contains_key(&start) {
                continue;
            }
            let mut open = vec![start];
            components.insert(start, count);
            while let Some([i, j]) = open.pop() {
                let rows = j.saturating_sub(1)..=j + 1;
                let around = rows.flat_map(|j| (i.saturating_sub(1)..=i + 1).map(move |i| [i, j]));
                for next in around.filter(|next| existing.contains(next)) {
                    if !components.contains_key(&next) && self.joined([i, j], next) {
                        components.insert(next, count);
                        open.push(next);
                    }
                }
            }
            count += 1;
        }
        (count > 1).then_some(components)
    }

    /// Groups of the points in all spans that have a parted function.
    fn groups(&self) -> Vec<Group> {
        let near: BTreeSet<FunctionIndex> =
            self.cut_places().into_iter().flat_map(|place| self.functions(place)).collect();
        let parted: BTreeMap<FunctionIndex, Components> =
            near.into_iter().filter_map(|function| Some((function, self.components(function)?))).collect();
        let mut groups: BTreeMap<(FunctionIndex, Vec<Option<usize>>), Vec<PointIndex>> = BTreeMap::new();
        let places: BTreeSet<PointIndex> = parted.values().flat_map(|components| components.keys().copied()).collect();
        for place in places {
            let of = |function: FunctionIndex| parted.get(&function).map(|components| components[&place]);
            let key: Vec<Option<usize>> = self.functions(place).map(of).collect();
            let [_, ny] = self.lattice.points;
            let first = [self.first_column(place[0] / self.lattice.points[0]), self.lattice.rows[place[1] / ny].first];
            groups.entry((first, key)).or_default().push(place);
        }
        let group = |((first, key), places): ((FunctionIndex, Vec<Option<usize>>), Vec<PointIndex>)| {
            let functions = self.functions(places[0]).zip(key).collect();
            let row = places[0][1] / self.lattice.points[1];
            Group { first, row, places, functions, sheet: 0 }
        };
        groups.into_iter().map(group).collect()
    }
}

/// Whether the step from a to b crosses a segment. A point on the line of the segment counts as one on its
/// left, so that it has a side.
fn cross([a, b]: Segment, [c, d]: Segment) -> bool {
    let turn = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let apart = (0..2).any(|i| a[i].max(b[i]) < c[i].min(d[i]) || c[i].max(d[i]) < a[i].min(b[i]));
    !apart && (turn(c, d, a) >= 0.0) != (turn(c, d, b) >= 0.0) && turn(a, b, c) * turn(a, b, d) <= 0.0
}
