//! How a boundary moves with its body.

use rayon::prelude::*;

use super::boundary_functions::BoundaryFunctions;
use super::surface::{Center, Surface};
use super::view::BodyView;
use crate::linear_algebra::control_grid::VectorField;
use crate::particles::follower::Follower;

/// Depth under the boundary at which there is material, in spans.
const DEPTH: f64 = 0.5;
/// Length of a segment above which it may span a gap, in spans.
const MOST_STRETCH: f64 = 2.0;

impl Surface {
    /// Moves with a velocity field (m/s) of its body for `dt` seconds. Where there is no material any more
    /// the boundary ends: it must neither stretch across a gap nor push with nothing behind it.
    pub(crate) fn follow(&mut self, body: &BodyView, velocity: &VectorField, dt: f64) {
        let displacements = self.displacements_of(body, velocity, dt);
        self.displacements = displacements.iter().map(|displacement| displacement.unwrap_or_default()).collect();
        for (vertex, displacement) in self.vertices.iter_mut().zip(&self.displacements) {
            *vertex = [0, 1].map(|d| vertex[d] + displacement[d]);
        }
        let span = body.patch.shortest_span();
        let held = |vertex: u32| displacements[vertex as usize].is_some();
        let bare = |segment: &u32| {
            let [from, to] = self.segments[*segment as usize];
            !held(from) || !held(to) || self.spans_a_gap(body, *segment, span)
        };
        let bare: Vec<u32> = (0..self.segments.len() as u32).filter(bare).collect();
        if let Some(&first) = bare.first() {
            self.opened.get_or_insert(self.center(first).position);
            let mut number = 0..;
            self.segments.retain(|_| number.next().is_some_and(|n| bare.binary_search(&n).is_err()));
            self.join();
        }
    }

    /// Whether a segment has become so long that there is no material of its body under its middle.
    fn spans_a_gap(&self, body: &BodyView, segment: u32, span: f64) -> bool {
        let [a, b] = self.ends(segment);
        if (b[0] - a[0]).hypot(b[1] - a[1]) <= MOST_STRETCH * span {
            return false;
        }
        let Center { position, normal, .. } = self.center(segment);
        let inside = [0, 1].map(|d| position[d] - DEPTH * span * normal[d]);
        Follower::nearest(inside, body.patch, body.cells).is_none()
    }

    /// Takes the displacements of the coming step from a velocity field (m/s) of its body.
    pub(crate) fn expect(&mut self, body: &BodyView, velocity: &VectorField, dt: f64) {
        self.displacements =
            self.displacements_of(body, velocity, dt).into_iter().map(Option::unwrap_or_default).collect();
    }

    /// Displacements of the vertices in `dt` seconds, m; `None` where the body has no material any more.
    fn displacements_of(&self, body: &BodyView, velocity: &VectorField, dt: f64) -> Vec<Option<[f64; 2]>> {
        let displacement = |vertex: usize| {
            let time = fault!("boundary-lags-behind", dt => 0.9 * dt);
            BoundaryFunctions::new(body, self.vertices[vertex])
                .map(|functions| functions.value(velocity).map(|v| time * v))
        };
        (0..self.vertices.len()).into_par_iter().map(displacement).collect()
    }
}
