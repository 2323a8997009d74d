//! What is wrong with a patch, or with a point that should lie on it. Directions count from 0, as in the
//! interface.

use thiserror::Error;

/// A patch that cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NurbsError {
    /// Knots that are no open knot vector of a degree from 1 to 4.
    #[error("direction {direction}: {what}")]
    Knots {
        /// Parametric direction.
        direction: usize,
        /// What is wrong, and where.
        what: String,
    },
    /// Control points of another number than knots and degrees ask for, or that are not finite.
    #[error("{0}")]
    ControlPoints(String),
    /// Weights of another number than control points, or that are not positive and finite.
    #[error("{0}")]
    Weights(String),
    /// Geometry folded or inside out.
    #[error(
        "the geometry is folded in span ({}, {}): the Jacobian determinant is {determinant:e} at parameters ({}, {}); \
         move or reorder the control points so that the second direction lies to the left of the first",
        span[0], span[1], parameters[0], parameters[1]
    )]
    Folded {
        /// Span in each direction.
        span: [usize; 2],
        /// Parameters of a Gauss point where it is folded, in the unit of the knots.
        parameters: [f64; 2],
        /// Jacobian determinant at that Gauss point: not positive, or not finite.
        determinant: f64,
    },
    /// A rectangle or a sector of a ring without area.
    #[error("{0}")]
    Empty(String),
}

/// A point that could not be mapped back.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LocateError {
    /// The point is not on the patch.
    #[error("it lies outside the patch; the nearest point found is ({}, {}), {distance:e} m away", nearest[0], nearest[1])]
    Outside {
        /// Nearest point of the patch that the search met, m.
        nearest: [f64; 2],
        /// Distance of that nearest point from the given point, m.
        distance: f64,
    },
    /// The point is on the patch, where the geometry is folded or collapsed.
    #[error("the geometry is folded or collapsed there: the Jacobian determinant is {determinant:e}")]
    Folded {
        /// Jacobian determinant at the point: about zero, negative or not a number.
        determinant: f64,
    },
    /// NaN or infinite point.
    #[error("the point is not finite")]
    NotFinite,
}
