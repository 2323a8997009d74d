//! What circles feel that overlap: forces, slip, and the work of a rigid one.

use super::arc::{Arc, rule};
use super::*;
use crate::contact::rigid::RigidMotion;

/// A circle in so many arcs.
fn circle(center: [f64; 2], radius: f64, count: usize) -> Outline {
    let turn = std::f64::consts::TAU / count as f64;
    let at = |i: usize| {
        let (sin, cos) = (turn * i as f64).sin_cos();
        ([center[0] + radius * cos, center[1] + radius * sin], [-radius * turn * sin, radius * turn * cos])
    };
    let arc = |i: usize| Arc::new([at(i).0, at(i + 1).0], [at(i).1, at(i + 1).1], &rule());
    Outline::new((0..count).map(arc).collect(), 2.0)
}

fn pair(apart: f64) -> Vec<Outline> {
    vec![circle([0.0; 2], 1.0, 64), circle([apart * 0.8, apart * 0.6], 1.0, 60)]
}

/// Contact of two thick bodies on spans of 0.1 m.
fn contact(friction: f64, rigid: Vec<RigidOutline>) -> GapPotential {
    let thick = circle([0.0; 2], 1.0, 64);
    let thin = ThinParts::new(&thick.arcs, 0.1, |[x, y]| x.hypot(y) < 1.0);
    GapPotential::new(0.1, friction, rigid, vec![thin.clone(), thin], vec![])
}

fn found(apart: f64) -> GapPotential {
    let mut potential = contact(0.0, vec![]);
    potential.find(pair(apart), 0.0, 0.0).unwrap();
    potential
}

#[test]
fn circles_that_do_not_overlap_feel_nothing() {
    assert!(found(2.0 + 1e-5).forces.is_empty());
    assert!(!found(2.0 - 1e-3).forces.is_empty());
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
    for GapForce { places: [a, b], force, .. } in &potential.forces {
        moment += (b[0] - a[0]) * force[1] - (b[1] - a[1]) * force[0];
    }
    let along = 0.8 * total[0] + 0.6 * total[1];
    assert!((along + slope).abs() < 2e-3 * along && along > 0.0, "{along} {slope}");
    assert!(moment.abs() < 1e-15 && (0.8 * total[1] - 0.6 * total[0]).abs() < 1e-2 * along, "{moment} {total:?}");
}

#[test]
fn a_boundary_deep_in_another_body_is_said() {
    let mut potential = contact(0.0, vec![]);
    let error = potential.find(pair(1.7), 0.0, 0.0).unwrap_err();
    assert!(matches!(error, NotFollowed::TooDeep { spans, .. } if spans > 1.0), "{error}");
}

#[test]
fn circles_that_turn_together_do_not_slip_and_one_that_turns_alone_is_held_back() {
    let mut potential = contact(0.3, vec![]);
    let turned = |outline: &Outline, angle: f64, center: [f64; 2]| {
        let (sin, cos) = angle.sin_cos();
        let turn = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
        let place = |x: [f64; 2]| {
            let arm = turn([0, 1].map(|d| x[d] - center[d]));
            [0, 1].map(|d| center[d] + arm[d])
        };
        Outline::new(outline.arcs.iter().map(|arc| arc.moved(place, turn)).collect(), outline.spring)
    };
    let rubbing = |potential: &GapPotential| {
        potential.forces.iter().fold([0.0; 2], |sum: [f64; 2], pair| {
            let friction = pair.friction.unwrap();
            let on_b = if pair.bodies == [0, 1] { 1.0 } else { -1.0 };
            [0, 1].map(|d| sum[d] + on_b * friction[d])
        })
    };
    let normal = |potential: &GapPotential| potential.forces.iter().map(|p| p.force[0].hypot(p.force[1])).sum::<f64>();
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
    let mut potential = contact(0.0, vec![rigid]);
    let energy = |potential: &GapPotential| potential.ledger().loss;
    potential.find(vec![scene_body.clone()], 0.0, 0.0).unwrap();
    let before = energy(&potential);
    potential.find(vec![scene_body], 1e-4, 1e-4).unwrap();
    let (work, gain) = (potential.ledger().work, energy(&potential) - before);
    assert!(gain > 0.0 && (work - gain).abs() < 5e-3 * gain, "{work} {gain}");
    assert!(potential.contact_forces().iter().all(|force| force.bodies == [0, 1]));
}
