//! Bilinear finite elements with an AT2 phase field for the impact-loaded plate: a reference that shares no
//! line with the solver it judges.
//!
//! Rectangles with 2 × 2 Gauss points, lumped mass, central differences; spectral split and history field
//! (Miehe et al. 2010, Borden et al. 2012); the phase field is solved for in every step by conjugate
//! gradients with Jacobi scaling. Modules, each calling only those before it: [`mesh`], [`material`],
//! [`element`]; [`stencil`] and [`gradients`] (linear algebra); [`phase_field`], [`dynamics`], [`crack`];
//! [`plate`] and [`kalthoff`] (the runs). SI units, per metre of thickness.

pub mod crack;
pub mod dynamics;
pub mod element;
pub mod gradients;
pub mod kalthoff;
pub mod material;
pub mod mesh;
pub mod phase_field;
pub mod plate;
pub mod stencil;
