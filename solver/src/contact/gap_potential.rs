//! Contact by a potential of the gap, for bodies whose spans integrate.
//!
//! Where the boundary of a body lies at a depth d inside another one, that costs energy,
//!
//! ```text
//! E = Σ_(a, b) 1/2 ∫_(∂a) κ/2 d_b(x)² ds,      κ = α min(ρ c²)/h,
//! ```
//!
//! the sum over both orders of every pair, so that neither body is the master of the other. d_b(x) is the
//! distance to the nearest place y on the boundary of b; the force on a at x and its opposite on b at y act
//! along the line through both. They keep momentum and angular momentum, and what the potential takes while
//! bodies approach it gives back while they part: contact loses nothing, and no force acts before the gap is
//! closed. The price is a depth of p/κ under a pressure p: a strain times h/α, with the stiffness α over that
//! of a span which the scene chooses (`contact.stiffness`). The critical step counts κ.
//!
//! Friction acts beside it ([`friction`]). Rigid bodies ([`rigid_outline`]) have an outline and no stiffness
//! of their own; they work on the others with their own velocity, `−(F(n) · V(n) + F(n+1) · V(n+1)) dt/2` with
//! the forces F on them.
//!
//! The boundaries are the cubics through the places and tangents that the inverse of the motion gives
//! ([`arc`]), with four Gauss points each. Wriggers 2006, *Computational contact mechanics*, section 6.3, has
//! the penalty method; Puso & Laursen 2004, *A mortar segment-to-segment contact method for large deformation
//! solid mechanics*, the reason to integrate over boundaries instead of looking at their nodes.

pub(crate) mod arc;
pub(crate) mod friction;
pub(crate) mod rigid_outline;

use super::ContactLedger;
use super::impulse::ContactForce;
use super::motion::TooFast;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::dot;
use crate::splines::quadrature::Rule;
use arc::{Arc, Outline, around, nearest, rule};
use friction::{Friction, Meeting};
use rigid_outline::RigidOutline;

/// A pair of opposite forces, and that of friction beside it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GapForce {
    /// Bodies a and b.
    pub bodies: [usize; 2],
    /// Where it acts on each, m.
    pub places: [[f64; 2]; 2],
    /// Force on b, N/m.
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
#[derive(Debug, Clone)]
pub(crate) struct GapPotential {
    /// Depth that is too much, m.
    reach: f64,
    rule: Rule,
    /// They are counted after the bodies that deform.
    rigid: Vec<RigidOutline>,
    friction: Option<Friction>,
    forces: Vec<GapForce>,
    energy: f64,
    /// Power of rigid bodies now, W/m, and their work so far, J/m.
    power: f64,
    work: f64,
}

impl GapPotential {
    /// Bodies that do not touch on a mesh whose shortest span has this length, m, with the rigid ones among
    /// them and a coefficient of friction.
    pub(crate) fn new(span: f64, friction: f64, rigid: Vec<RigidOutline>) -> Self {
        Self {
            reach: span,
            rule: rule(),
            rigid,
            friction: Friction::new(friction),
            forces: Vec::new(),
            energy: 0.0,
            power: 0.0,
            work: 0.0,
        }
    }

    /// Finds the forces at a time, s, `dt` after they were found last, between boundaries that are there now.
    ///
    /// # Errors
    /// If a boundary is a span deep in another body.
    pub(crate) fn find(&mut self, mut outlines: Vec<Outline>, time: f64, dt: f64) -> Result<(), TooFast> {
        let deformable = outlines.len();
        outlines.extend(self.rigid.iter().map(|body| body.at(time)));
        self.forces.clear();
        self.energy = 0.0;
        self.friction.iter_mut().for_each(Friction::begin);
        let boxes: Vec<_> = outlines.iter().map(|outline| around(outline.arcs.iter().map(Arc::bounds))).collect();
        for a in 0..outlines.len() {
            for b in
                (0..outlines.len()).filter(|&b| b != a && smaller(outlines[a].spring, outlines[b].spring).is_finite())
            {
                let low = [0, 1].map(|d| larger(boxes[a][0][d], boxes[b][0][d]));
                let high = [0, 1].map(|d| smaller(boxes[a][1][d], boxes[b][1][d]));
                if (0..2).all(|d| low[d] <= high[d]) {
                    self.compare([a, b], &outlines, [low, high])?;
                }
            }
        }
        self.friction.iter_mut().for_each(Friction::end);
        if !self.rigid.is_empty() {
            let power = self.power_of_rigid_bodies(deformable, time);
            self.work += 0.5 * dt * (self.power + power);
            self.power = power;
        }
        Ok(())
    }

    /// What the boundary of a in a box feels of b.
    fn compare(&mut self, [a, b]: [usize; 2], outlines: &[Outline], common: [[f64; 2]; 2]) -> Result<(), TooFast> {
        let meets = |arc: &Arc, [low, high]: [[f64; 2]; 2]| {
            let [own_low, own_high] = arc.bounds();
            (0..2).all(|d| own_high[d] >= low[d] && own_low[d] <= high[d])
        };
        let within = |body: usize, region: [[f64; 2]; 2]| {
            outlines[body].arcs.iter().enumerate().filter(move |(_, arc)| meets(arc, region))
        };
        let wider = [common[0].map(|x| x - self.reach), common[1].map(|x| x + self.reach)];
        let other: Vec<(usize, &Arc)> = within(b, wider).collect();
        let spring = smaller(outlines[a].spring, outlines[b].spring);
        for (number, arc) in within(a, common) {
            for (point, place) in arc.places(&self.rule).enumerate() {
                let Some(nearest) = nearest(place.position, &other) else { continue };
                if dot(place.normal, nearest.normal) >= 0.0 || nearest.depth <= 0.0 {
                    continue;
                }
                let depth = nearest.depth;
                if depth > self.reach {
                    return Err(TooFast { place: place.position, spans: depth / self.reach });
                }
                let out = [0, 1].map(|d| (nearest.position[d] - place.position[d]) / depth);
                let pressure = 0.5 * spring * depth * place.length;
                self.energy += 0.5 * pressure * depth;
                let friction = self.friction.as_mut().map(|friction| {
                    let (label, stiffness) = (([a, b], number, point), 0.5 * spring * place.length);
                    friction.force(&Meeting { label, place, nearest, arcs: &outlines[b].arcs, stiffness })
                });
                self.forces.push(GapForce {
                    bodies: [a, b],
                    places: [place.position, nearest.position],
                    force: out.map(|out| -pressure * out),
                    friction,
                });
            }
        }
        Ok(())
    }

    /// Power of the rigid bodies, which are counted from `first`, on the others, W/m.
    fn power_of_rigid_bodies(&self, first: usize, time: f64) -> f64 {
        let on = |body: usize, place: [f64; 2], force: [f64; 2]| {
            let velocity = |rigid: &RigidOutline| rigid.velocity_at(place, time);
            body.checked_sub(first).map_or(0.0, |rigid| -dot(force, velocity(&self.rigid[rigid])))
        };
        let of_pair = |pair: &GapForce| {
            let GapForce { bodies: [a, b], places: [x, y], force, friction } = *pair;
            let rubbing = friction.unwrap_or_default();
            on(a, x, force.map(|f| -f)) + on(b, y, force) + on(a, y, rubbing.map(|f| -f)) + on(b, y, rubbing)
        };
        self.forces.iter().map(of_pair).sum()
    }

    /// The forces that were found last.
    pub(crate) fn forces(&self) -> &[GapForce] {
        &self.forces
    }

    /// The same as forces on the body of the higher number.
    pub(crate) fn contact_forces(&self) -> Vec<ContactForce> {
        let ordered = |pair: &GapForce| {
            let GapForce { bodies: [a, b], places, force, friction } = *pair;
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
        let [stored, dissipated] = friction.as_ref().map_or([0.0; 2], |f| [f.stored(), f.dissipated()]);
        ContactLedger { loss: energy + stored + dissipated, friction: dissipated, work: *work }
    }

    /// Stores or takes up what steps change: a history of slip and what was booked. Forces follow from it.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { reach: _, rule: _, rigid: _, friction, forces: _, energy: _, power: _, work } = self;
        if let Some(friction) = friction {
            friction.exchange(archive)?;
        }
        if !self.rigid.is_empty() {
            archive.value(work)?;
        }
        Ok(())
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let rigid: usize = self.rigid.iter().map(RigidOutline::bytes).sum();
        rigid + self.forces.len() * size_of::<GapForce>() + self.friction.as_ref().map_or(0, Friction::bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::rigid::RigidMotion;

    /// A circle in so many arcs.
    fn circle(center: [f64; 2], radius: f64, count: usize) -> Outline {
        let turn = std::f64::consts::TAU / count as f64;
        let at = |i: usize| {
            let (sin, cos) = (turn * i as f64).sin_cos();
            ([center[0] + radius * cos, center[1] + radius * sin], [-radius * turn * sin, radius * turn * cos])
        };
        let arc = |i: usize| Arc::new([at(i).0, at(i + 1).0], [at(i).1, at(i + 1).1]);
        Outline { arcs: (0..count).map(arc).collect(), spring: 2.0 }
    }

    fn pair(apart: f64) -> Vec<Outline> {
        vec![circle([0.0; 2], 1.0, 64), circle([apart * 0.8, apart * 0.6], 1.0, 60)]
    }

    fn found(apart: f64) -> GapPotential {
        let mut potential = GapPotential::new(0.1, 0.0, vec![]);
        potential.find(pair(apart), 0.0, 0.0).unwrap();
        potential
    }

    #[test]
    fn circles_that_do_not_overlap_feel_nothing() {
        assert!(found(2.0 + 1e-5).forces().is_empty());
        assert!(!found(2.0 - 1e-3).forces().is_empty());
    }

    #[test]
    fn the_force_is_the_derivative_of_the_energy_and_has_no_moment() {
        let (apart, step) = (1.98, 1e-5);
        let potential = found(apart);
        let slope = (found(apart + step).ledger().loss - found(apart - step).ledger().loss) / (2.0 * step);
        let (mut total, mut moment) = ([0.0; 2], 0.0);
        for force in potential.contact_forces() {
            (0..2).for_each(|d| total[d] += force.force[d]);
        }
        for GapForce { places: [a, b], force, .. } in potential.forces() {
            moment += (b[0] - a[0]) * force[1] - (b[1] - a[1]) * force[0];
        }
        let along = 0.8 * total[0] + 0.6 * total[1];
        assert!((along + slope).abs() < 2e-3 * along && along > 0.0, "{along} {slope}");
        assert!(moment.abs() < 1e-15 && (0.8 * total[1] - 0.6 * total[0]).abs() < 1e-2 * along, "{moment} {total:?}");
    }

    #[test]
    fn a_boundary_deep_in_another_body_is_said() {
        let mut potential = GapPotential::new(0.1, 0.0, vec![]);
        let error = potential.find(pair(1.7), 0.0, 0.0).unwrap_err();
        assert!(error.spans > 1.0);
    }

    #[test]
    fn circles_that_turn_together_do_not_slip_and_one_that_turns_alone_is_held_back() {
        let mut potential = GapPotential::new(0.1, 0.3, vec![]);
        let turned = |outline: &Outline, angle: f64, center: [f64; 2]| {
            let (sin, cos) = angle.sin_cos();
            let turn = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
            let place = |x: [f64; 2]| {
                let arm = turn([0, 1].map(|d| x[d] - center[d]));
                [0, 1].map(|d| center[d] + arm[d])
            };
            Outline { arcs: outline.arcs.iter().map(|arc| arc.moved(place, turn)).collect(), ..*outline }
        };
        let rubbing = |potential: &GapPotential| {
            potential.forces().iter().fold([0.0; 2], |sum: [f64; 2], pair| {
                let friction = pair.friction.unwrap();
                [0, 1].map(|d| sum[d] + friction[d])
            })
        };
        let normal =
            |potential: &GapPotential| potential.forces().iter().map(|p| p.force[0].hypot(p.force[1])).sum::<f64>();
        let start = pair(1.98);
        for step in 0..10 {
            let together = start.iter().map(|outline| turned(outline, 1e-3 * f64::from(step), [0.3, 0.1]));
            potential.find(together.collect(), 0.0, 0.0).unwrap();
        }
        let [x, y] = rubbing(&potential);
        assert!(x.hypot(y) < 1e-4 * normal(&potential), "{x} {y}");
        assert!(potential.ledger().friction < 1e-12);
        // b turns on about its own centre by more than an elastic slip: a pulls it back by mu N.
        let [a, b] = [0, 1].map(|i| turned(&start[i], 9e-3, [0.3, 0.1]));
        let center = [0, 1].map(|d| b.arcs[0].position(0.0)[d] + b.arcs[30].position(0.0)[d]).map(|sum| 0.5 * sum);
        for step in 0..10 {
            potential.find(vec![a.clone(), turned(&b, 2e-3 * f64::from(step), center)], 0.0, 0.0).unwrap();
        }
        let [x, y] = rubbing(&potential);
        let share = (-0.6 * x + 0.8 * y) / normal(&potential);
        assert!((share.abs() - 0.3).abs() < 0.01 && share > 0.0, "{share}");
        assert!(potential.ledger().friction > 0.0);
    }

    #[test]
    fn a_rigid_body_works_on_the_others_with_its_own_velocity() {
        let scene_body = circle([0.0, 0.0], 1.0, 64);
        let motion = RigidMotion::steady([1.95, 0.0], [-0.5, 0.0], 0.2);
        let rigid = RigidOutline::new(circle([1.95, 0.0], 1.0, 60).arcs, motion);
        let mut potential = GapPotential::new(0.1, 0.0, vec![rigid]);
        let energy = |potential: &GapPotential| potential.ledger().loss;
        potential.find(vec![scene_body.clone()], 0.0, 0.0).unwrap();
        let before = energy(&potential);
        potential.find(vec![scene_body], 1e-4, 1e-4).unwrap();
        let (work, gain) = (potential.ledger().work, energy(&potential) - before);
        assert!(gain > 0.0 && (work - gain).abs() < 5e-3 * gain, "{work} {gain}");
        assert!(potential.contact_forces().iter().all(|force| force.bodies == [0, 1]));
    }
}
