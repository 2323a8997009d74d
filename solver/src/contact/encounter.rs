//! Where two boundaries are near each other, square by square.

/// What the segments of two bodies see of each other whose middle of the gap lies in a square: sums.
pub(super) struct Encounter {
    pub bodies: [usize; 2],
    pub square: [i32; 2],
    pub count: f64,
    pub position: [f64; 2],
    pub gap: f64,
    pub normal: [f64; 2],
}

impl Encounter {
    pub(super) fn new(bodies: [usize; 2], square: [i32; 2]) -> Self {
        Self { bodies, square, count: 0.0, position: [0.0; 2], gap: 0.0, normal: [0.0; 2] }
    }

    pub(super) fn position(&self) -> [f64; 2] {
        self.position.map(|sum| sum / self.count)
    }
}
