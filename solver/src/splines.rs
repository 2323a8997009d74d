//! Splines (E 13): knot vectors and their spaces, NURBS patches and the background mesh, Gauss points.
//!
//! Symbols: N_a shape functions of control point a, xi parameters, w_a weights, P_a control points (m).
//! Calls [`linear_algebra`](crate::linear_algebra) and [`scene`](crate::scene).

pub(crate) mod insertion;
pub mod nurbs;
pub mod patch;
pub mod quadrature;
pub mod spline;
