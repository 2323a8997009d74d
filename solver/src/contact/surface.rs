//! The boundary of a body as segments between vertices that move with it, and distances from it.

use rayon::prelude::*;

use super::handle::{DEPTH, Handle};
use crate::extremes::{larger, smaller};
use crate::quadrature::MAX_POINTS;
use crate::scene::{Body, Mesh, Shape};
use crate::shape::polygon_edges;
use crate::updated_frame::field::DiscreteField;
use crate::updated_frame::grid::VectorField;

/// Distance from the boundary within which the middle of a segment counts as lying on it, over that of the points.
const ON_BOUNDARY: f64 = 0.1;

/// A boundary: segments with the body to their left.
#[derive(Debug, Clone)]
pub struct Surface {
    vertices: Vec<[f64; 2]>,
    segments: Vec<[u32; 2]>,
    /// Segments that end and begin at each vertex.
    neighbours: Vec<[Option<u32>; 2]>,
}

/// The point of a boundary that is nearest to a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Distance, m; negative inside the body.
    pub distance: f64,
    /// Outward unit normal there.
    pub normal: [f64; 2],
}

/// Centre of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Center {
    /// Position, m.
    pub position: [f64; 2],
    /// Outward unit normal.
    pub normal: [f64; 2],
}

impl Surface {
    /// The boundary of `body` at t = 0, in segments as long as its points stand apart.
    pub fn new(mesh: &Mesh, body: &Body) -> Self {
        let spacing = spacing(mesh, body);
        let shape = without_patch(&body.shape, mesh);
        let mut surface = Self { vertices: Vec::new(), segments: Vec::new(), neighbours: Vec::new() };
        for ring in rings(&shape, spacing) {
            surface.add(&ring, |middle| is_on_boundary(&shape, middle, ON_BOUNDARY * spacing));
        }
        surface.join();
        surface
    }

    /// About how many segments [`Self::new`] would make, without making them.
    pub(crate) fn expected_segments(mesh: &Mesh, body: &Body) -> f64 {
        perimeter(&without_patch(&body.shape, mesh)) / spacing(mesh, body)
    }

    /// Segments of a closed line, in order; those whose middle `keep` refuses are left out.
    fn add(&mut self, ring: &[[f64; 2]], keep: impl Fn([f64; 2]) -> bool) {
        let first = self.vertices.len() as u32;
        let count = ring.len() as u32;
        self.vertices.extend(ring);
        for i in 0..count {
            let ends = [i, (i + 1) % count];
            let [a, b] = ends.map(|v| ring[v as usize]);
            if keep([0, 1].map(|d| 0.5 * (a[d] + b[d]))) {
                self.segments.push(ends.map(|v| first + v));
            }
        }
    }

    /// Forgets vertices without segments, and finds the neighbours of the others.
    fn join(&mut self) {
        let mut numbers = vec![None; self.vertices.len()];
        let mut kept = Vec::new();
        for vertex in self.segments.iter_mut().flatten() {
            *vertex = *numbers[*vertex as usize].get_or_insert_with(|| {
                kept.push(self.vertices[*vertex as usize]);
                kept.len() as u32 - 1
            });
        }
        self.vertices = kept;
        self.neighbours = vec![[None; 2]; self.vertices.len()];
        for (index, [from, to]) in self.segments.iter().enumerate() {
            self.neighbours[*to as usize][0] = Some(index as u32);
            self.neighbours[*from as usize][1] = Some(index as u32);
        }
    }

    /// Moves with a velocity field (m/s) of its body for `dt` seconds. A vertex that has lost its material stays behind.
    pub fn follow(&mut self, field: &DiscreteField, velocity: &VectorField, dt: f64) {
        let depth = DEPTH * field.shortest_span();
        let moved = (0..self.vertices.len()).into_par_iter().map(|vertex| {
            let position = self.vertices[vertex];
            let normal = self.vertex_normal(vertex);
            let inside = [0, 1].map(|d| position[d] - depth * normal[d]);
            Handle::new(field, position, inside).map_or(position, |handle| {
                let velocity = handle.value(velocity);
                [0, 1].map(|d| position[d] + dt * velocity[d])
            })
        });
        self.vertices = moved.collect();
    }

    /// Moves every vertex to the place of a map, m.
    pub fn place(&mut self, place: impl Fn(usize) -> [f64; 2]) {
        self.vertices.iter_mut().enumerate().for_each(|(index, vertex)| *vertex = place(index));
    }

    pub(crate) fn vertices_mut(&mut self) -> &mut Vec<[f64; 2]> {
        &mut self.vertices
    }

    /// Centroid of the region it bounds, m.
    pub fn centroid(&self) -> [f64; 2] {
        let (mut area, mut moment) = (0.0, [0.0; 2]);
        for index in 0..self.segments.len() as u32 {
            let [a, b] = self.ends(index);
            let part = 0.5 * (a[0] * b[1] - a[1] * b[0]);
            area += part;
            moment = [0, 1].map(|d| moment[d] + part * (a[d] + b[d]) / 3.0);
        }
        moment.map(|m| m / area)
    }

    /// Positions of the vertices, m.
    pub fn positions(&self) -> &[[f64; 2]] {
        &self.vertices
    }

    /// Box around the boundary: lower left and upper right corner, m.
    pub fn bounding_box(&self) -> [[f64; 2]; 2] {
        self.vertices.iter().fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], vertex| {
            [[0, 1].map(|d| smaller(low[d], vertex[d])), [0, 1].map(|d| larger(high[d], vertex[d]))]
        })
    }

    /// Numbers of the segments that may lie in a box.
    pub fn segments_in(&self, [low, high]: [[f64; 2]; 2]) -> Vec<u32> {
        let meets = |index: &u32| {
            let [a, b] = self.ends(*index);
            (0..2).all(|d| a[d].max(b[d]) >= low[d] && a[d].min(b[d]) <= high[d])
        };
        (0..self.segments.len() as u32).filter(meets).collect()
    }

    /// Centre of a segment.
    pub fn center(&self, segment: u32) -> Center {
        let [a, b] = self.ends(segment);
        Center { position: [0, 1].map(|d| 0.5 * (a[d] + b[d])), normal: normal(a, b) }
    }

    /// The point nearest to a position (m) on one of `segments`, if any lies within `reach` (m).
    pub fn nearest(&self, position: [f64; 2], segments: &[u32], reach: f64) -> Option<Nearest> {
        let mut best: Option<(f64, u32, f64, [f64; 2])> = None;
        for &segment in segments {
            let [a, b] = self.ends(segment);
            let along = [b[0] - a[0], b[1] - a[1]];
            let offset = [position[0] - a[0], position[1] - a[1]];
            let t = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
            let from = [0, 1].map(|d| offset[d] - t * along[d]);
            let square = dot(from, from);
            if best.is_none_or(|(least, ..)| square < least) {
                best = Some((square, segment, t, from));
            }
        }
        let (square, segment, t, from) = best?;
        let distance = square.sqrt();
        if distance > reach {
            return None;
        }
        let normal = self.normal_at(segment, t);
        let outside = dot(from, normal) >= 0.0;
        Some(Nearest { distance: if outside { distance } else { -distance }, normal })
    }

    /// Outward normal of a segment at a fraction t of its length: at its ends that of the vertex.
    fn normal_at(&self, segment: u32, t: f64) -> [f64; 2] {
        let [from, to] = self.segments[segment as usize];
        if t <= 0.0 {
            self.vertex_normal(from as usize)
        } else if t >= 1.0 {
            self.vertex_normal(to as usize)
        } else {
            self.segment_normal(segment)
        }
    }

    /// Mean of the outward normals of the segments that meet at a vertex; zero if there are none.
    fn vertex_normal(&self, vertex: usize) -> [f64; 2] {
        let normals = self.neighbours[vertex].iter().flatten().map(|&segment| self.segment_normal(segment));
        unit(normals.fold([0.0; 2], |sum, n| [0, 1].map(|d| sum[d] + n[d]))).unwrap_or_default()
    }

    fn segment_normal(&self, segment: u32) -> [f64; 2] {
        let [a, b] = self.ends(segment);
        normal(a, b)
    }

    fn ends(&self, segment: u32) -> [[f64; 2]; 2] {
        self.segments[segment as usize].map(|vertex| self.vertices[vertex as usize])
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let per_vertex = size_of::<[f64; 2]>() + size_of::<[Option<u32>; 2]>();
        self.vertices.len() * per_vertex + self.segments.len() * size_of::<[u32; 2]>()
    }
}

/// Distance between the points of a body, m: that of the smallest span.
fn spacing(mesh: &Mesh, body: &Body) -> f64 {
    let smallest = |d: usize| {
        let spans = mesh.knots[d].windows(2).map(|pair| pair[1] - pair[0]).filter(|length| *length > 0.0);
        spans.fold(f64::INFINITY, smaller) / body.particles_per_cell[d].clamp(1, MAX_POINTS) as f64
    };
    smallest(0).min(smallest(1))
}

/// The same shape with a rectangle for the whole patch, which is one in the updated frame.
fn without_patch(shape: &Shape, mesh: &Mesh) -> Shape {
    match shape {
        Shape::Patch => Shape::Rectangle { min: mesh.origin(), max: mesh.end() },
        Shape::Difference { of, minus } => {
            let minus = minus.iter().map(|hole| without_patch(hole, mesh)).collect();
            Shape::Difference { of: Box::new(without_patch(of, mesh)), minus }
        }
        other => other.clone(),
    }
}

/// Length of all lines that [`rings`] gives, m.
fn perimeter(shape: &Shape) -> f64 {
    let circle = |radius: f64| std::f64::consts::TAU * radius;
    match shape {
        Shape::Rectangle { min, max } => 2.0 * ((max[0] - min[0]) + (max[1] - min[1])),
        Shape::Disk { radius, .. } => circle(*radius),
        Shape::Annulus { inner_radius, outer_radius, .. } => circle(*inner_radius) + circle(*outer_radius),
        Shape::Polygon { points } => polygon_edges(points).map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum(),
        Shape::Patch => 0.0, // see without_patch
        Shape::Difference { of, minus } => perimeter(of) + minus.iter().map(perimeter).sum::<f64>(),
    }
}

/// Closed lines that bound a shape, the body to their left, in steps of about `spacing`.
fn rings(shape: &Shape, spacing: f64) -> Vec<Vec<[f64; 2]>> {
    let circle = |center: [f64; 2], radius: f64| -> Vec<[f64; 2]> {
        // A multiple of four, so that the circle keeps the symmetries of the mesh.
        let count = 4 * ((std::f64::consts::FRAC_PI_2 * radius / spacing).ceil() as usize).max(4);
        let at = |i: usize| {
            let (sin, cos) = (std::f64::consts::TAU * (i as f64 + 0.5) / count as f64).sin_cos();
            [center[0] + radius * cos, center[1] + radius * sin]
        };
        (0..count).map(at).collect()
    };
    let polygon = |corners: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let edges = polygon_edges(corners);
        let along = |[a, b]: [[f64; 2]; 2]| {
            let count = (((b[0] - a[0]).hypot(b[1] - a[1]) / spacing).ceil() as usize).max(1);
            (0..count).map(move |i| [0, 1].map(|d| a[d] + (b[d] - a[d]) * i as f64 / count as f64))
        };
        let mut line: Vec<_> = edges.flat_map(along).collect();
        if polygon_edges(corners).map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum::<f64>() < 0.0 {
            line.reverse();
        }
        line
    };
    match shape {
        Shape::Rectangle { min, max } => vec![polygon(&[*min, [max[0], min[1]], *max, [min[0], max[1]]])],
        Shape::Disk { center, radius } => vec![circle(*center, *radius)],
        Shape::Annulus { center, inner_radius, outer_radius } => {
            let mut lines = vec![circle(*center, *outer_radius)];
            if *inner_radius > 0.0 {
                lines.push(circle(*center, *inner_radius));
                lines[1].reverse();
            }
            lines
        }
        Shape::Polygon { points } => vec![polygon(points)],
        Shape::Patch => Vec::new(), // see without_patch
        Shape::Difference { of, minus } => {
            let holes = minus.iter().flat_map(|hole| rings(hole, spacing)).map(|mut line| {
                line.reverse();
                line
            });
            rings(of, spacing).into_iter().chain(holes).collect()
        }
    }
}

fn is_on_boundary(shape: &Shape, position: [f64; 2], tolerance: f64) -> bool {
    shape.contains_within(position, tolerance) && !shape.contains_within(position, -tolerance)
}

/// Unit normal to the right of the way from `a` to `b`.
fn normal(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length = fault!("normal-not-normalised", along[0].hypot(along[1]) => 1.0);
    [along[1] / length, -along[0] / length]
}

/// The direction of a vector, unless it is next to nothing beside a unit vector.
pub fn unit(vector: [f64; 2]) -> Option<[f64; 2]> {
    let length = vector[0].hypot(vector[1]);
    (length > 1e-6).then(|| vector.map(|x| x / length))
}

/// Scalar product.
pub fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
