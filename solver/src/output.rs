//! What a run shows: pictures, states of points and extremes, spans that hold material.

pub mod inspection;
pub mod picture;
pub mod span_grid;
