//! Frictional contact between the discrete fields of bodies, and with rigid bodies.
//!
//! Bodies meet at the control points both have mass at, but only where their boundaries touch: supports of quadratic and
//! cubic splines overlap up to three spans before the bodies do. Boundaries are lines that move with the bodies
//! ([`Surface`]). Every segment of one that faces another within a span measures the signed gap between them at its centre
//! x_s, and control points take the means over the segments s of both bodies, weighted with length l and shape function:
//!
//! ```text
//! g_I = Σ l_s N_I(x_s) g_s / Σ l_s N_I(x_s),        n_I ∝ Σ l_s N_I(x_s) (n_a − n_b)_s
//! ```
//!
//! The normal is the same for both bodies but for its sign. At a control point with velocities v_a, v_b after the kick, the
//! impulse P on b, and −P on a, is the smallest that keeps the gap from closing further than it is open,
//! `(v_b − v_a) · n ≥ −max(g, 0)/dt`, with Coulomb friction: it stops sliding or is the coefficient times its normal part.
//! Impulses never pull, and never push apart. Where several bodies meet, impulses are found pair by pair until they settle.
//!
//! The force P/dt acts over a kick from w to v, so `−P · (w + v)/2`, with w and v relative velocities, is lost: that is the
//! contact loss of the ledger, half of it booked with the velocity the step begins with, half with the one it ends with. A rigid
//! body does external work with its own velocity.

pub mod impulse;
pub mod rigid;
pub mod surface;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::patch::Patch;
use crate::scene::Scene;
use crate::updated_frame::field::DiscreteField;
pub use rigid::RigidBody;
pub use surface::Surface;
use surface::{Center, dot, unit};

/// Cosine of the angle between outward normals above which boundaries do not face each other.
const FACING: f64 = -0.5;

/// Two bodies at a control point where their boundaries are near each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting {
    /// Column and row of the control point in the whole patch.
    pub control: [usize; 2],
    /// Numbers of the bodies a and b; rigid ones are counted after the others.
    pub bodies: [usize; 2],
    /// Mean gap, m; negative where the boundaries overlap.
    pub gap: f64,
    /// Unit normal from a to b.
    pub normal: [f64; 2],
}

/// What contact took and gave so far, J per metre of thickness.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactLedger {
    /// Energy lost.
    pub loss: f64,
    /// The part of it that friction took.
    pub friction: f64,
    /// Work of rigid bodies.
    pub work: f64,
}

/// Contact of the bodies of a scene.
#[derive(Debug, Clone)]
pub struct Contact {
    friction: f64,
    whole: Arc<Patch>,
    greville: [Vec<f64>; 2],
    /// Distance within which boundaries are compared, m: the shortest span.
    reach: f64,
    rigid: Vec<RigidBody>,
    meetings: Vec<Meeting>,
    ledger: ContactLedger,
}

/// Sums over segments at a control point.
#[derive(Default)]
struct Sums {
    weight: f64,
    gap: f64,
    normal: [f64; 2],
}

type Key = ([usize; 2], [usize; 2]);

impl Contact {
    /// Contact of a scene, if it declares any.
    pub fn new(scene: &Scene, whole: &Arc<Patch>) -> Option<Self> {
        let spans = || whole.spaces.iter().flat_map(|space| space.spans());
        Some(Self {
            friction: scene.contact.as_ref()?.friction,
            whole: Arc::clone(whole),
            greville: [0, 1].map(|d| whole.spaces[d].greville()),
            reach: spans().map(|span| span.length()).fold(f64::INFINITY, f64::min),
            rigid: scene.bodies.iter().filter(|b| b.rigid).map(|b| RigidBody::new(&scene.mesh, b)).collect(),
            meetings: Vec::new(),
            ledger: ContactLedger::default(),
        })
    }

    /// Moves the rigid bodies to where they are at a time, s.
    pub fn move_rigid(&mut self, time: f64) {
        self.rigid.iter_mut().for_each(|body| body.move_to(time));
    }

    /// Finds where bodies are near each other now.
    pub fn find(&mut self, fields: &[DiscreteField]) {
        let surfaces: Vec<&Surface> =
            fields.iter().filter_map(|f| f.surface()).chain(self.rigid.iter().map(|r| r.surface())).collect();
        let boxes: Vec<_> = surfaces.iter().map(|surface| surface.bounding_box()).collect();
        let mut sums = BTreeMap::new();
        for b in 1..surfaces.len() {
            for a in 0..b.min(fields.len()) {
                let common = [
                    [0, 1].map(|d| boxes[a][0][d].max(boxes[b][0][d]) - self.reach),
                    [0, 1].map(|d| boxes[a][1][d].min(boxes[b][1][d]) + self.reach),
                ];
                if (0..2).all(|d| common[0][d] <= common[1][d]) {
                    self.compare([a, b], [surfaces[a], surfaces[b]], common, &mut sums);
                }
            }
        }
        let meeting = |((control, bodies), sums): (Key, Sums)| {
            Some(Meeting { control, bodies, gap: sums.gap / sums.weight, normal: unit(sums.normal)? })
        };
        self.meetings = sums.into_iter().filter_map(meeting).collect();
    }

    /// Adds what the segments of two boundaries in a box see of each other.
    fn compare(
        &self,
        bodies: [usize; 2],
        surfaces: [&Surface; 2],
        common: [[f64; 2]; 2],
        sums: &mut BTreeMap<Key, Sums>,
    ) {
        let segments = surfaces.map(|surface| surface.segments_in(common));
        for (own, other, sign) in [(0, 1, 1.0), (1, 0, -1.0)] {
            for &segment in &segments[own] {
                let Center { position, normal, length } = surfaces[own].center(segment);
                let Some(nearest) = surfaces[other].nearest(position, &segments[other], self.reach) else { continue };
                if dot(normal, nearest.normal) > FACING {
                    continue;
                }
                let Some(normal) = unit([0, 1].map(|d| sign * (normal[d] - nearest.normal[d]))) else { continue };
                self.for_each_function(position, |control, n| {
                    let sum: &mut Sums = sums.entry((control, bodies)).or_default();
                    sum.weight += length * n;
                    sum.gap += length * n * nearest.distance;
                    sum.normal = [0, 1].map(|d| sum.normal[d] + length * n * normal[d]);
                });
            }
        }
    }

    /// Calls `f` with control point and value of the shape functions at a position of the patch.
    fn for_each_function(&self, position: [f64; 2], mut f: impl FnMut([usize; 2], f64)) {
        let spaces = &self.whole.spaces;
        let Some(span) = self.whole.locate(position).map(|place| place.span) else { return };
        let [x, y] = [0, 1].map(|d| spaces[d].shape_functions(span[d], position[d]));
        let first = [0, 1].map(|d| spaces[d].spans()[span[d]].first);
        for l in 0..=spaces[1].degree() {
            for k in 0..=spaces[0].degree() {
                let n = x.value[k] * y.value[l];
                if n > 0.0 {
                    f([first[0] + k, first[1] + l], n);
                }
            }
        }
    }

    /// Control points where bodies are near each other.
    pub fn meetings(&self) -> &[Meeting] {
        &self.meetings
    }

    /// What contact took and gave so far.
    pub fn ledger(&self) -> ContactLedger {
        self.ledger
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let rigid: usize = self.rigid.iter().map(|body| body.bytes()).sum();
        self.meetings.len() * size_of::<Meeting>() + 8 * (self.greville[0].len() + self.greville[1].len()) + rigid
    }
}
