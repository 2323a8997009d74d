//! A short trial of a scene: what its steps take here.

use std::time::Instant;

use fisura::Scene;
use fisura::scene::Mesh;
use fisura::simulation::breakdown::Breakdown;
use fisura::simulation::{Simulation, square_pixels};
use fisura_verification::scene_run::{FRAME_PIXELS, peak_memory_mb};
use fisura_verification::watch;

/// Wall time of the steps of a trial, s; the step that passes it is the last.
const LONGEST: f64 = 1.0;
/// Steps that are not counted: the first brings memory into the caches, and what a step finds at rest is dear
/// or cheap.
const FIRST: usize = 2;

/// Steps that were taken on trial, and what they took.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    /// Steps that were timed.
    pub steps: usize,
    /// Their wall time, s.
    pub steps_s: f64,
    /// Wall time of a row of the history, s.
    pub sample_s: f64,
    /// Wall time of a picture, s.
    pub picture_s: f64,
    /// Its size, bytes: a run keeps all of them.
    pub picture_bytes: usize,
    /// Largest memory of the process, 10⁶ bytes, where the system tells.
    pub memory_mb: Option<f64>,
    /// Size of the state, bytes, which a checkpoint holds.
    pub state_bytes: usize,
}

impl Trial {
    /// Takes steps for about a second, or all there are; `None` of a scene that has less than one to time.
    ///
    /// # Errors
    /// A breakdown within those steps.
    pub(super) fn of(scene: &Scene, simulation: &mut Simulation) -> Result<Option<Self>, Breakdown> {
        let size = [0, 1].map(|d| scene.mesh.end()[d] - scene.mesh.origin()[d]);
        let start = Instant::now();
        let picture = (!scene.output.frames.is_empty()).then(|| simulation.picture(square_pixels(size, FRAME_PIXELS)));
        let picture_s = start.elapsed().as_secs_f64();
        let values = picture.map_or(0, |picture| picture.stress.len() + picture.phase.map_or(0, |phase| phase.len()));
        let start = Instant::now();
        std::hint::black_box(simulation.sample());
        let sample_s = start.elapsed().as_secs_f64();
        for _ in 0..FIRST.min(simulation.plan().steps().saturating_sub(1)) {
            simulation.step()?;
        }
        let (before, start) = (simulation.steps(), Instant::now());
        while !simulation.finished() && start.elapsed().as_secs_f64() < LONGEST && watch::check().is_ok() {
            simulation.step()?;
        }
        let (steps, steps_s) = (simulation.steps() - before, start.elapsed().as_secs_f64());
        let (picture_bytes, memory_mb) = (8 * values, peak_memory_mb());
        let state_bytes = simulation.checkpoint().map_or(0, |state| state.len());
        let trial = Self { steps, steps_s, sample_s, picture_s, picture_bytes, memory_mb, state_bytes };
        Ok((steps > 0).then_some(trial))
    }

    /// Wall time of a step, s.
    pub(super) fn step_s(&self) -> f64 {
        self.steps_s / self.steps as f64
    }
}

/// A scene with every second inner knot left out where spans are short, until it has at most `most` spans;
/// `None` of a patch with control points of its own, which cannot do without its knots.
pub(super) fn coarser(scene: &Scene, most: usize) -> Option<Scene> {
    let mut scene = scene.clone();
    scene.mesh.geometry.is_none().then_some(())?;
    while spans(&scene.mesh).iter().product::<usize>() > most {
        let degree = scene.mesh.degree;
        for (d, knots) in scene.mesh.knots.iter_mut().enumerate() {
            let (first, last) = (degree[d] + 1, knots.len() - degree[d] - 1);
            let inner = knots[first..last].iter().copied().skip(1).step_by(2).collect::<Vec<_>>();
            *knots = [&knots[..first], &inner, &knots[last..]].concat();
        }
    }
    Some(scene)
}

/// Number of non-empty spans per direction.
pub(super) fn spans(mesh: &Mesh) -> [usize; 2] {
    mesh.knots.each_ref().map(|knots| knots.windows(2).filter(|k| k[1] > k[0]).count())
}
