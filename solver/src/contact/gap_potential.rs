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
//! closed. The price is a depth of p/κ under a pressure p, a strain times h.
//!
//! The boundaries are the cubics through the places and tangents that the inverse of the motion gives
//! ([`Arc`]), with four Gauss points each. Wriggers 2006, *Computational contact mechanics*, section 6.3, has
//! the penalty method; Puso & Laursen 2004, *A mortar segment-to-segment contact method for large deformation
//! solid mechanics*, the reason to integrate over boundaries instead of looking at their nodes.

use super::impulse::ContactForce;
use super::motion::TooFast;
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::vectors::{dot, unit};
use crate::scene::Layout;
use crate::splines::quadrature::Rule;

/// α: stiffness over that of a span. The critical step counts it ([`spring`]). Half of it makes a contact
/// softer than the first span behind it, and longer.
const STIFFNESS: f64 = 0.5;
/// Gauss points of an arc.
const POINTS: usize = 4;
/// Corrections of the nearest place, and what is near enough, in arcs.
const CORRECTIONS: usize = 20;
const CLOSE: f64 = 1e-13;

/// Stiffness κ of the boundary of a body, Pa/m, by its `ρ c²`, Pa, and the shortest span, m.
pub(crate) fn spring(modulus: f64, span: f64) -> f64 {
    STIFFNESS * modulus / span
}

/// A step of a boundary as a cubic of t from 0 to 1, by the powers of t; the body is to its left.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arc([[f64; 2]; 4]);

/// A place on a boundary.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoundaryPlace {
    /// m.
    pub position: [f64; 2],
    /// Outward unit normal.
    pub normal: [f64; 2],
    /// Length it stands for, m.
    pub length: f64,
}

impl Arc {
    /// From one end to the other; tangents are derivatives with respect to t, m.
    pub(crate) fn new(ends: [[f64; 2]; 2], tangents: [[f64; 2]; 2]) -> Self {
        let [a, b] = ends;
        let [s, t] = tangents;
        let power = |f: &dyn Fn(usize) -> f64| [0, 1].map(f);
        Self([a, s, power(&|d| 3.0 * (b[d] - a[d]) - 2.0 * s[d] - t[d]), power(&|d| 2.0 * (a[d] - b[d]) + s[d] + t[d])])
    }

    fn position(&self, t: f64) -> [f64; 2] {
        let Self([c0, c1, c2, c3]) = self;
        [0, 1].map(|d| c0[d] + t * (c1[d] + t * (c2[d] + t * c3[d])))
    }

    fn tangent(&self, t: f64) -> [f64; 2] {
        let Self([_, c1, c2, c3]) = self;
        [0, 1].map(|d| c1[d] + t * (2.0 * c2[d] + t * 3.0 * c3[d]))
    }

    fn curvature(&self, t: f64) -> [f64; 2] {
        let Self([_, _, c2, c3]) = self;
        [0, 1].map(|d| 2.0 * c2[d] + t * 6.0 * c3[d])
    }

    /// Its Gauss points.
    pub(crate) fn places<'a>(&'a self, rule: &'a Rule) -> impl Iterator<Item = BoundaryPlace> + 'a {
        rule.points.iter().zip(&rule.weights).map(|(&t, weight)| {
            let [tx, ty] = self.tangent(t);
            let length = tx.hypot(ty);
            BoundaryPlace { position: self.position(t), normal: [ty / length, -tx / length], length: weight * length }
        })
    }

    /// Lower left and upper right corner of a box around it, m.
    fn bounds(&self) -> [[f64; 2]; 2] {
        let ends = [self.position(0.0), self.position(1.0)];
        let [s, t] = [self.tangent(0.0), self.tangent(1.0)];
        let inner = [[0, 1].map(|d| ends[0][d] + s[d] / 3.0), [0, 1].map(|d| ends[1][d] - t[d] / 3.0)];
        around(ends.into_iter().chain(inner).map(|x| [x, x]))
    }

    /// The place nearest to a position, m: t, the square of the distance, and the place.
    fn nearest(&self, position: [f64; 2]) -> (f64, f64, [f64; 2]) {
        let from = |t: f64| {
            let x = self.position(t);
            [0, 1].map(|d| x[d] - position[d])
        };
        let [start, end] = [from(0.0), from(1.0)];
        let along = [0, 1].map(|d| end[d] - start[d]);
        let mut t = (-dot(start, along) / dot(along, along)).clamp(0.0, 1.0);
        for _ in 0..CORRECTIONS {
            let (apart, tangent) = (from(t), self.tangent(t));
            let slope = dot(apart, tangent);
            let curved = dot(tangent, tangent) + dot(apart, self.curvature(t));
            let next = (t - slope / larger(curved, 0.1 * dot(tangent, tangent))).clamp(0.0, 1.0);
            let change = (next - t).abs();
            t = next;
            if change <= CLOSE {
                break;
            }
        }
        let apart = from(t);
        (t, dot(apart, apart), self.position(t))
    }
}

/// The box around some boxes.
fn around(boxes: impl Iterator<Item = [[f64; 2]; 2]>) -> [[f64; 2]; 2] {
    boxes.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], [other_low, other_high]| {
        [[0, 1].map(|d| smaller(low[d], other_low[d])), [0, 1].map(|d| larger(high[d], other_high[d]))]
    })
}

/// A pair of opposite forces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct GapForce {
    /// Bodies a and b.
    pub bodies: [usize; 2],
    /// Where it acts on each, m.
    pub places: [[f64; 2]; 2],
    /// Force on b, N/m.
    pub force: [f64; 2],
}

impl GapForce {
    /// Gap between the bodies where it acts, m: negative.
    pub(crate) fn gap(&self) -> f64 {
        let [a, b] = self.places;
        -(b[0] - a[0]).hypot(b[1] - a[1])
    }
}

/// Boundary of a body now.
#[derive(Debug, Clone)]
pub(crate) struct Outline {
    /// Its arcs.
    pub arcs: Vec<Arc>,
    /// κ of the body, Pa/m.
    pub spring: f64,
}

/// Contact of the bodies of a scene.
#[derive(Debug, Clone)]
pub(crate) struct GapPotential {
    /// Depth that is too much, m.
    reach: f64,
    rule: Rule,
    forces: Vec<GapForce>,
    energy: f64,
}

impl GapPotential {
    /// Bodies that do not touch on a mesh whose shortest span has this length, m.
    pub(crate) fn new(span: f64) -> Self {
        Self { reach: span, rule: rule(), forces: Vec::new(), energy: 0.0 }
    }

    /// Finds the forces between boundaries.
    ///
    /// # Errors
    /// If a boundary is a span deep in another body.
    pub(crate) fn find(&mut self, outlines: &[Outline]) -> Result<(), TooFast> {
        self.forces.clear();
        self.energy = 0.0;
        let boxes: Vec<_> = outlines.iter().map(|outline| around(outline.arcs.iter().map(Arc::bounds))).collect();
        for a in 0..outlines.len() {
            for b in (0..outlines.len()).filter(|&b| b != a) {
                let low = [0, 1].map(|d| larger(boxes[a][0][d], boxes[b][0][d]));
                let high = [0, 1].map(|d| smaller(boxes[a][1][d], boxes[b][1][d]));
                if (0..2).all(|d| low[d] <= high[d]) {
                    self.compare([a, b], outlines, [low, high])?;
                }
            }
        }
        Ok(())
    }

    /// What the boundary of a in a box feels of b.
    fn compare(&mut self, [a, b]: [usize; 2], outlines: &[Outline], common: [[f64; 2]; 2]) -> Result<(), TooFast> {
        let meets = |arc: &&Arc, [low, high]: [[f64; 2]; 2]| {
            let [own_low, own_high] = arc.bounds();
            (0..2).all(|d| own_high[d] >= low[d] && own_low[d] <= high[d])
        };
        let wider = [common[0].map(|x| x - self.reach), common[1].map(|x| x + self.reach)];
        let own: Vec<&Arc> = outlines[a].arcs.iter().filter(|arc| meets(arc, common)).collect();
        let other: Vec<&Arc> = outlines[b].arcs.iter().filter(|arc| meets(arc, wider)).collect();
        let spring = smaller(outlines[a].spring, outlines[b].spring);
        for place in own.iter().flat_map(|arc| arc.places(&self.rule)) {
            let Some(nearest) = nearest(place.position, &other) else { continue };
            if dot(place.normal, nearest.normal) >= 0.0 || nearest.depth <= 0.0 {
                continue;
            }
            let Closest { depth, position, .. } = nearest;
            if depth > self.reach {
                return Err(TooFast { place: place.position, spans: depth / self.reach });
            }
            let out = [0, 1].map(|d| (position[d] - place.position[d]) / depth);
            let pressure = 0.5 * spring * depth * place.length;
            self.energy += 0.5 * pressure * depth;
            let force = out.map(|out| -pressure * out);
            self.forces.push(GapForce { bodies: [a, b], places: [place.position, position], force });
        }
        Ok(())
    }

    /// The forces that were found last.
    pub(crate) fn forces(&self) -> &[GapForce] {
        &self.forces
    }

    /// The same as forces on the body of the higher number.
    pub(crate) fn contact_forces(&self) -> Vec<ContactForce> {
        let ordered = |pair: &GapForce| {
            let GapForce { bodies: [a, b], places, force } = *pair;
            let position = [0, 1].map(|d| 0.5 * (places[0][d] + places[1][d]));
            if a < b {
                ContactForce { bodies: [a, b], position, force }
            } else {
                ContactForce { bodies: [b, a], position, force: force.map(|f| -f) }
            }
        };
        self.forces.iter().map(ordered).collect()
    }

    /// Energy of the potential, J/m.
    pub(crate) fn energy(&self) -> f64 {
        self.energy
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.forces.len() * size_of::<GapForce>()
    }
}

/// Rule along an arc.
pub(crate) fn rule() -> Rule {
    Rule::new(Layout::Gauss, POINTS)
}

/// The nearest place of a boundary.
struct Closest {
    /// How deep the position is inside the body, m; negative outside.
    depth: f64,
    position: [f64; 2],
    /// Outward unit normal there.
    normal: [f64; 2],
}

fn nearest(position: [f64; 2], arcs: &[&Arc]) -> Option<Closest> {
    let mut best: Option<(f64, &Arc, f64, [f64; 2])> = None;
    for &arc in arcs {
        let [low, high] = arc.bounds();
        let beside = [0, 1].map(|d| larger(0.0, larger(low[d] - position[d], position[d] - high[d])));
        if best.is_some_and(|(least, ..)| dot(beside, beside) > least) {
            continue;
        }
        let (t, square, place) = arc.nearest(position);
        if best.is_none_or(|(least, ..)| square < least) {
            best = Some((square, arc, t, place));
        }
    }
    let (square, arc, t, place) = best?;
    let [tx, ty] = arc.tangent(t);
    let normal = unit([ty, -tx].map(|x| x / tx.hypot(ty)))?;
    let inside = dot([0, 1].map(|d| position[d] - place[d]), normal) < 0.0;
    Some(Closest { depth: if inside { square.sqrt() } else { -square.sqrt() }, position: place, normal })
}

#[cfg(test)]
mod tests {
    use super::*;

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

    fn found(apart: f64) -> GapPotential {
        let mut potential = GapPotential::new(0.1);
        potential.find(&[circle([0.0; 2], 1.0, 64), circle([apart * 0.8, apart * 0.6], 1.0, 60)]).unwrap();
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
        let slope = (found(apart + step).energy() - found(apart - step).energy()) / (2.0 * step);
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
        let mut potential = GapPotential::new(0.1);
        let error = potential.find(&[circle([0.0; 2], 1.0, 64), circle([1.7, 0.0], 1.0, 64)]).unwrap_err();
        assert!(error.spans > 1.0);
    }
}
