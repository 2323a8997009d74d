//! Fields on two nested grids: control values of the fine one that the coarse one determines.
//!
//! Symbols: R the matrix of knot insertion, whose rows have the sum 1.

use super::lane::Scalar;

/// Fine control points whose values are `u_f = R u_c`, and whose forces act as `f_c += Rᵀ f_f`.
#[derive(Debug, Clone, Default)]
pub(crate) struct Interface {
    points: Vec<usize>,
    /// Number of the first entry of each point, and of all.
    starts: Vec<usize>,
    /// Index in a coarse field, and weight.
    entries: Vec<(usize, f64)>,
}

impl Interface {
    /// Of fine control points with their rows of R.
    pub(crate) fn new(rows: impl Iterator<Item = (usize, Vec<(usize, f64)>)>) -> Self {
        let mut interface = Self { starts: vec![0], ..Self::default() };
        for (point, row) in rows {
            interface.points.push(point);
            interface.entries.extend(row);
            interface.starts.push(interface.entries.len());
        }
        interface
    }

    /// Fine control points with their rows of R.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, &[(usize, f64)])> {
        self.points.iter().zip(self.starts.windows(2)).map(|(point, ends)| (*point, &self.entries[ends[0]..ends[1]]))
    }

    /// Sets the fine values: `u_f = R u_c`.
    pub(crate) fn spread<T: Scalar>(&self, coarse: &[T], fine: &mut [T]) {
        for (point, row) in self.rows() {
            fine[point] = T::of(row.iter().map(|&(at, weight)| weight * coarse[at].into()).sum());
        }
    }

    /// Moves fine forces to the coarse control points: `f_c += Rᵀ f_f`, `f_f = 0`.
    pub(crate) fn fold<T: Scalar>(&self, fine: &mut [T], coarse: &mut [T]) {
        for (point, row) in self.rows() {
            let force: f64 = std::mem::replace(&mut fine[point], T::ZERO).into();
            for &(at, weight) in row {
                coarse[at] = T::of(coarse[at].into() + fault!("forces-of-the-interface-lost", weight * force => 0.0));
            }
        }
    }
}

/// Sets the values of a chain of fields, coarse to fine, that the coarser ones determine.
pub(crate) fn spread_all<T: Scalar>(interfaces: &[Interface], fields: &mut [&mut [T]]) {
    for (level, interface) in interfaces.iter().enumerate() {
        let (coarse, fine) = fields.split_at_mut(level + 1);
        interface.spread(coarse[level], fine[0]);
    }
}

/// Moves the forces of a chain of fields, fine to coarse.
pub(crate) fn fold_all<T: Scalar>(interfaces: &[Interface], fields: &mut [&mut [T]]) {
    for (level, interface) in interfaces.iter().enumerate().rev() {
        let (coarse, fine) = fields.split_at_mut(level + 1);
        interface.fold(fine[0], coarse[level]);
    }
}
