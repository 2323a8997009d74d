//! A square block of points in the total frame, and the phases of its step one by one: for stage timings and
//! for the criterion benchmarks.

use fisura::linear_algebra::lane::Lane;
use fisura::linear_algebra::stencil::Stencil;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::PhaseField;
use fisura::phase_field::assembly::{Constant, Integrand, PointCoefficients, add_form};
use fisura::phase_field::fracture::LatticeFracture;
use fisura::scene::{
    Crack, Fracture, Frame, Material, Mesh, PhaseFieldInterval, PhaseFieldSolver, Plane, Scene, Shape, SolverSettings,
    Split, Transfer,
};
use fisura::splines::patch::Patch;
use fisura::transfer::kernels::{DegradedStress, ElasticStress, HistoryUpdate};
use fisura::transfer::point_kernel::Fields;
use fisura::transfer::sweep::{StripForces, sweep};

use super::BenchError;
use crate::extremes::largest;
use crate::scene::plain::PlainScene;

/// Span length, m: the length scale.
pub const SPAN: f64 = 0.25e-3;
/// Density of the block, kg/m³.
pub const DENSITY: f64 = 2450.0;
/// Spans that the mesh reaches beyond a moving block.
pub const MARGIN: usize = 4;

/// A glass square of `cells` × `cells` spans with `points` × `points` Gauss points each and a crack to its
/// middle. On all sides the mesh reaches `margin` spans beyond it; from p on, all functions on the body are
/// uniform.
pub fn cracked_scene(degree: usize, points: usize, cells: usize, margin: usize) -> Scene {
    let fracture = Fracture::at2(3.0, SPAN);
    let glass = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: DENSITY, fracture: Some(fracture) };
    let size = SPAN * cells as f64;
    let edge = SPAN * margin as f64;
    let mesh = Mesh::uniform([degree; 2], [-edge; 2], [size + 2.0 * edge; 2], [cells + 2 * margin; 2]);
    let mut scene = PlainScene::free(mesh, glass, points).scene();
    scene.analysis.safety = 0.8;
    scene.analysis.end_time = 1e-3;
    scene.output.samples = 1;
    scene.solver = SolverSettings {
        phase_field_tolerance: 2e-6,
        phase_field_solver: PhaseFieldSolver::ConjugateGradients,
        phase_field_interval: PhaseFieldInterval::Steps(1),
    };
    scene.bodies[0].shape = Shape::Rectangle { min: [0.0; 2], max: [size; 2] };
    scene.bodies[0].cracks = vec![Crack::seed([0.0, 0.5 * size], [0.5 * size; 2])];
    scene
}

/// The same without crack and fracture, spinning.
pub fn elastic_scene(degree: usize, points: usize, cells: usize, margin: usize) -> Scene {
    let mut scene = cracked_scene(degree, points, cells, margin);
    scene.bodies[0].cracks.clear();
    scene.bodies[0].angular_velocity = 100.0;
    scene.materials.values_mut().for_each(|m| m.fracture = None);
    scene
}

/// The same in the updated frame (FLIP).
pub fn moving_scene(degree: usize, points: usize, cells: usize, margin: usize) -> Scene {
    let mut scene = elastic_scene(degree, points, cells, margin);
    (scene.analysis.frame, scene.analysis.transfer) = (Frame::Updated, Transfer::Flip);
    scene
}

/// A cracked block and what its phases work on.
pub struct Block {
    /// Name of its records: degree and points, as in `p2_2x2`.
    pub name: String,
    /// The scene that it stands for.
    pub scene: Scene,
    /// Spline patch of the background mesh.
    pub patch: Patch,
    /// Its material points.
    pub lattice: Lattice,
    /// Elastic moduli of its material, Pa.
    pub moduli: ElasticModuli,
    /// Fracture constants.
    pub model: FractureModel,
    /// A rough displacement, m.
    pub displacement: [Vec<f64>; 2],
    /// History energy of the seeded crack, J/m³.
    pub history: Vec<Lane>,
    /// Number of material points.
    pub points: usize,
}

impl Block {
    /// The block of [`cracked_scene`].
    ///
    /// # Errors
    /// If its first phase field does not converge.
    pub fn new(degree: usize, points: usize, cells: usize, margin: usize) -> Result<Self, BenchError> {
        Self::of(cracked_scene(degree, points, cells, margin))
    }

    /// The block of a scene like that.
    ///
    /// # Errors
    /// If its first phase field does not converge.
    pub fn of(scene: Scene) -> Result<Self, BenchError> {
        let patch = Patch::new(&scene.mesh);
        let lattice = Lattice::new(&patch, &scene.bodies[0]);
        let material = &scene.materials[&scene.bodies[0].material];
        let moduli = ElasticModuli::new(material, Plane::Strain);
        let model = FractureModel::of(material).ok_or_else(|| BenchError::other("the block does not fracture"))?;
        let mut displacement = [lattice.grid.zeros(), lattice.grid.zeros()];
        for (n, at) in lattice.grid.indices().enumerate() {
            displacement[0][at] = 1e-7 * (0.37 * n as f64).sin();
            displacement[1][at] = 1e-7 * (0.23 * n as f64).cos();
        }
        let fracturing = LatticeFracture::new(&patch, &lattice, &scene.bodies[0], model, None, &scene.solver);
        let history = fracturing.map_err(|_| BenchError::other("the first phase field does not converge"))?.history;
        let (degree, points) = (lattice.degree[0], lattice.points[0]);
        let (name, count) = (format!("p{degree}_{points}x{points}"), lattice.count());
        Ok(Self { name, scene, patch, lattice, moduli, model, displacement, history, points: count })
    }

    fn fields<'a>(&'a self, phase: &'a [f64]) -> Fields<'a> {
        Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase }
    }

    /// Stress of the intact block and its forces.
    pub fn elastic_sweep(&self, strips: &mut StripForces) {
        let kernel = || ElasticStress { moduli: self.moduli, energy: Lane::ZERO };
        let mut kernels: Vec<_> = (0..self.lattice.strips()).map(|_| kernel()).collect();
        sweep(&self.lattice, self.fields(&[]), &mut kernels, Some(strips));
    }

    /// `H ← max(H, psi+)` with a split.
    pub fn history_sweep(&self, split: Split, history: &mut [Lane]) {
        let (moduli, model) = (self.moduli, FractureModel { split, ..self.model });
        let chunks = history.chunks_mut(self.lattice.strip_batches());
        let mut kernels: Vec<_> = chunks.map(|history| HistoryUpdate { cells: &[], moduli, model, history }).collect();
        sweep(&self.lattice, self.fields(&[]), &mut kernels, None);
    }

    /// Degraded stress and its forces with a split; `at_points` is the phase field and what is excess
    /// there.
    pub fn degraded_sweep(
        &self,
        split: Split,
        phase: &[f64],
        history: &mut [Lane],
        at_points: &mut [Vec<Lane>; 2],
        strips: &mut StripForces,
    ) {
        let model = FractureModel { split, ..self.model };
        let chunk = self.lattice.strip_batches();
        let [phases, excess] = at_points;
        let states = phases.chunks_mut(chunk).zip(excess.chunks_mut(chunk)).zip(history.chunks_mut(chunk));
        let mut kernels: Vec<_> = states
            .map(|((phase, excess), history)| DegradedStress {
                cells: &[],
                moduli: self.moduli,
                model,
                history,
                updates_history: false,
                phase,
                excess,
                drive: &mut [],
                energy: Lane::ZERO,
                history_work: Lane::ZERO,
                drive_work: Lane::ZERO,
            })
            .collect();
        sweep(&self.lattice, self.fields(phase), &mut kernels, Some(strips));
    }

    /// Room for [`Self::degraded_sweep`].
    pub fn at_points(&self) -> [Vec<Lane>; 2] {
        let zeros = || vec![Lane::ZERO; self.lattice.batches()];
        [zeros(), zeros()]
    }

    /// Total of the forces over the sum of their sizes: a body that is left to itself pulls nowhere.
    pub fn force_imbalance(&self, strips: &StripForces) -> f64 {
        let mut forces = [self.lattice.grid.zeros(), self.lattice.grid.zeros()];
        strips.assemble(self.lattice.grid.stride, &mut forces);
        let imbalance = |component: &Vec<f64>| {
            let (sum, size) = component.iter().fold((0.0, 0.0), |(s, a), f| (s + f, a + f.abs()));
            f64::abs(sum) / size
        };
        largest(forces.iter().map(imbalance))
    }

    /// The whole phase-field matrix.
    pub fn assemble(&self, matrix: &mut Stencil) {
        matrix.coefficients_mut().fill(0.0);
        let reaction = Reaction { history: &self.history, per_energy: self.model.reaction_per_energy() };
        add_form(matrix, &self.lattice, Integrand::Mass, &reaction);
        add_form(matrix, &self.lattice, Integrand::Diffusion, &Constant(self.model.diffusion()));
    }

    /// The phase-field matrix, and how far `1·K·1` is from the integral of the reaction, relative to it:
    /// gradients of a constant vanish.
    pub fn matrix(&self) -> (Stencil, f64) {
        let mut matrix = Stencil::zeros(self.lattice.grid, self.lattice.degree);
        self.assemble(&mut matrix);
        let (mut ones, mut image) = (self.lattice.grid.zeros(), self.lattice.grid.zeros());
        self.lattice.grid.indices().for_each(|at| ones[at] = 1.0);
        let sum = matrix.apply(&ones, &mut image);
        let mut expected = 0.0;
        let per_energy = self.model.reaction_per_energy();
        self.lattice.for_each_point(|batch, lane, _, weight| {
            expected += weight * (1.0 + per_energy * self.history[batch][lane]);
        });
        (matrix, (sum / expected - 1.0).abs())
    }

    /// The phase field of the seeded crack.
    ///
    /// # Errors
    /// If it does not converge.
    pub fn phase_field(&self) -> Result<PhaseField, BenchError> {
        let mut field = PhaseField::new(&self.lattice, self.model, &self.scene.solver);
        let solved = field.initialise(&self.lattice, &self.history);
        solved.map_err(|_| BenchError::other("the first phase field does not converge"))?;
        Ok(field)
    }

    /// The history after H grew by a hundredth of `Gc/l0` about the crack tip.
    pub fn grown_history(&self) -> Vec<Lane> {
        let tip = self.scene.bodies[0].cracks[0].points[1];
        let mut history = self.history.clone();
        self.lattice.for_each_point(|batch, lane, [x, y], _| {
            if (x - tip[0]).hypot(y - tip[1]) < 6.0 * SPAN {
                history[batch][lane] += 0.01 * self.model.toughness / self.model.length_scale;
            }
        });
        history
    }

    /// Span and position of every point, by direction.
    pub fn located(&self) -> Vec<[(usize, f64); 2]> {
        let mut located = Vec::with_capacity(self.points);
        self.lattice.for_each_point(|_, _, position, _| {
            located.push([0, 1].map(|d| (self.patch.spaces[d].find_span(position[d]).unwrap_or(0), position[d])));
        });
        located
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
