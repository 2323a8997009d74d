//! Bilinear finite elements with a phase field for the impact-loaded plate and the test of Kalthoff and
//! Winkler: a reference that shares no line with the solver it judges.
//!
//! Rectangles with 2 × 2 Gauss points, lumped mass, central differences; spectral split; AT2 with a history
//! field (Miehe et al. 2010, Borden et al. 2012) or AT1 with the last field as a bound; the phase field is
//! solved for in every step by conjugate gradients with Jacobi scaling. Modules, each calling only those
//! before it: [`mesh`], [`material`], [`element`]; [`stencil`], [`gradients`], [`bounded`] (linear algebra);
//! [`phase_field`], [`dynamics`], [`crack`]; [`plate`] and [`kalthoff`] (the runs). SI units, per metre of
//! thickness.

pub mod bounded;
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
