//! placeholder tour
pub mod error;
pub mod scene;
