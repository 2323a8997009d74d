//! Transfers between material points and control points (E 15–18): sweeps over points, and what they compute
//! at each.
//!
//! Symbols: N_a(x_p) and its gradient, sigma Kirchhoff's or Cauchy's stress (Pa), f nodal forces (N/m).
//! Calls [`particles`](crate::particles), [`material`](crate::material) and [`splines`](crate::splines).

pub(crate) mod elastic_forces;
pub(crate) mod finite;
pub mod kernels;
pub mod point_kernel;
pub mod sweep;
