//! Fracture of one body in the total frame: history energy, phase field, and what is measured of them; the
//! seed of a crack in either frame, `H0 = B Gc/(4 l0) (1 − d/w)` at the distance d < w from it.

use std::collections::BTreeSet;

use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::{larger, smaller};
use crate::linear_algebra::lane::{LANES, Lane};
use crate::material::degradation::{BROKEN, FractureModel};
use crate::particles::lattice::Lattice;
use crate::phase_field::PhaseField;
use crate::phase_field::lag::LagWork;
use crate::phase_field::toughness::relative_toughness;
use crate::scene::{Body, Crack, CrackKind, Fracture, SolverSettings};
use crate::splines::patch::Patch;
use crate::transfer::finite::{Elastic, elastic_sweep, sweep_with};
use crate::transfer::kernels::{DegradedStress, HistoryUpdate, ScreenedStress, SurfaceEnergy};
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::{StripForces, sweep};

/// Ratio of the largest initial history energy to Gc/(4 l0) on a seeded crack (Borden et al. 2012).
pub(crate) const SEED_STRENGTH: f64 = 1000.0;

/// Distance of the places on a seed at which functions are looked at, of the shortest span; and value of one
/// that vanishes there.
const SEED_STEP: f64 = 0.05;
const VANISHING: f64 = 1e-9;
/// Distance on either side of a seed to which its functions are looked for, in spans: a little more than
/// half, so that a seed in the middle of a span has both neighbours. For p = 3 and 4 what their functions
/// reach there is below [`VANISHING`], and one span is enough.
const SEED_REACH: f64 = 0.501;

/// Difference of two distances from the start of a crack that counts as none, of the spacing of points.
const TIE: f64 = 1e-3;

/// History, or present driving energy, and phase field of a body.
#[derive(Debug, Clone)]
pub struct LatticeFracture {
    /// Constants of the fracture model.
    pub model: FractureModel,
    /// Driving energy H at the points, J/m³: the largest so far, or with a threshold the present one.
    pub history: Vec<Lane>,
    /// Phase field at the points.
    pub phase: Vec<Lane>,
    /// `s (H − psi+)` at the points with `s = g'/2`, J/m³.
    pub excess: Vec<Lane>,
    /// Work between solves, if there are steps without one.
    pub(crate) lag_work: Option<LagWork>,
    /// Phase field on the control points.
    pub field: PhaseField,
    /// Gc over its mean at the points, where it is random.
    pub relative: Option<Vec<Lane>>,
    /// Iterations of the last solve.
    pub iterations: usize,
    /// Cracks that grow as prescribed; if there are any, the strain drives nothing.
    pub driven: Vec<Crack>,
    /// Energy of the intact body (J/m), if its forces were summed since the last sweep of the degraded
    /// stress.
    pub intact_energy: Option<f64>,
}

/// Sums over the points, J per metre of thickness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressSums {
    /// Elastic energy of the material, degraded where it is cracked, J/m.
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
        patch: &Patch,
        lattice: &Lattice,
        body: &Body,
        model: FractureModel,
        fracture: Option<&Fracture>,
        settings: &SolverSettings,
    ) -> Result<Self, SolveFailure> {
        let relative = fracture.and_then(|fracture| relative_toughness(patch, lattice, body, fracture));
        let history = seeded_history(lattice, body, &model, relative.as_deref());
        let zeros = vec![Lane::ZERO; lattice.batches()];
        let mut field = PhaseField::with_toughness(lattice, model, relative.as_deref(), settings);
        if model.threshold().is_some() {
            field.break_at(&fault!("at1-seed-forgotten", functions_on_seeds(patch, body) => Vec::new()));
        }
        let convergence = field.initialise(lattice, &history)?;
        let iterations = convergence.iterations;
        let lag_work = field.skips_solves().then(|| LagWork::new(lattice.batches()));
        let (phase, excess) = (vec![Lane::splat(1.0); lattice.batches()], zeros);
        let driven = body.cracks.iter().filter(|crack| matches!(crack.kind, CrackKind::Driven(_))).cloned().collect();
        Ok(Self { model, history, phase, excess, lag_work, field, relative, iterations, driven, intact_energy: None })
    }

    /// Whether the model has a threshold, below which material is intact.
    pub(crate) fn has_threshold(&self) -> bool {
        self.model.threshold().is_some()
    }

    /// H from the present displacement, or from cracks that are driven, at a time, s; with a threshold also
    /// the forces of the intact body, to which those of the damage will be added.
    pub fn update_history(&mut self, body: Elastic, time: f64, u: &VectorField, forces: &mut StripForces) {
        let (model, Elastic { lattice, moduli, .. }) = (self.model, body);
        if !self.driven.is_empty() {
            let grown: Vec<Crack> = self.driven.iter().filter_map(|crack| crack.grown(time)).collect();
            let Self { history, relative, .. } = self;
            lattice.for_each_point(|batch, lane, position, _| {
                let relative = relative.as_ref().map_or(1.0, |relative| relative[batch][lane]);
                let seeded = relative * seed_energy(&model, &grown, position);
                history[batch][lane] = larger(history[batch][lane], seeded);
            });
            return;
        }
        let fields = Fields { displacement: [&u[0], &u[1]], phase: &[] };
        let (chunk, span) = (lattice.strip_batches(), lattice.points_per_span());
        let cells_of_strip = chunk / span;
        if let Some((awake, phase)) = self.field.awake_mut() {
            let level = model.screening_level(&moduli, awake.least_threshold());
            let mut reached = vec![false; lattice.cells()];
            let strips = reached.chunks_mut(cells_of_strip);
            let kernel =
                |reached| ScreenedStress { moduli, level, span, reached, most: Lane::ZERO, energy: Lane::ZERO };
            let mut kernels: Vec<_> = strips.map(kernel).collect();
            sweep_with(body, fields, &mut kernels, Some(forces));
            self.intact_energy = Some(kernels.iter().map(|k| k.energy.sum()).sum());
            let before = awake.computed.clone();
            awake.choose(lattice, &reached, phase);
            let left = before.iter().zip(&awake.computed).map(|(before, now)| *before && !now);
            let left = self.history.chunks_mut(span).zip(left).filter(|(_, left)| *left);
            left.for_each(|(drive, _)| drive.fill(Lane::ZERO)); // below the level, and not known
        }
        let mut cells = self.field.awake().map_or(&[][..], |awake| &awake.computed).chunks(cells_of_strip);
        let strips = self.history.chunks_mut(chunk);
        let kernel = |history| HistoryUpdate { cells: cells.next().unwrap_or_default(), moduli, model, history };
        let mut kernels: Vec<_> = strips.map(kernel).collect();
        sweep_with(body, fields, &mut kernels, None);
    }

    /// Begins the work between solves with zero.
    pub(crate) fn begin_work(&mut self, lattice: &Lattice) {
        if let Some(mut work) = self.lag_work.take() {
            (work.on_drive, work.surface_at_start) = (0.0, self.surface_energy(lattice).0);
            self.lag_work = Some(work);
        }
    }

    /// Whether H is needed for the c of the coming step; otherwise the sweep of the stress will update it.
    pub(crate) fn needs_history(&self) -> bool {
        self.field.is_due() || !self.driven.is_empty()
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

    /// Degraded stress at the points and its nodal forces; keeps c and `s (H − psi+)` for the history work of
    /// the next step.
    pub fn degraded_forces(&mut self, body: Elastic, u: &VectorField, forces: &mut StripForces) -> StressSums {
        let (model, Elastic { lattice, moduli, .. }) = (self.model, body);
        let fields = Fields { displacement: [&u[0], &u[1]], phase: self.field.control_values() };
        let chunk = lattice.strip_batches();
        let awake = self.field.awake();
        let swept = self.intact_energy.take();
        let sweep = || elastic_sweep(body, fields, forces);
        let intact = awake.map_or(0.0, |_| swept.unwrap_or_else(sweep));
        // excess is work where c changes: it has to be known before c does
        let knows_excess = model.driving_work().is_some();
        let visited = awake.map(|awake| if knows_excess { &awake.computed[..] } else { &awake.damaged });
        let mut cells = visited.unwrap_or_default().chunks(chunk / lattice.points_per_span());
        let updates_history = self.field.is_carried_on() && self.driven.is_empty();
        let mut drive = self.lag_work.iter_mut().flat_map(|work| work.drive.chunks_mut(chunk));
        let states = self.phase.chunks_mut(chunk).zip(self.excess.chunks_mut(chunk));
        let mut kernels: Vec<_> = states
            .zip(self.history.chunks_mut(chunk))
            .map(|((phase, excess), history)| DegradedStress {
                cells: cells.next().unwrap_or_default(),
                moduli,
                model,
                history,
                updates_history,
                phase,
                excess,
                drive: drive.next().unwrap_or_default(),
                energy: Lane::ZERO,
                history_work: Lane::ZERO,
                drive_work: Lane::ZERO,
            })
            .collect();
        sweep_with(body, fields, &mut kernels, Some(forces));
        let drive_work: f64 = kernels.iter().map(|k| k.drive_work.sum()).sum();
        let history_work: f64 = kernels.iter().map(|k| k.history_work.sum()).sum();
        let elastic_energy = intact + kernels.iter().map(|k| k.energy.sum()).sum::<f64>();
        let share = 1.0 - model.residual_stiffness;
        self.lag_work.iter_mut().for_each(|work| work.on_drive += share * drive_work);
        StressSums {
            elastic_energy,
            history_work: share * fault!("history-work-halved", history_work => 0.5 * history_work),
        }
    }

    /// What the phase field adds to the energy of the body, given the work of the history field and the
    /// surface energy, by the names of columns, J/m.
    pub(crate) fn works(&self, history_work: f64, surface_energy: f64) -> Vec<(&'static str, f64)> {
        let of_lag = |work: &LagWork| fault!("phase-lag-work-left-out", work.total(surface_energy) => 0.0);
        let residual = self.field.work_on_bounds().or(self.lag_work.as_ref().map(of_lag));
        let values = self.model.driving_work().map(|_| history_work).into_iter().chain(residual);
        self.model.columns_of_work(residual.is_some()).into_iter().zip(values).collect()
    }

    /// Surface energy per unit thickness (J/m) and smallest c at a point.
    pub fn surface_energy(&self, lattice: &Lattice) -> (f64, f64) {
        let model = self.model;
        let relative = self.relative.as_deref().unwrap_or_default();
        let mut strips = relative.chunks(lattice.strip_batches());
        let mut kernel = |_| SurfaceEnergy {
            model,
            relative: strips.next().unwrap_or_default(),
            energy: Lane::ZERO,
            least: Lane::splat(f64::INFINITY),
        };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(&mut kernel).collect();
        let fields = Fields { displacement: [&[], &[]], phase: self.field.control_values() };
        sweep(lattice, fields, &mut kernels, None);
        let energy = kernels.iter().map(|k| k.energy.sum()).sum();
        let least = kernels.iter().flat_map(|k| k.least.0).fold(f64::INFINITY, smaller);
        (energy, least)
    }

    /// Material points with c below [`BROKEN`].
    pub(crate) fn broken_points(&self, lattice: &Lattice) -> Vec<BrokenPoint> {
        let mut broken = Vec::new();
        for (batch, phases) in self.phase.iter().enumerate().filter(|(_, c)| c.0.iter().any(|c| *c < BROKEN)) {
            let area = lattice.weights_of(batch);
            for lane in (0..LANES).filter(|&lane| area[lane] > 0.0 && phases[lane] < BROKEN) {
                let position = lattice.position(batch, lane);
                broken.push(BrokenPoint { position, phase: phases[lane], spacing: area[lane].sqrt() });
            }
        }
        broken
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        let relative = self.relative.as_ref().map_or(0, Vec::len);
        let drive = self.lag_work.as_ref().map_or(0, |work| work.drive.len());
        let lanes = self.history.len() + self.phase.len() + self.excess.len() + drive + relative;
        lanes * size_of::<Lane>() + self.field.bytes()
    }
}

/// Half width (m) of the initial history field of a crack; a slit has none.
pub fn half_width(crack: &Crack, length_scale: f64) -> Option<f64> {
    match crack.kind {
        CrackKind::Seed(half_width) => Some(half_width.unwrap_or(0.5 * length_scale)),
        CrackKind::Driven(_) => Some(0.5 * length_scale),
        CrackKind::Slit => None,
    }
}

/// A material point with c below [`BROKEN`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct BrokenPoint {
    /// Position, m; that at t = 0 in the total frame.
    pub position: [f64; 2],
    /// Phase field c at the point.
    pub phase: f64,
    /// Distance to its neighbours, m.
    pub spacing: f64,
}

/// Where the crack of a body begins, m: the first point of its first initial crack; without one, the most
/// broken point of those that are broken first.
pub(crate) fn crack_start(body: &Body) -> Option<[f64; 2]> {
    let first = body.cracks.first()?;
    Some(fault!("tip-from-the-end-of-the-seed", first.points[0] => first.points[first.points.len() - 1]))
}

/// The most broken point, m.
pub(crate) fn most_broken(broken: &[BrokenPoint]) -> Option<[f64; 2]> {
    broken.iter().min_by(|a, b| a.phase.total_cmp(&b.phase)).map(|point| point.position)
}

/// The tip of a crack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackTip {
    /// Position of the tip, m; in the total frame that of its material at t = 0.
    pub place: [f64; 2],
    /// Its distance from the start of the crack, m.
    pub distance: f64,
}

/// The place at the largest distance from the start of a crack where c is [`BROKEN`], of two places the upper
/// one. Broken points are moved outwards to it by the gradient of c, at most by their spacing.
pub(crate) fn crack_tip(
    start: [f64; 2],
    broken: &[BrokenPoint],
    gradient: impl Fn([f64; 2]) -> [f64; 2],
) -> Option<CrackTip> {
    let distance = |p: [f64; 2]| (p[0] - start[0]).hypot(p[1] - start[1]);
    let foremost = broken.iter().max_by(|a, b| distance(a.position).total_cmp(&distance(b.position)))?;
    let near = distance(foremost.position) - foremost.spacing;
    let moved = |point: &BrokenPoint| {
        let (position, from_start) = (point.position, distance(point.position));
        if from_start == 0.0 {
            return position; // no direction leads outwards
        }
        let outwards = [0, 1].map(|d| (position[d] - start[d]) / from_start);
        let slope = gradient(position);
        let ahead = (BROKEN - point.phase) / (slope[0] * outwards[0] + slope[1] * outwards[1]);
        let ahead = if ahead >= 0.0 { ahead.min(point.spacing) } else { 0.0 };
        [0, 1].map(|d| position[d] + ahead * outwards[d])
    };
    let tips = || broken.iter().filter(|point| distance(point.position) >= near).map(moved);
    let tie = tips().map(distance).fold(0.0, larger) - TIE * foremost.spacing;
    let place = tips().filter(|tip| distance(*tip) >= tie).max_by(|a, b| a[1].total_cmp(&b[1]))?;
    Some(CrackTip { place, distance: distance(place) })
}

/// Initial history energy `H0(d) = B Gc/(4 l0) (1 − d/w)` within the half width w of a crack, else zero.
pub(crate) fn seed_energy(model: &FractureModel, cracks: &[Crack], position: [f64; 2]) -> f64 {
    let strength = SEED_STRENGTH * model.toughness / (4.0 * model.length_scale);
    let of_crack = |crack: &Crack| {
        let half_width = half_width(crack, model.length_scale)?;
        let reach = fault!("seed-twice-as-wide", half_width => 2.0 * half_width);
        Some(strength * (1.0 - crack.distance(position) / reach))
    };
    cracks.iter().filter_map(of_crack).fold(0.0, larger)
}

/// Control points whose functions do not vanish in the one to three spans next to the seeds of a body. A
/// displacement that is smooth across a knot opens freely over as many; over fewer it stays bridged.
fn functions_on_seeds(patch: &Patch, body: &Body) -> Vec<usize> {
    let step = SEED_STEP * patch.shortest_span();
    let mut found = BTreeSet::new();
    for [place, normal] in body.cracks.iter().filter(|crack| !crack.is_slit()).flat_map(|crack| crack.places(step)) {
        let reach = fault!("seed-on-a-line", SEED_REACH => 0.0) * patch.span_across(place, normal).unwrap_or(0.0);
        for side in [-reach, 0.0, reach] {
            let beside = [0, 1].map(|d| place[d] + side * normal[d]);
            let functions = patch.functions_at(beside).into_iter().flat_map(|functions| functions.values);
            found.extend(functions.filter(|(_, value)| *value > VANISHING).map(|(at, _)| at));
        }
    }
    found.into_iter().collect()
}

/// H0 at the points, with the Gc that is there.
fn seeded_history(lattice: &Lattice, body: &Body, model: &FractureModel, relative: Option<&[Lane]>) -> Vec<Lane> {
    let mut history = vec![Lane::ZERO; lattice.batches()];
    let cracks: Vec<Crack> = body.cracks.iter().filter_map(|crack| crack.grown(0.0)).collect();
    if !cracks.is_empty() && model.threshold().is_none() {
        lattice.for_each_point(|batch, lane, position, _| {
            let relative = relative.map_or(1.0, |relative| relative[batch][lane]);
            history[batch][lane] = relative * seed_energy(model, &cracks, position);
        });
    }
    history
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tip_is_the_place_furthest_from_the_start() {
        let broken = |position| BrokenPoint { position, phase: 0.03, spacing: 0.1 };
        let slope = |_| [0.0, 1.0];
        let tip = |broken: &[BrokenPoint]| crack_tip([1.0, 1.0], broken, slope).map(|tip| tip.place);
        assert_eq!(tip(&[]), None);
        assert_eq!(tip(&[broken([1.0, 1.0])]), Some([1.0, 1.0]), "the start itself");
        let moved = tip(&[broken([1.0, 1.5]), broken([1.0, 1.0])]).unwrap();
        approx::assert_relative_eq!(moved[1], 1.52, epsilon = 1e-12);
        assert_eq!(tip(&[broken([3.0, 1.0]), broken([1.0, -2.0])]), Some([1.0, -2.0]), "no further where c falls");
        let level = |_| [0.0; 2];
        let branches = [broken([2.0, 2.0]), broken([2.0, 0.0])];
        let upper = crack_tip([1.0, 1.0], &branches, level).unwrap().place;
        approx::assert_relative_eq!(upper[0], upper[1]); // moved by the spacing, since c does not rise
        approx::assert_relative_eq!(upper[1], 2.0 + 0.1 / 2.0_f64.sqrt(), epsilon = 1e-12);
    }
}
