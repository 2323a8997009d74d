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
//! Both together are what T takes from the motion, `(T(n) + T(n+1))/2 Δs`, exactly while w stays. Where
//! boundaries part, the stored energy of slip is dissipated.
//!
//! The pair ±T acts at one place for both bodies, y on the boundary of b, so that it has no moment: on a as a
//! force at x and a couple. There the material of a moves as its boundary at x does, turned with that:
//! `Δs = τ · [Δx + Δθ × (y − x) − Δy]`, which a common rotation leaves at zero. Both places carry labels, so
//! Δx and Δy are differences of positions of the same material, and nothing of the grid is needed.
//!
//! Wriggers 2006, *Computational contact mechanics*, sections 5.2.3 and 6.3.2, has the return mapping.

use serde::{Deserialize, Serialize};

use super::arc::{Arc, BoundaryPlace, Closest};
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::vectors::dot;

/// Which Gauss point of which boundary: bodies a and b, the arc of a, the point on it.
pub(crate) type Label = ([usize; 2], usize, usize);

/// A Gauss point of a boundary that is inside another body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactPoint<'a> {
    pub label: Label,
    /// On the boundary of a.
    pub place: BoundaryPlace,
    /// On the boundary of b.
    pub nearest: Closest,
    /// Arcs of b.
    pub arcs: &'a [Arc],
    /// κ/2 w, N/m².
    pub stiffness: f64,
}

/// History variables of a Gauss point in contact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct History {
    label: Label,
    /// Place and outward normal on a, m.
    place: [f64; 2],
    normal: [f64; 2],
    /// The place opposite by its label on b, and where that was, m.
    opposite: (usize, f64),
    position: [f64; 2],
    /// Elastic slip, m, and its force, N/m.
    slip: f64,
    force: f64,
}

/// Friction between the bodies of a scene.
#[derive(Debug, Clone)]
pub(crate) struct Friction {
    coefficient: f64,
    /// In the order of their labels: of the last step, and of this one so far.
    histories: Vec<History>,
    found: Vec<History>,
    pub stored: f64,
    pub dissipated: f64,
}

impl Friction {
    /// None between bodies that do not touch; `None` for a coefficient of zero.
    pub(crate) fn new(coefficient: f64) -> Option<Self> {
        let (histories, found) = (Vec::new(), Vec::new());
        (coefficient > 0.0).then_some(Self { coefficient, histories, found, stored: 0.0, dissipated: 0.0 })
    }

    /// Force on b at a Gauss point, N/m. They come in the order of their labels. Asked again at the same
    /// positions, it is the same bit by bit.
    pub(crate) fn force(&mut self, point: &ContactPoint<'_>) -> [f64; 2] {
        let ContactPoint { label, place, nearest, arcs, stiffness } = *point;
        let tangent = [-nearest.direction[1], nearest.direction[0]];
        let limit = self.coefficient * nearest.distance;
        let before =
            self.histories.binary_search_by(|history| history.label.cmp(&label)).ok().map(|at| self.histories[at]);
        let (slip, force) = match before {
            // What it slid by since it closed is not known: that counts from here.
            None => (0.0, 0.0),
            Some(history) => {
                let moved = dot(history.motion(point), tangent);
                let trial = history.slip + moved;
                let slip = trial.clamp(-limit, limit);
                let force = stiffness * slip;
                let kept = fault!("slip-not-returned", slip => trial);
                self.dissipated += 0.5 * (history.force + force) * (moved - (kept - history.slip));
                (kept, force)
            }
        };
        self.stored += 0.5 * force * slip;
        let (arc, t) = nearest.label;
        self.found.push(History {
            label,
            place: place.position,
            normal: place.normal,
            opposite: nearest.label,
            position: arcs[arc].position(t),
            slip,
            force,
        });
        tangent.map(|tangent| force * tangent)
    }

    /// Begins to collect the contact points of a step.
    pub(crate) fn begin(&mut self) {
        self.found.clear();
        self.stored = 0.0;
    }

    /// Dissipates the stored energy of slip where boundaries have parted.
    pub(crate) fn end(&mut self) {
        let Self { histories, found, dissipated, .. } = self;
        let parted = |history: &&History| found.binary_search_by(|other| other.label.cmp(&history.label)).is_err();
        *dissipated += histories.iter().filter(parted).map(|history| 0.5 * history.force * history.slip).sum::<f64>();
        std::mem::swap(histories, found);
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        archive.value(&mut self.histories)?;
        archive.value(&mut self.dissipated)
    }
}

impl History {
    /// How the material of a moved past that of b since then, where b is now, m.
    fn motion(&self, point: &ContactPoint<'_>) -> [f64; 2] {
        let ContactPoint { place, nearest, arcs, .. } = *point;
        let turn = self.normal[0] * place.normal[1] - self.normal[1] * place.normal[0];
        let arm = [0, 1].map(|d| nearest.position[d] - place.position[d]);
        let turned = [-turn * arm[1], turn * arm[0]];
        let (arc, t) = self.opposite;
        let opposite = arcs[arc].position(t);
        [0, 1].map(|d| place.position[d] - self.place[d] + turned[d] - (opposite[d] - self.position[d]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::arc::{Outline, nearest, rule};
    use super::*;

    const DEPTH: f64 = 1e-3;
    const STIFFNESS: f64 = 5.0;

    /// A block, of which one place is looked at, 1e-3 m deep in a floor; both may move along it.
    fn look(friction: &mut Friction, block: f64, floor: f64, depth: f64) -> f64 {
        let arcs = [Arc::new([[1.0 + floor, 0.0], [-1.0 + floor, 0.0]], [[-2.0, 0.0]; 2], &rule())];
        let place = BoundaryPlace { position: [block, -depth], normal: [0.0, -1.0], length: 0.1 };
        friction.begin();
        let nearest = nearest(place.position, &Outline::new(arcs.to_vec(), 1.0), 0..1, |_| true).unwrap();
        let label = ([0, 1], 3, 2);
        let point = ContactPoint { label, place, nearest, arcs: &arcs, stiffness: STIFFNESS };
        let [x, y] = if depth > 0.0 { friction.force(&point) } else { [0.0; 2] };
        friction.end();
        assert!(y.abs() < 1e-15, "{y}");
        x
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
    fn what_sticks_gives_back_what_it_took_and_a_floor_that_comes_along_feels_nothing() {
        let mut friction = Friction::new(0.4).unwrap();
        look(&mut friction, 0.0, 0.0, DEPTH);
        assert!(look(&mut friction, 3e-4, 0.0, DEPTH) > 0.0);
        assert!((look(&mut friction, 3.5e-4, 5e-5, DEPTH) - STIFFNESS * 3e-4).abs() < 1e-15);
        assert!(look(&mut friction, 0.0, 0.0, DEPTH).abs() < 1e-15);
        assert_eq!(friction.dissipated, 0.0);
    }
}
