//! Scenes and small helpers that several tests share.

pub mod plain_points;
pub mod standing_wave;

use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::linear_algebra::control_grid::ControlGrid;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura::splines::spline::SplineSpace;

pub fn glass() -> Material {
    Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: None }
}

pub fn brittle() -> Fracture {
    Fracture::at2(3.0, 0.25e-3)
}

/// Fracture with a threshold.
pub fn at1(split: Split) -> Fracture {
    Fracture { model: CrackModel::At1, split, ..brittle() }
}

/// Gives the material of a scene a threshold, and its seeds the bound.
pub fn make_at1(scene: &mut Scene, split: Split) {
    make_bounded(scene, at1(split));
}

/// Makes the cracks of a scene cohesive, and its seeds bounds; a1 = 4.35 at 7.5 MPa.
pub fn make_cohesive(scene: &mut Scene, tensile_strength: f64, softening: Softening, split: Split) {
    let model = CrackModel::PfCzm { tensile_strength, softening };
    make_bounded(scene, Fracture { model, split, ..brittle() });
}

fn make_bounded(scene: &mut Scene, fracture: Fracture) {
    scene.materials.get_mut("glass").unwrap().fracture = Some(fracture);
    let seeds = scene.bodies[0].cracks.iter_mut().filter(|crack| crack.kind != CrackKind::Slit);
    seeds.for_each(|crack| crack.kind = CrackKind::Seed(None));
}

pub fn moduli() -> ElasticModuli {
    ElasticModuli::new(&glass(), Plane::Strain)
}

pub fn fracture_model() -> FractureModel {
    FractureModel::of(&Material { fracture: Some(brittle()), ..glass() }).unwrap()
}

pub fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Rectangle { min, max }
}

/// A body at rest of Gauss points.
pub fn body(shape: Shape, points: [usize; 2]) -> Body {
    Body { particles_per_cell: points, ..Body::at_rest("body", "glass", shape) }
}

/// A glass rectangle that fills its mesh from the origin to `size`, free on all sides.
pub fn elastic_scene(degree: usize, size: [f64; 2], cells: [usize; 2]) -> Scene {
    Scene {
        title: String::new(),
        mesh: Mesh::uniform([degree; 2], [0.0; 2], size, cells),
        analysis: Analysis {
            plane: Plane::Strain,
            thickness: 1.0,
            frame: Frame::Total,
            kinematics: Kinematics::Small,
            end_time: 5e-6,
            time_step: TimeStep::Auto,
            safety: 0.8,
            transfer: Transfer::default(),
            mass: Mass::Lumped,
            gravity: [0.0; 2],
            gravity_time: TimeFactor::default(),
        },
        solver: SolverSettings {
            phase_field_tolerance: 1e-10,
            phase_field_solver: PhaseFieldSolver::ConjugateGradients,
            phase_field_interval: PhaseFieldInterval::Steps(1),
        },
        materials: [("glass".to_string(), glass())].into(),
        bodies: vec![body(rectangle([0.0; 2], size), [degree.max(2); 2])],
        contact: None,
        boundaries: vec![],
        equilibrium: false,
        output: Output::rows(10),
    }
}

/// A solid of unit modulus and density.
pub fn unit_solid() -> Material {
    Material { young_modulus: 1.0, poisson_ratio: 0.3, density: 1.0, fracture: None }
}

/// A free body of a material called `solid` in the updated frame, with FLIP, at half the critical step, for 1
/// s.
pub fn updated_scene(material: Material, mesh: Mesh, shape: Shape) -> Scene {
    let mut scene = elastic_scene(mesh.degree[0], [1.0; 2], [1; 2]);
    scene.materials = [("solid".to_string(), material)].into();
    scene.bodies[0].material = "solid".into();
    scene.bodies[0].shape = shape;
    scene.mesh = mesh;
    scene.analysis = Analysis { frame: Frame::Updated, end_time: 1.0, safety: 0.5, ..scene.analysis };
    scene
}

/// A plate of 10 mm by 5 mm with spans of l0, pulled open by `stress` (Pa); an elastic one.
pub fn pulled_plate(stress: f64) -> Scene {
    let mut scene = elastic_scene(2, [0.01, 0.005], [40, 20]);
    let pull = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::ramp(1e-6));
    scene.bodies[0].tractions = vec![pull(Side::Top, stress), pull(Side::Bottom, -stress)];
    scene
}

/// A small plate, clamped at its left side, whose right side is driven in x.
pub fn driven_plate(cells: [usize; 2]) -> Scene {
    let mut scene = elastic_scene(2, [0.01, 0.005], cells);
    scene.boundaries =
        vec![Boundary::fixed(Side::Left, [true, true]), Boundary::driven(Side::Right, [true, false], [1.0, 0.0])];
    scene
}

/// The plate, brittle and with a crack of 4 mm from its left side.
pub fn notched_plate(stress: f64) -> Scene {
    let mut scene = pulled_plate(stress);
    scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
    scene.bodies[0].cracks = vec![Crack::wide_seed([0.0, 0.0025], [0.004, 0.0025], Some(0.25e-3))];
    scene
}

/// Two brittle discs in collision, with finite strains.
pub fn two_discs() -> Scene {
    let mut scene = notched_plate(1e6);
    scene.mesh = Mesh::uniform([2; 2], [0.0; 2], [0.02, 0.01], [80, 40]);
    let disc = |name: &str, x: f64, speed: f64| Body {
        name: name.into(),
        shape: Shape::Disk { center: [x, 0.005], radius: 0.004 },
        velocity: [speed, 0.0],
        cracks: vec![],
        tractions: vec![],
        ..scene.bodies[0].clone()
    };
    scene.bodies = vec![disc("left", 0.006, 20.0), disc("right", 0.014, -20.0)];
    scene.boundaries.clear();
    scene.contact = Some(Contact { friction: 0.2, ..Contact::default() });
    scene.analysis.frame = Frame::Updated;
    scene.analysis.kinematics = Kinematics::Finite;
    scene.analysis.end_time = 3e-6;
    scene
}

/// An elastic horseshoe whose sides rigid blocks press together, one further down than the other.
pub fn horseshoe() -> Scene {
    let mut scene = two_discs();
    scene.materials.values_mut().for_each(|material| material.fracture = None);
    let around = Box::new(rectangle([0.004, 0.002], [0.016, 0.008]));
    let slit = rectangle([0.00995, 0.001], [0.01005, 0.007]);
    let block = |name: &str, x: [f64; 2], y: [f64; 2], speed: f64| Body {
        name: name.into(),
        rigid: true,
        velocity: [speed, 0.0],
        ..body(rectangle([x[0], y[0]], [x[1], y[1]]), [2, 2])
    };
    scene.bodies = vec![
        body(Shape::Difference { of: around, minus: vec![slit] }, [2, 2]),
        block("left", [0.002, 0.004], [0.003, 0.006], 30.0),
        block("right", [0.016, 0.018], [0.002, 0.005], -30.0),
    ];
    scene.contact = Some(Contact { friction: 0.4, self_contact: true, ..Contact::default() });
    let (frame, kinematics) = (Frame::Total, Kinematics::Finite);
    scene.analysis = Analysis { end_time: 6e-6, frame, kinematics, ..scene.analysis };
    scene
}

/// Runs a scene; its samples from t = 0 on.
pub fn run(scene: &Scene) -> (Simulation, Vec<Sample>) {
    let mut simulation = Simulation::new(scene).expect("the scene starts");
    let mut samples = vec![simulation.sample()];
    while !simulation.finished() {
        samples.push(simulation.advance_to_next_sample().expect("the scene runs"));
    }
    (simulation, samples)
}

/// Largest closure over the largest energy of a run; not a number if one closure is not.
pub fn relative_closure(samples: &[Sample]) -> f64 {
    let largest = |of: fn(&Sample) -> f64| samples.iter().map(of).max_by(f64::total_cmp).expect("samples");
    largest(|s| s.closure.abs()) / largest(Sample::largest_term)
}

/// Largest closure of a sample over its own largest energy; not a number if one closure is not.
pub fn closure_of_any_sample(samples: &[Sample]) -> f64 {
    let closures = samples.iter().map(|s| s.closure.abs() / s.largest_term().max(1e-300));
    closures.max_by(f64::total_cmp).expect("samples")
}

/// Runs `f` in a pool of its own.
pub fn with_threads<T: Send>(threads: usize, f: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool").install(f)
}

/// Numbers in [−1, 1), the same for the same seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed ^ 0x9e37_79b9_7f4a_7c15)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A field on the control points.
    pub fn field(&mut self, grid: ControlGrid, scale: f64) -> Vec<f64> {
        let mut field = grid.zeros();
        for at in grid.indices() {
            field[at] = scale * self.next();
        }
        field
    }
}

/// An open knot vector with spans of ratio 1.3 and the knots of `repeated` doubled.
pub fn graded_knots(degree: usize, spans: usize, repeated: &[usize]) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    let (mut x, mut length) = (0.0, 0.1);
    for span in 1..=spans {
        x += length;
        length *= if span.is_multiple_of(7) { 0.4 } else { 1.3 };
        let times = if span == spans {
            degree + 1
        } else if repeated.contains(&span) {
            degree.min(2)
        } else {
            1
        };
        knots.extend(std::iter::repeat_n(x, times));
    }
    knots
}

/// An open knot vector from 0 to 1 whose spans differ by up to a factor of 100; every third inner knot is
/// repeated.
pub fn random_knots(random: &mut Random, degree: usize, spans: usize) -> Vec<f64> {
    let lengths: Vec<f64> = (0..spans).map(|_| 10f64.powf(1.0 + random.next())).collect();
    let total: f64 = lengths.iter().sum();
    let mut knots = vec![0.0; degree + 1];
    let mut sum = 0.0;
    for (n, length) in lengths[..spans - 1].iter().enumerate() {
        sum += length / total;
        knots.extend(vec![sum; if n % 3 == 2 { degree.min(2) } else { 1 }]);
    }
    knots.extend(vec![1.0; degree + 1]);
    knots
}

/// A bent square of about 1 m on random knots with weights from 0.1 to 10; bend and weights are tamed until
/// neither it nor its halves are folded.
pub fn random_patch(degree: [usize; 2], spans: [usize; 2], seed: u64) -> NurbsPatch {
    let mut random = Random::new(seed);
    let knots = [0, 1].map(|d| random_knots(&mut random, degree[d], spans[d]));
    let [gx, gy] = [0, 1].map(|d| SplineSpace::new(degree[d], &knots[d]).greville());
    let logarithms: Vec<f64> = (0..gx.len() * gy.len()).map(|_| random.next()).collect();
    for tame in [1.0, 0.5, 0.25, 0.1] {
        let bend = |u: f64, v: f64| [u + 0.3 * tame * v * v, v + 0.4 * tame * u * (1.0 - u) + 0.2 * tame * u * v];
        let control = gy.iter().flat_map(|&v| gx.iter().map(move |&u| bend(u, v))).collect();
        let weights = logarithms.iter().map(|log| 10f64.powf(tame * log)).collect();
        if let Ok(patch) = NurbsPatch::new(degree, [&knots[0], &knots[1]], control, weights)
            && patch.subdivide(2).is_ok()
        {
            return patch;
        }
    }
    panic!("seed {seed} folds")
}

/// A biquadratic square with curved sides, raised to `degree` and cut into `parts` per direction; polynomial.
pub fn bent_patch(degree: usize, parts: usize) -> NurbsPatch {
    let piece: &[f64] = &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let x = [0.0, 0.5, 1.0, -0.1, 0.55, 1.15, 0.1, 0.5, 1.0];
    let y = [0.0, 0.15, 0.0, 0.4, 0.45, 0.35, 0.8, 0.7, 0.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    refined(NurbsPatch::new([2, 2], [piece, piece], points, vec![1.0; 9]).expect("not folded"), degree, parts)
}

/// The quarter annulus with radii 1 and 2, of `degree` in both directions and `parts` spans per direction.
pub fn annulus(degree: usize, parts: usize) -> NurbsPatch {
    refined(NurbsPatch::quarter_annulus(1.0, 2.0).expect("growing radii"), degree, parts)
}

fn refined(mut patch: NurbsPatch, degree: usize, parts: usize) -> NurbsPatch {
    for direction in 0..2 {
        while patch.spaces()[direction].degree() < degree {
            patch = patch.elevate(direction).expect("degree up to 4");
        }
    }
    patch.subdivide(parts).expect("not folded")
}

/// A general patch as a scene: a glass body that is all of it, `points` per span and direction.
pub fn patch_scene(patch: &NurbsPatch, points: usize) -> Scene {
    let mut scene = elastic_scene(1, [1.0; 2], [1; 2]);
    scene.mesh = Mesh::of(patch);
    scene.bodies[0] = body(Shape::Patch, [points; 2]);
    scene
}
