//! Nodal forces of an elastic body.

use super::finite::sweep_with;
use super::kernels::ElasticStress;
use super::point_kernel::Fields;
use super::sweep::StripForces;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::lane::Lane;
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::Lattice;
use crate::scene::Kinematics;

/// Nodal forces (N/m) of the elastic stress under a displacement (m); returns the elastic energy, J/m.
pub(crate) fn elastic_forces(
    lattice: &Lattice,
    moduli: ElasticModuli,
    kinematics: Kinematics,
    displacement: &VectorField,
    strips: &mut StripForces,
    out: &mut VectorField,
) -> f64 {
    let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
    let energy = elastic_sweep(lattice, moduli, kinematics, fields, strips);
    strips.assemble(lattice.grid.stride, out);
    energy
}

/// Forces (N/m) of the elastic stress, strip by strip; returns the elastic energy, J/m.
pub(crate) fn elastic_sweep(
    lattice: &Lattice,
    moduli: ElasticModuli,
    kinematics: Kinematics,
    fields: Fields,
    strips: &mut StripForces,
) -> f64 {
    let mut kernels: Vec<_> = (0..lattice.strips()).map(|_| ElasticStress { moduli, energy: Lane::ZERO }).collect();
    sweep_with(kinematics, lattice, fields, &mut kernels, Some(strips));
    kernels.iter().map(|k| k.energy.sum()).sum()
}
