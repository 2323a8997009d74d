//! State of the bounds of the phase field: see [`minimise`](super::minimise).

use super::awake::Awake;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::lane::Lane;
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
    pub(super) linearised: Option<Box<Linearised>>,
}

/// What an equation that is not linear in c is linearised with: see [`newton`](super::newton).
#[derive(Debug, Clone)]
pub(super) struct Linearised {
    /// Right-hand side of the intact body.
    pub(super) rest: Vec<f64>,
    /// Energies at the points that would give the brackets of K with a quadratic degradation, J/m³.
    pub(super) energies: Vec<Lane>,
    /// Whether the brackets of K are kept positive.
    pub(super) convex: bool,
}

impl Linearised {
    fn new(rest: &[f64], batches: usize) -> Box<Self> {
        Box::new(Self { rest: rest.to_vec(), energies: vec![Lane::ZERO; batches], convex: false })
    }
}

impl Bounds {
    /// Of an intact body with this right-hand side, and values of Gc over its mean at the points.
    pub(super) fn new(
        threshold: f64,
        lattice: &Lattice,
        relative: Option<&[Lane]>,
        model: &FractureModel,
        load: &[f64],
    ) -> Box<Self> {
        let zeros = || lattice.patch_grid.zeros();
        Box::new(Self {
            awake: Awake::new(threshold, lattice, relative),
            residual: zeros(),
            work: 0.0,
            held: Vec::new(),
            image: zeros(),
            linearised: matches!(model.law, CrackLaw::Cohesive(_)).then(|| Linearised::new(load, lattice.batches())),
        })
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { awake: _, residual, work, held, image: _, linearised: _ } = self;
        archive.list(residual)?;
        *held = (0..residual.len()).filter(|&at| residual[at] != 0.0).collect();
        archive.value(work)
    }

    /// Heap memory, bytes.
    pub(super) fn bytes(&self) -> usize {
        let lanes = self.linearised.as_ref().map_or(0, |linearised| linearised.energies.len());
        16 * self.residual.len() + size_of::<Lane>() * lanes
    }
}
