//! The material at a point: elasticity, its energy split into what drives cracks and the rest, finite strain,
//! degradation, random toughness, and what a crack costs on a mesh.
//!
//! Symbols: e strain, sigma stress (Pa), psi+ and psi− energy densities (J/m³), F deformation gradient, g(c)
//! degradation. Calls [`linear_algebra`](crate::linear_algebra) and [`scene`](crate::scene).

pub mod cohesive;
pub mod degradation;
pub mod elasticity;
pub mod hencky;
pub mod mesh_toughness;
pub mod random_field;
pub mod split;
