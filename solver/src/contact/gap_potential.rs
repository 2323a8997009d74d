//! Contact by a potential of the gap, for bodies in the total frame.
//!
//! Where the boundary of a body lies at a depth d inside another one, that costs energy,
//!
//! ```text
//! E = Σ_(a, b) 1/2 ∫_(∂a) κ/2 d_b(x)² dS,      κ = α min(ρ c²)/h,
//! ```
//!
//! the sum over both orders of every pair, so that neither body is the master of the other, with lengths dS
//! at t = 0. d_b(x) is the distance of a place x that is inside b ([`winding`]) to the nearest place y on
//! the boundary of b. It is continuous also where y jumps from one side of a corner to the other, and so is
//! E. The force on a at x and its opposite on b at y act along the line through both. They keep momentum and
//! angular momentum, and what the potential takes while bodies approach it gives back while they part:
//! contact loses nothing, and no force acts before the gap is closed. The price is a depth of p/κ under a
//! pressure p: a strain times h/α, with the stiffness α over that of a span which the scene chooses
//! (`contact.stiffness`). The critical step counts κ. Where a body is thin its far face does not count
//! ([`thin_parts`]).
//!
//! The boundary of a body may also meet itself, where [`OwnPairs`] says so. Friction acts beside it
//! ([`friction`]). Rigid bodies ([`RigidOutline`]) have an outline and no stiffness of their own; they work
//! on the others with their own velocity V, `−(F(n) · V(n) + F(n+1) · V(n+1)) dt/2` with the forces F on
//! them.
//!
//! The boundaries are the cubics through places and tangents that the displacement moves ([`arc`]), with
//! four Gauss points each, and 32 on a rigid body near a corner of another one. Both are linear in the
//! control values, so the forces are the derivatives of E.
//! Wriggers 2006, *Computational contact mechanics*, section 6.3, has the penalty method; Puso & Laursen
//! 2004, *A mortar segment-to-segment contact method for large deformation solid mechanics*, the reason to
//! integrate over boundaries instead of looking at their nodes.

pub(crate) mod arc;
pub(crate) mod friction;
pub(crate) mod thin_parts;
mod winding;

use super::ContactLedger;
use super::impulse::ContactForce;
use super::motion::NotFollowed;
use super::rigid::{RigidOutline, RigidPose};
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::extremes::{around, larger, smaller};
use crate::linear_algebra::vectors::dot;
use crate::material::elasticity::ElasticModuli;
use crate::splines::quadrature::Rule;
use arc::{BoundaryPlace, Closest, Outline, nearest, rules};
use friction::{ContactPoint, Friction};
use thin_parts::{OwnPairs, ThinParts};

/// Depth, in spans, from which on a boundary is not inside its own body, but on the far side of it.
const FAR_SIDE: f64 = 0.5;
/// Cosine of the normals of two places from which on one is on the far face, if that part is thin.
const BEHIND: f64 = 0.5;
/// Part of the thickness of a thin part that a boundary may be deep in it.
const FOLLOWED: f64 = 0.7;
/// Part of the thickness within which the nearest face counts, also the far one: a back follows its front.
const ENTERED: f64 = 0.1;
/// Depth, in spans, that is followed at least: beside a corner every part is thin.
const LEAST: f64 = 0.25;
/// Distance before a boundary, in spans, at which its own body is looked for, and depth that counts as none:
/// boundaries that touch overlap by round-off.
const SKIN: f64 = 1e-9;

/// Stiffness κ of the boundary (Pa/m) of a body of such a density (kg/m³) for a stiffness α and a shortest
/// span (m).
pub(crate) fn boundary_stiffness(stiffness: f64, moduli: &ElasticModuli, density: f64, span: f64) -> f64 {
    let speed = moduli.dilatational_speed(density);
    stiffness * (density * speed * speed) / span
}

/// A pair of opposite forces, and that of friction beside it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GapForce {
    /// Numbers of the bodies a and b, of which rigid ones are counted last; a body that meets itself is both.
    pub bodies: [usize; 2],
    /// Where it acts on each, m.
    pub places: [[f64; 2]; 2],
    /// The same as the number of the arc and t on it: they move with the material.
    pub labels: [(usize, f64); 2],
    /// Force of the potential on b, per unit thickness, N/m; the opposite force acts on a.
    pub force: [f64; 2],
    /// Force of friction on b, N/m; it acts on both bodies where the other does on b.
    pub friction: Option<[f64; 2]>,
}

impl GapForce {
    /// Gap between the bodies where it acts, m: negative.
    pub(crate) fn gap(&self) -> f64 {
        let [a, b] = self.places;
        -(b[0] - a[0]).hypot(b[1] - a[1])
    }
}

/// Contact of the bodies of a scene.
#[derive(Debug, Clone, Default)]
pub(crate) struct GapPotential {
    /// Depth that contact follows where bodies are thick, m: the shortest span.
    reach: f64,
    rules: [Rule; 2],
    /// They are counted after the bodies that deform.
    rigid: Vec<RigidOutline>,
    /// Of all bodies, in this order.
    thin: Vec<ThinParts>,
    /// What may meet of each body that deforms, if bodies may meet themselves.
    own: Vec<OwnPairs>,
    friction: Option<Friction>,
    pub forces: Vec<GapForce>,
    energy: f64,
    /// Power of rigid bodies now, W/m, and their work so far, J/m.
    power: f64,
    work: f64,
}

impl GapPotential {
    /// Bodies that do not touch on a mesh whose shortest span has this length, m, with a coefficient of
    /// friction, the rigid ones among them, and what may meet of each other one, if they may meet themselves.
    pub(crate) fn new(
        span: f64,
        friction: f64,
        rigid: Vec<RigidOutline>,
        thin: Vec<ThinParts>,
        own: Vec<OwnPairs>,
    ) -> Self {
        let (rules, friction) = (rules(), Friction::new(friction));
        Self { reach: span, rules, rigid, thin, own, friction, ..Self::default() }
    }

    /// Finds the forces at a time, s, `dt` after they were found last, between boundaries that are there now.
    ///
    /// # Errors
    /// If a boundary is deeper in another body than contact follows.
    pub(crate) fn find(&mut self, mut outlines: Vec<Outline>, time: f64, dt: f64) -> Result<(), NotFollowed> {
        let (deformable, alone) = (outlines.len(), self.own.len());
        let (rigid, poses): (Vec<_>, Vec<_>) = self.rigid.iter().map(|body| body.at(time)).unzip();
        outlines.extend(rigid);
        self.forces.clear();
        self.energy = 0.0;
        self.friction.iter_mut().for_each(Friction::begin);
        let boxes: Vec<_> = outlines.iter().map(|outline| around(outline.boxes.iter().copied())).collect();
        for a in 0..outlines.len() {
            let deforms = |b: usize| smaller(outlines[a].spring, outlines[b].spring).is_finite();
            let meets = |b: usize| if a == b { a < alone } else { deforms(b) };
            for b in (0..outlines.len()).filter(|&b| meets(b)) {
                let low = [0, 1].map(|d| larger(boxes[a][0][d], boxes[b][0][d]));
                let high = [0, 1].map(|d| smaller(boxes[a][1][d], boxes[b][1][d]));
                if (0..2).all(|d| low[d] <= high[d]) {
                    self.compare([a, b], &outlines, [low, high])?;
                }
            }
        }
        if let Some(friction) = &mut self.friction {
            friction.end(outlines);
        }
        if !self.rigid.is_empty() {
            let power = self.power_of_rigid_bodies(deformable, &poses);
            self.work += 0.5 * dt * (self.power + power);
            self.power = power;
        }
        Ok(())
    }

    /// What the boundary of a in a box feels of b.
    fn compare(&mut self, [a, b]: [usize; 2], outlines: &[Outline], common: [[f64; 2]; 2]) -> Result<(), NotFollowed> {
        let own = self.own.get(a).filter(|_| a == b);
        let spring = smaller(outlines[a].spring, outlines[b].spring);
        let corners = if outlines[a].spring.is_infinite() { outlines[b].corners() } else { Vec::new() };
        for number in outlines[a].within(common) {
            for (point, t, place) in outlines[a].places(number, &self.rules, &corners, self.reach) {
                let found = match own {
                    None => self.opposite(place, &outlines[b], b),
                    Some(own) => self
                        .opposite_own(place, &outlines[b], |other| own.may_meet(number, other))
                        .map(|nearest| (nearest, self.reach)),
                };
                let Some((nearest, followed)) = found else { continue };
                let depth = nearest.distance;
                if depth <= SKIN * self.reach {
                    continue;
                }
                if depth > followed {
                    let [spans, follows] = [depth, followed].map(|depth| depth / self.reach);
                    return Err(NotFollowed::TooDeep { place: place.position, spans, follows });
                }
                let pressure = 0.5 * spring * depth * place.length;
                self.energy += 0.5 * pressure * depth;
                let (bodies, labels) = ([a, b], [(number, t), nearest.label]);
                let friction = self.friction.as_mut().map(|friction| {
                    let tangent = [-nearest.direction[1], nearest.direction[0]];
                    let point = ContactPoint { bodies, number: point, labels, tangent };
                    friction.force(point, [depth, 0.5 * spring * place.length], outlines)
                });
                self.forces.push(GapForce {
                    bodies,
                    places: [place.position, nearest.position],
                    labels,
                    force: nearest.direction.map(|out| -pressure * out),
                    friction,
                });
            }
        }
        Ok(())
    }

    /// The nearest place on the boundary of another body of this number, if a place of a boundary is inside
    /// it, and the depth that contact follows there, m.
    fn opposite(&self, place: BoundaryPlace, other: &Outline, number: usize) -> Option<(Closest, f64)> {
        let BoundaryPlace { position, normal, .. } = place;
        if !other.contains(position) {
            return None;
        }
        let near = || other.within([position.map(|x| x - self.reach), position.map(|x| x + self.reach)]);
        let found = nearest(position, other, near(), |_| true)
            .or_else(|| nearest(position, other, 0..other.arcs.len(), |_| true))?;
        let thin = &self.thin[number];
        let behind = |(arc, t): (usize, f64)| thin.is_thin(arc) && dot(other.arcs[arc].normal(t), normal) > BEHIND;
        if behind(found.label)
            && let Some(front) = nearest(position, other, near(), |label| !behind(label))
        {
            let thickness = front.distance + found.distance;
            if found.distance > ENTERED * thickness {
                return Some((front, smaller(larger(FOLLOWED * thickness, LEAST * self.reach), self.reach)));
            }
        }
        fault!("depth-between-facing-places-only", true => dot(normal, found.direction) < 0.0)
            .then_some((found, self.reach))
    }

    /// The nearest of the places that it may meet on the boundary of its own body, if it is inside that.
    fn opposite_own(
        &self,
        place: BoundaryPlace,
        outline: &Outline,
        may_meet: impl Fn(usize) -> bool,
    ) -> Option<Closest> {
        let BoundaryPlace { position, normal, .. } = place;
        let before = [0, 1].map(|d| position[d] + SKIN * self.reach * normal[d]);
        if fault!("own-boundary-meets-from-afar", !outline.contains(before) => false) {
            return None;
        }
        let far = FAR_SIDE * self.reach;
        let near = outline.within([position.map(|x| x - far), position.map(|x| x + far)]);
        let nearest = nearest(position, outline, near.filter(|other| may_meet(*other)), |_| true);
        nearest.filter(|nearest| nearest.distance <= far)
    }

    /// Power of the rigid bodies, which are counted from `first`, on the others, W/m.
    fn power_of_rigid_bodies(&self, first: usize, poses: &[RigidPose]) -> f64 {
        let on = |body: usize, place: [f64; 2], force: [f64; 2]| {
            body.checked_sub(first).map_or(0.0, |rigid| -dot(force, poses[rigid].velocity_at(place)))
        };
        let of_pair = |pair: &GapForce| {
            let GapForce { bodies: [a, b], places: [x, y], labels: _, force, friction } = *pair;
            let friction = friction.unwrap_or_default();
            on(a, x, force.map(|f| -f)) + on(b, y, force) + on(a, y, friction.map(|f| -f)) + on(b, y, friction)
        };
        self.forces.iter().map(of_pair).sum()
    }

    /// The same as forces on the body of the higher number.
    pub(crate) fn contact_forces(&self) -> Vec<ContactForce> {
        let ordered = |pair: &GapForce| {
            let GapForce { bodies: [a, b], places, labels: _, force, friction } = *pair;
            let position = [0, 1].map(|d| 0.5 * (places[0][d] + places[1][d]));
            let force = friction.map_or(force, |friction| [0, 1].map(|d| force[d] + friction[d]));
            if a < b {
                ContactForce { bodies: [a, b], position, force }
            } else {
                ContactForce { bodies: [b, a], position, force: force.map(|f| -f) }
            }
        };
        self.forces.iter().map(ordered).collect()
    }

    /// What contact took and gave so far: the energy that potential and slip hold is lost to the bodies.
    pub(crate) fn ledger(&self) -> ContactLedger {
        let Self { energy, work, friction, .. } = self;
        let [stored, dissipated] = friction.as_ref().map_or([0.0; 2], |f| [f.stored, f.dissipated]);
        ContactLedger { loss: energy + stored + dissipated, friction: dissipated, work: *work }
    }

    /// Stores or takes up what steps change: a history of slip and what was booked. Forces follow from it.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { reach: _, rules: _, rigid: _, thin: _, own: _, friction, forces: _, energy: _, power: _, work } =
            self;
        friction.iter_mut().try_for_each(|friction| friction.exchange(archive))?;
        if !self.rigid.is_empty() {
            archive.value(work)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
