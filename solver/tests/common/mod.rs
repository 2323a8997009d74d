//! Scenes and small helpers that several tests share.
#![allow(dead_code)] // each test takes what it needs

use fisura::Simulation;
use fisura::energy::Sample;
use fisura::material::{ElasticModuli, FractureModel};
use fisura::patch::ControlGrid;
use fisura::scene::*;

pub fn glass() -> Material {
    Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: None }
}

pub fn brittle() -> Fracture {
    Fracture {
        critical_energy_release_rate: 3.0,
        length_scale: 0.25e-3,
        residual_stiffness: 0.0,
        split: Split::Spectral,
    }
}

pub fn moduli() -> ElasticModuli {
    ElasticModuli::new(&glass(), Plane::Strain)
}

pub fn fracture_model() -> FractureModel {
    FractureModel::new(&brittle())
}

pub fn rectangle(min: [f64; 2], max: [f64; 2]) -> Shape {
    Shape::Rectangle { min, max }
}

/// A body at rest of Gauss points.
pub fn body(shape: Shape, points: [usize; 2]) -> Body {
    Body {
        name: "body".into(),
        material: "glass".into(),
        shape,
        particles_per_cell: points,
        layout: Layout::Gauss,
        velocity: [0.0; 2],
        angular_velocity: 0.0,
        rigid: false,
        tractions: vec![],
        cracks: vec![],
    }
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
            transfer: Transfer::Flip,
            mass: Mass::Lumped,
            gravity: [0.0; 2],
        },
        solver: SolverSettings {
            phase_field_tolerance: 1e-10,
            phase_field_solver: PhaseFieldSolver::ConjugateGradients,
        },
        materials: [("glass".to_string(), glass())].into(),
        bodies: vec![body(rectangle([0.0; 2], size), [degree.max(2); 2])],
        contact: None,
        boundaries: vec![],
        output: Output { samples: 10, frames: vec![] },
    }
}

/// A plate of 10 mm by 5 mm with spans of l0, pulled open by `stress` (Pa); an elastic one.
pub fn pulled_plate(stress: f64) -> Scene {
    let mut scene = elastic_scene(2, [0.01, 0.005], [40, 20]);
    let pull = |side, stress| Traction { edge: Edge::Side(side), stress: [0.0, stress], ramp: Some(1e-6) };
    scene.bodies[0].tractions = vec![pull(Side::Top, stress), pull(Side::Bottom, -stress)];
    scene
}

/// The plate, brittle and with a crack of 4 mm from its left side.
pub fn notched_plate(stress: f64) -> Scene {
    let mut scene = pulled_plate(stress);
    scene.materials.get_mut("glass").unwrap().fracture = Some(brittle());
    scene.bodies[0].cracks = vec![Crack { from: [0.0, 0.0025], to: [0.004, 0.0025], half_width: Some(0.25e-3) }];
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
