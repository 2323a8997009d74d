//! Linear algebra: values of several points side by side, matrices whose rows couple neighbouring control
//! points, conjugate gradients with incomplete and complete factors.
//!
//! Symbols: A a symmetric matrix, M its preconditioner, r a residual. Calls no other module but
//! [`checkpoint`](crate::checkpoint).

pub mod active_columns;
pub mod cholesky;
pub mod conjugate_gradients;
pub mod control_grid;
pub mod extremes;
pub mod incomplete_cholesky;
pub(crate) mod interface;
pub mod lane;
pub mod preconditioner;
pub mod stencil;
mod terms;
pub(crate) mod vectors;
