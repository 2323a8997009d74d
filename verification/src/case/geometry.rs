//! Geometries of two rings in head-on collision, for a sweep.
//!
//! The paper gives the number of points of a ring but neither its radii nor the length scale. A geometry is
//! an assumption until the sequence of events it leads to is held against the one in the paper's words.

use std::f64::consts::PI;

use fisura::scene::{Mesh, Scene, Shape};

/// A geometry of the rings and how it is resolved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Geometry {
    /// Outer radius of a ring, m.
    pub outer: f64,
    /// Inner radius of a ring, m.
    pub inner: f64,
    /// Length scale l0, m.
    pub length_scale: f64,
    /// Points per span and direction.
    pub points: usize,
}

/// Material points of a ring in the paper.
pub const PARTICLES: usize = 12888;
/// Room around the ring for its motion, in spans.
const MARGIN: usize = 6;

impl Geometry {
    /// Number of points of a ring that touches x = 0 from the left, its centre on y = 0, on a lattice with
    /// points half a spacing (m) beside both axes.
    pub fn count(&self, spacing: f64) -> usize {
        let ring = Shape::Annulus { center: [-self.outer, 0.0], inner_radius: self.inner, outer_radius: self.outer };
        let steps = (2.0 * self.outer / spacing).ceil() as usize + 1;
        let at = |i: usize| (i as f64 + 0.5) * spacing;
        let column = |i: usize| (0..steps).filter(|&j| ring.contains([-at(i), at(j)])).count();
        2 * (0..steps).map(column).sum::<usize>()
    }

    /// The spacing (m) next to that of the ring's area with exactly `particles` points; else the one that
    /// comes closest.
    pub fn spacing(&self, particles: usize) -> f64 {
        let nominal = (PI * (self.outer * self.outer - self.inner * self.inner) / particles as f64).sqrt();
        let tries =
            (0..400).map(|n| nominal * (1.0 + 2e-5 * ((n + 1) / 2) as f64 * if n % 2 == 0 { 1.0 } else { -1.0 }));
        let off = |spacing: f64| self.count(spacing).abs_diff(particles);
        tries.map(|spacing| (off(spacing), spacing)).min_by_key(|(off, _)| *off).map_or(nominal, |(_, spacing)| spacing)
    }

    /// `template` with this geometry: its first body becomes a ring that touches x = 0 from the left, and its
    /// mesh reaches around it, with a few spans beyond x = 0; y = 0 is a line of knots.
    pub fn against_a_wall(&self, template: &Scene) -> Scene {
        let mut scene = template.clone();
        let h = self.points as f64 * self.spacing(PARTICLES);
        let spans = [(2.0 * self.outer / h).ceil() as usize + MARGIN, (self.outer / h).ceil() as usize + MARGIN];
        let cells = [spans[0] + MARGIN, 2 * spans[1]];
        let (origin, size) = (spans.map(|n| -(n as f64) * h), cells.map(|n| n as f64 * h));
        scene.mesh = Mesh::uniform(template.mesh.degree, origin, size, cells);
        let ring = &mut scene.bodies[0];
        let (center, inner_radius, outer_radius) = ([-self.outer, 0.0], self.inner, self.outer);
        ring.shape = Shape::Annulus { center, inner_radius, outer_radius };
        ring.particles_per_cell = [self.points; 2];
        for material in scene.materials.values_mut() {
            if let Some(fracture) = &mut material.fracture {
                fracture.length_scale = self.length_scale;
            }
        }
        scene
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_has_the_points_of_the_paper() {
        for (outer, inner) in [(0.05, 0.03), (0.08, 0.05), (0.06, 0.045)] {
            let geometry = Geometry { outer, inner, length_scale: 1e-3, points: 2 };
            let off = geometry.count(geometry.spacing(PARTICLES)).abs_diff(PARTICLES);
            assert!(off <= 4, "{outer} {inner}: {off} points off");
        }
    }
}
