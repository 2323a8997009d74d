//! Sums between material points and control points in the total frame (E 15–18): sweeps over points, and what
//! they compute at each. Those of the updated frame are in `dynamics/updated_frame/transfer.rs`, and what
//! velocity a point gets (FLIP, XPIC, …) is in `dynamics/updated_frame/velocity_transfer.rs`.
//!
//! Symbols: N_a(x_p) and its gradient, sigma Kirchhoff's or Cauchy's stress (Pa), f nodal forces (N/m).
//! Calls [`particles`](crate::particles), [`material`](crate::material) and [`splines`](crate::splines).

pub mod finite;
pub mod kernels;
pub mod point_kernel;
pub mod sweep;
