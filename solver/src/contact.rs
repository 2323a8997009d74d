//! Frictional contact between the discrete fields of bodies, and with rigid bodies.
//!
//! The boundary of a body is a line of segments that moves with it ([`Surface`]): bodies meet where their
//! boundaries do, though supports of quadratic and cubic splines overlap up to three spans earlier. The
//! centre of every segment that faces another boundary measures the signed gap to it. What the segments of
//! both bodies measure within a square as large as a span is one [`ContactConstraint`]: its position x and
//! gap g are their means, with more weight where the gap is smaller. So constraints are as many as control
//! points can tell apart, and neither body is the master of the other. An impulse P acts there on one body,
//! −P on the other. Both spread it over control points with weights W that stand for the same position x
//! ([`mod@constraint`]),
//!
//! ```text
//! f_I = ± W_I P,        v_rel = Σ W_I^b v_I^b − Σ W_I^a v_I^a,        Σ W_I = 1,   Σ W_I x_I = x,
//! ```
//!
//! which keeps momentum and angular momentum to round-off. The normal is that between both boundaries, the
//! same for both bodies but for its sign. On a rigid body it is that of the rigid boundary, except at its
//! corners: a smooth rigid surface without friction pushes along its normal only. Impulses are the smallest
//! that keep every gap from closing further than it is open, `v_rel · n ≥ −max(g, 0)/dt`, with Coulomb
//! friction: they stop sliding or are the coefficient times their normal part. They never pull, and never
//! push apart. They are found constraint by constraint until they converge (projected Gauss–Seidel),
//! starting from those of the step before.
//!
//! That takes from an impact the energy of about a span. Where the scene gives boundaries a stiffness κ they
//! overlap instead, and the normal force is that of the potential which contact has in the total frame
//! ([`gap_potential`]), `Σ κ d dS/2` over the segments of both bodies with depths d. Friction is found as
//! before.
//!
//! The force P/dt acts over a kick from w to v, so `−P · (w + v)/2`, with w and v relative velocities, is
//! lost: that is the contact loss of the ledger, half of it booked with the velocity the step begins with,
//! half with the one it ends with. A rigid body does external work with its own velocity.

pub mod constraint;
pub(crate) mod crack_faces;
mod encounter;
pub(crate) mod gap_potential;
pub mod impulse;
pub(crate) mod motion;
pub(crate) mod outline;
pub(crate) mod rigid;
pub(crate) mod surface;

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::extremes::{around, larger, smaller};
use crate::linear_algebra::vectors::{dot, unit};
use crate::scene::Scene;
use crate::splines::patch::Patch;
pub use constraint::{BodyView, ContactConstraint};
use constraint::{BoundaryFunctions, Impulse};
use encounter::{Encounter, Sight, Squares};
use motion::{AHEAD, MOST, NotFollowed};
pub(crate) use rigid::RigidBody;
use surface::Center;
pub use surface::Surface;

/// Cosine of the angle between outward normals above which boundaries do not face each other.
const FACING: f64 = -0.5;
/// Cosine up to which a place on one boundary that is inside the other body is held back by the face there:
/// the flanks of a wedge of half angle 3° or more. Beside a right corner that is pressed in the faces of the
/// corner do not meet the face beneath.
const CUTTING: f64 = -0.05;
/// Cosine from which on the nearest face is the far side of a thin body that a boundary is deep in; and the
/// depth under it, in spans, that is none: faces of bodies on each other may lie in one line.
const BEHIND: f64 = 0.5;
const FLUSH: f64 = 0.1;
/// Gap up to which a constraint is looked at, in spans, unless more could close in a step.
const NEAR: f64 = 0.1;

/// What contact took and gave so far, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactLedger {
    /// Energy that bodies lost to contact, J/m; energy stored in the contact potential counts as lost.
    pub loss: f64,
    /// The part of it that friction took.
    pub friction: f64,
    /// Work of rigid bodies.
    pub work: f64,
}

/// Contact of the bodies of a scene.
#[derive(Debug, Clone)]
pub struct ContactSolver {
    friction: f64,
    /// Whether boundaries are not rigid.
    soft: bool,
    squares: Squares,
    /// Shortest span of the patch, m.
    reach: f64,
    rigid: Vec<RigidBody>,
    /// Where bodies are near each other.
    pub constraints: Vec<ContactConstraint>,
    /// Length of a step, s.
    step: f64,
    /// Forces of the last step (impulses per second), where to start from.
    pub(crate) last: BTreeMap<([usize; 2], [usize; 2]), Impulse>,
    /// What contact took and gave so far.
    pub(crate) ledger: ContactLedger,
}

impl ContactSolver {
    /// Contact of a scene, if it declares any.
    pub fn new(scene: &Scene, whole: &Patch) -> Option<Self> {
        Some(Self {
            friction: scene.contact.as_ref()?.friction,
            soft: scene.contact.as_ref()?.stiffness.is_some(),
            squares: Squares::new(whole),
            reach: whole.shortest_span(),
            rigid: scene.bodies.iter().filter(|b| b.rigid).map(|b| RigidBody::new(&scene.mesh, b)).collect(),
            constraints: Vec::new(),
            step: 0.0,
            last: BTreeMap::new(),
            ledger: ContactLedger::default(),
        })
    }

    /// Takes the length of a step, s.
    pub(crate) fn set_step(&mut self, dt: f64) {
        self.step = dt;
    }

    /// Moves the rigid bodies to where they are at a time, s.
    pub(crate) fn move_rigid(&mut self, time: f64) {
        self.rigid.iter_mut().for_each(|body| body.move_to(time, self.step));
    }

    /// Finds where bodies are near each other now.
    ///
    /// # Errors
    /// If bodies are about to meet that approach each other too far in a step, or boundaries that are not
    /// rigid are too deep in each other.
    pub fn find(&mut self, bodies: &[BodyView]) -> Result<(), NotFollowed> {
        let surfaces: Vec<&Surface> =
            bodies.iter().filter_map(|body| body.surface).chain(self.rigid.iter().map(|r| &r.surface)).collect();
        let boxes: Vec<_> = surfaces.iter().map(|surface| surface.bounding_box()).collect();
        let displacements: Vec<_> =
            surfaces.iter().map(|surface| around(surface.displacements.iter().map(|way| [*way; 2]))).collect();
        let mut encounters = Vec::new();
        for b in 1..surfaces.len() {
            for a in 0..b.min(bodies.len()) {
                // Vertices pass each other by so much at most.
                let past = |d: usize| {
                    let ([low, high], [other_low, other_high]) = (displacements[a], displacements[b]);
                    (high[d] - other_low[d]).max(other_high[d] - low[d]).max(0.0)
                };
                let reach = self.reach + AHEAD * past(0).hypot(past(1));
                let common = [
                    [0, 1].map(|d| boxes[a][0][d].max(boxes[b][0][d]) - reach),
                    [0, 1].map(|d| boxes[a][1][d].min(boxes[b][1][d]) + reach),
                ];
                if (0..2).all(|d| common[0][d] <= common[1][d]) {
                    encounters.extend(self.compare(
                        [surfaces[a], surfaces[b]],
                        [a, b],
                        b >= bodies.len(),
                        common,
                        reach,
                    )?);
                }
            }
        }
        self.constraints = encounters.iter().filter_map(|encounter| self.constraint(encounter, bodies)).collect();
        Ok(())
    }

    /// What the segments of two boundaries in a box see of each other, no further than `reach` (m), square by
    /// square: across gaps that are small, or could close in a step. The second body may be rigid.
    fn compare(
        &self,
        surfaces: [&Surface; 2],
        bodies: [usize; 2],
        is_rigid: bool,
        common: [[f64; 2]; 2],
        reach: f64,
    ) -> Result<Vec<Encounter>, NotFollowed> {
        let mut squares = BTreeMap::new();
        let segments = surfaces.map(|surface| surface.segments_in(common));
        for (own, other, sign) in [(0, 1, 1.0), (1, 0, -1.0)] {
            for &segment in &segments[own] {
                let Center { position, normal, displacement, length } = surfaces[own].center(segment);
                let Some(nearest) = surfaces[other].nearest(position, &segments[other], reach) else { continue };
                let cosine = dot(normal, nearest.normal);
                let (depth, follows) = (-nearest.distance / self.reach, if cosine > BEHIND { FLUSH } else { MOST });
                if self.soft && depth > follows {
                    return Err(NotFollowed::TooDeep { place: position, spans: depth, follows });
                }
                let is_cutting = cosine > FACING;
                if is_cutting && (cosine > fault!("flanks-not-met", CUTTING => FACING) || nearest.distance >= 0.0) {
                    continue;
                }
                let at_rigid = fault!("rigid-normal-between-both", is_rigid => false);
                let outward = if at_rigid && own == 1 {
                    normal
                } else if is_cutting || at_rigid && nearest.is_smooth {
                    nearest.normal.map(|n| -n)
                } else {
                    [0, 1].map(|d| normal[d] - nearest.normal[d])
                };
                let halfway = outward.map(|n| sign * n);
                let along = fault!("normal-of-one-body", halfway => if own == 0 { normal } else { nearest.normal });
                let Some(normal) = unit(along, 1.0) else { continue };
                let closing = sign * dot([0, 1].map(|d| displacement[d] - nearest.displacement[d]), normal);
                let near = larger(NEAR * self.reach, AHEAD * closing);
                if nearest.distance > near {
                    continue;
                }
                if closing > MOST * self.reach {
                    return Err(NotFollowed::TooFast { place: position, spans: closing / self.reach });
                }
                let middle = [0, 1].map(|d| position[d] + 0.5 * sign * nearest.distance * normal[d]);
                let square = self.squares.of(middle);
                let sight = Sight { position: middle, gap: nearest.distance, normal, length };
                let encounter = || Encounter { bodies, square, seen: Vec::new(), span: self.reach, soft: self.soft };
                squares.entry(square).or_insert_with(encounter).seen.push(sight);
            }
        }
        Ok(Encounter::merged(squares.into_values(), &self.squares))
    }

    /// The constraint of a square; none if a body has no material there.
    fn constraint(&self, encounter: &Encounter, bodies: &[BodyView]) -> Option<ContactConstraint> {
        let Encounter { bodies: pair @ [a, b], square, .. } = *encounter;
        let softer =
            |stiffness: f64| bodies.get(b).map_or(stiffness, |b| smaller(stiffness, b.stiffness.unwrap_or(stiffness)));
        let pressing = bodies[a].stiffness.map(|stiffness| softer(stiffness) * encounter.overlap());
        if pressing == Some(0.0) {
            return None; // not yet
        }
        let position = encounter.position();
        let normal = encounter.direction()?;
        let on_a = BoundaryFunctions::new(&bodies[a], position)?;
        let on_b = match bodies.get(b) {
            Some(body) => Some(BoundaryFunctions::new(body, position)?),
            None => None,
        };
        let gap = encounter.gap();
        Some(ContactConstraint { gap, pressing, bodies: pair, square, position, normal, on_a, on_b })
    }

    /// Whether boundaries are not rigid.
    pub(crate) fn is_soft(&self) -> bool {
        self.soft
    }

    /// Stores or takes up what steps change. Rigid bodies and constraints follow from time and bodies.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { friction: _, soft: _, squares: _, reach: _, rigid: _, constraints: _, step, last, ledger } = self;
        archive.value(step)?;
        archive.value(last)?;
        archive.value(ledger)
    }
}
