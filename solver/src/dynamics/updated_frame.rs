//! Explicit dynamics in the updated frame: points carry everything, the grid is rebuilt at every step (lumped
//! mass).
//!
//! Between two whole steps n and n + 1 the shape functions are means over the domains of the points as they
//! are at n ([`transfer`]). The scheme is velocity Verlet written as one full kick on the rebuilt grid; no
//! acceleration outlives its grid. What the points take from the grid is the transfer's choice: see
//! [`velocity_transfer`]. Strains are small, the sum of `dt sym(grad v(n + 1/2))`, or finite: Hencky strains
//! of the deformation gradient of each point with Kirchhoff stresses, so that the internal force is
//! `Σ V tau grad N` with the reference volume V ([`crate::material::hencky`]). Every loss of a transfer is
//! measured: see [`losses`].
//!
//! Every body is a discrete field of its own ([`field`]), with its own mass, momentum, force and phase field
//! on the shared patch. Bodies meet through [`crate::contact`], if the scene declares it: its impulses are
//! part of the kick. A body that is cracked through becomes several fields ([`fragments`]).
//!
//! # The critical step
//!
//! It is shorter than the `2/ω_max` of a grid that keeps its velocity. For points at rest a mode of the grid
//! obeys `u ← u + dt (v − dt ω² u)`, `v ← v − dt s ω² u` with FLIP, where 0 ≤ s ≤ 1 is what the way to the
//! points and back (`M⁻¹` times the consistent mass) leaves of an increment. The mode is stable up to
//! `ω dt = 2/√(2 − s)`: 1.46 for the shortest waves of quadratic splines, and √2 for what the points do not
//! see. [`UpdatedFrame::critical_step`] is √2/ω_max for every transfer
//! ([`velocity_transfer`]). With finite strains ω_max is that of the stiffness without the geometric part.

pub(crate) mod affine;
pub mod assembly;
mod begin;
mod conditions;
pub mod fictitious;
pub mod field;
mod fragments;
pub mod grid;
mod held_edges;
pub(crate) mod held_sides;
mod inspect;
pub(crate) mod loads;
pub(crate) mod losses;
pub(crate) mod observe;
mod pieces;
pub(crate) mod pointwise_fracture;
pub(crate) mod stiffness;
pub mod strain;
pub mod transfer;
pub(crate) mod velocity_transfer;
pub(crate) mod verify;
pub mod windows;

use std::sync::Arc;

use crate::contact::impulse::Kick;
use crate::contact::{BodyView, ContactSolver};
use crate::dynamics::body_sample;
use crate::dynamics::failure::Failure;
use crate::linear_algebra::extremes::smaller;
use crate::scene::Scene;
use crate::splines::patch::Patch;
use field::DiscreteField;

/// The bodies of a scene in the updated frame.
#[derive(Debug, Clone)]
pub struct UpdatedFrame {
    /// Background patch of the whole mesh; the nodal fields of a body cover a part of it.
    pub patch: Arc<Patch>,
    /// The fields of the bodies that deform: of those that are whole, or of fragments.
    pub fields: Vec<DiscreteField>,
    /// Number of the body that each field is of, or is a fragment of.
    bodies: Vec<usize>,
    /// Contact of the bodies, if the scene declares it.
    pub contact: Option<ContactSolver>,
    /// Steps since bodies were checked for fragments, if they may fall into some.
    fragments: Option<usize>,
    thickness: f64,
    /// Names in columns of the bodies that are recorded one by one, rigid ones last.
    recorded: Option<Vec<String>>,
}

impl UpdatedFrame {
    /// The bodies of `scene` at t = 0 with their initial accelerations.
    ///
    /// # Errors
    /// If an initial phase field does not converge, or a point is not on the patch.
    pub fn new(scene: &Scene) -> Result<Self, Failure> {
        let patch = Arc::new(Patch::new(&scene.mesh));
        let deformable = scene.bodies.iter().enumerate().filter(|(_, body)| !body.rigid);
        let field = |(number, body): (usize, &_)| {
            DiscreteField::new(scene, body, &patch).map_err(|failure| failure.of_body(number))
        };
        let fields = deformable.map(field).collect::<Result<Vec<_>, _>>()?;
        let bodies = (0..fields.len()).collect();
        let contact = ContactSolver::new(scene, &patch);
        let recorded = scene.output.bodies.then(|| body_sample::names(scene));
        let parts = scene.contact.as_ref().is_some_and(|contact| contact.fragments);
        let fragments = parts.then_some(0);
        let thickness = scene.analysis.thickness;
        let mut frame = Self { patch, fields, bodies, contact, fragments, thickness, recorded };
        frame.part_at_start()?;
        if let Some(contact) = &mut frame.contact {
            contact.find(&views(&frame.fields))?;
        }
        Ok(frame)
    }

    /// Looks as far ahead as steps of `dt` seconds need, before the first one.
    ///
    /// # Errors
    /// If bodies are about to meet that approach each other too far in a step.
    pub fn prepare(&mut self, dt: f64) -> Result<(), Failure> {
        self.fields.iter_mut().try_for_each(|field| field.prepare(dt))?;
        let Some(contact) = &mut self.contact else { return Ok(()) };
        self.fields.iter_mut().for_each(|field| field.expect_motion(dt));
        contact.set_step(dt);
        contact.move_rigid(0.0);
        contact.find(&views(&self.fields))?;
        Ok(())
    }

    /// One time step of `dt` seconds.
    ///
    /// # Errors
    /// If a phase field does not converge, a point leaves the patch, impulses of contact do not converge, or
    /// bodies meet that approach each other too far in a step.
    pub fn step(&mut self, dt: f64) -> Result<(), Failure> {
        let kick = self.coming_kick(dt);
        let Self { fields, contact, .. } = self;
        if let Some(contact) = contact {
            contact.set_step(dt);
            for push in contact.act(&views(fields), kick)? {
                fields[push.body].add_acceleration(push.at, push.acceleration);
            }
            fields.iter_mut().for_each(|field| field.hold_pushed(dt));
        }
        fields.iter_mut().try_for_each(|field| field.step(dt))?;
        self.part_if_due(dt)?;
        let Self { fields, contact, .. } = self;
        if let Some(contact) = contact {
            contact.move_rigid(fields[0].time());
            contact.find(&views(fields))?;
        }
        Ok(())
    }

    /// The kick of the coming step: the same for all bodies.
    fn coming_kick(&self, dt: f64) -> Kick {
        Kick { length: self.fields[0].kick_length(dt), step: dt }
    }

    /// Critical time step of the undamaged bodies at the present positions, s; infinite if nothing can move.
    pub fn critical_step(&self) -> f64 {
        self.fields.iter().map(|field| field.critical_step()).fold(f64::INFINITY, smaller)
    }

    /// Takes the critical time step (s) again if a point may have moved a quarter of the shortest span since
    /// it was last taken.
    pub fn retake_critical_step(&mut self) -> Option<f64> {
        if !self.fields.iter().any(DiscreteField::has_moved) {
            return None;
        }
        self.fields.iter_mut().for_each(|field| field.travelled = 0.0);
        Some(self.critical_step())
    }
}

/// The bodies as contact sees them.
fn views(fields: &[DiscreteField]) -> Vec<BodyView<'_>> {
    fields.iter().map(DiscreteField::view).collect()
}
