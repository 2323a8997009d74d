//! One mesh of a convergence study: the scene, the discrete solution, and its errors.

use std::sync::Arc;
use std::time::Instant;

use fisura::dynamics::statics::StaticSolver;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::linear_algebra::control_grid::ControlGrid;
use fisura::linear_algebra::lane::Lane;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::phase_field::PhaseField;
use fisura::scene::{Layout, Mass, Scene};
use fisura::splines::patch::control_points_on;
use fisura::splines::quadrature::Rule;
use nalgebra::DMatrix;

use super::errors::ErrorPoints;
use super::problem::{Manufactured, Problem};
use super::scene::scene;
use super::{OnMesh, Variant, other};
use crate::case::convergence::{ConvergenceSetup, Loading, PatchFamily};
use crate::exact::Equation;
use crate::extremes::larger;
use crate::study::orders::Level;
use crate::study::{StudyError, projected, projected_on};

/// Control values of a vector field, by component.
type VectorField = [Vec<f64>; 2];

/// Square of the frequency (1/s²) that holds a free body in its elliptic projection.
const SHIFT: f64 = 1.0;

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
        let errors: Vec<f64> = match self.problem.equation {
            Equation::Projection => {
                let displacement = |x| self.problem.solution.displacement(x, 0.0);
                let field = match self.setup.mass {
                    Mass::Consistent => self.project(displacement)?,
                    Mass::Lumped => self.project_by_row_sums(displacement),
                };
                self.displacement_errors(&field, 0.0)
            }
            Equation::Static => {
                let field = self.solve_static()?;
                self.static_errors(&field)
            }
            Equation::PhaseField => {
                let field = self.solve_phase_field()?;
                self.phase_errors(&field, 0.0)
            }
            Equation::Dynamic => {
                let end = self.run(step)?;
                let mut errors = self.displacement_errors(&self.frame.displacement, end);
                errors.push(self.velocity_error(&self.frame.velocity, end));
                if let Some(fracture) = &self.frame.fracture {
                    errors.extend(self.phase_errors(fracture.field.control_values(), end));
                }
                errors
            }
        };
        let seconds = start.elapsed().as_secs_f64();
        let grid = self.grid();
        let fields = if self.problem.equation == Equation::PhaseField { 1 } else { 2 };
        Ok(Level { h: self.span_length(), unknowns: fields * grid.columns * grid.rows, seconds, errors })
    }

    fn best_errors(&self) -> Result<Vec<f64>, StudyError> {
        let (solution, dynamic) = (&self.problem.solution, self.problem.equation == Equation::Dynamic);
        let end = if dynamic { self.end_time() } else { 0.0 };
        let mut errors = Vec::new();
        if self.problem.equation != Equation::PhaseField {
            let best = self.project(|x| solution.displacement(x, end))?;
            errors.extend(match self.problem.equation {
                Equation::Static => self.static_errors(&best),
                _ => self.displacement_errors(&best, end),
            });
        }
        if dynamic {
            errors.push(self.velocity_error(&self.project(|x| solution.velocity(x, end))?, end));
        }
        if let Some(phase) = solution.phase() {
            let [field, _] = self.project(|x| [phase.value(x, end), 0.0])?;
            errors.extend(self.phase_errors(&field, end));
        }
        Ok(errors)
    }

    fn critical_step(&self) -> f64 {
        self.frame.critical_step()
    }

    fn span_length(&self) -> f64 {
        let [x, y] = self.frame.patch.spaces.each_ref().map(|space| space.spans().len());
        (self.points.area() / (x * y) as f64).sqrt()
    }
}

impl<'a> Discrete<'a> {
    /// The mesh with `cells` spans per direction for the n-th degree.
    pub fn new(setup: &'a ConvergenceSetup, problem: &'a Problem, n: usize, cells: usize) -> Result<Self, StudyError> {
        let scene = scene(setup, problem, n, cells, Variant::PLAIN)?;
        let frame = TotalFrame::new(&scene).map_err(|_| other("the initial phase field does not converge"))?;
        let points = ErrorPoints::new(&frame.patch, &scene.bodies[0]);
        Ok(Self { setup, problem, frame, points, scene })
    }

    /// Names of the errors of a kind of problem, in the order of [`Level::errors`], and their order below p +
    /// 1.
    pub fn norms(problem: &Problem, patch: PatchFamily) -> Vec<(&'static str, usize)> {
        let displacement = [("displacement error in L2", 0), ("displacement error in H1", 1)];
        if problem.equation == Equation::Static && patch == PatchFamily::Holed {
            return [&displacement[..], &[("stress error, largest at a point", 1)]].concat();
        }
        let phase = [("phase-field error in L2", 0), ("phase-field error in H1", 1)];
        match problem.equation {
            Equation::Projection | Equation::Static => displacement.to_vec(),
            Equation::PhaseField => phase.to_vec(),
            Equation::Dynamic => {
                let mut norms = displacement.to_vec();
                norms.push(("velocity error in L2", 0));
                if problem.solution.phase().is_some() {
                    norms.extend(phase);
                }
                norms
            }
        }
    }

    fn end_time(&self) -> f64 {
        self.setup.end_time.unwrap_or(self.problem.end_time)
    }

    fn grid(&self) -> ControlGrid {
        self.frame.lattice.grid
    }

    fn manufactured(&self) -> Arc<Manufactured> {
        let model = FractureModel::of(&self.problem.solution.material());
        Arc::new(Manufactured {
            solution: self.problem.solution.clone(),
            loading: self.setup.loading,
            moved: false,
            diffusion: model.map_or(0.0, |model| model.diffusion()),
        })
    }

    /// Projection of a vector field; components that boundaries hold are zero where they are so in the exact
    /// solution.
    fn project(&self, function: impl Fn([f64; 2]) -> [f64; 2] + Sync) -> Result<VectorField, StudyError> {
        match self.problem.equation {
            Equation::Dynamic => projected(&self.frame, function),
            _ => projected_on(&self.frame.lattice, |_| Vec::new(), function),
        }
    }

    /// The quotient of `Σ_p V_p N_I f` and `Σ_p V_p N_I`: what a lumped transfer from points to grid gives.
    fn project_by_row_sums(&self, function: impl Fn([f64; 2]) -> [f64; 2] + Sync) -> VectorField {
        let lattice = &self.frame.lattice;
        let volumes = lattice.integrate(|_, _, _| 1.0);
        [0, 1].map(|i| {
            let sums = lattice.integrate(|_, _, x| function(x)[i]);
            sums.iter().zip(&volumes).map(|(sum, volume)| if *volume > 0.0 { sum / volume } else { 0.0 }).collect()
        })
    }

    fn solve_static(&mut self) -> Result<VectorField, StudyError> {
        let zeros = || [self.grid().zeros(), self.grid().zeros()];
        let prescribed = self.project_on_sides()?;
        let (still, forcing) = (zeros(), self.manufactured());
        self.frame.start_from(still.clone(), still, forcing).map_err(|_| other("no phase field is expected"))?;
        let forces = self.frame.forced_loads();
        let solver =
            StaticSolver::new(&self.frame, 0.0).ok_or_else(|| other("the stiffness is not positive definite"))?;
        Ok(solver.solve(&forces, &prescribed))
    }

    /// Least-squares projection of the exact displacement along the sides that are held.
    fn project_on_sides(&self) -> Result<VectorField, StudyError> {
        let mut field = [self.grid().zeros(), self.grid().zeros()];
        let degree = self.frame.patch.spaces.each_ref().map(|space| space.degree());
        let rule = Rule::new(Layout::Gauss, degree[0].max(degree[1]) + 3);
        for &(side, fixed) in &self.problem.held {
            let at = control_points_on(side, self.grid());
            let number = |index: usize| at.iter().position(|&other| other == index);
            let mut matrix = DMatrix::zeros(at.len(), at.len());
            let mut right = DMatrix::zeros(at.len(), 2);
            for point in self.frame.patch.boundary(side, &rule) {
                let exact = self.problem.solution.displacement(point.functions.position, 0.0);
                let on_side = point.functions.values.iter().filter_map(|&(index, value)| Some((number(index)?, value)));
                let functions: Vec<(usize, f64)> = on_side.collect();
                for &(m, value) in &functions {
                    for &(n, other) in &functions {
                        matrix[(m, n)] += point.length * value * other;
                    }
                    for component in 0..2 {
                        right[(m, component)] += point.length * value * exact[component];
                    }
                }
            }
            let factor = matrix.cholesky().ok_or_else(|| other("the points do not determine the side"))?;
            let solution = factor.solve(&right);
            for component in (0..2).filter(|&component| fixed[component]) {
                for (n, &index) in at.iter().enumerate() {
                    field[component][index] = solution[(n, component)];
                }
            }
        }
        Ok(field)
    }

    fn solve_phase_field(&self) -> Result<Vec<f64>, StudyError> {
        let phase = self.problem.solution.phase().ok_or_else(|| other("the solution has no phase field"))?;
        let model = FractureModel::of(&self.problem.solution.material());
        let model = model.ok_or_else(|| other("the material has no fracture"))?;
        let lattice = &self.frame.lattice;
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

    /// The initial displacement that excites no waves of its own: the elastic energy of its error, plus the
    /// kinetic energy of as much velocity, is least. A least-squares projection would leave an error of high
    /// frequency, which costs the velocity an order.
    fn elliptic_projection(&self) -> Result<VectorField, StudyError> {
        let solution = &self.problem.solution;
        let material = solution.material();
        let moduli = ElasticModuli::new(&material, solution.plane());
        let mut forces = [self.grid().zeros(), self.grid().zeros()];
        let [x, y] = &mut forces;
        self.frame.lattice.add_integral(&mut [x, y], |_, _, position| {
            let [[xx, xy], [yx, yy]] = solution.displacement_gradient(position, 0.0);
            let [sx, sy, sxy] = moduli.stress([xx, yy, 0.5 * (xy + yx)].map(Lane::splat)).map(|s| s[0]);
            let force = solution.displacement(position, 0.0).map(|u| SHIFT * material.density * u);
            (force, [[sx, sxy], [sxy, sy]])
        });
        let solver = StaticSolver::new(&self.frame, SHIFT).ok_or_else(|| other("no elliptic projection"))?;
        Ok(solver.solve(&forces, &[self.grid().zeros(), self.grid().zeros()]))
    }

    /// Runs to the end in equal steps; the end time, s.
    fn run(&mut self, step: f64) -> Result<f64, StudyError> {
        let end = self.end_time();
        let solution = &self.problem.solution;
        let displacement = self.elliptic_projection()?;
        let velocity = self.project(|x| solution.velocity(x, 0.0))?;
        let broken = |_| other("the phase field does not converge");
        self.frame.start_from(displacement, velocity, self.manufactured()).map_err(broken)?;
        let steps = (end / step).ceil().max(1.0);
        for _ in 0..steps as usize {
            crate::watch::check()?;
            self.frame.step(end / steps).map_err(broken)?;
        }
        Ok(end)
    }

    /// Relative errors of a displacement in L2 and in the H1 seminorm.
    fn displacement_errors(&self, field: &VectorField, time: f64) -> Vec<f64> {
        let solution = &self.problem.solution;
        let exact = |x| (solution.displacement(x, time), solution.displacement_gradient(x, time));
        let squares = self.points.vector_squares(field, exact);
        vec![squares.l2(), squares.h1()]
    }

    /// Errors of a static displacement, and around a hole of its stress.
    fn static_errors(&self, field: &VectorField) -> Vec<f64> {
        let mut errors = self.displacement_errors(field, 0.0);
        if self.setup.patch == PatchFamily::Holed {
            errors.push(self.largest_stress_error(field));
        }
        errors
    }

    /// Largest error of a component of the stress at a material point, Pa.
    fn largest_stress_error(&self, field: &VectorField) -> f64 {
        let mut worst = 0.0;
        self.frame.lattice.for_each_point(|_, _, position, _| {
            let [xx, yy, xy] = self.frame.elastic_stress_at(field, position);
            let exact = self.problem.solution.stress(position, 0.0);
            for error in [xx - exact[0][0], yy - exact[1][1], xy - exact[0][1]] {
                worst = larger(worst, error.abs());
            }
        });
        worst
    }

    fn velocity_error(&self, field: &VectorField, time: f64) -> f64 {
        self.points.vector_squares(field, |x| (self.problem.solution.velocity(x, time), [[0.0; 2]; 2])).l2()
    }

    fn phase_errors(&self, field: &[f64], time: f64) -> Vec<f64> {
        let Some(phase) = self.problem.solution.phase() else { return Vec::new() };
        let squares = self.points.squares(field, |x| (phase.value(x, time), phase.gradient(x, time)));
        vec![squares.l2(), squares.h1()]
    }
}
