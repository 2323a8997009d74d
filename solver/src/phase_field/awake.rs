//! Where the phase field of a model with a threshold may change, and the state of its bounds: see
//! [`minimise`](super::minimise).
//!
//! Where c is 1 and the driving energy below the threshold, the residual of the phase-field equation keeps c
//! at its bound: nothing happens. A cell is awake where it is damaged or driven beyond the threshold. Control
//! points whose functions it sees are candidates: their values may change. Their rows of the matrix need the
//! cells that see one of them, and no others.
//!
//! The driving energy is computed in tiles with such cells and in those around them. A tile enters in time:
//! from half of the threshold on, in all of its energy.

use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::extremes::smaller;
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
    /// Room for the product `K c` during a solve.
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

/// Cells and control points that take part.
#[derive(Debug, Clone)]
pub(crate) struct Awake {
    /// Driving energy up to which material stays intact, J/m³: of every cell, or the same for all.
    threshold: Vec<f64>,
    /// Whether everything takes part in the coming solve.
    pub(super) everything: bool,
    /// Cells of which the driving energy is computed.
    pub computed: Vec<bool>,
    /// Cells whose energy is in the matrix; and all those of their tiles.
    assembled: Vec<bool>,
    pub damaged: Vec<bool>,
    /// Control points whose value may change, in order, and as marks.
    pub(super) candidates: Vec<usize>,
    is_candidate: Vec<bool>,
    /// Control points whose value may change at all, unless all may.
    allowed: Option<Vec<bool>>,
}

impl Awake {
    /// Everything is awake, until the first solve; `relative` are values of Gc over its mean at the points.
    pub(super) fn new(threshold: f64, lattice: &Lattice, relative: Option<&[Lane]>) -> Self {
        let (cells, control_points) = (lattice.cells(), lattice.patch_grid.len());
        let least =
            |cell: &[Lane]| threshold * cell.iter().flat_map(|relative| relative.0).fold(f64::INFINITY, smaller);
        let of_cells = |relative: &[Lane]| relative.chunks(lattice.points_per_span()).map(least).collect();
        Self {
            threshold: relative.map_or_else(|| vec![threshold], of_cells),
            everything: true,
            computed: vec![true; cells],
            assembled: vec![true; cells],
            damaged: vec![true; cells],
            candidates: Vec::new(),
            is_candidate: vec![false; control_points],
            allowed: None,
        }
    }

    /// Lets these control points alone change.
    pub(super) fn allow(&mut self, allowed: Vec<bool>) {
        if !allowed.contains(&true) {
            self.sleep();
            self.everything = false;
        }
        self.allowed = Some(allowed);
    }

    /// Cells whose driving energy is more than half of the threshold.
    pub(crate) fn near_the_threshold(&self, lattice: &Lattice, drive: &[Lane]) -> impl Iterator<Item = usize> {
        let part = fault!("refined-after-the-crack", 0.5 => f64::INFINITY);
        (0..self.computed.len()).filter(move |&cell| self.computed[cell] && self.is_driven(lattice, drive, cell, part))
    }

    /// Whether the driving energy of a point of a cell is more than a part of the threshold. Points outside
    /// of the body, without weight, see motions that it does not have.
    fn is_driven(&self, lattice: &Lattice, drive: &[Lane], cell: usize, part: f64) -> bool {
        let span = lattice.points_per_span();
        let enough = part * self.threshold[if self.threshold.len() > 1 { cell } else { 0 }];
        let is_enough = |drive: Lane| drive.0.iter().any(|&energy| energy > enough);
        let of_body = |batch: usize| {
            drive[batch].zip(lattice.weights_of(batch), |energy, weight| if weight > 0.0 { energy } else { 0.0 })
        };
        (cell * span..(cell + 1) * span).any(|batch| is_enough(drive[batch]) && is_enough(of_body(batch)))
    }

    /// Chooses the cells to compute: tiles where a cell is `driven` or c below 1, and those around them.
    /// Spans that a boundary or a slit cuts are always computed, and wake the tiles where they lie.
    pub(crate) fn choose(&mut self, lattice: &Lattice, driven: &[bool], phase: &[f64]) {
        let (strips, tiles) = (lattice.patch_strips(), lattice.tiles.len());
        let mut near = vec![false; strips * tiles];
        let is_awake = |cell: usize| driven[cell] || (self.computed[cell] && is_damaged(lattice, cell, phase));
        let seen = fault!("cut-spans-wake-nothing", driven.len() => lattice.patch_rows * tiles);
        for [strip, tile] in (0..seen).filter(|&cell| is_awake(cell)).flat_map(|cell| lattice.tiles_of_cell(cell)) {
            for around in strip.saturating_sub(1)..(strip + 2).min(strips) {
                near[around * tiles..][tile.saturating_sub(1)..(tile + 2).min(tiles)].fill(true);
            }
        }
        let everything = self.everything;
        for (cell, computed) in self.computed.iter_mut().enumerate() {
            let (row, tile) = (cell / tiles, cell % tiles);
            *computed = everything || lattice.patch_strip_of(row).is_none_or(|strip| near[strip * tiles + tile]);
        }
    }

    /// Smallest driving energy up to which material stays intact, J/m³.
    pub(crate) fn least_threshold(&self) -> f64 {
        self.threshold.iter().copied().fold(f64::INFINITY, smaller)
    }

    /// Whether the energy of a cell is in the matrix.
    pub(super) fn is_assembled(&self, cell: usize) -> bool {
        self.assembled[cell]
    }

    /// The candidates as part of the matrix.
    pub(super) fn active(&self, lattice: &Lattice) -> ActiveColumns {
        ActiveColumns::exactly(lattice.patch_grid, self.candidates.iter().copied())
    }

    /// Forgets the candidates.
    pub(super) fn sleep(&mut self) {
        [&mut self.is_candidate, &mut self.assembled, &mut self.damaged]
            .into_iter()
            .for_each(|marks| marks.fill(false));
        self.candidates.clear();
    }

    /// Finds the candidates at the present c; whether there are more than before.
    pub(super) fn wake(&mut self, lattice: &Lattice, drive: &[Lane], phase: &[f64]) -> bool {
        let cells = || (0..self.computed.len()).filter(|&cell| self.computed[cell]);
        let is_awake = |cell: usize| {
            self.everything || self.is_driven(lattice, drive, cell, 1.0) || is_damaged(lattice, cell, phase)
        };
        let (mut more, mut is_candidate) = (false, self.is_candidate.clone());
        for cell in cells().filter(|&cell| is_awake(cell)) {
            for row in lattice.functions_of_cell(cell) {
                more |= is_candidate[row.clone()].contains(&false);
                is_candidate[row].fill(true);
            }
        }
        if more {
            let near = |cell: usize| lattice.functions_of_cell(cell).any(|row| is_candidate[row].contains(&true));
            self.assembled = self.computed.iter().enumerate().map(|(cell, computed)| *computed && near(cell)).collect();
            let is_allowed = |at: usize| self.allowed.as_ref().is_none_or(|allowed| allowed[at]);
            let candidates = lattice.patch_grid.indices().filter(|&at| is_candidate[at] && is_allowed(at));
            self.candidates = candidates.collect();
            self.is_candidate = is_candidate;
            self.spread_over_tiles(lattice);
        }
        more
    }

    /// Marks all cells of the tiles in which one is assembled.
    fn spread_over_tiles(&mut self, lattice: &Lattice) {
        self.damaged.copy_from_slice(&self.assembled);
        let tiles = lattice.tiles.len();
        for strip in 0..lattice.table_strips() {
            for tile in 0..tiles {
                let cells = lattice.strip_rows(strip).map(|row| row * tiles + tile);
                if cells.clone().any(|cell| self.assembled[cell]) {
                    cells.for_each(|cell| self.damaged[cell] = true);
                }
            }
        }
    }
}

/// Whether c is below 1 at a function of a cell.
fn is_damaged(lattice: &Lattice, cell: usize, phase: &[f64]) -> bool {
    lattice.functions_of_cell(cell).any(|row| phase[row].iter().any(|&c| c < 1.0))
}
