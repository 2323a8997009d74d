//! Fracture of one body in the total frame: history energy, phase field, and what is measured of them; the
//! seed of a crack in either frame, `H0 = B Gc/(4 l0) (1 − d/w)` at the distance d < w from it.

use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::{BROKEN, FractureModel};
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::Lattice;
use crate::phase_field::PhaseField;
use crate::scene::shape::distance_to_segment;
use crate::scene::{Body, Boundary, Crack, Kinematics, Scene, Side, SolverSettings};
use crate::transfer::finite::sweep_with;
use crate::transfer::kernels::{DegradedStress, HistoryUpdate, SurfaceEnergy};
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::{StripForces, sweep};

/// Ratio of the largest initial history energy to Gc/(4 l0) on a seeded crack (Borden et al. 2012).
pub(crate) const SEED_STRENGTH: f64 = 1000.0;

/// History and phase field of a body.
#[derive(Debug, Clone)]
pub struct LatticeFracture {
    /// Constants.
    pub model: FractureModel,
    /// History energy H at the points, J/m³.
    pub history: Vec<Lane>,
    /// Phase field at the points.
    pub phase: Vec<Lane>,
    /// `c (H − psi+)` at the points, J/m³.
    pub excess: Vec<Lane>,
    /// Phase field on the control points.
    pub field: PhaseField,
    /// Iterations of the last solve.
    pub iterations: usize,
}

/// Sums over the points, J per metre of thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressSums {
    /// Elastic energy.
    pub elastic_energy: f64,
    /// Work of the history field since the last sweep.
    pub history_work: f64,
}

impl LatticeFracture {
    /// Seeds the cracks of `body` and solves for the initial phase field.
    ///
    /// # Errors
    /// If the initial solve does not converge.
    pub fn new(
        lattice: &Lattice,
        body: &Body,
        model: FractureModel,
        settings: &SolverSettings,
    ) -> Result<Self, SolveFailure> {
        let history = seeded_history(lattice, body, &model);
        let zeros = vec![Lane::ZERO; lattice.batches()];
        let mut field = PhaseField::new(lattice, model, settings);
        let convergence = field.initialise(lattice, &history)?;
        Ok(Self { model, history, phase: zeros.clone(), excess: zeros, field, iterations: convergence.iterations })
    }

    /// H from the present displacement.
    pub fn update_history(
        &mut self,
        lattice: &Lattice,
        moduli: ElasticModuli,
        kinematics: Kinematics,
        displacement: &[Vec<f64>; 2],
    ) {
        let model = self.model;
        let strips = self.history.chunks_mut(lattice.strip_batches());
        let mut kernels: Vec<_> = strips.map(|history| HistoryUpdate { moduli, model, history }).collect();
        let fields = Fields { displacement: [&displacement[0], &displacement[1]], phase: &[] };
        sweep_with(kinematics, lattice, fields, &mut kernels, None);
    }

    /// c at the end of a step, from the present H or carried on.
    ///
    /// # Errors
    /// If the solve does not converge.
    pub fn advance_phase_field(&mut self, lattice: &Lattice) -> Result<(), SolveFailure> {
        if let Some(convergence) = self.field.advance(lattice, &self.history)? {
            self.iterations = convergence.iterations;
        }
        Ok(())
    }

    /// c from the present H.
    ///
    /// # Errors
    /// If the solve does not converge.
    pub fn solve_phase_field(&mut self, lattice: &Lattice) -> Result<(), SolveFailure> {
        self.iterations = self.field.solve(lattice, &self.history)?.iterations;
        Ok(())
    }

    /// Degraded stress at the points and its nodal forces; keeps c and `c (H − psi+)` for the history work of
    /// the next step.
    pub fn degraded_forces(
        &mut self,
        lattice: &Lattice,
        moduli: ElasticModuli,
        kinematics: Kinematics,
        displacement: [&[f64]; 2],
        forces: &mut StripForces,
    ) -> StressSums {
        let model = self.model;
        let chunk = lattice.strip_batches();
        let states = self.phase.chunks_mut(chunk).zip(self.excess.chunks_mut(chunk));
        let mut kernels: Vec<_> = states
            .zip(self.history.chunks(chunk))
            .map(|((phase, excess), history)| DegradedStress {
                moduli,
                model,
                history,
                phase,
                excess,
                energy: Lane::ZERO,
                history_work: Lane::ZERO,
            })
            .collect();
        let fields = Fields { displacement, phase: self.field.control_values() };
        sweep_with(kinematics, lattice, fields, &mut kernels, Some(forces));
        let history_work: f64 = kernels.iter().map(|k| k.history_work.sum()).sum();
        StressSums {
            elastic_energy: kernels.iter().map(|k| k.energy.sum()).sum(),
            history_work: (1.0 - model.residual_stiffness)
                * fault!("history-work-halved", history_work => 0.5 * history_work),
        }
    }

    /// Surface energy per unit thickness (J/m) and smallest c at a point.
    pub fn surface_energy(&self, lattice: &Lattice) -> (f64, f64) {
        let model = self.model;
        let start = || SurfaceEnergy { model, energy: Lane::ZERO, least: Lane::splat(f64::INFINITY) };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(|_| start()).collect();
        let fields = Fields { displacement: [&[], &[]], phase: self.field.control_values() };
        sweep(lattice, fields, &mut kernels, None);
        let energy = kernels.iter().map(|k| k.energy.sum()).sum();
        let least = kernels.iter().flat_map(|k| k.least.0).fold(f64::INFINITY, smaller);
        (energy, least)
    }

    /// Point of largest x with c below [`BROKEN`] at heights of at least `lowest` (m), by linear
    /// interpolation between neighbouring points along a row.
    pub fn crack_tip(&self, lattice: &Lattice, lowest: f64) -> Option<[f64; 2]> {
        let mut tip: Option<[f64; 2]> = None;
        for row in 0..lattice.rows.len() {
            for b in 0..lattice.points[1] {
                let Some(broken) = self.rightmost_broken(lattice, row, b, lowest) else { continue };
                if tip.is_none_or(|tip| fault!("tip-of-the-shortest-row", broken[0] > tip[0] => broken[0] < tip[0])) {
                    tip = Some(broken);
                }
            }
        }
        tip
    }

    fn rightmost_broken(&self, lattice: &Lattice, row: usize, b: usize, lowest: f64) -> Option<[f64; 2]> {
        let mut next: Option<([f64; 2], f64)> = None;
        let mut tip: Option<[f64; 2]> = None;
        for (tile_index, tile) in lattice.tiles.iter().enumerate().rev() {
            for lane in (0..tile.count).rev() {
                for a in (0..lattice.points[0]).rev() {
                    let batch = lattice.batch(row, tile_index, b, a);
                    let (position, c) = (lattice.position(batch, lane), self.phase[batch][lane]);
                    if lattice.weight(row, tile_index, b, a)[lane] == 0.0 || position[1] < lowest {
                        next = None; // nothing to interpolate to
                        continue;
                    }
                    if c < BROKEN {
                        let beyond = next.filter(|(_, other)| *other >= BROKEN).map(|(place, other)| {
                            let t = (BROKEN - c) / (other - c);
                            [0, 1].map(|d| position[d] + t * (place[d] - position[d]))
                        });
                        let here = beyond.filter(|place| place[0] > position[0]).unwrap_or(position);
                        if tip.is_none_or(|tip| here[0] > tip[0]) {
                            tip = Some(here);
                        }
                        if lattice.mapping.is_none() {
                            return tip; // positions grow along the row
                        }
                    }
                    next = Some((position, c));
                }
            }
        }
        tip
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let lanes = self.history.len() + self.phase.len() + self.excess.len();
        lanes * size_of::<Lane>() + self.field.bytes()
    }
}

/// Half width (m) of the initial history field of a crack.
pub fn half_width(crack: &Crack, length_scale: f64) -> f64 {
    crack.half_width.unwrap_or(0.5 * length_scale)
}

/// Height from which the crack tip is looked for: the middle of the body, or its foot if the body is the
/// upper half of a symmetric one: it stands on the bottom side, a roller holds that side, and a crack lies
/// along it.
pub(crate) fn lowest_tip(scene: &Scene, body: &Body) -> f64 {
    let (low, high) = scene.mesh.extent(&body.shape);
    let at_foot = |y: f64| (y - low[1]).abs() <= 1e-9 * (high[1] - low[1]);
    let roller = |b: &Boundary| b.side == Side::Bottom && b.fix == [false, true] && b.velocity[1] == 0.0;
    let half = at_foot(scene.mesh.origin()[1])
        && scene.boundaries.iter().any(roller)
        && body.cracks.iter().any(|crack| at_foot(crack.from[1]) && at_foot(crack.to[1]));
    if half { low[1] } else { 0.5 * (low[1] + high[1]) }
}

/// Initial history energy `H0(d) = B Gc/(4 l0) (1 − d/w)` within the half width w of a crack, else zero.
pub(crate) fn seed_energy(model: &FractureModel, body: &Body, position: [f64; 2]) -> f64 {
    let strength = SEED_STRENGTH * model.toughness / (4.0 * model.length_scale);
    let of_crack = |crack: &Crack| {
        let half_width = half_width(crack, model.length_scale);
        let reach = fault!("seed-twice-as-wide", half_width => 2.0 * half_width);
        strength * (1.0 - distance_to_segment(position, crack.from, crack.to) / reach)
    };
    body.cracks.iter().map(of_crack).fold(0.0, larger)
}

fn seeded_history(lattice: &Lattice, body: &Body, model: &FractureModel) -> Vec<Lane> {
    let mut history = vec![Lane::ZERO; lattice.batches()];
    if !body.cracks.is_empty() {
        lattice.for_each_point(|batch, lane, position, _| history[batch][lane] = seed_energy(model, body, position));
    }
    history
}
