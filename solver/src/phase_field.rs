//! The phase-field equation of a body (E 10–12, 19–24), AT2 in Borden's convention, c = 1 intact.
//!
//! ```text
//! Σ_J K_IJ c_J = Σ_p V_p N_I(x_p)
//! K_IJ = Σ_p V_p [ (4 l0 (1 − k) H_p/Gc + 1) N_I N_J + 4 l0² grad N_I · grad N_J ]
//! ```
//!
//! The points' volumes enter once (the source prints them twice in E 24) and the `+ 1` stands (E 9 and 11
//! drop it). The history energy H only grows, and so does K: only spans whose H grew since the last solve are
//! added (delta assembly). An increment too small to move c by a hundredth of the tolerance anywhere waits.
//!
//! AT1 has other coefficients (`material/degradation.rs`), and bounds in place of a history
//! (`phase_field/minimise.rs`). With a cohesive crack the equation is not linear (`phase_field/newton.rs`).
//!
//! # The tolerance
//!
//! A solve ends when its error e in c is, in the energy norm of the equation over the diffusion `4 l0²`,
//! about the tolerance:
//!
//! ```text
//! ∫ [ (4 l0 (1 − k) H/Gc + 1) e²/(4 l0²) + |grad e|² ] dx ≤ tolerance²
//! ```
//!
//! Every part of the body obeys it alone: in any square of side 2 l0 the root mean square of e is at most the
//! tolerance, wherever it lies, however fine the mesh is there, and however large the body around it. The
//! norm of the residual over that of the right-hand side, a sum of volumes, would allow more at the crack the
//! larger the mesh is.

mod advance;
pub mod assembly;
mod awake;
pub mod fracture;
pub(crate) mod lag;
pub(crate) mod levels;
mod method;
mod minimise;
mod newton;
mod toughness;

use serde::{Deserialize, Serialize};

use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::{Convergence, SolveFailure};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{LANES, Lane};
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::linear_algebra::stencil::Stencil;
use crate::material::degradation::FractureModel;
use crate::particles::lattice::Lattice;
use crate::phase_field::assembly::{Increments, Integrand, Scaled, add_form, changed};
use crate::scene::{Anisotropy, SolverSettings};
use awake::Bounds;
use lag::Lag;
use method::{ITERATION_LIMIT, Method};

/// Diagonal and right-hand side of control points without material, as a fraction of the largest right-hand
/// side.
const EMPTY: f64 = 1e-6;

/// Diagonal, of the largest, up to which a control point sees too little material: in a corner of a cut span.
const NOTHING: f64 = 1e-28;

/// What is added to the diagonal of a body with cut spans, of itself.
const SEPARATE: f64 = 1e-14;

/// Counters of the phase-field solver.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhaseFieldCounts {
    /// Number of linear systems that were solved so far.
    pub solves: usize,
    /// Number of iterations in all these solves; a direct solve counts as one.
    pub iterations: usize,
}

impl PhaseFieldCounts {
    /// Of two solvers together.
    #[must_use]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { solves: self.solves + other.solves, iterations: self.iterations + other.iterations }
    }
}

/// Phase field of one body on its control points.
#[derive(Debug, Clone)]
pub struct PhaseField {
    model: FractureModel,
    tolerance: f64,
    matrix: Stencil,
    pub(crate) load: Vec<f64>,
    /// Control values, and those of the solve before.
    phase: Vec<f64>,
    previous: Vec<f64>,
    /// History energy that is in the matrix.
    assembled: Vec<Lane>,
    method: Method,
    /// If there are steps without a solve.
    lag: Option<Box<Lag>>,
    /// If the model has a threshold.
    bounds: Option<Box<Bounds>>,
    pub(crate) counts: PhaseFieldCounts,
}

impl PhaseField {
    /// Phase field on the points of `lattice`, intact until the first solve.
    pub fn new(lattice: &Lattice, model: FractureModel, settings: &SolverSettings) -> Self {
        Self::with_toughness(lattice, model, None, settings)
    }

    /// As [`Self::new`]; with values of Gc over its mean at the points, unless it is the same everywhere.
    pub(crate) fn with_toughness(
        lattice: &Lattice,
        model: FractureModel,
        relative: Option<&[Lane]>,
        settings: &SolverSettings,
    ) -> Self {
        let mut matrix = Stencil::zeros(lattice.patch_grid, lattice.degree);
        let mut load = add_forms(&mut matrix, lattice, &model, relative, 1.0);
        isolate_empty(&mut matrix, &mut load);
        if lattice.has_cut_spans() {
            // in a pointed tip just beyond a knot functions are alike to round-off
            matrix.grid.indices().for_each(|at| matrix.set_diagonal(at, matrix.diagonal(at) * (1.0 + SEPARATE)));
        }
        let at_rest = model.threshold().map_or(0.0, |_| model.source() / model.reaction_per_energy());
        let assembled = vec![Lane::splat(at_rest); lattice.batches()];
        let mut field = Self::intact(matrix, load, assembled, model, settings);
        let bounds = |threshold| Bounds::new(threshold, lattice, relative, &model, &field.load);
        field.bounds = model.threshold().map(bounds);
        field
    }

    /// Phase field whose system is assembled anew at every step (see [`Self::system_mut`]), intact until the
    /// first solve.
    pub(crate) fn without_lattice(
        grid: ControlGrid,
        degree: [usize; 2],
        model: FractureModel,
        settings: &SolverSettings,
    ) -> Self {
        Self::intact(Stencil::zeros(grid, degree), grid.zeros(), Vec::new(), model, settings)
    }

    fn intact(
        matrix: Stencil,
        load: Vec<f64>,
        assembled: Vec<Lane>,
        model: FractureModel,
        settings: &SolverSettings,
    ) -> Self {
        let mut phase = matrix.grid.zeros();
        matrix.grid.indices().for_each(|at| phase[at] = 1.0);
        Self {
            model,
            tolerance: fault!("phase-tolerance-ignored", settings.phase_field_tolerance => 1e-2),
            load,
            previous: phase.clone(),
            lag: Lag::new(settings.phase_field_interval, &phase),
            bounds: None,
            phase,
            method: Method::new(
                &matrix,
                settings.phase_field_solver,
                assembled.is_empty() || model.threshold().is_some(),
            ),
            assembled,
            matrix,
            counts: PhaseFieldCounts::default(),
        }
    }

    /// Goes over to another grid, whose first control column and row lie `shift` columns and rows further;
    /// control points that were not there begin intact.
    pub(crate) fn relocate(&mut self, grid: ControlGrid, shift: [isize; 2]) {
        let old = self.matrix.grid;
        let moved = |values: &[f64]| {
            let mut moved = grid.zeros();
            for at in grid.indices() {
                let column = (grid.column_of(at) as isize + shift[0]) as usize; // wraps around when negative
                let row = (grid.row_of(at) as isize + shift[1]) as usize;
                moved[at] = if column < old.columns && row < old.rows { values[old.index(column, row)] } else { 1.0 };
            }
            moved
        };
        (self.phase, self.previous) = (moved(&self.phase), moved(&self.previous));
        self.matrix = Stencil::zeros(grid, self.matrix.degree());
        self.load = grid.zeros();
        self.method = self.method.anew(&self.matrix);
    }

    /// Matrix and right-hand side, to be assembled by the caller.
    pub(crate) fn system_mut(&mut self) -> (&mut Stencil, &mut Vec<f64>) {
        (&mut self.matrix, &mut self.load)
    }

    /// Leaves others than these control points out of the system.
    pub(crate) fn restrict(&mut self, active: ActiveColumns) {
        self.matrix.restrict(active);
    }

    /// Takes control values from those of a coarser level, now and at the last solves: `spread` sets them in
    /// a field from another.
    pub(crate) fn take_values(&mut self, coarse: &Self, spread: impl Fn(&[f64], &mut [f64])) {
        spread(&coarse.phase, &mut self.phase);
        spread(&coarse.previous, &mut self.previous);
        if let (Some(coarse), Some(lag)) = (&coarse.lag, &mut self.lag) {
            spread(&coarse.solved, &mut lag.solved);
        }
    }

    /// Replaces the right-hand side: `Σ_p V_p s_p N_I(x_p)` with a manufactured source s.
    pub fn set_load(&mut self, load: Vec<f64>) {
        if let Some(linearised) = self.bounds.as_mut().and_then(|bounds| bounds.linearised.as_mut()) {
            linearised.rest.clone_from(&load);
        }
        self.load = load;
    }

    /// Control values of c.
    pub fn control_values(&self) -> &[f64] {
        &self.phase
    }

    /// Solves for c with the history energy (J/m³) of every batch of points.
    ///
    /// # Errors
    /// If the tolerance is not reached, or the system has no solution; errors are in the norm of the
    /// tolerance.
    pub fn solve(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Convergence, SolveFailure> {
        if let Some(mut bounds) = self.bounds.take() {
            let result = self.minimise(&mut bounds, lattice, history);
            self.bounds = Some(bounds);
            return result;
        }
        self.assemble_history(lattice, history);
        self.solve_system()
    }

    /// Solves the system as it stands.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn solve_system(&mut self) -> Result<Convergence, SolveFailure> {
        self.solve_with(TOO_MANY, 1.0)
    }

    /// Solves the system as it stands; `patience` is the number of iterations that an incomplete factor is
    /// granted, and `ahead` the time since the last solve over that between the last two.
    fn solve_with(&mut self, patience: usize, ahead: f64) -> Result<Convergence, SolveFailure> {
        self.extrapolate(ahead);
        self.solve_from_here(patience)
    }

    /// Solves the system as it stands from the present c.
    fn solve_from_here(&mut self, patience: usize) -> Result<Convergence, SolveFailure> {
        self.counts.solves += 1;
        let unit = self.model.diffusion().sqrt();
        let found = self.method.solve(&self.matrix, &self.load, &mut self.phase, unit * self.tolerance, patience);
        let found = found.map_err(|failure| in_the_norm(failure, unit, || is_finite(&self.matrix)))?;
        let convergence = Convergence { error: found.error / unit, ..found };
        self.counts.iterations += convergence.iterations;
        Ok(convergence)
    }

    /// First solve with a seeded crack: the factor is made for it, and there is nothing to extrapolate from.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn initialise(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Convergence, SolveFailure> {
        if self.bounds.is_some() {
            return self.solve(lattice, history);
        }
        self.assemble_history(lattice, history);
        self.initialise_system()
    }

    /// First solve of the system as it stands.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub(crate) fn initialise_system(&mut self) -> Result<Convergence, SolveFailure> {
        self.renew_preconditioner();
        let convergence = self.solve_with(ITERATION_LIMIT, 1.0)?;
        self.begin_from_here();
        Ok(convergence)
    }

    /// Takes the present c for the first: the solve came from afar, and says nothing of those to come.
    fn begin_from_here(&mut self) {
        self.previous.copy_from_slice(&self.phase);
        if let Some(lag) = &mut self.lag {
            lag.begin(&self.phase);
        }
        if let Some(preconditioner) = self.method.preconditioner() {
            preconditioner.forget();
        }
    }

    /// Adds the points of a lattice with their H to the matrix, or with a `sign` of −1 takes them away; their
    /// part of the right-hand side.
    fn add_points(&mut self, lattice: &Lattice, relative: Option<&[Lane]>, history: &[Lane], sign: f64) -> Vec<f64> {
        if sign > 0.0 {
            self.assemble_history(lattice, history);
        } else {
            let none = vec![Lane::ZERO; history.len()];
            self.assemble_increments(lattice, &none, 0.0, |_| true);
        }
        add_forms(&mut self.matrix, lattice, &self.model, relative, sign)
    }

    /// Makes the preconditioner anew from the matrix as it stands: control points may have gained or lost
    /// material.
    pub(crate) fn renew_preconditioner(&mut self) {
        if let Some(preconditioner) = self.method.preconditioner().filter(|p| !p.is_complete()) {
            preconditioner.renew(&self.matrix); // a complete factor is made anew for every solve as it is
        }
    }

    /// Change of an energy that moves c by a hundredth of the tolerance, J/m³.
    fn negligible(&self) -> f64 {
        fault!("small-growth-never-assembled", 0.01 * self.tolerance => 0.1) / self.model.reaction_per_energy()
    }

    /// Adds what the history energy changed by.
    fn assemble_history(&mut self, lattice: &Lattice, history: &[Lane]) {
        self.assemble_increments(lattice, history, self.negligible(), |_| true);
    }

    /// Adds what the energies of some of the cells changed by, where it is more than `threshold` (J/m³).
    fn assemble_increments(
        &mut self,
        lattice: &Lattice,
        history: &[Lane],
        threshold: f64,
        takes: impl Fn(usize) -> bool + Sync,
    ) {
        let reaction = self.model.reaction_per_energy();
        let span = lattice.points_per_span();
        let takes =
            |cell: usize, assembled: &[Lane], history: &[Lane]| takes(cell) && changed(assembled, history, threshold);
        let increments = Increments { history, assembled: &self.assembled, reaction, takes: &takes };
        add_form(&mut self.matrix, lattice, Integrand::Mass, &increments);
        for (cell, (assembled, history)) in self.assembled.chunks_mut(span).zip(history.chunks(span)).enumerate() {
            if lattice.is_cell_occupied(cell) && takes(cell, assembled, history) {
                assembled.copy_from_slice(history);
            }
        }
    }

    /// Start of the next solve: linear extrapolation of the last two, `ahead` times the time between them.
    fn extrapolate(&mut self, ahead: f64) {
        let grid = self.matrix.grid;
        for used in self.matrix.active().within(grid, 0..grid.rows) {
            for (phase, previous) in self.phase[used.clone()].iter_mut().zip(&mut self.previous[used]) {
                let next = (1.0 + ahead) * *phase - ahead * *previous;
                *previous = *phase;
                *phase = next;
            }
        }
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let vectors = self.load.len() + self.phase.len() + self.previous.len() + LANES * self.assembled.len();
        self.matrix.bytes()
            + 8 * vectors
            + self.method.bytes()
            + self.lag.as_ref().map_or(0, |lag| 16 * lag.solved.len())
            + self.bounds.as_ref().map_or(0, |bounds| bounds.bytes())
    }
}

/// Adds what does not depend on H to a matrix, times a sign; returns what it adds to the right-hand side.
fn add_forms(
    matrix: &mut Stencil,
    lattice: &Lattice,
    model: &FractureModel,
    relative: Option<&[Lane]>,
    sign: f64,
) -> Vec<f64> {
    let diffusion = match model.gradient {
        Anisotropy::NONE => Integrand::Diffusion,
        tensor => Integrand::Anisotropic(tensor),
    };
    let everywhere = vec![Lane::splat(1.0); lattice.batches()];
    let toughness = relative.unwrap_or(&everywhere);
    // with a threshold, the driving energies will take the place of the local term
    let local = if model.threshold().is_some() { &everywhere } else { toughness };
    add_form(matrix, lattice, Integrand::Mass, &Scaled(local, sign * model.source()));
    let gradients = fault!("gradient-of-mean-toughness", toughness => &everywhere);
    add_form(matrix, lattice, diffusion, &Scaled(gradients, sign * model.diffusion()));
    let mut load = integrate_with(lattice, |batch, lane| toughness[batch][lane]);
    load.iter_mut().for_each(|load| *load *= sign * model.source());
    load
}

/// Holds control points at `c = 1` that see no material, or so little of it that they cannot change c
/// anywhere.
fn isolate_empty(matrix: &mut Stencil, load: &mut [f64]) {
    let value = EMPTY * load.iter().copied().fold(0.0, larger);
    for at in matrix.bare(NOTHING).1 {
        matrix.set_diagonal(at, value);
        load[at] = value;
    }
}

/// A failure with its error in the norm of the tolerance, of a matrix that may not be finite.
fn in_the_norm(failure: SolveFailure, unit: f64, is_finite: impl FnOnce() -> bool) -> SolveFailure {
    match failure {
        SolveFailure::NotConverged { iterations, error } => {
            SolveFailure::NotConverged { iterations, error: error / unit }
        }
        SolveFailure::NotPositiveDefinite if !is_finite() => SolveFailure::NotFinite,
        other => other,
    }
}

/// Whether all coefficients are finite.
fn is_finite(matrix: &Stencil) -> bool {
    matrix.coefficients().iter().all(|value| value.is_finite())
}

/// `Σ_p V_p N_I(x_p)` per unit thickness, m².
pub fn integrate_shape_functions(lattice: &Lattice) -> Vec<f64> {
    integrate_with(lattice, |_, _| 1.0)
}

/// `Σ_p V_p f_p N_I(x_p)` per unit thickness, m² times the unit of f, which is given by batch and lane.
fn integrate_with(lattice: &Lattice, value: impl Fn(usize, usize) -> f64 + Sync) -> Vec<f64> {
    let of_point = |batch: usize, lane: usize, _| {
        let value = value(batch, lane);
        fault!("phase-load-without-volumes", value => value / lattice.weights_of(batch)[lane])
    };
    lattice.onto_patch(lattice.integrate(of_point))
}
