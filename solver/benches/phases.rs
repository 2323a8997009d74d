//! One benchmark per phase of the step, with throughput in material points.
//!
//! A square of 65 536 points (p = 2, 128 × 128 spans of 2 × 2) or about as many (p = 3, 85 × 85 spans of 3 × 3) with a
//! seeded crack. Every answer is checked before it is timed. One thread: what a second one adds is another question.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BatchSize, Bencher, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fisura::Simulation;
use fisura::assembly::{Constant, Form, PointCoefficients, add_form};
use fisura::critical_step::highest_frequency;
use fisura::incomplete_cholesky::IncompleteCholesky;
use fisura::kernels::{DegradedStress, ElasticStress, HistoryUpdate};
use fisura::lane::Lane;
use fisura::lattice::Lattice;
use fisura::material::{ElasticModuli, FractureModel};
use fisura::patch::Patch;
use fisura::phase_field::PhaseField;
use fisura::scene::*;
use fisura::stencil::Stencil;
use fisura::sweep::{Fields, StripForces, sweep};

/// Span length, m: the length scale.
const SPAN: f64 = 0.25e-3;

/// A cracked square of the given degree and what its phases work on.
struct Square {
    name: String,
    scene: Scene,
    patch: Patch,
    lattice: Lattice,
    moduli: ElasticModuli,
    model: FractureModel,
    displacement: [Vec<f64>; 2],
    history: Vec<Lane>,
    points: u64,
}

impl Square {
    fn new(degree: usize, points: usize, cells: usize) -> Self {
        let scene = scene(degree, points, cells);
        let patch = Patch::new(&scene.mesh);
        let lattice = Lattice::new(&patch, &scene.bodies[0]);
        let material = &scene.materials["glass"];
        let moduli = ElasticModuli::new(material, Plane::Strain);
        let model = FractureModel::new(material.fracture.as_ref().unwrap());
        let mut displacement = [lattice.grid.zeros(), lattice.grid.zeros()];
        for (n, at) in lattice.grid.indices().enumerate() {
            displacement[0][at] = 1e-7 * (0.37 * n as f64).sin();
            displacement[1][at] = 1e-7 * (0.23 * n as f64).cos();
        }
        let history = fisura::fracture::Fracturing::new(&lattice, &scene.bodies[0], model, &scene.solver)
            .expect("the first solve converges")
            .history;
        let count = lattice.count() as u64;
        let name = format!("p{degree}_{points}x{points}");
        Self { name, scene, patch, lattice, moduli, model, displacement, history, points: count }
    }

    fn fields<'a>(&'a self, phase: &'a [f64]) -> Fields<'a> {
        Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase }
    }

    /// A body that is left to itself pulls nowhere: its internal forces add up to zero.
    fn check_forces(&self, strips: &StripForces) {
        let mut forces = [self.lattice.grid.zeros(), self.lattice.grid.zeros()];
        strips.assemble(self.lattice.grid.stride, &mut forces);
        for component in forces {
            let (sum, size) = component.iter().fold((0.0, 0.0), |(s, a), f| (s + f, a + f.abs()));
            assert!(size > 0.0 && f64::abs(sum) <= 1e-12 * size, "total force {sum:e} of {size:e}");
        }
    }

    fn elastic_sweep(&self, strips: &mut StripForces) {
        let kernel = || ElasticStress { moduli: self.moduli, energy: Lane::ZERO };
        let mut kernels: Vec<_> = (0..self.lattice.strips()).map(|_| kernel()).collect();
        sweep(&self.lattice, self.fields(&[]), &mut kernels, Some(strips));
    }

    fn history_sweep(&self, history: &mut [Lane]) {
        let (moduli, model) = (self.moduli, self.model);
        let chunks = history.chunks_mut(self.lattice.strip_batches());
        let mut kernels: Vec<_> = chunks.map(|history| HistoryUpdate { moduli, model, history }).collect();
        sweep(&self.lattice, self.fields(&[]), &mut kernels, None);
    }

    fn degraded_sweep(
        &self,
        phase: &[f64],
        history: &[Lane],
        at_points: &mut [Vec<Lane>; 2],
        strips: &mut StripForces,
    ) {
        let chunk = self.lattice.strip_batches();
        let [phases, remembered] = at_points;
        let states = phases.chunks_mut(chunk).zip(remembered.chunks_mut(chunk)).zip(history.chunks(chunk));
        let mut kernels: Vec<_> = states
            .map(|((phase, remembered), history)| DegradedStress {
                moduli: self.moduli,
                model: self.model,
                history,
                phase,
                remembered,
                energy: Lane::ZERO,
                history_work: Lane::ZERO,
            })
            .collect();
        sweep(&self.lattice, self.fields(phase), &mut kernels, Some(strips));
    }

    /// The whole phase-field matrix.
    fn assemble(&self, matrix: &mut Stencil) {
        matrix.coefficients_mut().fill(0.0);
        let reaction = Reaction { history: &self.history, per_energy: self.model.reaction_per_energy() };
        add_form(matrix, &self.lattice, Form::Mass, &reaction);
        add_form(matrix, &self.lattice, Form::Diffusion, &Constant(self.model.diffusion()));
    }

    fn matrix(&self) -> Stencil {
        let mut matrix = Stencil::zeros(self.lattice.grid, self.lattice.degree);
        self.assemble(&mut matrix);
        let (mut ones, mut image) = (self.lattice.grid.zeros(), self.lattice.grid.zeros());
        self.lattice.grid.indices().for_each(|at| ones[at] = 1.0);
        let sum = matrix.apply(&ones, &mut image); // gradients of a constant vanish: the reaction is left
        let mut expected = 0.0;
        let per_energy = self.model.reaction_per_energy();
        self.lattice.for_each_point(|batch, lane, _, weight| {
            expected += weight * (1.0 + per_energy * self.history[batch][lane]);
        });
        assert!((sum / expected - 1.0).abs() <= 1e-10, "1·K·1 = {sum:e} for {expected:e}");
        matrix
    }

    fn phase_field(&self) -> PhaseField {
        let mut field = PhaseField::new(&self.lattice, self.model, &self.scene.solver);
        let outcome = field.initialise(&self.lattice, &self.history).expect("the first solve converges");
        assert!(outcome.relative_residual <= self.scene.solver.phase_field_tolerance);
        field
    }
}

/// `1 + 4 l0 (1 − k) H/Gc` at the points.
struct Reaction<'a> {
    history: &'a [Lane],
    per_energy: f64,
}

impl PointCoefficients for Reaction<'_> {
    #[inline(always)]
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for (i, weight) in weights.iter().enumerate() {
            out[i] = *weight * (self.history[first + i] * self.per_energy + Lane::splat(1.0));
        }
        true
    }
}

fn scene(degree: usize, points: usize, cells: usize) -> Scene {
    let size = SPAN * cells as f64;
    let fracture = Fracture {
        critical_energy_release_rate: 3.0,
        length_scale: SPAN,
        residual_stiffness: 0.0,
        split: Split::Spectral,
    };
    let glass = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: Some(fracture) };
    let crack = Crack { from: [0.0, 0.5 * size], to: [0.5 * size, 0.5 * size], half_width: None };
    Scene {
        title: String::new(),
        mesh: Mesh::uniform([degree; 2], [0.0; 2], [size; 2], [cells; 2]),
        analysis: Analysis {
            plane: Plane::Strain,
            thickness: 1.0,
            frame: Frame::Total,
            kinematics: Kinematics::Small,
            end_time: 1e-6,
            time_step: TimeStep::Auto,
            safety: 0.8,
            transfer: Transfer::Flip,
            mass: Mass::Lumped,
            gravity: [0.0; 2],
        },
        solver: SolverSettings {
            phase_field_tolerance: 1e-8,
            phase_field_solver: PhaseFieldSolver::ConjugateGradients,
        },
        materials: [("glass".to_string(), glass)].into(),
        bodies: vec![Body {
            name: "square".into(),
            material: "glass".into(),
            shape: Shape::Rectangle { min: [0.0; 2], max: [size; 2] },
            particles_per_cell: [points; 2],
            layout: Layout::Gauss,
            velocity: [0.0; 2],
            angular_velocity: 0.0,
            rigid: false,
            tractions: vec![],
            cracks: vec![crack],
        }],
        contact: None,
        boundaries: vec![],
        output: Output { samples: 1, frames: vec![] },
    }
}

/// One phase of one square.
fn measure(criterion: &mut Criterion, name: &str, square: &Square, run: impl FnMut(&mut Bencher)) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(1200));
    group.throughput(Throughput::Elements(square.points));
    group.bench_function(BenchmarkId::from_parameter(&square.name), run);
    group.finish();
}

/// One phase of one square: `routine` is timed.
fn phase(criterion: &mut Criterion, name: &str, square: &Square, mut routine: impl FnMut()) {
    measure(criterion, name, square, |bencher| bencher.iter(&mut routine));
}

/// Shape functions at every point, as the total frame does once and the updated frame at every step.
fn basis(criterion: &mut Criterion, square: &Square) {
    let mut positions = Vec::new();
    square.lattice.for_each_point(|_, _, position, _| {
        positions.push([0, 1].map(|d| (square.patch.spaces[d].find_span(position[d]).unwrap(), position[d])));
    });
    let sum = |at: &[(usize, f64); 2]| {
        let [x, y] = [0, 1].map(|d| square.patch.spaces[d].shape_functions(at[d].0, at[d].1));
        x.value.iter().sum::<f64>() * y.value.iter().sum::<f64>()
    };
    assert!(positions.iter().all(|at| (sum(at) - 1.0).abs() <= 1e-13), "shape functions sum to one");
    phase(criterion, "basis", square, || {
        for at in &positions {
            for d in 0..2 {
                black_box(square.patch.spaces[d].shape_functions(at[d].0, at[d].1));
            }
        }
    });
}

fn sweeps(criterion: &mut Criterion, square: &Square) {
    let mut strips = StripForces::new(&square.lattice);
    square.elastic_sweep(&mut strips);
    square.check_forces(&strips);
    phase(criterion, "elastic_sweep", square, || square.elastic_sweep(&mut strips));

    let mut history = square.history.clone();
    square.history_sweep(&mut history);
    assert!(history.iter().zip(&square.history).all(|(new, old)| (0..8).all(|l| new[l] >= old[l])), "H only grows");
    assert!(history != square.history, "and it grew");
    phase(criterion, "history_sweep", square, || square.history_sweep(&mut history));

    let field = square.phase_field();
    let zeros = || vec![Lane::ZERO; square.lattice.batches()];
    let mut at_points = [zeros(), zeros()];
    square.degraded_sweep(field.control_values(), &history, &mut at_points, &mut strips);
    square.check_forces(&strips);
    phase(criterion, "degraded_sweep", square, || {
        square.degraded_sweep(field.control_values(), &history, &mut at_points, &mut strips);
    });

    let mut forces = [square.lattice.grid.zeros(), square.lattice.grid.zeros()];
    phase(criterion, "sum_of_strips", square, || strips.assemble(square.lattice.grid.stride, &mut forces));
}

fn matrices(criterion: &mut Criterion, square: &Square) {
    let mut matrix = square.matrix();
    phase(criterion, "assembly", square, || square.assemble(&mut matrix));

    let mut x = square.lattice.grid.zeros();
    square.lattice.grid.indices().enumerate().for_each(|(n, at)| x[at] = (0.3 * n as f64).sin());
    let mut image = x.clone();
    let energy = matrix.apply(&x, &mut image);
    let product: f64 = x.iter().zip(&image).map(|(x, y)| x * y).sum();
    assert!(energy > 0.0 && (energy / product - 1.0).abs() <= 1e-12, "x·(A x)");
    phase(criterion, "stencil_apply", square, || {
        black_box(matrix.apply(&x, &mut image));
    });

    let mut factor = IncompleteCholesky::new(&matrix);
    assert!(factor.apply(&x, &mut image) > 0.0, "the preconditioner is positive definite");
    phase(criterion, "factorisation", square, || factor.refactor(&matrix));
    phase(criterion, "preconditioner", square, || {
        black_box(factor.apply(&x, &mut image));
    });
}

/// Solves as a step does them: where no H grew, which looks for increments and takes one residual; and where H grew by
/// a hundredth of `Gc/l0` about the crack tip, the same growth from the same state every time.
fn solves(criterion: &mut Criterion, square: &Square) {
    let mut field = square.phase_field();
    phase(criterion, "solve_unchanged", square, || {
        let outcome = field.solve(&square.lattice, &square.history).expect("the solve converges");
        assert_eq!(outcome.iterations, 0, "nothing changed");
    });

    let tip = [0.5 * SPAN * square.patch.spaces[0].spans().len() as f64; 2];
    let mut history = square.history.clone();
    square.lattice.for_each_point(|batch, lane, [x, y], _| {
        if (x - tip[0]).hypot(y - tip[1]) < 6.0 * SPAN {
            history[batch][lane] += 0.01 * square.model.toughness / square.model.length_scale;
        }
    });
    let start = square.phase_field();
    let solve = |field: &mut PhaseField| {
        let outcome = field.solve(&square.lattice, &history).expect("the solve converges");
        assert!(outcome.iterations > 0 && outcome.relative_residual <= 1e-8, "{outcome:?}");
    };
    measure(criterion, "solve_warm", square, |bencher| {
        bencher.iter_batched_ref(|| start.clone(), solve, BatchSize::LargeInput);
    });
}

fn steps(criterion: &mut Criterion, square: &Square) {
    let simulation = Simulation::new(&square.scene).expect("the scene starts");
    let critical = simulation.plan().critical;
    let speed = square.moduli.dilatational_speed(2450.0);
    assert!((0.4..1.1).contains(&(critical * speed / SPAN)), "c dt/h = {}", critical * speed / SPAN);
    phase(criterion, "critical_step", square, || {
        black_box(highest_frequency(&mut simulation.total_frame().unwrap().stiffness_operator()));
    });

    let mut elastic = square.scene.clone();
    elastic.bodies[0].cracks.clear();
    elastic.bodies[0].angular_velocity = 100.0;
    elastic.materials.values_mut().for_each(|m| m.fracture = None);
    let mut simulation = Simulation::new(&elastic).expect("the scene starts");
    (0..10).for_each(|_| simulation.step().expect("a stable step"));
    let sample = simulation.sample();
    assert!(sample.closure.abs() <= 1e-12 * sample.largest_term(), "the ledger closes");
    phase(criterion, "elastic_step", square, || simulation.step().expect("a stable step"));
}

fn all(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool of this process");
    for square in [Square::new(2, 2, 128), Square::new(3, 3, 85)] {
        basis(criterion, &square);
        sweeps(criterion, &square);
        matrices(criterion, &square);
        solves(criterion, &square);
        steps(criterion, &square);
    }
}

criterion_group!(benches, all);
criterion_main!(benches);
