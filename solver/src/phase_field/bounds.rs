//! State of the bounds of the phase field: see [`minimise`](super::minimise).

use super::awake::Awake;
use super::tangent::Tangent;
use crate::checkpoint::{Archive, StateError};
use crate::material::degradation::{CrackLaw, FractureModel};
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
    /// If the equation is not linear.
    pub(super) tangent: Option<Box<Tangent>>,
}

impl Bounds {
    /// Of an intact body with this right-hand side.
    pub(super) fn new(threshold: f64, lattice: &Lattice, model: &FractureModel, load: &[f64]) -> Box<Self> {
        let zeros = || lattice.patch_grid.zeros();
        Box::new(Self {
            awake: Awake::new(threshold, lattice),
            residual: zeros(),
            work: 0.0,
            held: Vec::new(),
            image: zeros(),
            tangent: match model.law {
                CrackLaw::Cohesive(law) => Some(Tangent::new(law, load, lattice.batches())),
                _ => None,
            },
        })
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { awake: _, residual, work, held, image: _, tangent: _ } = self;
        archive.list(residual)?;
        *held = (0..residual.len()).filter(|&at| residual[at] != 0.0).collect();
        archive.value(work)
    }

    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        let tangent = self.tangent.as_ref().map_or(0, |tangent| tangent.bytes());
        8 * (2 * self.residual.len() + self.held.len()) + self.awake.bytes() + tangent
    }
}
