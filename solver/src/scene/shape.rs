//! Regions of the plane: which positions lie in a shape, and how far it reaches.

use super::condition::Side;
use crate::linear_algebra::extremes::{around, larger, smaller};

/// Region of the plane, in m.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Axis-aligned rectangle.
    Rectangle {
        /// Lower left corner, m: the smallest x and y.
        min: [f64; 2],
        /// Upper right corner.
        max: [f64; 2],
    },
    /// Disk, bounded by a circle.
    Disk {
        /// Centre of the circle, m.
        center: [f64; 2],
        /// Radius of the circle, m.
        radius: f64,
    },
    /// Ring between two circles.
    Annulus {
        /// Centre of both circles, m.
        center: [f64; 2],
        /// Radius of the inner circle, m.
        inner_radius: f64,
        /// Radius of the outer circle, m.
        outer_radius: f64,
    },
    /// Simple polygon: its edges do not cross each other.
    Polygon {
        /// Corners in their order along the boundary, m; an edge joins the last one to the first.
        points: Vec<[f64; 2]>,
    },
    /// All of the background patch.
    Patch,
    /// All of some shapes.
    Union(Vec<Shape>),
    /// A shape without other shapes.
    Difference {
        /// The shape cut from.
        of: Box<Shape>,
        /// The shapes cut out.
        minus: Vec<Shape>,
    },
}

impl Shape {
    /// Whether `position` (m) lies in the shape; what bounds it belongs to it, except for the edges of a
    /// polygon, which belong to one side by the even–odd rule, and for what a difference takes away.
    pub fn contains(&self, position: [f64; 2]) -> bool {
        self.contains_within(position, 0.0)
    }

    /// Whether `position` (m) lies in the shape grown by `margin` (m); a negative margin shrinks it. A small
    /// positive margin makes it the closure of the shape, up to rounding.
    pub fn contains_within(&self, position: [f64; 2], margin: f64) -> bool {
        let distance = |center: &[f64; 2]| (position[0] - center[0]).hypot(position[1] - center[1]);
        match self {
            Self::Rectangle { min, max } => {
                (0..2).all(|d| position[d] >= min[d] - margin && position[d] <= max[d] + margin)
            }
            Self::Disk { center, radius } => distance(center) <= radius + margin,
            Self::Annulus { center, inner_radius, outer_radius } => {
                (inner_radius - margin..=outer_radius + margin).contains(&distance(center))
            }
            Self::Polygon { points } => {
                let inside = polygon_contains(points, position);
                let near =
                    |reach: f64| polygon_edges(points).any(|[a, b]| distance_to_segment(position, a, b) <= reach);
                match margin {
                    m if m > 0.0 => inside || near(m),
                    m if m < 0.0 => inside && !near(-m),
                    _ => inside,
                }
            }
            Self::Patch => true,
            Self::Union(shapes) => shapes.iter().any(|shape| shape.contains_within(position, margin)),
            Self::Difference { of, minus } => {
                of.contains_within(position, margin) && !minus.iter().any(|s| s.contains_within(position, -margin))
            }
        }
    }

    /// Smallest axis-aligned rectangle around the shape: lower left and upper right corner, m. That of the
    /// patch, which the shape does not know, is the whole plane; [`crate::scene::Mesh::extent`] clips it.
    pub fn bounding_box(&self) -> ([f64; 2], [f64; 2]) {
        match self {
            Self::Rectangle { min, max } => (*min, *max),
            Self::Disk { center, radius } | Self::Annulus { center, outer_radius: radius, .. } => {
                (center.map(|c| c - radius), center.map(|c| c + radius))
            }
            Self::Polygon { points } => around(points.iter().map(|point| [*point; 2])).into(),
            Self::Patch => ([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]),
            Self::Union(shapes) => around(shapes.iter().map(|shape| shape.bounding_box().into())).into(),
            Self::Difference { of, minus } => minus.iter().fold(of.bounding_box(), cut),
        }
    }

    /// Whether no edge of its shapes runs through its inside: a union has such edges.
    pub(crate) fn all_edges_bound(&self) -> bool {
        match self {
            Self::Union(_) => false,
            Self::Difference { of, minus } => of.all_edges_bound() && minus.iter().all(Self::all_edges_bound),
            _ => true,
        }
    }

    /// End points of a side of a rectangle, m; `None` for other shapes.
    pub fn side(&self, side: Side) -> Option<[[f64; 2]; 2]> {
        let Self::Rectangle { min, max } = self else { return None };
        let (across, upper) = side.axis();
        let at = if upper { max[across] } else { min[across] };
        Some([min, max].map(|corner| [0, 1].map(|d| if d == across { at } else { corner[d] })))
    }
}

/// A box without what a rectangle that reaches across it cuts off at a side.
fn cut((mut low, mut high): ([f64; 2], [f64; 2]), shape: &Shape) -> ([f64; 2], [f64; 2]) {
    let Shape::Rectangle { min, max } = shape else { return (low, high) };
    for d in 0..2 {
        let across = min[1 - d] <= low[1 - d] && max[1 - d] >= high[1 - d];
        if across && min[d] <= low[d] && max[d] < high[d] {
            low[d] = larger(low[d], max[d]);
        } else if across && max[d] >= high[d] && min[d] > low[d] {
            high[d] = smaller(high[d], min[d]);
        }
    }
    (low, high)
}

/// Edges of a polygon from the one that closes it on.
pub(crate) fn polygon_edges(points: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
    (0..points.len()).map(|i| [points[(i + points.len() - 1) % points.len()], points[i]])
}

/// Whether a position lies in a polygon, by the even–odd rule.
fn polygon_contains(points: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses =
        |[[x0, y0], [x1, y1]]: &[[f64; 2]; 2]| (y0 > &y) != (y1 > &y) && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0);
    polygon_edges(points).filter(crosses).count() % 2 == 1
}

/// Part of a segment beyond its ends that still belongs to it.
pub(super) const ROUND_OFF: f64 = 1e-9;

/// A straight line between two positions, m.
pub(crate) type Segment = [[f64; 2]; 2];

/// Whether the step from a to b crosses a segment. A position on the line of the segment counts as one on its
/// left, so that it has a side; where round-off puts both on different sides of it, they are parted as well.
pub(crate) fn cross([a, b]: Segment, [c, d]: Segment) -> bool {
    let along = [d[0] - c[0], d[1] - c[1]];
    let left = |p: [f64; 2]| along[0] * (p[1] - c[1]) - along[1] * (p[0] - c[0]);
    let apart = (0..2).any(|i| a[i].max(b[i]) < c[i].min(d[i]) || c[i].max(d[i]) < a[i].min(b[i]));
    let (from, to) = (left(a), left(b));
    if apart || (from >= 0.0) == (to >= 0.0) {
        return false;
    }
    let meeting = [0, 1].map(|i| a[i] + from / (from - to) * (b[i] - a[i]) - c[i]);
    let length = along[0] * along[0] + along[1] * along[1];
    let ends = -ROUND_OFF * length..=(1.0 + ROUND_OFF) * length;
    ends.contains(&(along[0] * meeting[0] + along[1] * meeting[1]))
}

/// Distance (m) of `position` from the segment between `from` and `to`.
pub(crate) fn distance_to_segment(position: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let offset = [position[0] - from[0], position[1] - from[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let projected = offset[0] * along[0] + offset[1] * along[1];
    let t = if length_squared > 0.0 { (projected / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (offset[0] - t * along[0]).hypot(offset[1] - t * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_hold_their_points_and_no_others() {
        let square = Shape::Polygon { points: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]] };
        let ring = Shape::Annulus { center: [0.0, 0.0], inner_radius: 1.0, outer_radius: 2.0 };
        let holed = Shape::Difference {
            of: Box::new(Shape::Rectangle { min: [0.0, 0.0], max: [2.0, 2.0] }),
            minus: vec![Shape::Disk { center: [1.0, 1.0], radius: 0.5 }],
        };
        assert!(square.contains([1.0, 0.5]) && !square.contains([2.1, 0.5]));
        assert!(ring.contains([1.5, 0.0]) && !ring.contains([0.5, 0.0]) && !ring.contains([2.0, 2.0]));
        assert!(holed.contains([0.2, 0.2]) && !holed.contains([1.2, 1.0]));
        assert_eq!(ring.bounding_box(), ([-2.0, -2.0], [2.0, 2.0]));
        let half = Shape::Difference {
            of: Box::new(ring),
            minus: vec![Shape::Rectangle { min: [-3.0, -3.0], max: [3.0, 0.0] }],
        };
        assert_eq!(half.bounding_box(), ([-2.0, 0.0], [2.0, 2.0]));
    }

    #[test]
    fn a_margin_moves_every_boundary_outwards_or_inwards() {
        let disk = |radius| Shape::Disk { center: [0.0; 2], radius };
        let shapes = [
            (Shape::Rectangle { min: [-1.0; 2], max: [1.0; 2] }, [1.0, 0.5]),
            (disk(1.0), [0.0, 1.0]),
            (Shape::Annulus { center: [0.0; 2], inner_radius: 0.5, outer_radius: 1.0 }, [0.5, 0.0]),
            (Shape::Polygon { points: vec![[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] }, [0.5, 0.5]),
            (Shape::Difference { of: Box::new(disk(2.0)), minus: vec![disk(1.0)] }, [1.0, 0.0]),
        ];
        for (shape, on_the_boundary) in shapes {
            assert!(shape.contains_within(on_the_boundary, 1e-9), "{shape:?}");
            assert!(!shape.contains_within(on_the_boundary, -1e-9), "{shape:?}");
        }
    }

    /// Positions along a line, to round-off, which puts some on its left and some on its right.
    #[test]
    fn a_segment_parts_positions_on_either_side_to_round_off() {
        let line = [[2.5e-3, 0.0], [14.5e-3, 12e-3]];
        let positions = (1..120).map(|i| 1e-4 * i as f64).map(|y| [2.5e-3 + y, y]).collect::<Vec<_>>();
        let left = |p: [f64; 2]| !cross([p, [12e-3, 4e-3]], line);
        let (mut parted, mut joined) = (0, 0);
        for pair in positions.windows(2) {
            assert_eq!(cross([pair[0], pair[1]], line), left(pair[0]) != left(pair[1]), "{pair:?}");
            *(if left(pair[0]) == left(pair[1]) { &mut joined } else { &mut parted }) += 1;
        }
        assert!(parted > 0 && joined > 0, "{parted} {joined}");
        assert!(!cross([[2.4e-3, 0.0], [2.4e-3, 1e-3]], line) && cross([[2.5e-3, 1e-5], [2.6e-3, 0.0]], line));
    }

    #[test]
    fn distance_beyond_the_end_is_to_the_end() {
        assert_eq!(distance_to_segment([3.0, 4.0], [-1.0, 0.0], [0.0, 0.0]), 5.0);
        assert_eq!(distance_to_segment([-0.5, 0.25], [-1.0, 0.0], [0.0, 0.0]), 0.25);
        assert_eq!(distance_to_segment([3.0, 4.0], [0.0, 0.0], [0.0, 0.0]), 5.0, "a segment without length");
    }
}
