//! What several checks share: questions to the mesh, a look at a body position by position, and the findings.

use std::cell::Cell;

use super::geometry::complexity;
use crate::particles::spans::{lengths_of_chords, lengths_of_spans};
use crate::scene::error::{SceneError, SceneWarning};
use crate::scene::{Analysis, Body, Frame, Mesh, Plane, Shape, Side};
use crate::splines::nurbs::NurbsPatch;
use crate::splines::spline::SplineSpace;

/// Relative tolerance of lengths: of "inside", "on the side" and "covers the mesh", of the size of the mesh
/// or body.
pub(super) const TOLERANCE: f64 = crate::splines::spline::ROUND_OFF;

/// Most positions along a line.
pub(super) const MOST_POSITIONS: usize = 10_000;

/// Most tests of a position against a corner or circle, over all lines of a body: a tenth of a second.
const MOST_LOOKS: usize = 10_000_000;

/// Such tests that cost as much as to find a position on a general patch.
const COST_OF_LOCATING: usize = 200;

/// What several checks ask of the mesh, found once: a general patch is not made for every body and crack.
pub(super) struct Ground<'a> {
    pub mesh: &'a Mesh,
    pub is_sound: bool,
    /// The geometry, if the mesh has one that is sound.
    pub patch: Option<NurbsPatch>,
    /// Smallest and largest span of that, m.
    pub patch_spans: [f64; 2],
    /// Spline spaces of both directions, if the mesh is sound.
    pub spaces: Option<[SplineSpace; 2]>,
}

impl<'a> Ground<'a> {
    pub(super) fn new(mesh: &'a Mesh, is_sound: bool, patch: Option<NurbsPatch>) -> Self {
        let patch_spans = patch.as_ref().map_or([f64::INFINITY, 0.0], lengths_of_chords);
        let spaces = is_sound.then(|| [0, 1].map(|d| SplineSpace::new(mesh.degree[d], &mesh.knots[d])));
        Self { mesh, is_sound, patch, patch_spans, spaces }
    }

    /// Smallest and largest span under a shape, m.
    pub(super) fn span_lengths(&self, shape: &Shape) -> [f64; 2] {
        if self.patch.is_some() { self.patch_spans } else { lengths_of_spans(self.mesh, shape) }
    }
}

/// A body looked at position by position.
pub(super) struct Look<'a> {
    pub body: &'a Body,
    pub ground: &'a Ground<'a>,
    /// End of the simulated time, s.
    pub end_time: f64,
    pub frame: Frame,
    pub plane: Plane,
    tolerance: f64,
    /// Parameters of the last position found on the patch.
    last: Cell<Option<[f64; 2]>>,
    /// Most positions along one line: the more lines and corners, the fewer.
    pub most: usize,
}

impl<'a> Look<'a> {
    pub(super) fn new(body: &'a Body, ground: &'a Ground<'a>, analysis: &Analysis) -> Self {
        let (min, max) = ground.mesh.extent(&body.shape);
        let lines = body.cracks.len() + body.tractions.len() + body.conditions.len();
        let cost = lines * (complexity(&body.shape) + if ground.patch.is_some() { COST_OF_LOCATING } else { 0 });
        Self {
            body,
            ground,
            end_time: analysis.end_time,
            frame: analysis.frame,
            plane: analysis.plane,
            tolerance: TOLERANCE * (max[0] - min[0]).max(max[1] - min[1]),
            last: Cell::new(None),
            most: (MOST_LOOKS / cost.max(1)).clamp(2, MOST_POSITIONS),
        }
    }

    pub(super) fn is_outside(&self, position: [f64; 2]) -> bool {
        let off_patch = || self.ground.patch.as_ref().is_some_and(|patch| !self.is_on(patch, position));
        !self.body.shape.contains_within(position, self.tolerance) || off_patch()
    }

    /// Whether a position (m) is on a patch; searched from the one before, which is near.
    fn is_on(&self, patch: &NurbsPatch, position: [f64; 2]) -> bool {
        let found = patch.locate(position, self.last.get());
        found.map(|location| self.last.set(Some(location.parameters))).is_ok()
    }

    /// First of about `intervals + 1` equally spaced positions (m) between two ends, both included, that is
    /// not in the closure of the body.
    pub(super) fn first_outside(&self, [from, to]: [[f64; 2]; 2], intervals: usize) -> Option<[f64; 2]> {
        let intervals = intervals.min(self.most - 1);
        let position = |i: usize| {
            let t = i as f64 / intervals as f64;
            [0, 1].map(|d| (1.0 - t) * from[d] + t * to[d])
        };
        (0..=intervals).map(position).find(|p| self.is_outside(*p))
    }
}

/// What the checks found so far.
#[derive(Default)]
pub(super) struct Findings {
    pub errors: Vec<SceneError>,
    pub warnings: Vec<SceneWarning>,
}

impl Findings {
    pub(super) fn error(&mut self, key: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        self.errors.push(SceneError { key: key.into(), message: message.into(), remedy: remedy.into() });
    }

    pub(super) fn warn(&mut self, key: impl Into<String>, message: impl Into<String>) {
        self.warnings.push(SceneWarning { key: key.into(), message: message.into() });
    }

    /// An error unless `value` is positive and finite; `like` is an example with its unit.
    pub(super) fn positive(&mut self, key: impl Into<String>, value: f64, like: &str) -> bool {
        let holds = value > 0.0 && value.is_finite();
        if !holds {
            self.error(key, format!("{value} is not positive"), format!("give a positive value such as {like}"));
        }
        holds
    }

    /// An error unless all values are finite.
    pub(super) fn finite(&mut self, key: impl Into<String>, values: &[f64]) -> bool {
        let holds = values.iter().all(|v| v.is_finite());
        if !holds {
            self.error(key, "not a finite number", "give finite numbers");
        }
        holds
    }
}

/// A side, as a scene file names it.
pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
        Side::Bottom => "bottom",
        Side::Top => "top",
    }
}
