//! Slices of a body at t = 0, so that places which may meet are of different ones.
//!
//! Points are neighbours if they are within [`STEP`] of each other and the way between them does not leave
//! the body and enter it again. From an end of the body on, points as many steps between neighbours away
//! are a layer; layers together as long as [`LENGTH`] are cut into connected parts. A part in which two
//! points at the boundary are further from each other along the material than straight on lies around a
//! slit, a notch or a hole: it is cut again from one of them, half-way to the other, until that way is no
//! longer than [`SHORTEST_FOLD`].

use std::collections::BTreeMap;

use crate::contact::Surface;
use crate::particles::neighbours::Neighbours;
use crate::particles::points::Point;

use super::super::pieces::{STEP, root, spacing};

/// Length of a slice along the body, in spans; points further apart are not taken for a fold.
const LENGTH: f64 = 16.0;
/// Area of the smallest slice, in squares of a span.
const LEAST_SPANS: f64 = 4.0;
/// Way along the material over the straight one from which on there is something else between two points.
const DETOUR: f64 = 1.25;
/// Way along the material below which two places are not told apart, in spans.
const SHORTEST_FOLD: f64 = 6.0;

/// Points and those next to each in the material.
struct Chains<'a> {
    points: &'a [Point],
    spacing: f64,
    next: Vec<Vec<u32>>,
    /// Points next to the boundary.
    is_outermost: Vec<bool>,
}

/// The boundary as lines, and which are near a place.
struct Lines {
    ends: Vec<[[f64; 2]; 2]>,
    neighbours: Neighbours,
}

/// Slice of every point, and pairs of points that are next to each other in different slices.
pub(super) struct Slicing<'a> {
    pub of: Vec<u32>,
    pub seams: Vec<[usize; 2]>,
    points: &'a [Point],
    neighbours: Neighbours,
    lines: Lines,
    step: f64,
}

impl<'a> Slicing<'a> {
    /// Of the points of a body with a boundary; `span` is the length of a span, m.
    pub(super) fn new(points: &'a [Point], surface: &Surface, span: f64) -> Self {
        let step = STEP * spacing(points);
        let lines = Lines::new(surface, step);
        let neighbours = Neighbours::new(points.iter().map(|point| point.position), step);
        let chains = Chains::new(points, &neighbours, &lines, step);
        let count = |spans: f64| (spans * span / chains.spacing).ceil().max(1.0) as u32;
        let least_area = LEAST_SPANS * span * span;
        let all: Vec<usize> = (0..points.len()).collect();
        let steps = chains.steps_from_the_end();
        let mut rest = chains.parts(&all, |at| steps[at], count(LENGTH), least_area);
        let mut walk = Walk::new(points.len());
        let mut of = vec![0; points.len()];
        let mut number = 0;
        while let Some(part) = rest.pop() {
            let fold = chains.fold(&part, [SHORTEST_FOLD, LENGTH].map(&count), &mut walk);
            let cut = fold.map(|(from, length)| {
                walk.go(&chains, from, length);
                chains.parts(&part, |at| walk.steps_to(at).unwrap_or(length), length.div_ceil(2), least_area)
            });
            match cut.filter(|parts| parts.len() > 1) {
                Some(parts) => rest.extend(parts),
                None => {
                    part.iter().for_each(|at| of[*at] = number);
                    number += 1;
                }
            }
        }
        let seams = chains.pairs().filter(|[a, b]| of[*a] != of[*b]).collect();
        Self { of, seams, points, neighbours, lines, step }
    }

    /// Slice of the nearest point to a place (m) with nothing of the boundary in between.
    pub(super) fn at(&self, place: [f64; 2]) -> Option<u32> {
        let squared = |at: usize| distance(place, self.points[at].position).powi(2);
        let near = self.neighbours.near(place).filter(|at| squared(*at) <= self.step * self.step);
        let seen = near.filter(|at| !self.lines.lie_between(place, self.points[*at].position));
        seen.min_by(|a, b| squared(*a).total_cmp(&squared(*b))).map(|at| self.of[at])
    }
}

impl Lines {
    fn new(surface: &Surface, step: f64) -> Self {
        let ends = surface.lines();
        let middles = ends.iter().map(|[a, b]| [0, 1].map(|d| 0.5 * (a[d] + b[d])));
        let neighbours = Neighbours::new(middles, step);
        Self { ends, neighbours }
    }

    /// Whether the way between two places (m), no further apart than a step, leaves the body and enters it
    /// again. A single line is crossed from a point beyond the chord of an arc.
    fn lie_between(&self, a: [f64; 2], b: [f64; 2]) -> bool {
        let middle = [0, 1].map(|d| 0.5 * (a[d] + b[d]));
        let crosses = |at: &usize| {
            let [c, d] = self.ends[*at];
            side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0
        };
        self.neighbours.near(middle).filter(crosses).nth(1).is_some()
    }
}

impl<'a> Chains<'a> {
    fn new(points: &'a [Point], neighbours: &Neighbours, lines: &Lines, step: f64) -> Self {
        let next = |at: usize| {
            let place = points[at].position;
            let near = neighbours.near(place).filter(|other| *other != at);
            let near = near.filter(|other| distance(place, points[*other].position) <= step);
            let joined = near.filter(|other| !lines.lie_between(place, points[*other].position));
            joined.map(|other| other as u32).collect()
        };
        let is_outermost = points.iter().map(|point| lines.neighbours.near(point.position).next().is_some());
        Self {
            points,
            spacing: spacing(points),
            next: (0..points.len()).map(next).collect(),
            is_outermost: is_outermost.collect(),
        }
    }

    /// Pairs of points next to each other.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let of = |at: usize| self.next[at].iter().map(move |other| [at, *other as usize]);
        (0..self.points.len()).flat_map(of).filter(|[a, b]| b < a)
    }

    /// Connected parts of some points, cut after every `length` steps; parts that are smaller than
    /// `least_area`, m², go with the next one.
    fn parts(&self, members: &[usize], steps: impl Fn(usize) -> u32, length: u32, least_area: f64) -> Vec<Vec<usize>> {
        let places: BTreeMap<usize, usize> = members.iter().copied().zip(0..).collect();
        let mut parents: Vec<usize> = (0..members.len()).collect();
        let mut areas: Vec<f64> = members.iter().map(|at| self.points[*at].volume).collect();
        let mut unite = |a: usize, b: usize, largest: f64| {
            let mut roots = [root(&mut parents, a), root(&mut parents, b)];
            roots.sort_unstable();
            let [first, second] = roots;
            if first != second && (areas[first] < largest || areas[second] < largest) {
                parents[second] = first;
                areas[first] += areas[second];
            }
        };
        let slab = |at: usize| steps(at) / length;
        let pairs = || {
            let of = |at: usize| self.next[at].iter().map(move |other| (at, *other as usize));
            let all = members.iter().copied().flat_map(of).filter(|(a, b)| b < a);
            all.filter_map(|(a, b)| Some((slab(a) == slab(b), places[&a], *places.get(&b)?)))
        };
        pairs().filter(|(same, ..)| *same).for_each(|(_, a, b)| unite(a, b, f64::INFINITY));
        pairs().for_each(|(_, a, b)| unite(a, b, least_area));
        let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (place, at) in members.iter().enumerate() {
            parts.entry(root(&mut parents, place)).or_default().push(*at);
        }
        parts.into_values().collect()
    }

    /// A point of a part that is far from another along the material and not straight on, and how many steps:
    /// more than `least`, for points no more than `most` apart.
    fn fold(&self, part: &[usize], [least, most]: [u32; 2], walk: &mut Walk) -> Option<(usize, u32)> {
        let outermost: Vec<usize> = part.iter().copied().filter(|at| self.is_outermost[*at]).collect();
        let reach = (DETOUR * f64::from(most)).ceil() as u32 + 1;
        let mut longest: Option<(usize, u32)> = None;
        for &from in &outermost {
            walk.go(self, from, reach);
            for &at in &outermost {
                let straight = distance(self.points[from].position, self.points[at].position) / self.spacing;
                let steps = walk.steps_to(at).unwrap_or(reach);
                let detour = f64::from(steps) > DETOUR * straight && straight <= f64::from(most);
                if detour && steps > longest.map_or(least, |(_, steps)| steps) {
                    longest = Some((from, steps));
                }
            }
        }
        longest
    }

    /// Steps from point to point that lead to each from an end of the connected part it is in.
    fn steps_from_the_end(&self) -> Vec<u32> {
        let mut all = vec![None; self.points.len()];
        let mut walk = Walk::new(self.points.len());
        for first in 0..self.points.len() {
            if all[first].is_none() {
                walk.go(self, first, u32::MAX);
                let end = walk.reached.last().map_or(first, |(at, _)| *at);
                walk.go(self, end, u32::MAX);
                walk.reached.iter().for_each(|&(at, steps)| all[at] = Some(steps));
            }
        }
        all.into_iter().map(Option::unwrap_or_default).collect()
    }
}

/// Points that steps from one lead to, the nearest first.
struct Walk {
    reached: Vec<(usize, u32)>,
    /// The walk that came by each point last, and its place in the list.
    last: Vec<(u32, u32)>,
    number: u32,
}

impl Walk {
    fn new(points: usize) -> Self {
        Self { reached: Vec::new(), last: vec![(0, 0); points], number: 0 }
    }

    /// Goes no more than `most` steps from a point.
    fn go(&mut self, chains: &Chains, from: usize, most: u32) {
        let Self { reached, last, number } = self;
        *number += 1;
        reached.clear();
        let mut visit = |reached: &mut Vec<(usize, u32)>, at: usize, steps: u32| {
            if last[at].0 != *number {
                last[at] = (*number, reached.len() as u32);
                reached.push((at, steps));
            }
        };
        visit(reached, from, 0);
        let mut next = 0;
        while let Some(&(at, steps)) = reached.get(next).filter(|(_, steps)| *steps < most) {
            chains.next[at].iter().for_each(|other| visit(reached, *other as usize, steps + 1));
            next += 1;
        }
    }

    /// Steps to a point, if it was reached.
    fn steps_to(&self, at: usize) -> Option<u32> {
        let (number, place) = self.last[at];
        (number == self.number).then(|| self.reached[place as usize].1)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

/// Twice the area of a triangle; its sign is the side of c.
fn side(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Body, Layout, Mesh, Shape};

    /// Points a tenth apart in a shape, with spans of two of them, and their slices.
    fn sliced(shape: &Shape) -> (Vec<[f64; 2]>, Vec<u32>, Vec<[usize; 2]>) {
        let places = (0..200).flat_map(|j| (0..200).map(move |i| [0.1 * i as f64 + 0.05, 0.1 * j as f64 + 0.05]));
        let places: Vec<_> = places.filter(|place| shape.contains(*place)).collect();
        let point = |place: &[f64; 2]| {
            let (velocity, displacement, strain, stress) = ([0.0; 2], [0.0; 2], [0.0; 3], [0.0; 3]);
            Point { position: *place, velocity, displacement, strain, stress, volume: 0.01 }
        };
        let points: Vec<Point> = places.iter().map(point).collect();
        let body = Body { layout: Layout::Uniform, ..Body::at_rest("", "", shape.clone()) };
        let surface = Surface::new(&Mesh::uniform([2; 2], [0.0; 2], [20.0; 2], [100; 2]), &body);
        let Slicing { of, seams, .. } = Slicing::new(&points, &surface, 0.2);
        (places, of, seams)
    }

    fn nearest(places: &[[f64; 2]], place: [f64; 2]) -> usize {
        let all = 0..places.len();
        all.min_by(|a, b| distance(places[*a], place).total_cmp(&distance(places[*b], place))).unwrap()
    }

    fn without(of: Shape, minus: Shape) -> Shape {
        Shape::Difference { of: Box::new(of), minus: vec![minus] }
    }

    fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
        Shape::Rectangle { min, max }
    }

    fn ring() -> Shape {
        Shape::Annulus { center: [10.0, 10.0], inner_radius: 7.0, outer_radius: 9.0 }
    }

    /// A ring is cut into slices that are no longer than they should be, and both sides of a slit, wherever
    /// it is between the points and however narrow, are of different ones that have no seam.
    #[test]
    fn both_sides_of_a_slit_are_different_slices() {
        for (middle, width) in [(10.0, 0.02), (10.0, 0.5), (10.02, 1e-6), (9.96, 0.003)] {
            let slit = rectangle([16.0, middle - 0.5 * width], [20.0, middle + 0.5 * width]);
            let (places, of, seams) = sliced(&without(ring(), slit));
            let count = of.iter().max().unwrap() + 1;
            assert!((12..=18).contains(&count), "{count}");
            let [below, above] = [9.6, 10.4].map(|y| of[nearest(&places, [18.0, y])]);
            assert_ne!(below, above);
            for pair in &seams {
                let [a, b] = pair.map(|at| of[at]);
                assert!(a != b && [a, b] != [below, above] && [b, a] != [below, above]);
            }
        }
    }

    /// Without a slit the slices meet at both ends, and opposite places are of different ones.
    #[test]
    fn a_closed_ring_is_cut_on_both_ways_round() {
        let (_, of, seams) = sliced(&ring());
        let mut pairs: Vec<[u32; 2]> = seams.iter().map(|pair| pair.map(|at| of[at])).collect();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        pairs.dedup();
        let count = of.iter().max().unwrap() + 1;
        assert_eq!(pairs.len() as u32, count, "each has two neighbours: {pairs:?}");
    }

    /// The lines of a circle are chords, and points may lie beyond them: none is left alone.
    #[test]
    fn points_beyond_a_chord_are_of_the_body() {
        for step in 0..50 {
            let radius = 1.0 + 0.0117 * f64::from(step);
            let (places, of, _) = sliced(&Shape::Disk { center: [5.013, 5.0], radius });
            assert!(of.iter().all(|slice| *slice == 0), "{} points, radius {radius}", places.len());
        }
    }

    /// A body no longer than a slice is one, and the rest of a longer one goes with its neighbour if it is
    /// small; convex bodies are cut for their length alone.
    #[test]
    fn convex_bodies_are_cut_for_their_length() {
        let count = |shape: &Shape| sliced(shape).1.iter().max().unwrap() + 1;
        let bar = |length: f64| count(&rectangle([0.0; 2], [length, 1.0]));
        assert_eq!([bar(3.0), bar(3.3), bar(6.4)], [1, 1, 2]);
        assert_eq!(count(&Shape::Disk { center: [5.0, 5.0], radius: 3.0 }), 2);
    }

    /// Wherever a notch or a hole is, both its sides are of different slices, and so are the sides of a slit
    /// that is narrower than points stand apart, but for the last spans before its tip.
    #[test]
    fn both_sides_of_notches_and_holes_are_different_slices() {
        for shift in [0.0, 0.7, 1.3, 2.2, 2.9] {
            let x = 4.0 + shift;
            let block = || rectangle([1.0, 1.0], [11.0, 4.0]);
            let notch = rectangle([x, 1.9], [x + 0.4, 5.0]);
            let hole = Shape::Disk { center: [x, 2.5], radius: 0.9 };
            let slit = rectangle([x, 1.0], [x + 0.01, 5.0]);
            for (shape, [a, b]) in [
                (without(block(), notch), [[x - 0.1, 3.7], [x + 0.5, 3.7]]),
                (without(block(), hole), [[x - 1.0, 2.5], [x + 1.0, 2.5]]),
                (without(rectangle([1.0, 0.2], [11.0, 4.0]), slit), [[x - 0.2, 3.7], [x + 0.2, 3.7]]),
            ] {
                let (places, of, _) = sliced(&shape);
                assert_ne!(of[nearest(&places, a)], of[nearest(&places, b)], "at {x}");
            }
        }
    }
}
