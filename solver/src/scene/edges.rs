//! The smooth edges that bound a shape, and where they meet knots and each other.

use super::Shape;
use super::shape::{Segment, cross};

/// Distance within which two places count as one, of the size of what they lie on.
const NEAR: f64 = 1e-12;
/// Distance from an edge at which it is looked for material, of the size of the edge.
pub(crate) const BESIDE: f64 = 1e-6;

/// A smooth part of the boundary of a shape, with the shape to its left.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum BoundaryEdge {
    /// From one corner to another, m.
    Line(Segment),
    /// Circle, counterclockwise if `sign` is 1, else clockwise.
    Circle {
        /// Centre of the circle, m.
        center: [f64; 2],
        /// Radius of the circle, m.
        radius: f64,
        /// Sense in which it is run through, 1 or −1.
        sign: f64,
    },
}

impl Shape {
    /// Its edges: those of a union or difference are all of its shapes', also where they bound nothing. The
    /// patch, which the shape does not know, has none.
    pub(crate) fn edges(&self) -> Vec<BoundaryEdge> {
        let circle =
            |center: &[f64; 2], radius: &f64, sign| BoundaryEdge::Circle { center: *center, radius: *radius, sign };
        match self {
            Self::Rectangle { min, max } => of_polygon(&[*min, [max[0], min[1]], *max, [min[0], max[1]]]),
            Self::Polygon { points } => of_polygon(points),
            Self::Disk { center, radius } => vec![circle(center, radius, 1.0)],
            Self::Annulus { center, inner_radius, outer_radius } => {
                vec![circle(center, outer_radius, 1.0), circle(center, inner_radius, -1.0)]
            }
            Self::Patch => Vec::new(),
            Self::Union(shapes) => shapes.iter().flat_map(Self::edges).collect(),
            Self::Difference { of, minus } => of
                .edges()
                .into_iter()
                .chain(minus.iter().flat_map(|hole| hole.edges()).map(BoundaryEdge::turned))
                .collect(),
        }
    }
}

fn of_polygon(corners: &[[f64; 2]]) -> Vec<BoundaryEdge> {
    let edge = |i: usize| [corners[i], corners[(i + 1) % corners.len()]];
    let doubled: f64 = (0..corners.len()).map(edge).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum();
    let along = |[a, b]: Segment| BoundaryEdge::Line(if doubled > 0.0 { [a, b] } else { [b, a] });
    (0..corners.len()).map(edge).map(along).collect()
}

impl BoundaryEdge {
    /// The same with the shape on its other side.
    fn turned(self) -> Self {
        match self {
            Self::Line([a, b]) => Self::Line([b, a]),
            Self::Circle { center, radius, sign } => Self::Circle { center, radius, sign: -sign },
        }
    }

    /// Position (m) and its derivative at s from 0 to 1.
    pub(crate) fn at(&self, s: f64) -> ([f64; 2], [f64; 2]) {
        match self {
            Self::Line([a, b]) => {
                let along = [0, 1].map(|d| b[d] - a[d]);
                ([0, 1].map(|d| a[d] + s * along[d]), along)
            }
            Self::Circle { center, radius, sign } => {
                let turn = sign * std::f64::consts::TAU;
                let (sin, cos) = (turn * s).sin_cos();
                let position = [center[0] + radius * cos, center[1] + radius * sin];
                (position, [-radius * turn * sin, radius * turn * cos])
            }
        }
    }

    /// Length of the whole edge, m: of a circle the circumference.
    pub(crate) fn length(&self) -> f64 {
        match self {
            Self::Line([a, b]) => (b[0] - a[0]).hypot(b[1] - a[1]),
            Self::Circle { radius, .. } => std::f64::consts::TAU * radius,
        }
    }

    /// Smallest box around it, m.
    pub(crate) fn bounding_box(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Line([a, b]) => [[0, 1].map(|d| a[d].min(b[d])), [0, 1].map(|d| a[d].max(b[d]))],
            Self::Circle { center, radius, .. } => [center.map(|c| c - radius), center.map(|c| c + radius)],
        }
    }

    /// Where coordinate `d` has a value (m): the other coordinate, m.
    pub(crate) fn crossings(&self, d: usize, value: f64) -> impl Iterator<Item = f64> + use<> {
        let found = match self {
            Self::Line([a, b]) => {
                let crosses = (a[d] < value) != (b[d] < value);
                let t = (value - a[d]) / (b[d] - a[d]);
                [crosses.then(|| a[1 - d] + t * (b[1 - d] - a[1 - d])), None]
            }
            Self::Circle { center, radius, .. } => {
                let square = radius * radius - (value - center[d]) * (value - center[d]);
                let half = (square > 0.0).then(|| square.sqrt());
                [half.map(|half| center[1 - d] - half), half.map(|half| center[1 - d] + half)]
            }
        };
        found.into_iter().flatten()
    }

    /// Where a position (m) on it is: s from 0 to 1.
    pub(crate) fn place_of(&self, [x, y]: [f64; 2]) -> f64 {
        match self {
            Self::Line([a, b]) => {
                let along = [b[0] - a[0], b[1] - a[1]];
                if along[0].abs() >= along[1].abs() { (x - a[0]) / along[0] } else { (y - a[1]) / along[1] }
            }
            Self::Circle { center, sign, .. } => {
                (sign * (y - center[1]).atan2(x - center[0]) / std::f64::consts::TAU).rem_euclid(1.0)
            }
        }
    }

    /// Whether a position (m) is on a part (s) of it.
    fn carries(&self, position: [f64; 2], [from, to]: [f64; 2]) -> bool {
        let s = self.place_after(from, self.place_of(position));
        let place = self.at(s).0;
        (from..=to).contains(&s) && (place[0] - position[0]).hypot(place[1] - position[1]) < BESIDE * self.length()
    }

    /// The same place s, on a circle in the first turn from another place on.
    pub(crate) fn place_after(&self, from: f64, s: f64) -> f64 {
        if let Self::Circle { .. } = self { s + (from - s).ceil() } else { s }
    }

    /// Where coordinate `d` has a value (m): s from 0 to 1.
    pub(crate) fn places(&self, d: usize, value: f64) -> impl Iterator<Item = f64> {
        let position = move |other: f64| if d == 0 { [value, other] } else { [other, value] };
        self.crossings(d, value).map(move |other| self.place_of(position(other)))
    }

    /// Where it meets others, between two of its places, and these (s), in order.
    pub(crate) fn places_met(&self, others: &[Self], [from, to]: [f64; 2]) -> Vec<f64> {
        let met = others.iter().flat_map(|other| self.meets(other)).map(|place| self.place_of(place));
        let turned = met.map(|s| self.place_after(from, s));
        let mut places: Vec<f64> = turned.filter(|s| from < *s && *s < to).chain([from, to]).collect();
        places.sort_by(f64::total_cmp);
        places
    }

    /// Whether a straight step (m) crosses it.
    pub(crate) fn is_crossed(&self, step: Segment) -> bool {
        match self {
            Self::Line(line) => cross(step, *line),
            Self::Circle { center, radius, .. } => !line_meets_circle(step, *center, *radius).is_empty(),
        }
    }

    /// Where it meets another edge, m.
    pub(crate) fn meets(&self, other: &Self) -> Vec<[f64; 2]> {
        match (self, other) {
            (Self::Line(a), Self::Line(b)) => lines_meet(*a, *b).into_iter().collect(),
            (Self::Line(line), Self::Circle { center, radius, .. })
            | (Self::Circle { center, radius, .. }, Self::Line(line)) => line_meets_circle(*line, *center, *radius),
            (Self::Circle { center: a, radius: r, .. }, Self::Circle { center: b, radius: s, .. }) => {
                circles_meet((*a, *r), (*b, *s))
            }
        }
    }
}

/// The parts (s) of the edges of a shape that have it on one side only. Where edges coincide one is taken.
pub(crate) fn bounding_parts(shape: &Shape) -> Vec<(BoundaryEdge, [f64; 2])> {
    let edges = shape.edges();
    let mut parts = Vec::<(BoundaryEdge, [f64; 2])>::new();
    for edge in &edges {
        let places = edge.places_met(&edges, [0.0, 1.0]);
        let first = parts.len();
        for pair in places.windows(2).filter(|pair| pair[1] - pair[0] > NEAR) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let [left, right] = beside(edge, middle).map(|place| shape.contains(place));
            let is_taken = parts[..first].iter().any(|(other, part)| other.carries(edge.at(middle).0, *part));
            match parts[first..].last_mut() {
                _ if left == right || is_taken => (),
                Some((_, part)) if part[1] == pair[0] => part[1] = pair[1],
                _ => parts.push((edge.clone(), [pair[0], pair[1]])),
            }
        }
    }
    parts
}

/// Middles of equal steps of at most `step` (m) along parts that bound a shape, m, and unit normals into it.
pub(crate) fn steps_along(parts: &[(BoundaryEdge, [f64; 2])], step: f64) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    parts.iter().flat_map(move |(edge, [from, to])| {
        let count = (edge.length() * (to - from) / step).ceil();
        (0..count as usize).map(move |i| {
            let (position, [x, y]) = edge.at(from + (i as f64 + 0.5) / count * (to - from));
            [position, [-y, x].map(|along| along / x.hypot(y))]
        })
    })
}

/// Positions (m) to the left and to the right of a place on an edge.
pub(crate) fn beside(edge: &BoundaryEdge, s: f64) -> [[f64; 2]; 2] {
    let (position, tangent) = edge.at(s);
    let size = match edge {
        BoundaryEdge::Line(_) => 1.0,
        BoundaryEdge::Circle { .. } => 1.0 / std::f64::consts::TAU, // the radius
    };
    [BESIDE, -BESIDE].map(|reach| [position[0] - reach * size * tangent[1], position[1] + reach * size * tangent[0]])
}

fn lines_meet([a, b]: Segment, [c, d]: Segment) -> Option<[f64; 2]> {
    let cross = |u: [f64; 2], v: [f64; 2]| u[0] * v[1] - u[1] * v[0];
    let from = |p: [f64; 2], q: [f64; 2]| [q[0] - p[0], q[1] - p[1]];
    let (along, other, apart) = (from(a, b), from(c, d), from(a, c));
    let determinant = cross(along, other);
    let [s, t] = [cross(apart, other) / determinant, cross(apart, along) / determinant];
    let on = -NEAR..=1.0 + NEAR; // also false for parallel lines, where s and t are not numbers or infinite
    (on.contains(&s) && on.contains(&t)).then(|| [0, 1].map(|i| a[i] + s * along[i]))
}

fn line_meets_circle([a, b]: Segment, center: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let foot = ((center[0] - a[0]) * along[0] + (center[1] - a[1]) * along[1]) / square;
    let at = |t: f64| [0, 1].map(|d| a[d] + t * along[d]);
    let [x, y] = at(foot);
    let beside = (x - center[0]) * (x - center[0]) + (y - center[1]) * (y - center[1]);
    let half = ((radius * radius - beside) / square).sqrt(); // not a number if they do not meet
    let on = -NEAR..=1.0 + NEAR;
    [foot - half, foot + half].into_iter().filter(|t| on.contains(t)).map(at).collect()
}

fn circles_meet((a, r): ([f64; 2], f64), (b, s): ([f64; 2], f64)) -> Vec<[f64; 2]> {
    let apart = [b[0] - a[0], b[1] - a[1]];
    let square = apart[0] * apart[0] + apart[1] * apart[1];
    let along = 0.5 * (1.0 + (r * r - s * s) / square);
    let half = (r * r / square - along * along).sqrt(); // not a number if they do not meet
    let place = |side: f64| [a[0] + along * apart[0] - side * apart[1], a[1] + along * apart[1] + side * apart[0]];
    [half, -half].into_iter().filter(|side| side.is_finite()).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_meet_where_they_should() {
        let circle = |center, radius| BoundaryEdge::Circle { center, radius, sign: 1.0 };
        let line = |a, b| BoundaryEdge::Line([a, b]);
        let near = |found: Vec<[f64; 2]>, exact: &[[f64; 2]]| {
            assert_eq!(found.len(), exact.len(), "{found:?}");
            for wanted in exact {
                let hit = found.iter().any(|p| (p[0] - wanted[0]).hypot(p[1] - wanted[1]) < 1e-12);
                assert!(hit, "{found:?} without {wanted:?}");
            }
        };
        near(line([0.0, 0.0], [2.0, 2.0]).meets(&line([0.0, 2.0], [2.0, 0.0])), &[[1.0, 1.0]]);
        near(line([0.0, 0.0], [2.0, 2.0]).meets(&line([1.0, 0.0], [3.0, 2.0])), &[]);
        near(line([0.0, 0.0], [0.4, 0.4]).meets(&line([0.0, 2.0], [2.0, 0.0])), &[]);
        near(line([-2.0, 0.6], [2.0, 0.6]).meets(&circle([0.0; 2], 1.0)), &[[-0.8, 0.6], [0.8, 0.6]]);
        near(circle([0.0; 2], 1.0).meets(&line([0.0, 0.6], [2.0, 0.6])), &[[0.8, 0.6]]);
        near(circle([0.0; 2], 1.0).meets(&circle([1.2, 0.0], 1.0)), &[[0.6, 0.8], [0.6, -0.8]]);
        near(circle([0.0; 2], 1.0).meets(&circle([3.0, 0.0], 1.0)), &[]);
        near(circle([0.0; 2], 1.0).meets(&circle([0.0; 2], 0.5)), &[]);
    }
}
