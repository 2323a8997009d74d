//! Constraints of contact: the places where two bodies are near each other, and what acts there.
//!
//! The control points that stand for a place on the boundary of a body are those of its shape functions
//! there, as for loads and conditions on edges (`particles::follower`). Affine velocity fields have their
//! values at the place, and an impulse is spread with neither momentum nor torque lost.

use std::collections::BTreeSet;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::surface::{Center, Surface};
use crate::linear_algebra::control_grid::{ControlGrid, VectorField};
use crate::particles::follower::Follower;
use crate::particles::points::Cells;
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_FUNCTIONS;

/// Depth under the boundary at which there is material, in spans.
const DEPTH: f64 = 0.5;

/// Length of a segment above which it may span a gap, in spans.
const MOST_STRETCH: f64 = 2.0;

/// Weights of control points that stand for a position of a body.
#[derive(Debug, Clone, Copy, Default)]
pub struct BoundaryFunctions {
    weights: [(usize, f64); MAX_FUNCTIONS],
    count: usize,
}

impl BoundaryFunctions {
    /// Stands for `position` (m); `None` if there is no material of the body within a span of it.
    pub fn new(body: &BodyView, position: [f64; 2]) -> Option<Self> {
        let place = Follower::carried(position, body.patch, body.inverse_mass, body.density)?;
        let mut functions = Self { weights: [(0, 0.0); MAX_FUNCTIONS], count: 0 };
        place.for_each_function(body.patch, body.grid, |at, n| {
            functions.weights[functions.count] = (at, fault!("impulse-beside-its-place", n => n * n));
            functions.count += 1;
        });
        Some(functions)
    }

    /// Index in the nodal fields and weight of every control point.
    pub fn weights(&self) -> &[(usize, f64)] {
        &self.weights[..self.count]
    }

    /// Value of a field on the control points at the position.
    pub fn value(&self, field: &VectorField) -> [f64; 2] {
        [0, 1].map(|c| self.weights().iter().map(|&(at, weight)| weight * field[c][at]).sum())
    }
}

/// A body as contact sees it, at the present whole step.
#[derive(Debug, Clone, Copy)]
pub struct BodyView<'a> {
    /// The part of the patch its nodal fields cover.
    pub patch: &'a Patch,
    /// Spans with material points.
    pub cells: &'a Cells,
    /// Its boundary, if it may meet others.
    pub surface: Option<&'a Surface>,
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Inverse of the lumped mass, m/kg; zero where that is negligible.
    pub inverse_mass: &'a [f64],
    /// Density of the undeformed material, kg/m³.
    pub density: f64,
    /// Stiffness κ of its boundary, Pa/m; none if that is rigid.
    pub stiffness: Option<f64>,
    /// Control points and components whose velocity is prescribed.
    pub fixed: &'a BTreeSet<(usize, usize)>,
    /// Velocity half a step ago, m/s.
    pub velocity: &'a VectorField,
    /// Acceleration without contact, m/s².
    pub acceleration: &'a VectorField,
}

impl BodyView<'_> {
    /// Inverse masses with which the components of a control point answer to a force, m/kg: zero where the
    /// velocity is prescribed or the mass negligible.
    pub(crate) fn mobility(&self, at: usize) -> [f64; 2] {
        [0, 1].map(|c| if self.fixed.contains(&(at, c)) { 0.0 } else { self.inverse_mass[at] })
    }
}

/// A place, as large as a span, where the boundaries of two bodies are near each other.
#[derive(Debug, Clone)]
pub struct ContactConstraint {
    /// Gap, m; negative where the boundaries overlap.
    pub gap: f64,
    /// Force that presses the bodies apart, N/m, if their boundaries are not rigid.
    pub(super) pressing: Option<f64>,
    /// Numbers of the bodies a and b; rigid ones are counted after the others, so only b may be rigid.
    pub(super) bodies: [usize; 2],
    /// Column and row of the square it stands for.
    pub(super) square: [usize; 2],
    /// Place between both boundaries where the impulse acts, m.
    pub(super) position: [f64; 2],
    /// Unit normal from a to b.
    pub(super) normal: [f64; 2],
    /// The control points that stand for the position in a and b; a rigid b has none.
    pub(super) on_a: BoundaryFunctions,
    pub(super) on_b: Option<BoundaryFunctions>,
}

/// Impulse at a constraint along normal and tangent, kg/s per unit thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Impulse {
    pub(super) normal: f64,
    pub(super) tangent: f64,
}

impl Impulse {
    pub(super) fn times(self, factor: f64) -> Self {
        Self { normal: factor * self.normal, tangent: factor * self.tangent }
    }
}

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
