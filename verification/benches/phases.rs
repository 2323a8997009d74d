//! One benchmark per phase of the step, with throughput in material points.
//!
//! A square of 65 536 points (p = 2, 128 × 128 spans of 2 × 2) or about as many (p = 3, 85 × 85 spans of 3 ×
//! 3) with a seeded crack; in the updated frame an elastic one, beside the minimal kernel as the yardstick.
//! Every answer is checked before it is timed. One thread: what a second one adds is another question.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{BatchSize, Bencher, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use fisura::Simulation;
use fisura::dynamics::critical_step::highest_frequency;
use fisura::linear_algebra::incomplete_cholesky::IncompleteCholesky;
use fisura::scene::{Contact, Split};
use fisura::transfer::sweep::StripForces;
use fisura_verification::bench::block::{Block, DENSITY, SPAN, elastic_scene, moving_scene};
use fisura_verification::bench::minimal::Minimal;
use fisura_verification::bench::moving_block::{MovingBlock, minimal};
use fisura_verification::bench::scenes::pair;

/// Round-off in sums of forces.
const BALANCED: f64 = 1e-12;

/// One phase of a block of so many points.
fn measure(criterion: &mut Criterion, name: &str, block: &str, points: usize, run: impl FnMut(&mut Bencher)) {
    let mut group = criterion.benchmark_group(name);
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(1200));
    group.throughput(Throughput::Elements(points as u64));
    group.bench_function(BenchmarkId::from_parameter(block), run);
    group.finish();
}

/// One phase of a square: `routine` is timed.
fn phase(criterion: &mut Criterion, name: &str, square: &Block, mut routine: impl FnMut()) {
    measure(criterion, name, &square.name, square.points, |bencher| bencher.iter(&mut routine));
}

/// Shape functions at every point, as the total frame does once and the updated frame at every step.
fn basis(criterion: &mut Criterion, square: &Block) {
    let located = square.located();
    let sum = |at: &[(usize, f64); 2]| {
        let [x, y] = [0, 1].map(|d| square.patch.spaces[d].shape_functions(at[d].0, at[d].1));
        x.value.iter().sum::<f64>() * y.value.iter().sum::<f64>()
    };
    assert!(located.iter().all(|at| (sum(at) - 1.0).abs() <= 1e-13), "shape functions sum to one");
    phase(criterion, "basis", square, || {
        for at in &located {
            for d in 0..2 {
                black_box(square.patch.spaces[d].shape_functions(at[d].0, at[d].1));
            }
        }
    });
}

fn sweeps(criterion: &mut Criterion, square: &Block) {
    let mut strips = StripForces::new(&square.lattice);
    square.elastic_sweep(&mut strips);
    assert!(square.force_imbalance(&strips) <= BALANCED, "total force");
    phase(criterion, "elastic_sweep", square, || square.elastic_sweep(&mut strips));

    let split = Split::Spectral;
    let mut history = square.history.clone();
    square.history_sweep(split, &mut history);
    assert!(history.iter().zip(&square.history).all(|(new, old)| (0..8).all(|l| new[l] >= old[l])), "H only grows");
    assert!(history != square.history, "and it grew");
    phase(criterion, "history_sweep", square, || square.history_sweep(split, &mut history));

    let field = square.phase_field().expect("the first solve converges");
    let mut at_points = square.at_points();
    square.degraded_sweep(split, field.control_values(), &mut history, &mut at_points, &mut strips);
    assert!(square.force_imbalance(&strips) <= BALANCED, "total force");
    phase(criterion, "degraded_sweep", square, || {
        square.degraded_sweep(split, field.control_values(), &mut history, &mut at_points, &mut strips);
    });

    let mut forces = [square.lattice.grid.zeros(), square.lattice.grid.zeros()];
    phase(criterion, "sum_of_strips", square, || strips.assemble(square.lattice.grid.stride, &mut forces));
}

fn matrices(criterion: &mut Criterion, square: &Block) {
    let (mut matrix, imbalance) = square.matrix();
    assert!(imbalance <= 1e-10, "1·K·1");
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

    let mut factor = IncompleteCholesky::new(&matrix, false);
    let (x, mut image): (Vec<f32>, _) = (x.iter().map(|x| *x as f32).collect(), vec![0.0; image.len()]);
    assert!(factor.apply(matrix.active(), &x, &mut image) > 0.0, "the preconditioner is positive definite");
    phase(criterion, "factorisation", square, || factor.refactor(&matrix));
    phase(criterion, "preconditioner", square, || {
        black_box(factor.apply(matrix.active(), &x, &mut image));
    });
}

/// Solves as a step does them: where no H grew, which looks for increments and takes one residual; and where
/// H grew by a hundredth of `Gc/l0` about the crack tip, the same growth from the same state every time.
fn solves(criterion: &mut Criterion, square: &Block) {
    let mut field = square.phase_field().expect("the first solve converges");
    phase(criterion, "solve_unchanged", square, || {
        let outcome = field.solve(&square.lattice, &square.history).expect("the solve converges");
        assert_eq!(outcome.iterations, 0, "nothing changed");
    });

    let history = square.grown_history();
    let start = square.phase_field().expect("the first solve converges");
    measure(criterion, "solve_warm", &square.name, square.points, |bencher| {
        let solve = |field: &mut fisura::phase_field::PhaseField| {
            let outcome = field.solve(&square.lattice, &history).expect("the solve converges");
            assert!(outcome.iterations > 0 && outcome.error <= 2e-6, "{outcome:?}");
        };
        bencher.iter_batched_ref(|| start.clone(), solve, BatchSize::LargeInput);
    });
}

fn steps(criterion: &mut Criterion, square: &Block) {
    let simulation = Simulation::new(&square.scene).expect("the scene starts");
    let critical = simulation.plan().critical;
    let speed = square.moduli.dilatational_speed(DENSITY);
    assert!((0.4..1.1).contains(&(critical * speed / SPAN)), "c dt/h = {}", critical * speed / SPAN);
    phase(criterion, "critical_step", square, || {
        black_box(highest_frequency(&mut simulation.total_frame().unwrap().stiffness_operator()));
    });

    let [degree, points] = [square.lattice.degree[0], square.lattice.points[0]];
    let elastic = elastic_scene(degree, points, square.lattice.rows.len(), 0);
    let mut simulation = Simulation::new(&elastic).expect("the scene starts");
    (0..10).for_each(|_| simulation.step().expect("a stable step"));
    let sample = simulation.sample();
    assert!(sample.closure.abs() <= 1e-12 * sample.largest_term(), "the ledger closes");
    phase(criterion, "elastic_step", square, || simulation.step().expect("a stable step"));
}

/// P2G, grid and G2P of the updated frame, its whole step, and that of the minimal kernel on the same points.
fn updated_frame<const P: usize>(criterion: &mut Criterion, points: usize, cells: usize) {
    let name = format!("p{P}_{points}x{points}");
    let mut block = MovingBlock::new(P, points, cells, 5).expect("the block moves");
    assert!(block.deviation() <= BALANCED, "the phases are those of the step");
    let count = block.count();
    measure(criterion, "grid", &name, count, |bencher| {
        bencher.iter_custom(|times| {
            let one = |_| {
                block.points_to_grid(); // the grid uses up what the points give
                let start = Instant::now();
                block.grid(0.0);
                start.elapsed()
            };
            (0..times).map(one).sum()
        });
    });
    let mut timed = |name: &str, block_name: &str, routine: &mut dyn FnMut()| {
        measure(criterion, name, block_name, count, |bencher| bencher.iter(&mut *routine));
    };
    timed("p2g", &name, &mut || block.points_to_grid());
    timed("g2p", &name, &mut || {
        black_box(block.grid_to_points(0.0));
    });
    let mut simulation = Simulation::new(&moving_scene(P, points, cells, P)).expect("the scene starts");
    timed("elastic_step_updated", &name, &mut || simulation.step().expect("a stable step"));

    let (mut kernel, dt): (Minimal<P>, f64) = minimal(points, cells).expect("the scene starts");
    timed("minimal_step", &name, &mut || kernel.step(dt));
}

/// Two bodies that meet: finding where they touch, and a whole step beside one of the same bodies without
/// contact.
fn contact(criterion: &mut Criterion, cells: usize) {
    let begun = |declared: Option<Contact>| {
        let mut simulation = Simulation::new(&pair(cells, 0.0, declared)).expect("the scene starts");
        (0..5).for_each(|_| simulation.step().expect("a stable step"));
        simulation
    };
    let (mut apart, mut meeting) = (begun(None), begun(Some(Contact { friction: 0.3, ..Contact::default() })));
    let frame = meeting.updated_frame().expect("the frame of contact");
    let mut found = frame.contact.clone().expect("it is declared");
    let forces = frame.contact_forces(meeting.plan().step);
    assert!(!found.constraints.is_empty() && !forces.is_empty(), "the bodies meet");
    let (name, points) = (format!("p2_2x2_{cells}_spans"), meeting.extent().particles);
    let mut timed = |name_of_phase: &str, routine: &mut dyn FnMut()| {
        measure(criterion, name_of_phase, &name, points, |bencher| bencher.iter(&mut *routine));
    };
    let fields = frame.fields.to_vec();
    let views: Vec<_> = fields.iter().map(|field| field.view()).collect();
    timed("contact_find", &mut || found.find(&views).expect("no body passes another"));
    timed("step_of_two_bodies", &mut || apart.step().expect("a stable step"));
    timed("step_of_two_bodies_in_contact", &mut || meeting.step().expect("a stable step"));
}

fn all(criterion: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("the first pool of this process");
    for (degree, points, cells) in [(2, 2, 128), (3, 3, 85)] {
        let square = Block::new(degree, points, cells, 0).expect("the first solve converges");
        basis(criterion, &square);
        sweeps(criterion, &square);
        matrices(criterion, &square);
        solves(criterion, &square);
        steps(criterion, &square);
    }
    updated_frame::<2>(criterion, 2, 128);
    updated_frame::<3>(criterion, 3, 85);
    contact(criterion, 128);
}

criterion_group!(benches, all);
criterion_main!(benches);
