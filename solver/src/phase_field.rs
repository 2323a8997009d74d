//! The phase-field equation of a body (E 10–12, 19–24), AT2 in Borden's convention, c = 1 intact.
//!
//! ```text
//! Σ_J K_IJ c_J = Σ_p V_p N_I(x_p),   K_IJ = Σ_p V_p [ (4 l0 (1 − k) H_p/Gc + 1) N_I N_J + 4 l0² grad N_I · grad N_J ]
//! ```
//!
//! The points' volumes enter once (the source prints them twice in E 24) and the `+ 1` stands (E 9 and 11 drop it).
//! The history energy H only grows, and so does K: only spans whose H grew since the last solve are added
//! (delta assembly). An increment too small to move the relative residual by a hundredth of the tolerance waits.

mod state;

use serde::{Deserialize, Serialize};

use crate::assembly::{Constant, Form, PointCoefficients, add_form};
use crate::cholesky::SparseCholesky;
use crate::conjugate_gradients::{ConjugateGradients, Convergence};
use crate::lane::{LANES, Lane};
use crate::lattice::Lattice;
use crate::material::FractureModel;
use crate::patch::ControlGrid;
use crate::preconditioner::Preconditioner;
use crate::scene::{PhaseFieldSolver, SolverSettings};
use crate::stencil::Stencil;

/// Iterations after which a solve counts as failed.
const ITERATION_LIMIT: usize = 2000;
/// Diagonal and right-hand side of control points without material, as a fraction of the largest right-hand side: they
/// hardly weigh in the norm that the tolerance refers to.
const EMPTY: f64 = 1e-6;

/// Counters of the phase-field solver.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PhaseFieldCounts {
    /// Systems solved.
    pub solves: usize,
    /// Iterations in all.
    pub iterations: usize,
}

/// Phase field of one body on its control points.
#[derive(Debug, Clone)]
pub struct PhaseField {
    model: FractureModel,
    tolerance: f64,
    matrix: Stencil,
    load: Vec<f64>,
    /// Control values, and those of the solve before.
    phase: Vec<f64>,
    previous: Vec<f64>,
    /// History energy that is in the matrix.
    assembled: Vec<Lane>,
    method: Method,
    counts: PhaseFieldCounts,
}

#[derive(Debug, Clone)]
enum Method {
    Iterative { workspace: Box<ConjugateGradients>, preconditioner: Box<Preconditioner> },
    Direct(Box<SparseCholesky>),
}

impl Method {
    fn new(matrix: &Stencil, settings: &SolverSettings) -> Self {
        match settings.phase_field_solver {
            PhaseFieldSolver::Cholesky => Self::Direct(Box::default()),
            PhaseFieldSolver::ConjugateGradients => Self::iterative(matrix),
        }
    }

    fn iterative(matrix: &Stencil) -> Self {
        Self::Iterative {
            workspace: Box::new(ConjugateGradients::new(matrix)),
            preconditioner: Box::new(Preconditioner::new(matrix)),
        }
    }
}

impl PhaseField {
    /// Phase field on the points of `lattice`, intact until the first solve.
    pub fn new(lattice: &Lattice, model: FractureModel, settings: &SolverSettings) -> Self {
        let mut matrix = Stencil::zeros(lattice.grid, lattice.degree);
        add_form(&mut matrix, lattice, Form::Mass, &Constant(1.0));
        add_form(&mut matrix, lattice, Form::Diffusion, &Constant(model.diffusion()));
        let mut load = integrate_shape_functions(lattice);
        isolate_empty(&mut matrix, &mut load);
        let assembled = vec![Lane::ZERO; lattice.batches()];
        Self::intact(matrix, load, assembled, model, settings)
    }

    /// Phase field whose system is assembled anew at every step (see [`Self::system_mut`]), intact until the first solve.
    pub fn without_lattice(
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
            tolerance: settings.phase_field_tolerance,
            load,
            previous: phase.clone(),
            phase,
            assembled,
            method: Method::new(&matrix, settings),
            matrix,
            counts: PhaseFieldCounts::default(),
        }
    }

    /// Goes over to another grid, whose first control column and row lie `shift` columns and rows further; control points
    /// that were not there begin intact.
    pub fn relocate(&mut self, grid: ControlGrid, shift: [isize; 2]) {
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
        self.method = match self.method {
            Method::Direct(_) => Method::Direct(Box::default()),
            Method::Iterative { .. } => Method::iterative(&self.matrix),
        };
    }

    /// Matrix and right-hand side, to be assembled by the caller.
    pub fn system_mut(&mut self) -> (&mut Stencil, &mut Vec<f64>) {
        (&mut self.matrix, &mut self.load)
    }

    /// Replaces the right-hand side of a body that fills the patch: `Σ_p V_p s_p N_I(x_p)` with a manufactured source s.
    pub fn set_load(&mut self, load: Vec<f64>) {
        self.load = load;
    }

    /// Control values of c.
    pub fn control_values(&self) -> &[f64] {
        &self.phase
    }

    /// Counters so far.
    pub fn counts(&self) -> PhaseFieldCounts {
        self.counts
    }

    /// Solves for c with the history energy (J/m³) of every batch of points.
    ///
    /// # Errors
    /// The relative residual reached, if it is not the tolerance.
    pub fn solve(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Convergence, Convergence> {
        self.assemble_increments(lattice, history);
        self.solve_system()
    }

    /// Solves the system as it stands.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_system(&mut self) -> Result<Convergence, Convergence> {
        self.extrapolate();
        self.counts.solves += 1;
        let Self { matrix, load, phase, .. } = self;
        let failed = Convergence { iterations: 0, relative_residual: f64::NAN };
        let convergence = match &mut self.method {
            Method::Direct(cholesky) => {
                cholesky.solve(matrix, load, phase).ok_or(failed)?;
                Convergence { iterations: 1, relative_residual: 0.0 }
            }
            Method::Iterative { workspace, preconditioner } => {
                let mut solve = |preconditioner: &Preconditioner| {
                    workspace.solve(matrix, preconditioner, load, phase, self.tolerance, ITERATION_LIMIT)
                };
                if preconditioner.is_complete() {
                    preconditioner.renew(matrix);
                }
                let mut result = solve(preconditioner);
                if result.iterations == ITERATION_LIMIT && preconditioner.complete(matrix) {
                    result = solve(preconditioner);
                }
                preconditioner.learn(matrix, result.iterations);
                result
            }
        };
        self.counts.iterations += convergence.iterations;
        let direct = matches!(self.method, Method::Direct(_));
        if direct || convergence.relative_residual <= self.tolerance { Ok(convergence) } else { Err(convergence) }
    }

    /// First solve with a seeded crack: the factor is made for it, and there is nothing to extrapolate from.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn initialise(&mut self, lattice: &Lattice, history: &[Lane]) -> Result<Convergence, Convergence> {
        self.assemble_increments(lattice, history);
        self.initialise_system()
    }

    /// First solve of the system as it stands.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn initialise_system(&mut self) -> Result<Convergence, Convergence> {
        self.renew_preconditioner();
        let convergence = self.solve_system()?;
        self.previous.copy_from_slice(&self.phase);
        if let Method::Iterative { preconditioner, .. } = &mut self.method {
            preconditioner.forget();
        }
        Ok(convergence)
    }

    /// Makes the preconditioner anew from the matrix as it stands: control points may have gained or lost material.
    pub fn renew_preconditioner(&mut self) {
        if let Method::Iterative { preconditioner, .. } = &mut self.method {
            preconditioner.renew(&self.matrix);
        }
    }

    /// Adds what the history energy grew by.
    fn assemble_increments(&mut self, lattice: &Lattice, history: &[Lane]) {
        let reaction = self.model.reaction_per_energy();
        let threshold = 0.01 * self.tolerance / reaction;
        let increments = Increments { history, assembled: &self.assembled, reaction, threshold };
        add_form(&mut self.matrix, lattice, Form::Mass, &increments);
        let span = lattice.points_per_span();
        for (assembled, history) in self.assembled.chunks_mut(span).zip(history.chunks(span)) {
            if grew(assembled, history, threshold) {
                assembled.copy_from_slice(history);
            }
        }
    }

    /// Start of the next solve: linear extrapolation of the last two.
    fn extrapolate(&mut self) {
        for (phase, previous) in self.phase.iter_mut().zip(&mut self.previous) {
            let next = 2.0 * *phase - *previous;
            *previous = *phase;
            *phase = next;
        }
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let method = match &self.method {
            Method::Iterative { workspace, preconditioner } => workspace.bytes() + preconditioner.bytes(),
            Method::Direct(_) => 0,
        };
        let vectors = self.load.len() + self.phase.len() + self.previous.len() + LANES * self.assembled.len();
        self.matrix.bytes() + 8 * vectors + method
    }
}

/// Holds control points without material at `c = 1`.
fn isolate_empty(matrix: &mut Stencil, load: &mut [f64]) {
    let grid = matrix.grid;
    let value = EMPTY * load.iter().copied().fold(0.0, f64::max);
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let at = grid.index(column, row);
            if matrix.diagonal(column, row) == 0.0 {
                matrix.set_diagonal(column, row, value);
                load[at] = value;
            }
        }
    }
}

/// Whether the history energy of a span row of a tile grew beyond the threshold.
#[inline(always)]
fn grew(assembled: &[Lane], history: &[Lane], threshold: f64) -> bool {
    let mut most = Lane::ZERO;
    for (assembled, history) in assembled.iter().zip(history) {
        most = most.max(*history - *assembled);
    }
    most.0.iter().any(|&growth| growth > threshold)
}

struct Increments<'a> {
    history: &'a [Lane],
    assembled: &'a [Lane],
    reaction: f64,
    threshold: f64,
}

impl PointCoefficients for Increments<'_> {
    #[inline(always)]
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        let range = first..first + weights.len();
        let (history, assembled) = (&self.history[range.clone()], &self.assembled[range]);
        if !grew(assembled, history, self.threshold) {
            return false;
        }
        for i in 0..weights.len() {
            out[i] = (history[i] - assembled[i]) * weights[i] * self.reaction;
        }
        true
    }
}

/// `Σ_p V_p N_I(x_p)` per unit thickness, m².
pub fn integrate_shape_functions(lattice: &Lattice) -> Vec<f64> {
    lattice.integrate(|_batch, _lane, _| {
        fault!("phase-load-without-volumes", 1.0 => {
            let (row, tile, b, a) = lattice.unbatch(_batch);
            1.0 / lattice.weight(row, tile, b, a)[_lane]
        })
    })
}
