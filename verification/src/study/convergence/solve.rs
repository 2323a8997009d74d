//! One mesh of a convergence study: the scene, the discrete solution, and its errors.

use std::sync::Arc;
use std::time::Instant;

use fisura::lane::Lane;
use fisura::material::FractureModel;
use fisura::patch::ControlGrid;
use fisura::phase_field::PhaseField;
use fisura::projection::Projection;
use fisura::scene::{Scene, Transfer};
use fisura::statics::StaticSolver;
use fisura::total_frame::TotalFrame;

use super::errors::{ErrorPoints, Squares};
use super::problem::{Kind, Manufactured, Problem};
use super::scene::scene;
use super::{OnMesh, other};
use crate::case::convergence::{ConvergenceSetup, Loading};
use crate::convergence::Level;
use crate::study::StudyError;

/// Control values of a vector field, by component.
type VectorField = [Vec<f64>; 2];

/// A problem on one mesh.
pub(super) struct Discrete<'a> {
    setup: &'a ConvergenceSetup,
    problem: &'a Problem,
    frame: TotalFrame,
    points: ErrorPoints,
    scene: Scene,
}

impl OnMesh for Discrete<'_> {
    fn level(mut self: Box<Self>, step: f64) -> Result<Level, StudyError> {
        let start = Instant::now();
        let errors: Vec<f64> = match self.problem.kind {
            Kind::Projection => {
                let field = self.project(|x| self.problem.solution.displacement(x, 0.0))?;
                self.displacement_errors(&field, 0.0)
            }
            Kind::Static => {
                let field = self.solve_static()?;
                self.displacement_errors(&field, 0.0)
            }
            Kind::PhaseField => {
                let field = self.solve_phase_field()?;
                self.phase_errors(&field, 0.0)
            }
            Kind::Dynamic => {
                let end = self.run(step)?;
                let mut errors = self.displacement_errors(self.frame.displacement(), end);
                let velocity = (0..2).map(|i| {
                    let exact = |x| (self.problem.solution.velocity(x, end)[i], [0.0; 2]);
                    self.points.squares(&self.frame.velocity()[i], exact)
                });
                errors.push(velocity.sum::<Squares>().l2());
                if let Some(fracture) = &self.frame.fracture {
                    errors.extend(self.phase_errors(fracture.field.control_values(), end));
                }
                errors
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let grid = self.grid();
        let fields = if self.problem.kind == Kind::PhaseField { 1 } else { 2 };
        Ok(Level { h: self.span_length(), unknowns: fields * grid.columns * grid.rows, seconds, errors })
    }

    fn critical_step(&self) -> f64 {
        self.frame.critical_step()
    }

    fn span_length(&self) -> f64 {
        let [x, y] = self.frame.patch().spaces.each_ref().map(|space| space.spans().len());
        (self.points.area() / (x * y) as f64).sqrt()
    }
}

impl<'a> Discrete<'a> {
    /// The mesh with `cells` spans per direction for the n-th degree.
    pub fn new(setup: &'a ConvergenceSetup, problem: &'a Problem, n: usize, cells: usize) -> Result<Self, StudyError> {
        let scene = scene(setup, problem, n, cells, Transfer::Flip)?;
        let frame = TotalFrame::new(&scene).map_err(|_| other("the initial phase field does not converge"))?;
        let points = ErrorPoints::new(frame.patch(), &scene.bodies[0]);
        Ok(Self { setup, problem, frame, points, scene })
    }

    /// Names of the errors of a kind of problem, in the order of [`Level::errors`], and their order below p + 1.
    pub fn norms(problem: &Problem) -> Vec<(&'static str, usize)> {
        let displacement = [("displacement error in L2", 0), ("displacement error in H1", 1)];
        let phase = [("phase-field error in L2", 0), ("phase-field error in H1", 1)];
        match problem.kind {
            Kind::Projection | Kind::Static => displacement.to_vec(),
            Kind::PhaseField => phase.to_vec(),
            Kind::Dynamic => {
                let mut norms = displacement.to_vec();
                norms.push(("velocity error in L2", 0));
                if problem.solution.phase().is_some() {
                    norms.extend(phase);
                }
                norms
            }
        }
    }

    fn grid(&self) -> ControlGrid {
        self.frame.lattice().grid
    }

    fn manufactured(&self) -> Arc<Manufactured> {
        let fracture = self.problem.solution.material().fracture;
        Arc::new(Manufactured {
            solution: self.problem.solution.clone(),
            loading: self.setup.loading,
            diffusion: fracture.map_or(0.0, |f| FractureModel::new(&f).diffusion()),
            moved: false,
        })
    }

    /// Projection of a vector field; components that boundaries hold are zero where they are so in the exact solution.
    fn project(&self, function: impl Fn([f64; 2]) -> [f64; 2]) -> Result<VectorField, StudyError> {
        let component = |i: usize| -> Result<Vec<f64>, StudyError> {
            let held = match self.problem.kind {
                Kind::Dynamic => self.frame.constraints().held(i),
                _ => Vec::new(),
            };
            let projection = Projection::new(self.frame.lattice(), &held)
                .ok_or_else(|| other("the points do not determine a projection"))?;
            Ok(projection.project(|x| function(x)[i]))
        };
        Ok([component(0)?, component(1)?])
    }

    fn solve_static(&mut self) -> Result<VectorField, StudyError> {
        let zeros = || [self.grid().zeros(), self.grid().zeros()];
        let prescribed = self.project(|x| self.problem.solution.displacement(x, 0.0))?;
        let (still, forcing) = (zeros(), self.manufactured());
        self.frame.start_from(still.clone(), still, forcing).map_err(|_| other("no phase field is expected"))?;
        let forces = self.frame.forced_loads();
        let solver = StaticSolver::new(&self.frame).ok_or_else(|| other("the stiffness is not positive definite"))?;
        Ok(solver.solve(&forces, &prescribed))
    }

    fn solve_phase_field(&self) -> Result<Vec<f64>, StudyError> {
        let phase = self.problem.solution.phase().ok_or_else(|| other("the solution has no phase field"))?;
        let fracture = self.problem.solution.material().fracture;
        let fracture = fracture.ok_or_else(|| other("the material has no fracture"))?;
        let model = FractureModel::new(&fracture);
        let lattice = self.frame.lattice();
        let mut history = vec![Lane::ZERO; lattice.batches()];
        lattice.for_each_point(|batch, lane, x, _| history[batch][lane] = phase.history(x, 0.0));
        let mut field = PhaseField::new(lattice, model, &self.scene.solver);
        field.set_load(match self.setup.loading {
            Loading::Strong => self.frame.phase_load(self.manufactured()),
            Loading::Weak => {
                let mut load = lattice.grid.zeros();
                lattice.add_integral(&mut [&mut load], |_, _, x| {
                    let reaction = model.reaction_per_energy() * phase.history(x, 0.0) + 1.0;
                    let gradient = phase.gradient(x, 0.0).map(|g| model.diffusion() * g);
                    ([reaction * phase.value(x, 0.0)], [gradient])
                });
                load
            }
        });
        field.solve(lattice, &history).map_err(|_| other("the phase field does not converge"))?;
        Ok(field.control_values().to_vec())
    }

    /// Runs to the end in equal steps; the end time, s.
    fn run(&mut self, step: f64) -> Result<f64, StudyError> {
        let end = self.setup.end_time.unwrap_or(self.problem.end_time);
        let solution = &self.problem.solution;
        let displacement = self.project(|x| solution.displacement(x, 0.0))?;
        let velocity = self.project(|x| solution.velocity(x, 0.0))?;
        let broken = |_| other("the phase field does not converge");
        self.frame.start_from(displacement, velocity, self.manufactured()).map_err(broken)?;
        let steps = (end / step).ceil().max(1.0);
        for _ in 0..steps as usize {
            self.frame.step(end / steps).map_err(broken)?;
        }
        Ok(end)
    }

    /// Relative errors of a displacement in L2 and in the H1 seminorm.
    fn displacement_errors(&self, field: &VectorField, time: f64) -> Vec<f64> {
        let solution = &self.problem.solution;
        let component = |i: usize| {
            let exact = |x| (solution.displacement(x, time)[i], solution.displacement_gradient(x, time)[i]);
            self.points.squares(&field[i], exact)
        };
        let squares: Squares = (0..2).map(component).sum();
        vec![squares.l2(), squares.h1()]
    }

    fn phase_errors(&self, field: &[f64], time: f64) -> Vec<f64> {
        let Some(phase) = self.problem.solution.phase() else { return Vec::new() };
        let squares = self.points.squares(field, |x| (phase.value(x, time), phase.gradient(x, time)));
        vec![squares.l2(), squares.h1()]
    }
}
