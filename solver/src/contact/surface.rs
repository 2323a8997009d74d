//! The boundary of a body as segments between vertices that move with it, and distances from it.

use super::outline::{bounds, perimeter, rings, spacing, without_patch};
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::extremes::around;
use crate::linear_algebra::vectors::{dot, unit};
use crate::scene::{Body, Mesh};

/// Distance from the boundary within which the middle of a segment counts as lying on it, over that of the
/// points.
const ON_BOUNDARY: f64 = 0.1;
/// Cosine of half the angle by which a boundary turns where it is smooth.
const SMOOTH: f64 = 0.97;

/// A boundary: segments with the body to their left.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    pub(super) vertices: Vec<[f64; 2]>,
    /// Displacement of each vertex in the last step, before the first one in the coming step, m.
    pub(super) displacements: Vec<[f64; 2]>,
    pub(super) segments: Vec<[u32; 2]>,
    /// Segments that end and begin at each vertex.
    pub(super) neighbours: Vec<[Option<u32>; 2]>,
    /// Where it was without material first, m.
    pub opened: Option<[f64; 2]>,
}

/// The point of a boundary that is nearest to a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nearest {
    /// Distance, m; negative inside the body.
    pub distance: f64,
    /// Outward unit normal there.
    pub normal: [f64; 2],
    /// Whether it is not a corner.
    pub is_smooth: bool,
    /// Its displacement in the last step, m.
    pub displacement: [f64; 2],
}

/// Centre of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Center {
    /// Position of the middle of the segment, m.
    pub position: [f64; 2],
    /// Outward unit normal.
    pub normal: [f64; 2],
    /// Its displacement in the last step, m.
    pub displacement: [f64; 2],
    /// Length of the segment, m.
    pub length: f64,
}

impl Surface {
    /// The boundary of `body` at t = 0, in segments as long as its points stand apart.
    pub fn new(mesh: &Mesh, body: &Body) -> Self {
        Self::with_spacing(mesh, body, spacing(mesh, body))
    }

    /// The boundary of `body` at t = 0, in segments of about this length, m.
    pub(super) fn with_spacing(mesh: &Mesh, body: &Body, spacing: f64) -> Self {
        let shape = without_patch(&body.shape, mesh);
        let mut surface = Self::default();
        for ring in rings(&shape, spacing) {
            surface.add(&ring, |ends| bounds(&shape, ends, ON_BOUNDARY * spacing));
        }
        surface.join();
        surface
    }

    /// About how many segments [`Self::new`] would make, without making them.
    pub(crate) fn expected_segments(mesh: &Mesh, body: &Body) -> f64 {
        perimeter(&without_patch(&body.shape, mesh)) / spacing(mesh, body)
    }

    /// Segments of a closed line, in order; those whose ends `keep` refuses are left out.
    fn add(&mut self, ring: &[[f64; 2]], keep: impl Fn([[f64; 2]; 2]) -> bool) {
        let first = self.vertices.len() as u32;
        let count = ring.len() as u32;
        self.vertices.extend(ring);
        self.displacements.resize(self.vertices.len(), [0.0; 2]);
        for i in 0..count {
            let ends = [i, (i + 1) % count];
            if keep(ends.map(|v| ring[v as usize])) {
                self.segments.push(ends.map(|v| first + v));
            }
        }
    }

    /// Forgets vertices without segments, and finds the neighbours of the others.
    pub(super) fn join(&mut self) {
        let mut numbers = vec![None; self.vertices.len()];
        let mut kept = Vec::new();
        for vertex in self.segments.iter_mut().flatten() {
            let old = *vertex as usize;
            *vertex = *numbers[old].get_or_insert_with(|| {
                kept.push(old);
                kept.len() as u32 - 1
            });
        }
        for places in [&mut self.vertices, &mut self.displacements] {
            *places = kept.iter().map(|&old| places[old]).collect();
        }
        self.find_neighbours();
    }

    fn find_neighbours(&mut self) {
        self.neighbours = vec![[None; 2]; self.vertices.len()];
        for (index, [from, to]) in self.segments.iter().enumerate() {
            self.neighbours[*to as usize][0] = Some(index as u32);
            self.neighbours[*from as usize][1] = Some(index as u32);
        }
    }

    /// Moves every vertex to the place of a map, m.
    pub fn place(&mut self, place: impl Fn(usize) -> [f64; 2]) {
        self.vertices.iter_mut().enumerate().for_each(|(index, vertex)| *vertex = place(index));
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { vertices, displacements, segments, neighbours: _, opened } = self;
        archive.value(vertices)?;
        archive.value(displacements)?;
        archive.value(segments)?;
        archive.value(opened)?;
        let ends = segments.iter().flatten().all(|&vertex| (vertex as usize) < vertices.len());
        if !ends || displacements.len() != vertices.len() {
            return Err(StateError::of_another_scene("the boundary of a body is not valid"));
        }
        self.find_neighbours();
        Ok(())
    }

    /// Box around the boundary: lower left and upper right corner, m.
    pub fn bounding_box(&self) -> [[f64; 2]; 2] {
        around(self.vertices.iter().map(|vertex| [*vertex; 2]))
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
        Center {
            position: [0, 1].map(|d| 0.5 * (a[d] + b[d])),
            normal: normal(a, b),
            displacement: self.way_at(segment, 0.5),
            length: (b[0] - a[0]).hypot(b[1] - a[1]),
        }
    }

    /// Centres of all segments.
    pub(crate) fn centers(&self) -> impl Iterator<Item = Center> + '_ {
        (0..self.segments.len() as u32).map(|segment| self.center(segment))
    }

    /// The point nearest to a position (m) on one of `segments`, if any lies within `reach` (m).
    pub(crate) fn nearest(&self, position: [f64; 2], segments: &[u32], reach: f64) -> Option<Nearest> {
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
        let sign = if outside { 1.0 } else { fault!("gap-without-sign", -1.0 => 1.0) };
        let is_smooth = dot(normal, self.segment_normal(segment)) > SMOOTH;
        Some(Nearest { distance: sign * distance, normal, is_smooth, displacement: self.way_at(segment, t) })
    }

    /// Keeps the segments whose places half a spacing of points (m) under them belong.
    pub(super) fn keep(&mut self, spacing: f64, belongs: impl Fn([f64; 2]) -> bool) {
        let under = |segment: u32| {
            let center = self.center(segment);
            [0, 1].map(|d| center.position[d] - 0.5 * spacing * center.normal[d])
        };
        let kept = (0..self.segments.len() as u32).filter(|s| belongs(under(*s))).map(|s| self.segments[s as usize]);
        self.segments = kept.collect();
    }

    /// Displacement of a place on a segment, at a fraction t of its length, in the last step, m.
    fn way_at(&self, segment: u32, t: f64) -> [f64; 2] {
        let [a, b] = self.segments[segment as usize].map(|vertex| self.displacements[vertex as usize]);
        [0, 1].map(|d| (1.0 - t) * a[d] + t * b[d])
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
    pub(super) fn vertex_normal(&self, vertex: usize) -> [f64; 2] {
        let normals = self.neighbours[vertex].iter().flatten().map(|&segment| self.segment_normal(segment));
        unit(normals.fold([0.0; 2], |sum, n| [0, 1].map(|d| sum[d] + n[d])), 1.0).unwrap_or_default()
    }

    fn segment_normal(&self, segment: u32) -> [f64; 2] {
        let [a, b] = self.ends(segment);
        normal(a, b)
    }

    pub(super) fn ends(&self, segment: u32) -> [[f64; 2]; 2] {
        self.segments[segment as usize].map(|vertex| self.vertices[vertex as usize])
    }
}

/// Unit normal to the right of the displacement from `a` to `b`.
fn normal(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    let along = [b[0] - a[0], b[1] - a[1]];
    let length = fault!("normal-not-normalised", along[0].hypot(along[1]) => 1.0);
    [along[1] / length, -along[0] / length]
}
