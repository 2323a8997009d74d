//! The points of a lattice as a graph, and its components in the supports of shape functions (see
//! [`parting`](super::parting)).

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use super::Lattice;
use super::sheets::{FunctionIndex, Gaps};
use super::tables::CutPoint;
use crate::scene::shape::{Segment, cross};

/// Number of a point: those of tables column by column, and behind them those of cut spans.
pub(super) type PointIndex = usize;
/// Columns and rows from a point of a table to half of its neighbours; the others have it ahead of them.
const AHEAD: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];
/// Bit of a point that exists, beside those of its neighbours ahead.
const EXISTS: u8 = 1 << AHEAD.len();
/// Points of a neighbouring span that a point of a cut span may be joined to, the nearest first.
const TRIED: usize = 4;

/// Points of a span that belong to the same components of all its functions.
pub(super) struct Group {
    /// First control point of the span.
    pub first: FunctionIndex,
    /// Index of the row of spans that the span lies in, from below.
    pub row: usize,
    /// Numbers of the points in the group, all of one span.
    pub places: Vec<PointIndex>,
    /// Component of every function of the span; none of one that is whole.
    pub functions: Vec<(FunctionIndex, Option<usize>)>,
    /// The sheet that it is put on; the patch itself is 0.
    pub sheet: usize,
}

/// The points of a lattice and which neighbours are joined.
pub(super) struct PointGraph<'a> {
    lattice: &'a Lattice,
    /// Positions of the points of tables, m.
    positions: Vec<[f64; 2]>,
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
    pub(super) fn new(lattice: &'a Lattice, slits: &[Segment], gaps: &Gaps<'_>, cut: &'a [CutPoint]) -> Self {
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
        let of = |point| {
            let (batch, lane) = lattice.batch_of(&columns, point);
            let exists = lattice.weights_of(batch)[lane] > 0.0;
            (if exists { EXISTS } else { 0 }, lattice.position(batch, lane))
        };
        let (links, positions) = (0..size[0] * size[1]).map(of).unzip();
        let joined_to_cut = BTreeMap::new();
        let mut graph = Self { lattice, positions, size, firsts, links, cut, cut_spans, joined_to_cut };
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

    /// Points of a span with the squares of their distances (m²) from another point, the nearest first.
    fn nearest_of(&self, span: FunctionIndex, from: PointIndex) -> [Option<(f64, PointIndex)>; TRIED] {
        let [x, y] = self.position(from);
        let mut nearest = [None; TRIED];
        for point in self.points_of(span).filter(|point| *point != from) {
            let to = self.position(point);
            let mut next = Some(((to[0] - x).powi(2) + (to[1] - y).powi(2), point));
            for place in &mut nearest {
                if place.is_none_or(|(square, _)| next.is_some_and(|(other, _)| other < square)) {
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
        match point.checked_sub(self.links.len()) {
            Some(number) => self.cut[number].point.0,
            None => self.positions[point],
        }
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
    pub(super) fn groups(&self) -> Vec<Group> {
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
