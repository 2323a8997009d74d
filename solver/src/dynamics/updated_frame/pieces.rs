//! Pieces of a body: the connected components of its intact points and which of the others go with each, or
//! given ones; and which of many places are near a place.

use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::vectors::dot;
use crate::particles::points::{FracturePoint, Point};

/// Phase field below which material holds nothing together.
pub(super) const SEPARATED: f64 = 0.5;

/// Length of the steps by which points hang together, over the distance between points: more than a diagonal
/// of points that a strain draws apart, less than the width in which a crack has c below [`SEPARATED`].
pub(super) const STEP: f64 = 1.6;

/// Which piece every point belongs to.
pub(super) struct Pieces<'a> {
    points: &'a [Point],
    neighbours: Neighbours,
    step: f64,
    of: Vec<Option<u32>>,
    pub count: u32,
}

impl<'a> Pieces<'a> {
    /// Of a body, if there are several that each cover at least `least_area`, m². Pieces are numbered in the
    /// order of their first points. A point that is broken or of a smaller piece goes with the one that it is
    /// nearest to along a chain of points, and with the first if there is no such chain.
    pub(super) fn find(points: &'a [Point], fracture: &[FracturePoint], least_area: f64) -> Option<Self> {
        let step = STEP * spacing(points);
        let neighbours = Neighbours::new(points.iter().map(|point| point.position), step);
        let mut pieces = Self { points, neighbours, step, of: Vec::new(), count: 0 };
        let groups = pieces.groups(|at| fault!("broken-points-hold", fracture[at].phase >= SEPARATED => true));
        let mut areas = vec![0.0; points.len()];
        for (group, point) in groups.iter().zip(points) {
            areas[*group] += point.volume;
        }
        let mut numbers = vec![None; points.len()];
        pieces.of = vec![None; points.len()];
        for (at, &group) in groups.iter().enumerate() {
            if areas[group] < least_area || fracture[at].phase < SEPARATED {
                continue;
            }
            pieces.of[at] = Some(*numbers[group].get_or_insert_with(|| {
                pieces.count += 1;
                pieces.count - 1
            }));
        }
        if pieces.count < 2 {
            return None;
        }
        pieces.grow();
        Some(pieces)
    }

    /// Number of the piece that a point belongs to.
    pub(super) fn of(&self, at: usize) -> u32 {
        self.of[at].unwrap_or_default()
    }

    /// Piece of the point nearest to a place (m).
    pub(super) fn at(&self, place: [f64; 2]) -> u32 {
        self.nearest(place, |_| true).map_or(0, |at| self.of(at))
    }

    /// For each point the first of those it hangs together with; points that `holds` refuses hang alone.
    fn groups(&self, holds: impl Fn(usize) -> bool) -> Vec<usize> {
        let mut parents: Vec<usize> = (0..self.points.len()).collect();
        for at in (0..self.points.len()).filter(|at| holds(*at)) {
            for other in self.neighbours.near(self.points[at].position).filter(|other| *other < at) {
                if holds(other) && self.square(self.points[at].position, other) <= self.step * self.step {
                    let [a, b] = [root(&mut parents, at), root(&mut parents, other)];
                    parents[a.max(b)] = a.min(b);
                }
            }
        }
        (0..parents.len()).map(|at| root(&mut parents, at)).collect()
    }

    /// Layer by layer, points without a piece take that of the nearest point that has one.
    fn grow(&mut self) {
        let mut bare: Vec<usize> = (0..self.of.len()).filter(|at| self.of[*at].is_none()).collect();
        loop {
            let nearest = |at: usize| self.nearest(self.points[at].position, |other| self.of[other].is_some());
            let layer: Vec<_> = bare.iter().filter_map(|&at| Some((at, self.of[nearest(at)?]))).collect();
            if layer.is_empty() {
                return;
            }
            for (at, piece) in layer {
                self.of[at] = piece;
            }
            bare.retain(|at| self.of[*at].is_none());
        }
    }

    /// The nearest point within a step of a place (m) among those that count, the first of several.
    fn nearest(&self, place: [f64; 2], counts: impl Fn(usize) -> bool) -> Option<usize> {
        let near = self.neighbours.near(place).filter(|at| counts(*at));
        let squares =
            near.map(|at| (self.square(place, at), at)).filter(|(square, _)| *square <= self.step * self.step);
        squares.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, at)| at)
    }

    /// Square of the distance of a point from a place, m².
    fn square(&self, place: [f64; 2], at: usize) -> f64 {
        let way = [0, 1].map(|d| self.points[at].position[d] - place[d]);
        dot(way, way)
    }
}

/// Distance between points, m.
pub(super) fn spacing(points: &[Point]) -> f64 {
    points.iter().map(|point| point.volume).fold(0.0, larger).sqrt()
}

/// The first of a group, and shortens the way to it.
pub(super) fn root(parents: &mut [usize], mut at: usize) -> usize {
    while parents[at] != at {
        parents[at] = parents[parents[at]];
        at = parents[at];
    }
    at
}

/// Places in squares, sorted by row and column.
#[derive(Debug, Clone)]
pub(crate) struct Neighbours {
    side: f64,
    sorted: Vec<([i32; 2], u32)>,
}

impl Neighbours {
    /// Of places, m; `side` is that of a square, m.
    pub(crate) fn new(places: impl Iterator<Item = [f64; 2]>, side: f64) -> Self {
        let mut sorted: Vec<_> = places.enumerate().map(|(at, place)| (square(place, side), at as u32)).collect();
        sorted.sort_unstable();
        Self { side, sorted }
    }

    /// Numbers of the places in the nine squares around a place: of all within a side of it, and some more.
    pub(crate) fn near(&self, place: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let [row, column] = square(place, self.side);
        (row - 1..=row + 1).flat_map(move |row| {
            let first = self.sorted.partition_point(|(square, _)| *square < [row, column - 1]);
            let in_row = self.sorted[first..].iter().take_while(move |(square, _)| *square <= [row, column + 1]);
            in_row.map(|(_, at)| *at as usize)
        })
    }
}

/// Row and column of the square of a place; those far off share the outermost.
fn square(place: [f64; 2], side: f64) -> [i32; 2] {
    let number = |x: f64| ((x / side).floor().clamp(-1e9, 1e9)) as i32;
    [number(place[1]), number(place[0])]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points a tenth apart, row by row from below; those marked `#` are intact, `.` broken.
    fn found(rows: &[&str], least_area: f64) -> Option<Vec<String>> {
        let mut points = Vec::new();
        let mut fracture = Vec::new();
        for (row, line) in rows.iter().rev().enumerate() {
            for (column, mark) in line.chars().enumerate().filter(|(_, mark)| *mark != ' ') {
                let position = [0.1 * column as f64, 0.1 * row as f64];
                points.push(Point::at_rest(position, [0.1, 0.1]));
                let phase = if mark == '#' { 1.0 } else { 0.0 };
                fracture.push(FracturePoint { phase, ..Default::default() });
            }
        }
        let pieces = Pieces::find(&points, &fracture, least_area)?;
        let mut at = 0;
        let mut rows: Vec<String> = rows
            .iter()
            .rev()
            .map(|line| {
                let name = |mark: char| {
                    at += usize::from(mark != ' ');
                    if mark == ' ' { mark } else { char::from(b'0' + pieces.of(at - 1) as u8) }
                };
                line.chars().map(name).collect()
            })
            .collect();
        rows.reverse();
        Some(rows)
    }

    #[test]
    fn a_crack_through_the_body_parts_it_and_one_that_ends_does_not() {
        assert_eq!(found(&["###....###", "###....###", "###....###"], 0.05).unwrap(), vec!["0000011111"; 3]);
        assert_eq!(found(&["##########", "###....###", "###....###"], 0.05), None);
    }

    #[test]
    fn splinters_and_broken_points_go_with_what_is_nearest() {
        let rows = ["######....###", "######..#.###", "######....###"];
        assert_eq!(found(&rows, 0.05).unwrap(), vec!["0000000011111"; 3]);
        let rows = ["######....###", "..........###", "######....###"];
        assert_eq!(found(&rows, 0.05).unwrap()[2], "0000000011111");
        assert_eq!(found(&rows, 0.07), None, "rows of six points are no fragments");
        assert_eq!(found(&["###   ###"], 0.5), None);
    }

    #[test]
    fn what_no_chain_of_points_reaches_goes_with_the_first() {
        assert_eq!(found(&["####     ####", "####    .####"], 0.03).unwrap()[1], "0000    11111");
        assert_eq!(found(&["####         ####", "####    .    ####"], 0.03).unwrap()[1], "0000    0    1111");
    }

    #[test]
    fn all_places_within_a_side_are_near() {
        let places: Vec<[f64; 2]> =
            (0..400).map(|i| [f64::from(i % 20) * 0.37 - 3.0, f64::from(i / 20) * 0.41 - 4.0]).collect();
        let neighbours = Neighbours::new(places.iter().copied(), 0.9);
        let distance = |from: [f64; 2], to: [f64; 2]| (from[0] - to[0]).hypot(from[1] - to[1]);
        for place in &places {
            let mut found: Vec<usize> =
                neighbours.near(*place).filter(|at| distance(*place, places[*at]) <= 0.9).collect();
            found.sort_unstable();
            let all: Vec<usize> = (0..places.len()).filter(|at| distance(*place, places[*at]) <= 0.9).collect();
            assert_eq!(found, all);
        }
    }
}
