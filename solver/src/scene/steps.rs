//! Straight steps that leave a shape, or go through it.

use super::Shape;
use super::edges::BoundaryEdge;
use super::shape::{Segment, cross, distance_to_segment, polygon_edges};

impl Shape {
    /// Whether the straight step between two positions (m) in the shape leaves it on the way.
    pub(crate) fn is_left_on(&self, step: Segment) -> bool {
        match self {
            Self::Rectangle { .. } | Self::Disk { .. } | Self::Patch => false, // convex, or all there is
            Self::Annulus { center, inner_radius, .. } => {
                distance_to_segment(*center, step[0], step[1]) < *inner_radius
            }
            Self::Polygon { points } => polygon_edges(points).any(|edge| cross(step, edge)),
            Self::Union(_) => {
                let line = BoundaryEdge::Line(step);
                let places = line.places_met(&self.edges(), [0.0, 1.0]);
                places.windows(2).any(|pair| !self.contains(line.at(0.5 * (pair[0] + pair[1])).0))
            }
            Self::Difference { of, minus } => of.is_left_on(step) || minus.iter().any(|hole| hole.is_met_on(step)),
        }
    }

    /// Whether the straight step between two positions (m) outside the shape goes through it.
    fn is_met_on(&self, step: Segment) -> bool {
        match self {
            Self::Rectangle { min, max } => {
                let corners = [*min, [max[0], min[1]], *max, [min[0], max[1]]];
                polygon_edges(&corners).any(|edge| cross(step, edge))
            }
            Self::Disk { center, radius } => distance_to_segment(*center, step[0], step[1]) < *radius,
            Self::Annulus { center, inner_radius, outer_radius } => {
                let hole = Self::Disk { center: *center, radius: *inner_radius };
                !step.iter().all(|end| hole.contains(*end))
                    && distance_to_segment(*center, step[0], step[1]) < *outer_radius
            }
            Self::Polygon { points } => polygon_edges(points).any(|edge| cross(step, edge)),
            Self::Patch => true,
            Self::Union(shapes) => shapes.iter().any(|shape| shape.is_met_on(step)),
            Self::Difference { of, minus } => {
                let within = |island: &Self| step.iter().all(|end| island.contains(*end)) && !island.is_left_on(step);
                of.is_met_on(step) && !minus.iter().any(within)
            }
        }
    }
}
