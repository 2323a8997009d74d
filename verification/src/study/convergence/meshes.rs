//! The meshes of a convergence study, one by one: for the study itself, and for what is timed.

use fisura::scene::Frame;

use super::moving::Moving;
use super::problem::Problem;
use super::solve::Discrete;
use super::{OnMesh, Variant, problem_of, variants};
use crate::case::Case;
use crate::case::convergence::{ConvergenceSetup, Refine};
use crate::exact::Equation;
use crate::study::StudyError;
use crate::study::orders::Level;

/// A curve of a case: number of its degree, and what distinguishes it from others of that degree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CurveKey {
    pub(super) n: usize,
    pub(super) variant: Variant,
}

/// What a case solves, mesh by mesh.
#[derive(Clone, Copy)]
pub(crate) struct Meshes<'a> {
    pub(super) setup: &'a ConvergenceSetup,
    pub(super) problem: &'a Problem,
}

impl<'a> Meshes<'a> {
    /// Solves a case on some mesh, without a study.
    ///
    /// # Errors
    /// A case without such a problem.
    pub(crate) fn with<R>(case: &Case, work: impl FnOnce(Meshes) -> R) -> Result<R, StudyError> {
        let (setup, problem, _) = problem_of(case)?;
        Ok(work(Meshes { setup, problem: &problem }))
    }

    /// The curves of the case.
    pub(crate) fn curves(&self) -> Vec<CurveKey> {
        let of_degree = |n| variants(self.setup).into_iter().map(move |variant| CurveKey { n, variant });
        (0..self.setup.degrees.len()).flat_map(of_degree).collect()
    }

    /// Degree of the splines of a curve.
    pub(crate) fn degree(&self, curve: CurveKey) -> usize {
        self.setup.degrees[curve.n]
    }

    fn mesh(&self, CurveKey { n, variant }: CurveKey, cells: usize) -> Result<Box<dyn OnMesh + 'a>, StudyError> {
        Ok(match self.setup.frame {
            Frame::Total => Box::new(Discrete::new(self.setup, self.problem, n, cells)?),
            Frame::Updated => Box::new(Moving::new(self.setup, self.problem, n, cells, variant)?),
        })
    }

    /// Solves on a mesh with so many spans per direction, with steps that belong to it.
    ///
    /// # Errors
    /// A run that breaks down.
    pub(crate) fn level(&self, curve: CurveKey, cells: usize) -> Result<Level, StudyError> {
        let power = match self.setup.refine {
            Refine::Mesh(Some(power)) => power,
            _ => 0.5 * (self.setup.degrees[curve.n] + 1) as f64,
        };
        let coarsest = self.mesh(curve, self.setup.cells[0])?;
        let critical = if self.problem.equation == Equation::Dynamic { coarsest.critical_step() } else { 0.0 };
        let mesh = self.mesh(curve, cells)?;
        let step = self.setup.safety[0] * critical * (mesh.span_length() / coarsest.span_length()).powf(power);
        mesh.level(step)
    }

    /// All levels of a curve, and the errors of the best approximation on the last.
    pub(super) fn levels(&self, curve: CurveKey) -> Result<(Vec<Level>, Vec<f64>), StudyError> {
        let finest = self.setup.cells[self.setup.cells.len() - 1];
        let levels: Result<Vec<Level>, StudyError> = match self.setup.refine {
            Refine::Mesh(_) => self.setup.cells.iter().map(|cells| self.level(curve, *cells)).collect(),
            Refine::TimeStep => {
                let critical = self.mesh(curve, finest)?.critical_step();
                let level = |&fraction: &f64| {
                    let level = self.mesh(curve, finest)?.level(fraction * critical)?;
                    Ok(Level { h: fraction * critical, ..level })
                };
                self.setup.safety.iter().map(level).collect()
            }
        };
        Ok((levels?, self.mesh(curve, finest)?.best_errors()?))
    }
}
