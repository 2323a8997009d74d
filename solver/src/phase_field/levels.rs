//! The phase field on nested levels: one system, solved on all of them together.
//!
//! Between two levels lie functions whose values the coarser one determines ([`Interface`]). The matrix of a
//! level holds what its own points add; what they add to functions of the interface belongs to the coarser
//! level.

use super::lag::Lag;
use super::method::{ITERATION_LIMIT, Method, PreconditionedSolver};
use super::{PhaseField, in_the_norm, is_finite};
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::{Convergence, OnGrid, SolveFailure, solve_on_grids};
use crate::linear_algebra::interface::{Interface, fold_all, spread_all};
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::preconditioner::TOO_MANY;
use crate::linear_algebra::stencil::Stencil;
use crate::particles::lattice::Lattice;

/// Diagonal, of the largest, that is left of material that was taken away.
const NOTHING: f64 = 1e-13;

/// What belongs to the phase field on one level.
pub(crate) struct OnLevel<'a> {
    pub field: &'a mut PhaseField,
    pub lattice: &'a Lattice,
    /// Driving energy at the points, J/m³.
    pub history: &'a [Lane],
    /// Control points with values of their own.
    pub own: &'a ActiveColumns,
    /// Right-hand side of the points of this level alone.
    pub load: &'a mut Vec<f64>,
    /// Gc over its mean at the points, where it varies.
    pub relative: Option<&'a [Lane]>,
}

/// Levels from coarse to fine, and what lies between them.
pub(crate) struct PhaseFieldLevels<'a> {
    pub levels: Vec<OnLevel<'a>>,
    pub interfaces: &'a [Interface],
}

impl PhaseFieldLevels<'_> {
    /// c at the end of a step, as [`PhaseField::advance`].
    ///
    /// # Errors
    /// As [`PhaseField::solve`].
    pub(crate) fn advance(&mut self) -> Result<Option<Convergence>, SolveFailure> {
        let due = self.levels.iter().any(|level| level.field.is_due());
        let mut lags: Vec<Box<Lag>> = self.levels.iter_mut().filter_map(|level| level.field.lag.take()).collect();
        lags.iter_mut().for_each(|lag| lag.since += 1);
        let mut lag = lags.iter_mut();
        for OnLevel { field, lattice, history, .. } in &mut self.levels {
            let mut lag = lag.next();
            if due {
                field.assemble_history(lattice, history);
                lag.iter_mut().for_each(|lag| field.go_back(lag));
                field.extrapolate(lag.map_or(1.0, |lag| lag.ahead()));
            } else if let Some(lag) = lag {
                field.carry_on(lag);
            }
        }
        self.spread();
        let result = if due { self.solve(TOO_MANY).map(Some) } else { Ok(None) };
        for (OnLevel { field, .. }, mut lag) in self.levels.iter_mut().zip(lags) {
            if due {
                field.end_solve(&mut lag);
            }
            field.lag = Some(lag);
        }
        result
    }

    /// First solve: there is nothing to extrapolate from.
    ///
    /// # Errors
    /// As [`PhaseField::solve`].
    pub(crate) fn initialise(&mut self) -> Result<Convergence, SolveFailure> {
        self.spread();
        let convergence = self.solve(ITERATION_LIMIT)?;
        for OnLevel { field, .. } in &mut self.levels {
            field.begin_from_here();
        }
        Ok(convergence)
    }

    /// Solves for c at the present time once more, with other points: its rate stays.
    ///
    /// # Errors
    /// As [`PhaseField::solve`].
    pub(crate) fn solve_anew(&mut self) -> Result<(), SolveFailure> {
        let before: Vec<Vec<f64>> = self.levels.iter().map(|level| level.field.phase.clone()).collect();
        for OnLevel { field, lattice, history, .. } in &mut self.levels {
            field.assemble_history(lattice, history);
        }
        self.solve(ITERATION_LIMIT)?;
        for (OnLevel { field, .. }, before) in self.levels.iter_mut().zip(before) {
            for at in field.matrix.active().within(field.matrix.grid, 0..field.matrix.grid.rows).flatten() {
                let change = field.phase[at] - before[at];
                field.previous[at] += change;
                field.lag.iter_mut().for_each(|lag| lag.solved[at] += change);
            }
        }
        Ok(())
    }

    /// Makes the right-hand sides and preconditioners anew, after points came or went.
    pub(crate) fn renew(&mut self) {
        for OnLevel { field, load, .. } in &mut self.levels {
            field.load.copy_from_slice(load);
        }
        let mut loads: Vec<_> = self.levels.iter_mut().map(|level| &mut level.field.load[..]).collect();
        fold_all(self.interfaces, &mut loads);
        self.renew_preconditioners();
    }

    /// Sets the values that coarser levels determine.
    pub(crate) fn spread(&mut self) {
        let mut fields: Vec<_> = self.levels.iter_mut().map(|level| &mut level.field.phase[..]).collect();
        spread_all(self.interfaces, &mut fields);
    }

    fn solve(&mut self, patience: usize) -> Result<Convergence, SolveFailure> {
        let model = self.levels[0].field.model;
        let (unit, tolerance) = (model.diffusion().sqrt(), self.levels[0].field.tolerance);
        let (mut spent, mut limit) = (0, patience);
        let found = loop {
            let mut grids: Vec<OnGrid> = self.levels.iter_mut().map(OnLevel::equation).collect();
            match solve_on_grids(&mut grids, self.interfaces, unit * tolerance, limit) {
                Err(SolveFailure::NotConverged { iterations, .. }) if limit < ITERATION_LIMIT => {
                    (spent, limit) = (spent + iterations, ITERATION_LIMIT);
                    self.renew_preconditioners();
                }
                found => break found,
            }
        };
        let finite = || self.levels.iter().all(|level| is_finite(&level.field.matrix));
        let found = found.map_err(|failure| in_the_norm(failure, unit, finite))?;
        self.spread();
        let counts = &mut self.levels[0].field.counts;
        (counts.solves, counts.iterations) = (counts.solves + 1, counts.iterations + spent + found.iterations);
        let stale =
            |level: &mut OnLevel| level.field.method.preconditioner().is_some_and(|p| p.learn(found.iterations));
        if self.levels.iter_mut().map(stale).fold(false, |any, stale| any | stale) {
            self.renew_preconditioners();
        }
        Ok(Convergence { iterations: spent + found.iterations, error: found.error / unit })
    }

    /// Makes the preconditioners anew, with what the points of each level add to the coarser one.
    fn renew_preconditioners(&mut self) {
        for number in 0..self.levels.len() {
            let mut matrix = self.levels[number].field.matrix.clone();
            matrix.restrict(self.levels[number].own.clone());
            if let (Some(interface), Some(finer)) = (self.interfaces.get(number), self.levels.get(number + 1)) {
                add_interface(interface, &finer.field.matrix, &mut matrix);
            }
            let (largest, empty) = matrix.bare(NOTHING);
            empty.into_iter().for_each(|at| matrix.set_diagonal(at, largest)); // without material
            if let Some(preconditioner) = self.levels[number].field.method.preconditioner() {
                preconditioner.renew(&matrix);
                preconditioner.forget();
            }
        }
    }
}

impl OnLevel<'_> {
    /// Adds what the points of a part of the lattice add to the system, or with a `sign` of −1 takes it away.
    pub(crate) fn add_points(&mut self, lattice: &Lattice, sign: f64) {
        let Self { field, relative, history, load, .. } = self;
        let added = field.add_points(lattice, *relative, history, sign);
        load.iter_mut().zip(added).for_each(|(load, added)| *load += added);
    }

    fn equation(&mut self) -> OnGrid<'_> {
        let PhaseField { matrix, load, phase, method, .. } = &mut *self.field;
        let Method::Iterative(solver) = method else { unreachable!("levels have an iterative solver") };
        let PreconditionedSolver { workspace, preconditioner } = &mut **solver;
        OnGrid { workspace, matrix, preconditioner, own: self.own, b: load, x: phase }
    }
}

/// `A_c += Rᵀ A_f R` with the couplings of the interface among themselves.
fn add_interface(interface: &Interface, fine: &Stencil, coarse: &mut Stencil) {
    let degree = coarse.degree();
    let rows: Vec<(usize, &[(usize, f64)])> = interface.rows().collect();
    let find = |at: usize| rows.binary_search_by_key(&at, |(point, _)| *point).ok();
    let (stride, length) = (coarse.grid.stride, coarse.row_length());
    for &(point, row) in &rows {
        let (fine_column, fine_row) = (fine.grid.column_of(point), fine.grid.row_of(point));
        for (number, offset) in fine.offsets().iter().enumerate() {
            let other = (point + offset.rows * fine.grid.stride).wrapping_add_signed(offset.columns);
            let Some(other) = find(other) else { continue };
            let coupling = fine.row(fine_row, number)[fine.grid.index(fine_column, 0)];
            let mut add = |one: &[(usize, f64)], other: &[(usize, f64)]| {
                for (&(i, w), &(l, v)) in one.iter().flat_map(|i| other.iter().map(move |l| (i, l))) {
                    if l >= i {
                        let columns = coarse.grid.column_of(l) as isize - coarse.grid.column_of(i) as isize;
                        let (row, rows) = (coarse.grid.row_of(i), coarse.grid.row_of(l) - coarse.grid.row_of(i));
                        let place = Stencil::offset_index(degree, columns, rows) * stride;
                        let at = row * length + place + coarse.grid.index(coarse.grid.column_of(i), 0);
                        coarse.coefficients_mut()[at] += w * v * coupling;
                    }
                }
            };
            add(row, rows[other].1);
            if number > 0 {
                add(rows[other].1, row);
            }
        }
    }
}
