//! Places of the body whose motion and stress are recorded.

use crate::dynamics::loads::carrier;
use crate::particles::lattice::Lattice;
use crate::scene::Probe;
use crate::splines::patch::{Patch, PointFunctions};

/// A place and the shape functions there.
#[derive(Debug, Clone)]
pub(super) struct ProbePlace {
    /// Its name.
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
