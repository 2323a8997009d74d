//! Knot insertion in homogeneous coordinates: the same geometry on more control points.

use super::{NurbsError, NurbsPatch};
use crate::splines::insertion;

impl NurbsPatch {
    /// The same geometry with `new` knots inserted in a direction (0 or 1), in any order and repeated as
    /// given.
    ///
    /// # Errors
    /// If a knot is not strictly inside the patch, or appears more often than the degree afterwards.
    pub fn insert_knots(&self, direction: usize, new: &[f64]) -> Result<Self, NurbsError> {
        let space = &self.spaces[direction];
        let (degree, old) = (space.degree(), space.knot_vector());
        let mut all = [old, new].concat();
        all.sort_by(f64::total_cmp);
        super::check::knots(direction, degree, &all)?;
        self.with_direction_changed(direction, degree, &all, |line| {
            let mix = |a: f64, p: &[f64; 3], q: &[f64; 3]| [0, 1, 2].map(|c| a * p[c] + (1.0 - a) * q[c]);
            insertion::insert_knots(space, new, line.to_vec(), mix)
        })
    }

    /// The same geometry with every non-empty span of both directions cut into `parts` equal ones.
    ///
    /// # Panics
    /// If `parts` is zero.
    pub fn subdivide(&self, parts: usize) -> Result<Self, NurbsError> {
        assert!(parts > 0, "a span has at least one part");
        let mut patch = self.clone();
        for direction in 0..2 {
            let spans = self.spaces[direction].spans().iter();
            let new: Vec<f64> = spans
                .flat_map(|span| (1..parts).map(|i| span.left + span.length() * i as f64 / parts as f64))
                .collect();
            patch = patch.insert_knots(direction, &new)?;
        }
        Ok(patch)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_outside_or_too_many_are_refused() {
        let patch = NurbsPatch::quarter_annulus(1.0, 2.0).unwrap();
        for bad in [0.0, 1.0, -0.5, 2.0, f64::NAN] {
            let error = patch.insert_knots(1, &[0.5, bad]).unwrap_err();
            assert!(matches!(error, NurbsError::Knots { direction: 1, .. }), "{error}");
        }
        let error = patch.insert_knots(0, &[0.5, 0.5]).unwrap_err();
        assert!(matches!(error, NurbsError::Knots { direction: 0, .. }), "{error}");
        assert_eq!(patch.insert_knots(1, &[0.5, 0.5]).unwrap().spaces()[1].dimension(), 5);
        assert_eq!(patch.subdivide(4).unwrap().spaces()[0].spans().len(), 4);
    }
}
