//! External loads: tractions carried by surface points.

use crate::patch::{BoundaryPoint, Patch};
use crate::quadrature::Rule;
use crate::scene::{Body, Edge, Shape, Side, Traction};

/// Surface point of a loaded boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position, m.
    pub position: [f64; 2],
    /// Length it stands for, m.
    pub length: f64,
}

/// Surface points along the edge of a traction, with the layout of the body in every span the edge crosses: the point
/// sums over the edge then fit those over the body, which the patch test needs for equally spaced points.
pub fn surface_points(patch: &Patch, body: &Body, edge: &Edge) -> Vec<SurfacePoint> {
    let ends = match edge {
        Edge::Side(side) => {
            body.shape.side(fault!("traction-on-wrong-edge", *side => Side::Bottom)).unwrap_or_default()
        }
        Edge::Segment(ends) => *ends,
    };
    let [from, to] = ends;
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let mut cuts = vec![0.0, 1.0];
    for d in 0..2 {
        if along[d].abs() > 1e-12 * length {
            let crossings = patch.spaces[d].spans().iter().map(|s| (s.left - from[d]) / along[d]);
            cuts.extend(crossings.filter(|t| (1e-12..1.0 - 1e-12).contains(t)));
        }
    }
    cuts.sort_by(f64::total_cmp);
    let direction = usize::from(along[1].abs() > along[0].abs());
    let rule = Rule::new(body.layout, body.particles_per_cell[direction]);
    let mut points = Vec::new();
    for pair in cuts.windows(2) {
        for (t, weight) in rule.points.iter().zip(&rule.weights) {
            let s = pair[0] + t * (pair[1] - pair[0]);
            points.push(SurfacePoint {
                position: [from[0] + s * along[0], from[1] + s * along[1]],
                length: weight * (pair[1] - pair[0]) * length,
            });
        }
    }
    points
}

/// Points on a side of the patch, with the layout of the body in every span.
pub fn boundary_points(patch: &Patch, body: &Body, side: Side) -> Vec<BoundaryPoint> {
    let along = if matches!(side, Side::Left | Side::Right) { 1 } else { 0 };
    patch.boundary(side, &Rule::new(body.layout, body.particles_per_cell[along]))
}

/// A traction as nodal forces that share one factor in time.
#[derive(Debug, Clone)]
pub struct NodalLoad {
    /// Control point and force at full strength per unit thickness, N/m.
    pub forces: Vec<(usize, [f64; 2])>,
    ramp: Option<f64>,
}

impl NodalLoad {
    /// Nodal forces of `traction` with the shape functions at the reference positions.
    pub fn new(patch: &Patch, body: &Body, traction: &Traction) -> Self {
        let mut sums = std::collections::BTreeMap::<usize, f64>::new();
        let mut add = |functions: &[(usize, f64)], length: f64| {
            for &(index, value) in functions {
                *sums.entry(index).or_default() += value * length;
            }
        };
        match (&traction.edge, &body.shape) {
            (Edge::Side(side), Shape::Patch) => {
                boundary_points(patch, body, *side).iter().for_each(|point| add(&point.functions, point.length));
            }
            _ => {
                for point in surface_points(patch, body, &traction.edge) {
                    if let Some(functions) = patch.functions_at(point.position) {
                        add(&functions.values, point.length);
                    }
                }
            }
        }
        let forces = sums.into_iter().map(|(index, sum)| (index, traction.stress.map(|s| s * sum))).collect();
        Self { forces, ramp: traction.ramp }
    }

    /// Factor at a time: rises linearly over the ramp.
    pub fn factor(&self, time: f64) -> f64 {
        self.ramp.map_or(1.0, |ramp| (time / ramp).clamp(0.0, 1.0))
    }
}
