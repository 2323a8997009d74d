//! Coulomb friction beside the potential of the gap: springs along the boundary that yield.
//!
//! At a Gauss point of the boundary of a that is a depth d inside b, with the pressure `N = κ/2 w d` over the
//! length w, the elastic slip g answers with a force along the tangent of b,
//!
//! ```text
//! T = κ/2 w g,     |g| ≤ mu d:   |T| ≤ mu N,
//! ```
//!
//! as stiff along the boundary as the potential is across it. In a step the material of a moves by Δs past
//! that of b, and g by as much of it as the bound leaves (return mapping); the rest, γ, is sliding:
//!
//! ```text
//! g(n+1) = min(max(g(n) + Δs, −mu d), mu d),     γ = Δs − [g(n+1) − g(n)],
//! stored  E_t = Σ T g/2,     dissipated  Δ = (T(n) + T(n+1))/2 γ.
//! ```
//!
//! Both together are what T takes from the motion, `(T(n) + T(n+1))/2 Δs`, exactly while w stays. A place
//! that comes into contact has g(n) = T(n) = 0, and one that parts g(n+1) = T(n+1) = 0. Their step counts:
//! contact that lasts for few steps would have much less friction without it.
//!
//! The pair ±T acts at one place for both bodies, y on the boundary of b, so that it has no moment: on a as a
//! force at x and a couple. There the material of a moves as its boundary at x does, turned with that:
//! `Δs = τ · [Δx + Δθ × (y − x) − Δy]`, which a common rotation leaves at zero. Both places carry labels, so
//! Δx and Δy are differences of positions of the same material, and nothing of the grid is needed.
//!
//! Wriggers 2006, *Computational contact mechanics*, sections 5.2.3 and 6.3.2, has the return mapping.

use serde::{Deserialize, Serialize};

use super::arc::Outline;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::vectors::dot;

/// A Gauss point of a boundary that is inside another body.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct ContactPoint {
    /// Numbers of the body a, whose boundary has the Gauss point, and of the body b, in which it lies.
    pub bodies: [usize; 2],
    /// Its number on the arc of a.
    pub number: usize,
    /// Arc and t on it: of itself on a, and of the nearest place on b.
    pub labels: [(usize, f64); 2],
    /// Unit vector along the boundary of b.
    pub tangent: [f64; 2],
}

/// History variables of a Gauss point in contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct History {
    point: ContactPoint,
    /// Elastic slip, m, and its force, N/m.
    slip: f64,
    force: f64,
}

/// Friction between the bodies of a scene.
#[derive(Debug, Clone)]
pub(crate) struct Friction {
    coefficient: f64,
    /// Boundaries of all bodies when contact was found last, if it was.
    before: Vec<Outline>,
    /// In the order of their keys: of the last step, and of this one so far.
    histories: Vec<History>,
    found: Vec<History>,
    pub stored: f64,
    pub dissipated: f64,
}

impl Friction {
    /// None between bodies that do not touch; `None` for a coefficient of zero.
    pub(crate) fn new(coefficient: f64) -> Option<Self> {
        let (before, histories, found) = (Vec::new(), Vec::new(), Vec::new());
        (coefficient > 0.0).then_some(Self { coefficient, before, histories, found, stored: 0.0, dissipated: 0.0 })
    }

    /// Force on b at a Gauss point, N/m, with its depth (m) and κ/2 w (N/m²), and the boundaries now. They
    /// come in the order of their keys. Asked again at the same positions, it is the same bit by bit.
    pub(crate) fn force(&mut self, point: ContactPoint, [depth, stiffness]: [f64; 2], now: &[Outline]) -> [f64; 2] {
        let limit = self.coefficient * depth;
        let known = self.histories.binary_search_by(|history| history.point.key().cmp(&point.key()));
        let [slip_before, force_before] =
            known.map_or([0.0; 2], |at| [self.histories[at].slip, self.histories[at].force]);
        let moved = point.slide(&self.before, now);
        let trial = slip_before + moved;
        let slip = trial.clamp(-limit, limit);
        let force = stiffness * slip;
        let kept = fault!("slip-not-returned", slip => trial);
        self.dissipated += 0.5 * (force_before + force) * (moved - (kept - slip_before));
        self.stored += 0.5 * force * slip;
        self.found.push(History { point, slip: kept, force });
        point.tangent.map(|tangent| force * tangent)
    }

    /// Begins to collect the contact points of a step.
    pub(crate) fn begin(&mut self) {
        self.found.clear();
        self.stored = 0.0;
    }

    /// Dissipates the elastic slip of places that parted; the boundaries now are those before the next step.
    pub(crate) fn end(&mut self, now: Vec<Outline>) {
        let Self { before, histories, found, dissipated, .. } = self;
        for History { point, slip, force } in &*histories {
            if found.binary_search_by(|other| other.point.key().cmp(&point.key())).is_err() {
                *dissipated += 0.5 * force * (slip + point.slide(before, &now));
            }
        }
        std::mem::swap(histories, found);
        *before = now;
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        if archive.is_reader() {
            self.before.clear(); // contact is found again where it was found last
        }
        archive.value(&mut self.histories)?;
        archive.value(&mut self.dissipated)
    }
}

impl ContactPoint {
    /// Which Gauss point of which boundary it is.
    fn key(&self) -> ([usize; 2], usize, usize) {
        (self.bodies, self.labels[0].0, self.number)
    }

    /// How far the material of a moved along that of b between two times, m.
    fn slide(&self, before: &[Outline], now: &[Outline]) -> f64 {
        if before.is_empty() {
            return 0.0;
        }
        let [[x, normal], [y, _]] = self.places(before);
        let [[x_now, normal_now], [y_now, _]] = self.places(now);
        let turn = normal[0] * normal_now[1] - normal[1] * normal_now[0];
        let turned = [-turn * (y_now[1] - x_now[1]), turn * (y_now[0] - x_now[0])];
        dot([0, 1].map(|d| x_now[d] - x[d] + turned[d] - (y_now[d] - y[d])), self.tangent)
    }

    /// Position, m, and outward unit normal of its material on both bodies.
    fn places(&self, outlines: &[Outline]) -> [[[f64; 2]; 2]; 2] {
        [0, 1].map(|side| {
            let (arc, t) = self.labels[side];
            let arc = &outlines[self.bodies[side]].arcs[arc];
            [arc.position(t), arc.normal(t)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::arc::{Arc, nearest, rule};
    use super::*;

    const DEPTH: f64 = 1e-3;
    const STIFFNESS: f64 = 5.0;

    /// A block, of which one place is looked at, a depth (m) in a floor; both may move along it.
    fn look(friction: &mut Friction, block: f64, floor: f64, depth: f64) -> f64 {
        let line = |ends: [[f64; 2]; 2]| {
            let tangent = [0, 1].map(|d| ends[1][d] - ends[0][d]);
            Outline::new(vec![Arc::new(ends, [tangent; 2], &rule())], 1.0)
        };
        let of_block = line([[block - 0.5, -depth], [block + 0.5, -depth]]);
        let now = [of_block, line([[1.0 + floor, 0.0], [-1.0 + floor, 0.0]])];
        friction.begin();
        let mut force = [0.0; 2];
        if depth > 0.0 {
            let nearest = nearest([block, -depth], &now[1], 0..1, |_| true).unwrap();
            let tangent = [-nearest.direction[1], nearest.direction[0]];
            let labels = [(0, 0.5), nearest.label];
            let point = ContactPoint { bodies: [0, 1], number: 2, labels, tangent };
            force = friction.force(point, [depth, STIFFNESS], &now);
        }
        friction.end(now.to_vec());
        assert!(force[1].abs() < 1e-15, "{force:?}");
        force[0]
    }

    #[test]
    fn no_friction_is_nothing() {
        assert!(Friction::new(0.0).is_none());
    }

    #[test]
    fn a_block_that_slides_is_held_back_by_mu_n_and_its_work_is_stored_or_dissipated() {
        let mut friction = Friction::new(0.4).unwrap();
        assert_eq!(look(&mut friction, 0.0, 0.0, DEPTH), 0.0);
        let (mut work, mut last) = (0.0, 0.0);
        for step in 1..=40 {
            let force = look(&mut friction, 5e-5 * f64::from(step), 0.0, DEPTH);
            work += 0.5 * (last + force) * 5e-5;
            last = force;
        }
        let limit = 0.4 * STIFFNESS * DEPTH;
        assert!((last - limit).abs() < 1e-12 * limit, "{last}");
        assert!((friction.stored + friction.dissipated - work).abs() < 1e-12 * work);
        // 2e-3 m less the elastic slip of mu d.
        assert!((friction.dissipated - limit * (2e-3 - 4e-4)).abs() < 1e-12 * work);
        // Where nothing moves nothing changes, not a bit.
        let (stored, dissipated) = (friction.stored, friction.dissipated);
        assert_eq!(look(&mut friction, 5e-5 * 40.0, 0.0, DEPTH), last);
        assert_eq!((friction.stored, friction.dissipated), (stored, dissipated));
        // What parts dissipates what slip stored.
        look(&mut friction, 5e-5 * 40.0, 0.0, -DEPTH);
        assert_eq!(friction.stored, 0.0);
        assert!((friction.dissipated - stored - dissipated).abs() < 1e-15);
    }

    #[test]
    fn the_steps_in_which_places_meet_and_part_count() {
        let mut friction = Friction::new(0.4).unwrap();
        look(&mut friction, 0.0, 0.0, -DEPTH);
        let (limit, slid) = (0.4 * STIFFNESS * DEPTH, 5e-3);
        assert!((look(&mut friction, slid, 0.0, DEPTH) - limit).abs() < 1e-12 * limit);
        assert!((friction.stored + friction.dissipated - 0.5 * limit * slid).abs() < 1e-12 * limit * slid);
        look(&mut friction, 2.0 * slid, 0.0, -DEPTH);
        assert!((friction.dissipated - limit * slid).abs() < 1e-12 * limit * slid);
    }

    #[test]
    fn what_sticks_gives_back_what_it_took_and_a_floor_that_comes_along_feels_nothing() {
        let mut friction = Friction::new(0.4).unwrap();
        look(&mut friction, 0.0, 0.0, DEPTH);
        assert!(look(&mut friction, 3e-4, 0.0, DEPTH) > 0.0);
        assert!((look(&mut friction, 3.5e-4, 5e-5, DEPTH) - STIFFNESS * 3e-4).abs() < 1e-15);
        assert!(look(&mut friction, 0.0, 0.0, DEPTH).abs() < 1e-15);
        assert_eq!(friction.dissipated, 0.0);
    }
}
