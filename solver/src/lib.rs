//! placeholder tour
pub mod error;
pub mod scene;
pub mod validate;
