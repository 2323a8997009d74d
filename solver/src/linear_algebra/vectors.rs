//! Vectors in the plane.

/// The direction of a sum of vectors, unless it is next to nothing beside the sum of their lengths.
pub(crate) fn unit(vector: [f64; 2], lengths: f64) -> Option<[f64; 2]> {
    let length = vector[0].hypot(vector[1]);
    (length > 1e-6 * lengths).then(|| vector.map(|x| x / length))
}

/// Scalar product of two vectors.
pub(crate) fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The cofactor of a gradient times a vector. With the gradient of a displacement, `(I + cof grad u) n dS` is
/// the element of length of a boundary after the displacement with its normal (Nanson's formula): in the
/// plane it is linear in u.
pub(crate) fn cofactor([[xx, xy], [yx, yy]]: [[f64; 2]; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    [yy * x - yx * y, xx * y - xy * x]
}
