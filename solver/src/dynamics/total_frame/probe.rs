//! Places of the body whose motion and stress are recorded.

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
    /// `None` off the patch.
    pub(super) fn new(patch: &Patch, lattice: &Lattice, probe: &Probe) -> Option<Self> {
        let on_patch = patch.functions_at(probe.at)?;
        let mut functions = on_patch.clone();
        functions.lift(lattice.lift(on_patch.values[0].0, probe.at));
        Some(Self { name: probe.name.clone(), functions, on_patch })
    }
}
