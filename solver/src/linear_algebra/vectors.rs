//! Vectors in the plane.

/// The direction of a vector, unless it is next to nothing beside a unit vector.
pub(crate) fn unit(vector: [f64; 2]) -> Option<[f64; 2]> {
    let length = vector[0].hypot(vector[1]);
    (length > 1e-6).then(|| vector.map(|x| x / length))
}

/// Scalar product.
pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}
