//! What is wrong with a patch, or with a point that should lie on it. Directions count from 0, as in the
//! interface.

use thiserror::Error;

/// A patch that cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NurbsError {
    /// Degree out of range.
    #[error("direction {direction}: degree {degree} is not from 1 to 4")]
    Degree {
        /// Parametric direction.
        direction: usize,
        /// Degree asked for.
        degree: usize,
    },
    /// Too few knots.
    #[error("direction {direction}: {count} knots; an open knot vector of this degree has at least {least}")]
    KnotCount {
        /// Parametric direction.
        direction: usize,
        /// Knots given.
        count: usize,
        /// Least number.
        least: usize,
    },
    /// NaN or infinite knot.
    #[error("direction {direction}: knot {index} is {value}; knots are finite numbers")]
    KnotNotFinite {
        /// Parametric direction.
        direction: usize,
        /// Index of the knot.
        index: usize,
        /// The knot.
        value: f64,
    },
    /// Knots go back.
    #[error("direction {direction}: knot {index} is {value}, less than {previous} before it; knots never decrease")]
    DecreasingKnots {
        /// Parametric direction.
        direction: usize,
        /// Index of the smaller knot.
        index: usize,
        /// The knot before.
        previous: f64,
        /// The knot.
        value: f64,
    },
    /// An end knot is not repeated degree + 1 times.
    #[error(
        "direction {direction}: end knot {knot} appears {times} times; an open knot vector repeats it {expected} times"
    )]
    NotOpen {
        /// Parametric direction.
        direction: usize,
        /// The end knot.
        knot: f64,
        /// How often it appears.
        times: usize,
        /// Degree + 1.
        expected: usize,
    },
    /// An inner knot is repeated so often that the patch would fall apart.
    #[error(
        "direction {direction}: inner knot {knot} appears {times} times; more than the degree, {degree}, tears the patch"
    )]
    TornKnot {
        /// Parametric direction.
        direction: usize,
        /// The knot.
        knot: f64,
        /// How often it appears.
        times: usize,
        /// Degree.
        degree: usize,
    },
    /// Wrong number of control points.
    #[error("{given} control points; the knots and degrees ask for {columns} x {rows}")]
    ControlPointCount {
        /// Points given.
        given: usize,
        /// Basis functions in the first direction.
        columns: usize,
        /// Basis functions in the second.
        rows: usize,
    },
    /// Wrong number of weights.
    #[error("{given} weights for {expected} control points")]
    WeightCount {
        /// Weights given.
        given: usize,
        /// Control points.
        expected: usize,
    },
    /// NaN or infinite control point.
    #[error("control point ({column}, {row}) is ({}, {}); coordinates are finite numbers", value[0], value[1])]
    ControlPointNotFinite {
        /// Index in the first direction.
        column: usize,
        /// Index in the second.
        row: usize,
        /// The point, m.
        value: [f64; 2],
    },
    /// Weight not positive and finite.
    #[error("the weight of control point ({column}, {row}) is {value}; weights are positive and finite")]
    Weight {
        /// Index in the first direction.
        column: usize,
        /// Index in the second.
        row: usize,
        /// The weight.
        value: f64,
    },
    /// Geometry folded or inside out.
    #[error(
        "the geometry is folded in span ({}, {}): the Jacobian determinant is {determinant:e} at parameters ({}, {}); \
         move or reorder the control points so that the second direction lies to the left of the first",
        span[0], span[1], parameters[0], parameters[1]
    )]
    Folded {
        /// Span in each direction.
        span: [usize; 2],
        /// Gauss point.
        parameters: [f64; 2],
        /// Determinant there.
        determinant: f64,
    },
    /// A knot to insert is not strictly inside.
    #[error("direction {direction}: knot {knot} to insert is not strictly between {low} and {high}")]
    InsertOutside {
        /// Parametric direction.
        direction: usize,
        /// The knot.
        knot: f64,
        /// First knot.
        low: f64,
        /// Last knot.
        high: f64,
    },
    /// A rectangle without area.
    #[error("a rectangle from ({}, {}) to ({}, {}) has no area; both coordinates must grow", low[0], low[1], high[0], high[1])]
    Rectangle {
        /// Lower left corner, m.
        low: [f64; 2],
        /// Upper right corner, m.
        high: [f64; 2],
    },
    /// Radii not 0 ≤ inner < outer.
    #[error("radii {inner} and {outer}: the inner one is at least 0 and less than the outer one")]
    Radii {
        /// Inner radius, m.
        inner: f64,
        /// Outer radius, m.
        outer: f64,
    },
    /// Angles not increasing or more than a turn apart.
    #[error("angles {start} to {end}: the second is larger, by at most a full turn (radians)")]
    Angles {
        /// First angle.
        start: f64,
        /// Last angle.
        end: f64,
    },
}

/// A point that could not be mapped back.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum LocateError {
    /// The point is not on the patch.
    #[error(
        "the point ({}, {}) lies outside the patch; the nearest point found is ({}, {}), {distance:e} m away",
        point[0], point[1], nearest[0], nearest[1]
    )]
    Outside {
        /// The point, m.
        point: [f64; 2],
        /// Nearest point of the patch that the search met, m.
        nearest: [f64; 2],
        /// Its distance, m.
        distance: f64,
    },
    /// The point is on the patch, where the geometry is folded or collapsed.
    #[error(
        "the point ({}, {}) lies where the geometry is folded or collapsed: the Jacobian determinant is {determinant:e} \
         at parameters ({}, {})",
        point[0], point[1], parameters[0], parameters[1]
    )]
    Folded {
        /// The point, m.
        point: [f64; 2],
        /// Its parameters.
        parameters: [f64; 2],
        /// Determinant there.
        determinant: f64,
    },
    /// NaN or infinite point.
    #[error("the point ({}, {}) is not finite", point[0], point[1])]
    NotFinite {
        /// The point, m.
        point: [f64; 2],
    },
}
