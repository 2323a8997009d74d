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
use crate::scene::shape::{Segment, cross};

/// Column and row of a point among all points of the lattice.
type PointIndex = [usize; 2];
/// Columns and rows from a point to half of its neighbours; the others have it ahead of them.
const AHEAD: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];
/// Bit of a point that exists, beside those of its neighbours ahead.
const EXISTS: u8 = 1 << AHEAD.len();
/// Component of a point that does not exist.
const NONE: usize = usize::MAX;

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
        let mut groups = PointGraph::new(self, segments, shape).groups();
        let sheets = choose_sheets(&mut groups);
        if sheets > 1 {
            groups.sort_by_key(|group| group.sheet);
            let windows = self.add_rows(&groups, sheets);
            self.move_points(&groups, &windows);
            self.sheets.iter_mut().for_each(|sheets| sheets.slits = segments.to_vec());
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
        let columns = self.span_columns();
        let mut moved = Vec::new();
        for group in groups {
            let SheetRows { taken, added, lift } = windows[group.sheet];
            for &place in &group.places {
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

    /// Batch and lane of a point.
    fn batch_of(&self, columns: &[(usize, usize)], [i, j]: PointIndex) -> (usize, usize) {
        let [nx, ny] = self.points;
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
    /// Columns and rows of points.
    size: [usize; 2],
    /// First functions of the columns and rows of spans.
    firsts: [Vec<usize>; 2],
    /// Of every point, column by column: whether it exists, and to which neighbours ahead it is joined.
    links: Vec<u8>,
}

/// The component of every point in the support of a function.
struct Components {
    window: [Range<usize>; 2],
    /// Column by column; [`NONE`] where there is no point.
    labels: Vec<usize>,
}

impl Components {
    fn index(&self, [i, j]: PointIndex) -> usize {
        (i - self.window[0].start) * self.window[1].len() + j - self.window[1].start
    }

    fn contains(&self, [i, j]: PointIndex) -> bool {
        self.window[0].contains(&i) && self.window[1].contains(&j)
    }

    fn points(&self) -> impl Iterator<Item = PointIndex> + '_ {
        let [columns, rows] = self.window.clone();
        let all = columns.flat_map(move |i| rows.clone().map(move |j| [i, j]));
        all.filter(|&point| self.labels[self.index(point)] != NONE)
    }
}

impl<'a> PointGraph<'a> {
    /// Neighbours are joined unless the step between them crosses one of the `slits` (m) or leaves the shape.
    fn new(lattice: &'a Lattice, slits: &[Segment], shape: Option<&Shape>) -> Self {
        let columns = lattice.span_columns();
        let size = [columns.len() * lattice.points[0], lattice.patch_rows * lattice.points[1]];
        let firsts = [
            columns.iter().map(|&(tile, lane)| lattice.tiles[tile].first + lane).collect(),
            lattice.rows[..lattice.patch_rows].iter().map(|row| row.first).collect(),
        ];
        let mut graph = Self { lattice, columns, size, firsts, links: vec![0; size[0] * size[1]] };
        for point in graph.all() {
            let (batch, lane) = lattice.batch_of(&graph.columns, point);
            let (row, tile, b, a) = lattice.unbatch(batch);
            if lattice.weight(row, tile, b, a)[lane] > 0.0 {
                graph.links[point[0] * size[1] + point[1]] = EXISTS;
            }
        }
        for point in graph.all().filter(|_| !slits.is_empty() || shape.is_some()) {
            for (bit, next) in graph.ahead(point) {
                let step = [point, next].map(|point| graph.position(point));
                let cut = slits.iter().any(|slit| fault!("slit-bridged", cross(step, *slit) => false));
                if graph.exists(point) && graph.exists(next) && !cut && !shape.is_some_and(|s| s.is_left_on(step)) {
                    graph.links[point[0] * size[1] + point[1]] |= 1 << bit;
                }
            }
        }
        graph
    }

    fn all(&self) -> impl Iterator<Item = PointIndex> + use<> {
        let [columns, rows] = self.size;
        (0..columns).flat_map(move |i| (0..rows).map(move |j| [i, j]))
    }

    fn links(&self, [i, j]: PointIndex) -> u8 {
        self.links[i * self.size[1] + j]
    }

    fn exists(&self, point: PointIndex) -> bool {
        self.links(point) & EXISTS != 0
    }

    fn position(&self, point: PointIndex) -> [f64; 2] {
        let (batch, lane) = self.lattice.batch_of(&self.columns, point);
        self.lattice.position(batch, lane)
    }

    /// The point a step from another one, forwards or backwards, if it is on the lattice.
    fn step(&self, [i, j]: PointIndex, [columns, rows]: [isize; 2]) -> Option<PointIndex> {
        let next = [i.checked_add_signed(columns)?, j.checked_add_signed(rows)?];
        (next[0] < self.size[0] && next[1] < self.size[1]).then_some(next)
    }

    /// Neighbours ahead, each with its bit.
    fn ahead(&self, point: PointIndex) -> impl Iterator<Item = (usize, PointIndex)> + use<> {
        AHEAD.map(|step| self.step(point, step)).into_iter().enumerate().filter_map(|(bit, next)| Some((bit, next?)))
    }

    /// Neighbours that a point is joined to.
    fn joined(&self, point: PointIndex) -> impl Iterator<Item = PointIndex> + '_ {
        let linked = |bit: usize, from: PointIndex| self.links(from) & (1 << bit) != 0;
        AHEAD.into_iter().enumerate().flat_map(move |(bit, [columns, rows])| {
            let ahead = self.step(point, [columns, rows]).filter(|_| linked(bit, point));
            let behind = self.step(point, [-columns, -rows]).filter(|behind| linked(bit, *behind));
            ahead.into_iter().chain(behind)
        })
    }

    /// First control point of the span of a point.
    fn first(&self, point: PointIndex) -> FunctionIndex {
        [0, 1].map(|d| self.firsts[d][point[d] / self.lattice.points[d]])
    }

    /// Functions of a span, given by its first one.
    fn functions(&self, [column, row]: FunctionIndex) -> impl Iterator<Item = FunctionIndex> + use<> {
        let [p, q] = self.lattice.degree;
        (row..=row + q).flat_map(move |row| (column..=column + p).map(move |column| [column, row]))
    }

    /// Spans with a point whose step to a neighbour is cut, by their first functions.
    fn cut_spans(&self) -> BTreeSet<FunctionIndex> {
        let mut spans = BTreeSet::new();
        for point in self.all() {
            for (bit, next) in self.ahead(point) {
                let either = self.exists(point) || self.exists(next);
                if either && self.links(point) & (1 << bit) == 0 {
                    spans.extend([point, next].map(|point| self.first(point)));
                }
            }
        }
        spans
    }

    /// Points in the support of a function.
    fn support(&self, [column, row]: FunctionIndex) -> [Range<usize>; 2] {
        let at = [column, row];
        [0, 1].map(|d| {
            let (firsts, points) = (&self.firsts[d], self.lattice.points[d]); // of spans, in increasing order
            let before = |function: usize| firsts.partition_point(|first| *first < function) * points;
            before(at[d].saturating_sub(self.lattice.degree[d]))..before(at[d] + 1)
        })
    }

    /// Components of the support of a function, if there are several.
    fn components(&self, function: FunctionIndex) -> Option<Components> {
        let window = self.support(function);
        let mut found = Components { labels: vec![NONE; window[0].len() * window[1].len()], window };
        let [columns, rows] = found.window.clone();
        let mut count = 0;
        for start in columns.flat_map(|i| rows.clone().map(move |j| [i, j])) {
            if !self.exists(start) || found.labels[found.index(start)] != NONE {
                continue;
            }
            let mut open = vec![start];
            while let Some(point) = open.pop() {
                let index = found.index(point);
                if found.labels[index] == NONE {
                    found.labels[index] = count;
                    open.extend(self.joined(point).filter(|next| found.contains(*next)));
                }
            }
            count += 1;
        }
        (count > 1).then_some(found)
    }

    /// Groups of the points in all spans that have a parted function.
    fn groups(&self) -> Vec<Group> {
        let near: BTreeSet<FunctionIndex> =
            self.cut_spans().into_iter().flat_map(|first| self.functions(first)).collect();
        let parted: BTreeMap<FunctionIndex, Components> =
            near.into_iter().filter_map(|function| Some((function, self.components(function)?))).collect();
        let points: BTreeSet<PointIndex> = parted.values().flat_map(Components::points).collect();
        let mut groups: BTreeMap<(FunctionIndex, Vec<Option<usize>>), Vec<PointIndex>> = BTreeMap::new();
        for point in points {
            let of = |function| parted.get(&function).map(|parts: &Components| parts.labels[parts.index(point)]);
            let first = self.first(point);
            groups.entry((first, self.functions(first).map(of).collect())).or_default().push(point);
        }
        let group = |((first, components), places): ((FunctionIndex, Vec<_>), Vec<PointIndex>)| Group {
            first,
            row: places[0][1] / self.lattice.points[1],
            functions: self.functions(first).zip(components).collect(),
            places,
            sheet: 0,
        };
        groups.into_iter().map(group).collect()
    }
}
