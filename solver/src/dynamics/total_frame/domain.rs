//! What is recorded at places of a body: domains of J-integrals, and places whose motion and stress are.

use std::sync::Arc;

use crate::dynamics::body_sample::column_name;
use crate::dynamics::loads::carrier;
use crate::dynamics::surface::points_around;
use crate::particles::lattice::Lattice;
use crate::scene::{Body, Crack, JIntegral, Probe, Shape};
use crate::splines::patch::{Patch, PointFunctions};

/// A J-integral, with its axis.
#[derive(Debug, Clone)]
pub(crate) struct Domain {
    /// Name of its column.
    pub column: String,
    /// Radius of the domain about the tip, m.
    pub radius: f64,
    /// Where the tip is if it does not move, or before there is a crack, m.
    pub tip: [f64; 2],
    /// Whether it is the tip of a crack that runs.
    pub moves: bool,
    /// Unit vector along the crack.
    pub axis: [f64; 2],
    /// Positions along the boundary of the body, m.
    pub boundary: Arc<Vec<[f64; 2]>>,
    /// Cracks at the start besides the nearest to the tip, and those that continue it in a straight line.
    others: Vec<Crack>,
}

impl Domain {
    /// Those of a scene, as far as it says where the tip is, and where the crack goes.
    pub(crate) fn all(patch: &Patch, body: &Body, integrals: &[JIntegral]) -> Vec<Self> {
        let (min, max) = patch.bounding_box();
        let shape = if body.shape == Shape::Patch { &Shape::Rectangle { min, max } } else { &body.shape };
        let places = || points_around(patch, shape).into_iter().map(|point| point.position).collect();
        let boundary = if integrals.is_empty() { Arc::default() } else { Arc::new(places()) };
        let domain = |integral: &JIntegral| {
            let (tip, axis) = integral.tip_and_axis(body)?;
            let (column, boundary) = (column(integral), Arc::clone(&boundary));
            let mut others = body.cracks.clone();
            others.sort_by(|a, b| a.distance(tip).total_cmp(&b.distance(tip)));
            others.drain(..others.len().min(1));
            others.retain(|crack| !continues(crack, tip, axis, integral.radius));
            Some(Self { column, radius: integral.radius, tip, moves: integral.at.is_none(), axis, boundary, others })
        };
        integrals.iter().filter_map(domain).collect()
    }

    /// Whether the body fills it about a tip (m), without another crack.
    pub(crate) fn is_filled(&self, tip: [f64; 2], shape: &Shape) -> bool {
        let reaches = |place: &[f64; 2]| (place[0] - tip[0]).hypot(place[1] - tip[1]) < self.radius;
        let is_free = self.others.iter().all(|crack| crack.distance(tip) >= self.radius);
        shape.contains(tip) && is_free && !self.boundary.iter().any(reaches)
    }
}

/// Whether a crack touches the tip (m) and lies along the axis; for lengths of the order of the radius (m).
fn continues(crack: &Crack, tip: [f64; 2], axis: [f64; 2], radius: f64) -> bool {
    let aside = |place: &[f64; 2]| (axis[0] * (place[1] - tip[1]) - axis[1] * (place[0] - tip[0])).abs();
    let tolerance = 1e-9 * radius;
    crack.distance(tip) <= tolerance && crack.points.iter().all(|place| aside(place) <= tolerance)
}

/// Column of the history, J/m².
pub fn column(integral: &JIntegral) -> String {
    let name = integral.name.as_ref().map_or(String::new(), |name| format!("{}_", column_name(name)));
    format!("{name}j_integral_j_per_m2")
}

/// A place and the shape functions there.
#[derive(Debug, Clone)]
pub(super) struct ProbePlace {
    /// Name of the probe, as the scene gives it.
    pub name: String,
    /// Functions with the control points of its side of a slit.
    pub functions: PointFunctions,
    /// Functions with the control points of the patch, which the phase field has.
    pub on_patch: PointFunctions,
}

impl ProbePlace {
    /// `None` off the patch. On the boundary of the body the nearest span of control points that can move
    /// stands for the place: `moves` says which have mass.
    pub(super) fn new(patch: &Patch, lattice: &Lattice, probe: &Probe, moves: impl Fn(usize) -> bool) -> Option<Self> {
        let carries =
            |first, at| lattice.has_side(first, probe.at) && moves(lattice.control_point(at, first, probe.at));
        let span = patch.geometry.is_none().then(|| carrier(patch, probe.at, carries)).flatten();
        let on_patch = span.map(|span| patch.functions(span)).or_else(|| patch.functions_at(probe.at))?;
        let mut functions = on_patch.clone();
        functions.lift(lattice.lift(on_patch.values[0].0, probe.at));
        Some(Self { name: probe.name.clone(), functions, on_patch })
    }
}
