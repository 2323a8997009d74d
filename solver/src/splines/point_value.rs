//! A scalar field and its gradient at a position.

/// A scalar field and its gradient at a position.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointValue {
    /// Value.
    pub value: f64,
    /// Gradient, 1/m; of a function of parameters, 1/unit of the knots.
    pub gradient: [f64; 2],
}
