//! The boundary of a fragment where a crack parted it from the rest of its body.
//!
//! With `S` the density of the points of the body on a lattice as fine as they stand, smoothed with a
//! quadratic spline (one inside), and `S_f` the part of the fragment, the faces lie where
//!
//! ```text
//! S_f = max(S, 1/2)/2:
//! ```
//!
//! halfway between the outermost points of two fragments while the crack is closed, so that both have the
//! same line and the gap is zero, and at their own outermost points once it is open. Lines between the
//! lattice's points are found cell by cell (marching squares), the fragment to their left.

use std::collections::BTreeMap;

use super::Surface;

/// Least distance of a vertex from the ends of its side of a cell, over that side: no segment is a point.
const LEAST: f64 = 0.01;

/// How often lines are smoothed: over about a span, below which contact resolves nothing.
const SMOOTHINGS: usize = 16;

/// A point of the body.
pub(crate) struct Place {
    /// Present position of the point, m.
    pub position: [f64; 2],
    /// Its volume per unit thickness, m².
    pub volume: f64,
    /// Whether it belongs to the fragment.
    pub own: bool,
}

/// Lines with the fragment to their left.
pub(crate) struct Faces {
    vertices: Vec<[f64; 2]>,
    segments: Vec<[u32; 2]>,
    spacing: f64,
}

/// Densities of the fragment and of all on a lattice: first column and row, columns and rows.
struct Densities {
    first: [i64; 2],
    size: [usize; 2],
    of: Vec<[f64; 2]>,
}

impl Faces {
    /// Of a fragment; its points stand `spacing` (m) apart.
    pub(crate) fn new(places: &[Place], spacing: f64) -> Self {
        let lattice = Densities::new(places, spacing);
        let mut faces = Self { vertices: Vec::new(), segments: Vec::new(), spacing };
        let mut numbers = BTreeMap::new();
        for row in 0..lattice.size[1].saturating_sub(1) {
            for column in 0..lattice.size[0].saturating_sub(1) {
                let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| [column + i, row + j]);
                let excess = corners.map(|corner| lattice.excess(corner));
                for side in 0..4 {
                    let leaves = |side: usize| excess[side] > 0.0 && excess[(side + 1) % 4] <= 0.0;
                    let enters = |side: usize| excess[side] <= 0.0 && excess[(side + 1) % 4] > 0.0;
                    if !leaves(side) {
                        continue;
                    }
                    let Some(next) = (1..4).map(|on| (side + on) % 4).find(|side| enters(*side)) else { continue };
                    let ends = [side, next].map(|side| {
                        let [inside, outside] = if leaves(side) { [side, side + 1] } else { [side + 1, side] };
                        let [inside, outside] = [corners[inside % 4], corners[outside % 4]];
                        *numbers.entry((inside, outside)).or_insert_with(|| {
                            faces.vertices.push(lattice.crossing(inside, outside, spacing));
                            faces.vertices.len() as u32 - 1
                        })
                    });
                    faces.segments.push(ends);
                }
            }
        }
        faces
    }
}

impl Densities {
    fn new(places: &[Place], spacing: f64) -> Self {
        // Its points are where those of the body are in a mesh that begins at the origin.
        let on_lattice = |place: &Place| place.position.map(|x| x / spacing - 0.5);
        let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
        for place in places.iter().filter(|place| place.own) {
            for (d, x) in on_lattice(place).into_iter().enumerate() {
                (low[d], high[d]) = (low[d].min(x.floor() as i64 - 2), high[d].max(x.ceil() as i64 + 2));
            }
        }
        let size = [0, 1].map(|d| (high[d] - low[d] + 1).max(0) as usize);
        let mut lattice = Self { first: low, size, of: vec![[0.0; 2]; size[0] * size[1]] };
        for place in places {
            let x = on_lattice(place);
            let nearest = x.map(f64::round);
            let share = place.volume / (spacing * spacing);
            for [i, j] in [-1, 0, 1].into_iter().flat_map(|j| [-1, 0, 1].map(|i| [i, j])) {
                let node = [nearest[0] as i64 + i, nearest[1] as i64 + j];
                if (0..2).all(|d| (low[d]..=high[d]).contains(&node[d])) {
                    let weight = spline(x[0] - node[0] as f64) * spline(x[1] - node[1] as f64);
                    let at = lattice.at([0, 1].map(|d| (node[d] - low[d]) as usize));
                    lattice.of[at][1] += weight * share;
                    if place.own {
                        lattice.of[at][0] += weight * share;
                    }
                }
            }
        }
        lattice
    }

    fn at(&self, [column, row]: [usize; 2]) -> usize {
        row * self.size[0] + column
    }

    /// `S_f − max(S, 1/2)/2`.
    fn excess(&self, node: [usize; 2]) -> f64 {
        let [own, all] = self.of[self.at(node)];
        own - 0.5 * all.max(0.5)
    }

    /// Where the line crosses the side of a cell between two corners, m.
    fn crossing(&self, inside: [usize; 2], outside: [usize; 2], spacing: f64) -> [f64; 2] {
        let [within, without] = [self.excess(inside), self.excess(outside)];
        let t = (within / (within - without)).clamp(LEAST, 1.0 - LEAST);
        [0, 1].map(|d| {
            let [a, b] = [inside, outside].map(|node| (node[d] as i64 + self.first[d]) as f64 + 0.5);
            spacing * (a + t * (b - a))
        })
    }
}

impl Surface {
    /// The boundary of a fragment: what `belongs` to it of this one, by places just under it (m), and the
    /// faces where there was no boundary.
    pub(crate) fn of_fragment(&self, belongs: impl Fn([f64; 2]) -> bool, faces: &Faces) -> Self {
        let mut part = self.clone();
        part.keep(faces.spacing, belongs);
        let within = |ends: &[u32; 2]| {
            let [a, b] = ends.map(|vertex| faces.vertices[vertex as usize]);
            let (middle, reach) = ([0, 1].map(|d| 0.5 * (a[d] + b[d])), faces.spacing);
            let near = self.segments_in([middle.map(|x| x - reach), middle.map(|x| x + reach)]);
            self.nearest(middle, &near, reach).is_none()
        };
        let kept = |ends: &&[u32; 2]| fault!("crack-faces-left-out", within(ends) => false);
        let segments: Vec<[u32; 2]> = faces.segments.iter().filter(kept).copied().collect();
        let first = part.vertices.len() as u32;
        part.vertices.extend(smooth(&faces.vertices, &segments));
        part.displacements.resize(part.vertices.len(), [0.0; 2]);
        part.segments.extend(segments.iter().map(|ends| ends.map(|vertex| first + vertex)));
        part.join();
        part
    }
}

/// Vertices of lines moved towards the middle of their neighbours, time and again; ends stay. Points of a
/// lattice end in steps where the crack runs across it, on which fragments would catch.
fn smooth(vertices: &[[f64; 2]], segments: &[[u32; 2]]) -> Vec<[f64; 2]> {
    let mut neighbours = vec![[None; 2]; vertices.len()];
    for &[from, to] in segments {
        (neighbours[from as usize][1], neighbours[to as usize][0]) = (Some(to as usize), Some(from as usize));
    }
    let mut smooth = vertices.to_vec();
    for _ in 0..SMOOTHINGS {
        let rough = smooth.clone();
        for (vertex, neighbours) in smooth.iter_mut().zip(&neighbours) {
            if let [Some(before), Some(after)] = *neighbours {
                *vertex = [0, 1].map(|d| 0.5 * vertex[d] + 0.25 * (rough[before][d] + rough[after][d]));
            }
        }
    }
    smooth
}

/// Quadratic spline of integral one, between ±1.5.
fn spline(x: f64) -> f64 {
    let x = x.abs();
    if x < 0.5 { 0.75 - x * x } else { 0.5 * (1.5 - x).max(0.0).powi(2) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::surface::Center;

    /// A block of 12 by 6 points a tenth apart, those to the right moved by `gap`; `side` is the fragment.
    fn faces(gap: f64, side: bool) -> Vec<Center> {
        let place = |i: usize, j: usize| Place {
            position: [0.1 * i as f64 + 0.05 + if i < 6 { 0.0 } else { gap }, 0.1 * j as f64 + 0.05],
            volume: 0.01,
            own: (i < 6) == side,
        };
        let places: Vec<Place> = (0..6).flat_map(|j| (0..12).map(move |i| place(i, j))).collect();
        let mut block = Surface::default();
        let corners = [[0.0, 0.0], [1.2 + gap, 0.0], [1.2 + gap, 0.6], [0.0, 0.6]];
        block.vertices = corners.to_vec();
        block.displacements = vec![[0.0; 2]; 4];
        block.segments = (0..4).map(|i| [i, (i + 1) % 4]).collect();
        block.join();
        let part = block.of_fragment(|_| false, &Faces::new(&places, 0.1));
        (0..part.segments.len() as u32).map(|segment| part.center(segment)).collect()
    }

    #[test]
    fn both_sides_of_a_closed_crack_have_the_same_line() {
        for (side, outward) in [(true, 1.0), (false, -1.0)] {
            let faces = faces(0.0, side);
            assert!((3..=6).contains(&faces.len()), "{}", faces.len());
            for Center { position, normal, .. } in faces {
                assert!((position[0] - 0.6).abs() < 1e-12 && (normal[0] - outward).abs() < 1e-12, "{position:?}");
            }
        }
    }

    #[test]
    fn both_sides_of_an_open_crack_lie_at_their_own_points() {
        for (side, outward, x) in [(true, 1.0, 0.6), (false, -1.0, 1.1)] {
            let faces = faces(0.5, side);
            assert!((3..=6).contains(&faces.len()), "{}", faces.len());
            for Center { position, normal, .. } in faces {
                assert!((position[0] - x).abs() < 0.04 && normal[0] * outward > 0.9, "{position:?} {normal:?}");
            }
        }
    }
}
