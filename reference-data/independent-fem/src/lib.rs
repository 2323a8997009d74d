//! Bilinear finite elements with a phase field for the impact-loaded plate and the benchmarks: a reference
//! that shares no line with the solver it judges.
//!
//! Rectangles with 2 × 2 Gauss points, lumped mass, central differences; spectral split; AT2 with a history
//! field (Miehe et al. 2010, Borden et al. 2012) or AT1 with the last field as a bound; the phase field is
//! solved for in every step by conjugate gradients with Jacobi scaling. Quadrilaterals of any shape, with
//! AT1, are a second body ([`quad_body`]). Modules, each calling only those before it: [`mesh`],
//! [`material`], [`element`]; [`stencil`], [`gradients`], [`bounded`] (linear algebra); [`phase_field`],
//! [`dynamics`], [`crack`]; [`quads`], [`random`], [`quad_body`]; [`plate`], [`kalthoff`] and [`mapped`] (the
//! runs). SI units, per metre of thickness.

pub mod bounded;
pub mod crack;
pub mod dynamics;
pub mod element;
pub mod gradients;
pub mod kalthoff;
pub mod mapped;
pub mod material;
pub mod mesh;
pub mod phase_field;
pub mod plate;
pub mod quad_body;
pub mod quads;
pub mod random;
pub mod stencil;
