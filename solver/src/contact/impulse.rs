//! Impulses of contact at the control points where bodies meet, and their energy.

use std::collections::HashMap;

use super::surface::dot;
use super::{Contact, ContactLedger, Meeting};
use crate::updated_frame::field::DiscreteField;

/// Most rounds over control points where more than two bodies meet.
const ROUNDS: usize = 50;
/// Change of an impulse, relative to the largest, below which the rounds end.
const SETTLED: f64 = 1e-12;

/// Time of a kick and of the step it belongs to, s: the first kick is half a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kick {
    /// Length of the kick.
    pub length: f64,
    /// Length of the step.
    pub step: f64,
}

/// Acceleration of a control point by contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Push {
    /// Number of the body.
    pub body: usize,
    /// Index in its nodal fields.
    pub at: usize,
    /// Acceleration, m/s².
    pub acceleration: [f64; 2],
}

/// A body at a meeting.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Index in the nodal fields; none of a rigid body.
    at: Option<usize>,
    /// Velocity before the kick, after it without contact, and after it, m/s.
    before: [f64; 2],
    free: [f64; 2],
    after: [f64; 2],
    /// Inverse masses of the components, m/kg; zero where they cannot answer.
    mobility: [f64; 2],
}

/// Impulse at a meeting along normal and tangent, kg/s.
#[derive(Debug, Clone, Copy, Default)]
struct Impulse {
    normal: f64,
    tangent: f64,
}

struct Pair<'a> {
    meeting: &'a Meeting,
    sides: [Side; 2],
    impulse: Impulse,
}

impl Contact {
    /// Accelerations that contact adds in the coming kick.
    pub fn pushes(&self, fields: &[DiscreteField], kick: Kick) -> Vec<Push> {
        self.resolve(fields, kick).iter().flat_map(|pair| pair.pushes(kick.length)).collect()
    }

    /// The same, and books the energies of the kick.
    pub fn act(&mut self, fields: &[DiscreteField], kick: Kick) -> Vec<Push> {
        let pairs = self.resolve(fields, kick);
        let ledger = pairs.iter().fold(self.ledger, |sum, pair| {
            sum.plus(pair.energy(kick, |side| side.after)).plus(pair.arriving(kick))
        });
        let pushes = pairs.iter().flat_map(|pair| pair.pushes(kick.length)).collect();
        self.ledger = ledger;
        pushes
    }

    /// The ledger at the present whole step: with the half of the coming kick that belongs to the step before.
    pub fn ledger_now(&self, fields: &[DiscreteField], kick: Kick) -> ContactLedger {
        self.resolve(fields, kick).iter().fold(self.ledger, |sum, pair| sum.plus(pair.arriving(kick)))
    }

    fn resolve(&self, fields: &[DiscreteField], kick: Kick) -> Vec<Pair<'_>> {
        let mut pairs: Vec<Pair> = self.meetings.iter().filter_map(|m| self.pair(fields, m, kick)).collect();
        let several = pairs.windows(2).any(|two| two[0].meeting.control == two[1].meeting.control);
        let mut pushed = HashMap::<(usize, usize), [f64; 2]>::new();
        for _ in 0..if several { ROUNDS } else { 1 } {
            let (mut largest, mut change) = (0.0_f64, 0.0_f64);
            for pair in &mut pairs {
                let old = pair.impulse;
                let extra = [0, 1].map(|s| pair.key(s).and_then(|key| pushed.get(&key)).copied().unwrap_or_default());
                pair.settle(extra, self.friction, kick.step);
                let delta = pair.vector_of(Impulse {
                    normal: pair.impulse.normal - old.normal,
                    tangent: pair.impulse.tangent - old.tangent,
                });
                for (s, sign) in [(0, -1.0), (1, 1.0)] {
                    if let Some(key) = pair.key(s) {
                        let sum = pushed.entry(key).or_default();
                        *sum = [0, 1].map(|c| sum[c] + sign * delta[c] * pair.sides[s].mobility[c]);
                    }
                }
                largest = largest.max(pair.impulse.normal);
                change = change.max(delta[0].hypot(delta[1]));
            }
            if change <= SETTLED * largest {
                break;
            }
        }
        for pair in &mut pairs {
            for s in 0..2 {
                let push = pair.key(s).and_then(|key| pushed.get(&key)).copied().unwrap_or_default();
                pair.sides[s].after = [0, 1].map(|c| pair.sides[s].free[c] + push[c]);
            }
        }
        pairs
    }

    /// Both bodies of a meeting; nothing if one has no mass there.
    fn pair<'a>(&self, fields: &[DiscreteField], meeting: &'a Meeting, kick: Kick) -> Option<Pair<'a>> {
        let [a, b] = meeting.bodies.map(|body| match fields.get(body) {
            Some(field) => {
                let at = field.index_of(meeting.control)?;
                let nodes = field.nodes();
                let velocity = [0, 1].map(|c| nodes.velocity[c][at]);
                (nodes.inverse_mass[at] > 0.0).then(|| Side {
                    at: Some(at),
                    before: velocity,
                    free: [0, 1].map(|c| velocity[c] + kick.length * nodes.acceleration[c][at]),
                    after: velocity,
                    mobility: nodes.mobility(at),
                })
            }
            None => {
                let position = [0, 1].map(|d| self.greville[d][meeting.control[d]]);
                let velocity = self.rigid[body - fields.len()].velocity_at(position);
                Some(Side { at: None, before: velocity, free: velocity, after: velocity, mobility: [0.0; 2] })
            }
        });
        Some(Pair { meeting, sides: [a?, b?], impulse: Impulse::default() })
    }
}

impl Pair<'_> {
    fn key(&self, side: usize) -> Option<(usize, usize)> {
        Some((self.meeting.bodies[side], self.sides[side].at?))
    }

    fn tangent(&self) -> [f64; 2] {
        let [x, y] = self.meeting.normal;
        [-y, x]
    }

    fn vector_of(&self, impulse: Impulse) -> [f64; 2] {
        let (n, t) = (self.meeting.normal, self.tangent());
        [0, 1].map(|c| impulse.normal * n[c] + impulse.tangent * t[c])
    }

    /// Impulse that keeps the gap from closing and sliding below the friction, given the velocities that all impulses so far
    /// add to both sides.
    fn settle(&mut self, pushed: [[f64; 2]; 2], friction: f64, step: f64) {
        let [a, b] = self.sides;
        let mobility = [0, 1].map(|c| a.mobility[c] + b.mobility[c]);
        let mut relative = [0, 1].map(|c| b.free[c] + pushed[1][c] - a.free[c] - pushed[0][c]);
        let answer = |direction: [f64; 2]| (0..2).map(|c| direction[c] * direction[c] * mobility[c]).sum::<f64>();
        let n = self.meeting.normal;
        if answer(n) > 0.0 {
            let allowed = -self.meeting.gap.max(0.0) / step;
            let normal = (self.impulse.normal + (allowed - dot(relative, n)) / answer(n)).max(0.0);
            relative = [0, 1].map(|c| relative[c] + (normal - self.impulse.normal) * n[c] * mobility[c]);
            self.impulse.normal = normal;
        }
        let t = self.tangent();
        if answer(t) > 0.0 {
            let most = friction * self.impulse.normal;
            self.impulse.tangent = (self.impulse.tangent - dot(relative, t) / answer(t)).clamp(-most, most);
        }
    }

    fn pushes(&self, length: f64) -> impl Iterator<Item = Push> {
        let vector = self.vector_of(self.impulse);
        let push = |side: usize, sign: f64| {
            let (body, at) = self.key(side)?;
            let mobility = self.sides[side].mobility;
            Some(Push { body, at, acceleration: [0, 1].map(|c| sign * vector[c] * mobility[c] / length) })
        };
        let pushes = [push(0, -1.0), push(1, 1.0)];
        pushes.into_iter().flatten().filter(|push| push.acceleration != [0.0; 2])
    }

    /// Energies of half the force of the kick with the velocities before it; there are none at the start.
    fn arriving(&self, kick: Kick) -> ContactLedger {
        if kick.length < kick.step { ContactLedger::default() } else { self.energy(kick, |side| side.before) }
    }

    /// Energies of half the force of the kick with velocities of both sides.
    fn energy(&self, kick: Kick, velocity: impl Fn(&Side) -> [f64; 2]) -> ContactLedger {
        let mut energy = ContactLedger::default();
        if self.impulse.normal == 0.0 {
            return energy;
        }
        let half = 0.5 * kick.step / kick.length;
        let all = self.vector_of(self.impulse);
        let friction = self.vector_of(Impulse { normal: 0.0, ..self.impulse });
        for (side, sign) in self.sides.iter().zip([-1.0, 1.0]) {
            let velocity = velocity(side);
            let work = |impulse: [f64; 2]| {
                let acts = |c: &usize| side.at.is_none() || side.mobility[*c] > 0.0;
                half * (0..2).filter(acts).map(|c| sign * impulse[c] * velocity[c]).sum::<f64>()
            };
            energy.loss -= work(all);
            energy.friction -= work(friction);
            if side.at.is_none() {
                energy.work -= work(all);
            }
        }
        energy
    }
}

impl ContactLedger {
    fn plus(self, other: Self) -> Self {
        Self {
            loss: self.loss + other.loss,
            friction: self.friction + other.friction,
            work: self.work + other.work,
        }
    }
}
