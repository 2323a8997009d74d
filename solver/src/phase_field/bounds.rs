//! State of the bounds of the phase field: see [`minimise`](super::minimise).

use super::awake::Awake;
use crate::checkpoint::{Archive, StateError};
use crate::particles::lattice::Lattice;

/// State of the bounds.
#[derive(Debug, Clone)]
pub(super) struct Bounds {
    pub(super) awake: Awake,
    /// `K c − b` at the last step; zero where nothing is awake.
    pub(super) residual: Vec<f64>,
    /// Work of the bounds so far, J/m.
    pub(super) work: f64,
    /// Control points where the residual is not zero.
    pub(super) held: Vec<usize>,
    /// Room for `K c`.
    pub(super) image: Vec<f64>,
}

impl Bounds {
    pub(super) fn new(threshold: f64, lattice: &Lattice) -> Box<Self> {
        let zeros = || lattice.patch_grid.zeros();
        Box::new(Self {
            awake: Awake::new(threshold, lattice),
            residual: zeros(),
            work: 0.0,
            held: Vec::new(),
            image: zeros(),
        })
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { awake: _, residual, work, held, image: _ } = self;
        archive.list(residual)?;
        *held = (0..residual.len()).filter(|&at| residual[at] != 0.0).collect();
        archive.value(work)
    }

    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        8 * (2 * self.residual.len() + self.held.len()) + self.awake.bytes()
    }
}
