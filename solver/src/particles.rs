//! Material points: their layouts in the spans of the mesh, tiles of spans that are computed together,
//! lengths of spans.
//!
//! Symbols: V_p volume (m²), x_p position (m). Calls [`splines`](crate::splines) and [`scene`](crate::scene).

pub(crate) mod follower;
pub mod lattice;
pub mod points;
pub mod spans;
