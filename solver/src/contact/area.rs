//! Area, boundary length and centroid of a shape, by integrals along its boundary. So many Gauss points make
//! those along a whole circle exact to round-off.

use crate::scene::edges::bounding_parts;
use crate::scene::{Layout, Shape};
use crate::splines::quadrature::{MAX_POINTS, Rule};

/// Integrals over a shape.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShapeIntegrals {
    /// m².
    pub area: f64,
    /// Length of the boundary, m.
    pub length: f64,
    /// m.
    pub centroid: [f64; 2],
}

impl ShapeIntegrals {
    /// Those of a shape that is not the patch.
    pub(crate) fn new(shape: &Shape) -> Self {
        let (rule, parts) = (Rule::new(Layout::Gauss, MAX_POINTS), bounding_parts(shape));
        let origin = parts.first().map_or([0.0; 2], |(edge, _)| edge.at(0.0).0);
        let (mut area, mut length, mut moment) = (0.0, 0.0, [0.0; 2]);
        for (edge, [from, to]) in &parts {
            for (at, weight) in rule.points.iter().zip(&rule.weights) {
                let (place, tangent) = edge.at(from + at * (to - from));
                let arm = [0, 1].map(|d| place[d] - origin[d]);
                let step = weight * (to - from);
                let part = 0.5 * step * (arm[0] * tangent[1] - arm[1] * tangent[0]);
                area += part;
                length += step * tangent[0].hypot(tangent[1]);
                (0..2).for_each(|d| moment[d] += 2.0 / 3.0 * part * arm[d]);
            }
        }
        Self { area, length, centroid: [0, 1].map(|d| origin[d] + moment[d] / area) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn parts_that_share_an_edge_are_counted_once() {
        let rectangle = |min, max| Shape::Rectangle { min, max };
        let angle = Shape::Union(vec![rectangle([3.0, 1.0], [5.0, 2.0]), rectangle([3.0, 1.0], [4.0, 3.0])]);
        let ShapeIntegrals { area, length, centroid } = ShapeIntegrals::new(&angle);
        assert_relative_eq!(area, 3.0, max_relative = 1e-12);
        assert_relative_eq!(length, 8.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[0], 3.0 + 5.0 / 6.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[1], 1.0 + 5.0 / 6.0, max_relative = 1e-12);
    }

    #[test]
    fn circles_are_exact() {
        let hole = Shape::Disk { center: [0.5, 0.1], radius: 0.5 };
        let shape =
            Shape::Difference { of: Box::new(Shape::Disk { center: [0.0; 2], radius: 2.0 }), minus: vec![hole] };
        let ShapeIntegrals { area, length, centroid } = ShapeIntegrals::new(&shape);
        let pi = std::f64::consts::PI;
        assert_relative_eq!(area, pi * 3.75, max_relative = 1e-12);
        assert_relative_eq!(length, pi * 5.0, max_relative = 1e-12);
        assert_relative_eq!(centroid[0], -0.125 / 3.75, max_relative = 1e-11);
    }
}
