//! Slicing of a body at t = 0: parts that are short against the way along its material.
//!
//! Points are neighbours if they are within [`STEP`] of each other and the body lies between them. From an
//! end of the body on, points as many steps between neighbours away are a layer; layers together as long as
//! [`LENGTH`] are cut into connected parts, and these are the slices.

use std::collections::VecDeque;

use crate::particles::neighbours::Neighbours;
use crate::particles::points::Point;
use crate::scene::Shape;

use super::super::pieces::{STEP, root, spacing};

/// Length of a slice along the body, in spans: points of one slice do not meet each other.
const LENGTH: f64 = 16.0;
/// Area of the smallest slice, in squares of a span.
const LEAST_SPANS: f64 = 36.0;
/// Places between two points that have to lie in the body, as fractions of the way.
const BETWEEN: [f64; 3] = [0.25, 0.5, 0.75];

/// Points and those next to each in the material.
struct Chains<'a> {
    points: &'a [Point],
    next: Vec<Vec<u32>>,
}

/// Slice of every point, and pairs of points that are next to each other in different slices.
pub(super) struct Slicing {
    pub of: Vec<u32>,
    pub seams: Vec<[usize; 2]>,
}

impl Slicing {
    /// Of the points of a body; `span` is the length of a span, m.
    pub(super) fn new(points: &[Point], shape: &Shape, span: f64) -> Self {
        let chains = Chains::new(points, shape);
        let steps = (LENGTH * span / spacing(points)).ceil() as u32;
        let slabs: Vec<u32> = chains.steps_from_the_end().iter().map(|count| count / steps.max(1)).collect();
        let mut parents: Vec<usize> = (0..points.len()).collect();
        let mut areas: Vec<f64> = points.iter().map(|point| point.volume).collect();
        let mut unite = |a: usize, b: usize, largest: f64| {
            let mut roots = [root(&mut parents, a), root(&mut parents, b)];
            roots.sort_unstable();
            let [first, second] = roots;
            if first != second && (areas[first] < largest || areas[second] < largest) {
                parents[second] = first;
                areas[first] += areas[second];
            }
        };
        chains.pairs().filter(|[a, b]| slabs[*a] == slabs[*b]).for_each(|[a, b]| unite(a, b, f64::INFINITY));
        chains.pairs().for_each(|[a, b]| unite(a, b, LEAST_SPANS * span * span));
        let (mut numbers, mut count) = (vec![None; points.len()], 0);
        let mut number = |at: usize| {
            *numbers[root(&mut parents, at)].get_or_insert_with(|| {
                count += 1;
                count - 1
            })
        };
        let of: Vec<u32> = (0..points.len()).map(&mut number).collect();
        let seams = chains.pairs().filter(|[a, b]| of[*a] != of[*b]).collect();
        Self { of, seams }
    }
}

impl<'a> Chains<'a> {
    fn new(points: &'a [Point], shape: &Shape) -> Self {
        let step = STEP * spacing(points);
        let neighbours = Neighbours::new(points.iter().map(|point| point.position), step);
        let is_next = |a: [f64; 2], b: [f64; 2]| {
            let way = [0, 1].map(|d| b[d] - a[d]);
            let inside = |t: f64| shape.contains([0, 1].map(|d| a[d] + t * way[d]));
            way[0].hypot(way[1]) <= step && BETWEEN.iter().all(|t| inside(*t))
        };
        let next = |at: usize| {
            let place = points[at].position;
            let others = neighbours.near(place).filter(|other| *other != at);
            others.filter(|other| is_next(place, points[*other].position)).map(|other| other as u32).collect()
        };
        Self { points, next: (0..points.len()).map(next).collect() }
    }

    /// Pairs of points next to each other.
    fn pairs(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let of = |at: usize| self.next[at].iter().map(move |other| [at, *other as usize]);
        (0..self.points.len()).flat_map(of).filter(|[a, b]| b < a)
    }

    /// Steps from point to point that lead to each from an end of the connected part it is in.
    fn steps_from_the_end(&self) -> Vec<u32> {
        let unknown = || vec![u32::MAX; self.points.len()];
        let (mut to_the_end, mut from_there) = (unknown(), unknown());
        for first in 0..self.points.len() {
            if to_the_end[first] == u32::MAX {
                let end = self.count_steps(first, &mut to_the_end);
                self.count_steps(end, &mut from_there);
            }
        }
        from_there
    }

    /// Counts the steps from a point to all that it hangs together with; one that is furthest away.
    fn count_steps(&self, from: usize, steps: &mut [u32]) -> usize {
        let (mut queue, mut last) = (VecDeque::from([from]), from);
        steps[from] = 0;
        while let Some(at) = queue.pop_front() {
            last = at;
            for other in self.next[at].iter().map(|other| *other as usize) {
                if steps[other] == u32::MAX {
                    steps[other] = steps[at] + 1;
                    queue.push_back(other);
                }
            }
        }
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points a tenth apart in a shape, with spans of two of them.
    fn slices(shape: &Shape) -> (Vec<[f64; 2]>, Slicing) {
        let places = (0..200).flat_map(|j| (0..200).map(move |i| [0.1 * i as f64 + 0.05, 0.1 * j as f64 + 0.05]));
        let places: Vec<_> = places.filter(|place| shape.contains(*place)).collect();
        let point = |place: &[f64; 2]| {
            let (velocity, displacement, strain, stress) = ([0.0; 2], [0.0; 2], [0.0; 3], [0.0; 3]);
            Point { position: *place, velocity, displacement, strain, stress, volume: 0.01 }
        };
        let points: Vec<Point> = places.iter().map(point).collect();
        (places, Slicing::new(&points, shape, 0.2))
    }

    fn ring() -> Shape {
        Shape::Annulus { center: [10.0, 10.0], inner_radius: 7.0, outer_radius: 9.0 }
    }

    /// A ring is cut into slices that are no longer than they should be, and both sides of a slit, however
    /// narrow, are of different ones that have no seam.
    #[test]
    fn both_sides_of_a_slit_are_different_slices() {
        for slit in [0.02, 0.5] {
            let slit = Shape::Rectangle { min: [16.0, 10.0 - 0.5 * slit], max: [20.0, 10.0 + 0.5 * slit] };
            let (places, slices) = slices(&Shape::Difference { of: Box::new(ring()), minus: vec![slit] });
            let count = slices.of.iter().max().unwrap() + 1;
            assert!((12..=18).contains(&count), "{count}");
            let at = |x: f64, y: f64| {
                let distance = |place: &[f64; 2]| (place[0] - x).hypot(place[1] - y);
                let nearest = (0..places.len()).min_by(|a, b| distance(&places[*a]).total_cmp(&distance(&places[*b])));
                slices.of[nearest.unwrap()]
            };
            let [below, above] = [at(18.0, 9.6), at(18.0, 10.4)];
            assert_ne!(below, above);
            for pair in &slices.seams {
                let [a, b] = pair.map(|at| slices.of[at]);
                assert!(a != b && [a, b] != [below, above] && [b, a] != [below, above]);
            }
        }
    }

    /// Without a slit the slices meet at both ends, and opposite places are of different ones.
    #[test]
    fn a_closed_ring_is_cut_on_both_ways_round() {
        let (_, slices) = slices(&ring());
        let mut pairs: Vec<[u32; 2]> = slices.seams.iter().map(|pair| pair.map(|at| slices.of[at])).collect();
        pairs.iter_mut().for_each(|pair| pair.sort_unstable());
        pairs.sort_unstable();
        pairs.dedup();
        let count = slices.of.iter().max().unwrap() + 1;
        assert_eq!(pairs.len() as u32, count, "each has two neighbours: {pairs:?}");
    }

    /// A body no longer than a slice is one, and the rest of a longer one goes with its neighbour.
    #[test]
    fn short_bodies_are_one_slice() {
        let bar = |length: f64| slices(&Shape::Rectangle { min: [0.0; 2], max: [length, 1.0] }).1;
        assert!(bar(3.0).of.iter().all(|slice| *slice == 0) && bar(3.0).seams.is_empty());
        assert_eq!(bar(3.6).of.iter().max(), Some(&0));
        assert_eq!(bar(6.4).of.iter().max(), Some(&1));
    }
}
