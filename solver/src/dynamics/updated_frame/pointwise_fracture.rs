//! Fracture of a body in the updated frame: history energy, phase field and degraded stress at moving points.

use rayon::prelude::*;

use super::assembly::assemble;
use super::fictitious::FictitiousMaterial;
use super::transfer::{contract, gather, walks};
use super::windows::cut;
use crate::checkpoint::{Archive, StateError};
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::smaller;
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, dispatch, each};
use crate::material::degradation::FractureModel;
use crate::material::elasticity::ElasticModuli;
use crate::material::split;
use crate::particles::points::{Cell, Cells, FracturePoint, Point};
use crate::phase_field::PhaseField;
use crate::phase_field::fracture::seed_energy;
use crate::scene::{Body, SolverSettings};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_FUNCTIONS;

/// History and phase field of a body.
#[derive(Debug, Clone)]
pub struct PointwiseFracture {
    /// Constants of the fracture model.
    pub model: FractureModel,
    /// History energy, phase field, … of each point, in the order of the points.
    pub points: Vec<FracturePoint>,
    /// Phase field on the control points.
    pub field: PhaseField,
    fictitious: FictitiousMaterial,
    /// Iterations of the last solve.
    pub iterations: usize,
    /// Surface energy of the crack per unit thickness, J/m.
    pub surface_energy: f64,
    /// Smallest c at a point.
    pub least_phase: f64,
}

/// Sums over the points at the new whole step, per unit thickness.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PointSums {
    /// Elastic energy, J/m.
    pub elastic_energy: f64,
    /// Work of the new stress over the step, `Σ V sigma(n+1) : de`, J/m.
    pub stress_work: f64,
    /// Work of the history field, J/m.
    pub history_work: f64,
    /// Energy the phase field gained as points moved through it, J/m.
    pub gained_in_motion: f64,
    surface_energy: f64,
    least_phase: f64,
}

impl PointwiseFracture {
    /// Seeds the cracks of `body` at its points; the phase field is not solved for yet.
    pub(crate) fn new(
        patch: &Patch,
        body: &Body,
        model: FractureModel,
        settings: &SolverSettings,
        points: &[Point],
    ) -> Self {
        let history = |p: &Point| seed_energy(&model, &body.cracks, p.position);
        let points = points.iter().map(|p| FracturePoint { history: history(p), phase: 1.0, ..Default::default() });
        let degree = [0, 1].map(|d| patch.spaces[d].degree());
        Self {
            points: points.collect(),
            field: PhaseField::without_lattice(patch.control_grid(), degree, model, settings),
            fictitious: FictitiousMaterial::new(patch, model.diffusion()),
            model,
            iterations: 0,
            surface_energy: 0.0,
            least_phase: 1.0,
        }
    }

    /// Goes over to another part of the patch, whose first control column and row lie `shift` columns and
    /// rows further.
    pub(crate) fn relocate(&mut self, patch: &Patch, shift: [isize; 2]) {
        self.field.relocate(patch.control_grid(), shift);
        self.fictitious = FictitiousMaterial::new(patch, self.model.diffusion());
    }

    /// `H ← max(H, psi+)` (E 10).
    pub(crate) fn update_history(&mut self, moduli: &ElasticModuli, cells: &Cells, points: &[Point]) {
        let model = self.model;
        let strips = cut(&mut self.points, cells.strips.iter().map(|s| s.points.clone()));
        strips.into_par_iter().zip(&cells.strips).for_each(|(fracture, strip)| {
            dispatch(UpdateHistory { moduli, model, points: &points[strip.points.clone()], fracture });
        });
    }

    /// Assembles and solves the phase-field system at the present positions.
    ///
    /// # Errors
    /// If there is no solution to the tolerance.
    pub(crate) fn solve(&mut self, patch: &Patch, cells: &Cells, points: &[Point]) -> Result<(), SolveFailure> {
        assemble(self.field.system_mut(), patch, cells, points, &self.points, &self.model, &self.fictitious);
        let first = self.field.counts.solves == 0;
        let result = if first { self.field.initialise_system() } else { self.field.solve_system() };
        self.iterations = result?.iterations;
        Ok(())
    }

    /// Phase field and degraded stress at the points (E 6), and what is summed over them.
    pub(crate) fn update_stress(
        &mut self,
        patch: &Patch,
        moduli: &ElasticModuli,
        cells: &Cells,
        points: &mut [Point],
    ) -> PointSums {
        let (model, phase) = (self.model, self.field.control_values());
        let ranges = || cells.strips.iter().map(|s| s.points.clone());
        let strips = cut(points, ranges()).into_par_iter().zip(cut(&mut self.points, ranges()));
        let sums: Vec<PointSums> = strips
            .zip(&cells.strips)
            .map(|((points, fracture), strip)| {
                let cells = &cells.cells[strip.cells.clone()];
                let grid = patch.control_grid();
                dispatch(UpdateStress { patch, grid, moduli, model, phase, cells, points, fracture })
            })
            .collect();
        let total = sums.iter().fold(PointSums { least_phase: f64::INFINITY, ..Default::default() }, PointSums::add);
        (self.surface_energy, self.least_phase) = (total.surface_energy, total.least_phase);
        PointSums { history_work: (1.0 - model.residual_stiffness) * total.history_work, ..total }
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { model: _, points, field, fictitious: _, iterations, surface_energy, least_phase } = self;
        archive.list(points)?;
        field.exchange(archive)?;
        archive.value(iterations)?;
        archive.value(surface_energy)?;
        archive.value(least_phase)
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.points.len() * size_of::<FracturePoint>() + self.field.bytes()
    }
}

impl PointSums {
    fn add(self, other: &Self) -> Self {
        Self {
            elastic_energy: self.elastic_energy + other.elastic_energy,
            stress_work: self.stress_work + other.stress_work,
            history_work: self.history_work + other.history_work,
            gained_in_motion: self.gained_in_motion + other.gained_in_motion,
            surface_energy: self.surface_energy + other.surface_energy,
            least_phase: smaller(self.least_phase, other.least_phase),
        }
    }
}

struct UpdateHistory<'a> {
    moduli: &'a ElasticModuli,
    model: FractureModel,
    points: &'a [Point],
    fracture: &'a mut [FracturePoint],
}

impl Vectorised for UpdateHistory<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for (points, fracture) in self.points.chunks(LANES).zip(self.fracture.chunks_mut(LANES)) {
            let strain = each!(i in [0, 1, 2] => gather(points, |p| p.strain[i]));
            let energy = split::driving_energy(self.moduli, self.model.split, strain);
            for (lane, point) in fracture.iter_mut().enumerate() {
                let grows = fault!("history-forgets", energy[lane] > point.history => true);
                point.history = if grows { energy[lane] } else { point.history };
            }
        }
    }
}

struct UpdateStress<'a> {
    patch: &'a Patch,
    grid: ControlGrid,
    moduli: &'a ElasticModuli,
    model: FractureModel,
    phase: &'a [f64],
    cells: &'a [Cell],
    points: &'a mut [Point],
    fracture: &'a mut [FracturePoint],
}

walks!([] UpdateStress<'_> => PointSums);

impl UpdateStress<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) -> PointSums {
        let mut sums = PointSums { least_phase: f64::INFINITY, ..Default::default() };
        let offset = self.cells.first().map_or(0, |cell| cell.points.start);
        let mut phases = [0.0; LANES];
        for cell in self.cells {
            let mut local = [0.0; MAX_FUNCTIONS];
            for l in 0..ky {
                let base = self.grid.index(cell.first[0], cell.first[1] + l);
                local[l * kx..(l + 1) * kx].copy_from_slice(&self.phase[base..base + kx]);
            }
            let all = cell.points.start - offset..cell.points.end - offset;
            for first in all.clone().step_by(LANES) {
                let some = first..(first + LANES).min(all.end);
                for at in some.clone() {
                    let (phase, slope) = self.interpolate(cell, at, &local, kx, ky, &mut sums);
                    let (point, cracked) = (&self.points[at], &mut self.fracture[at]);
                    let gained = each!(d in [0, 1] => 0.5 * (cracked.slope[d] + slope[d]) * cracked.moved[d]);
                    sums.gained_in_motion += point.volume * (gained[0] + gained[1]);
                    (phases[at - first], cracked.slope) = (phase, slope);
                }
                self.degrade(some, Lane(phases), &mut sums);
            }
        }
        sums
    }

    /// Phase field at a point, and the slope of its energy
    /// `(1 − k) c² H + Gc [(1 − c)²/(4 l0) + l0 |grad c|²]` with H and the control values kept; adds the
    /// surface energy (E 3).
    #[inline(always)]
    fn interpolate(
        &self,
        cell: &Cell,
        at: usize,
        local: &[f64; MAX_FUNCTIONS],
        kx: usize,
        ky: usize,
        sums: &mut PointSums,
    ) -> (f64, [f64; 2]) {
        let (point, history) = (&self.points[at], self.fracture[at].history);
        let [x, y] = &self.patch.spaces;
        let sx = x.shape_functions(cell.span[0], point.position[0]);
        let sy = y.shape_functions(cell.span[1], point.position[1]);
        let (xx, yy) = (
            x.second_derivatives(cell.span[0], point.position[0]),
            y.second_derivatives(cell.span[1], point.position[1]),
        );
        let ([mut c, mut along_x, mut along_y], mut second) = ([0.0; 3], [0.0; 3]);
        for l in 0..ky {
            let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
            for k in 0..kx {
                value += sx.value[k] * local[l * kx + k];
                slope += sx.derivative[k] * local[l * kx + k];
                curvature += xx[k] * local[l * kx + k];
            }
            c += sy.value[l] * value;
            along_x += sy.value[l] * slope;
            along_y += sy.derivative[l] * value;
            second[0] += sy.value[l] * curvature;
            second[1] += sy.derivative[l] * slope;
            second[2] += yy[l] * value;
        }
        let FractureModel { toughness, length_scale, residual_stiffness, .. } = self.model;
        let gradient_square = along_x * along_x + along_y * along_y;
        let of_gradient = fault!("moving-gradient-halved", length_scale => 0.5 * length_scale);
        let density = (1.0 - c) * (1.0 - c) / (4.0 * length_scale) + of_gradient * gradient_square;
        sums.surface_energy += point.volume * toughness * density;
        sums.least_phase = smaller(sums.least_phase, c);
        let by_value = 2.0 * (1.0 - residual_stiffness) * c * history - toughness * (1.0 - c) / (2.0 * length_scale);
        let by_gradient = 2.0 * toughness * length_scale;
        let slope = [
            by_value * along_x + by_gradient * (second[0] * along_x + second[1] * along_y),
            by_value * along_y + by_gradient * (second[1] * along_x + second[2] * along_y),
        ];
        (c, slope)
    }

    /// Degraded stress of at most eight points, their energy, and the works of the step.
    #[inline(always)]
    fn degrade(&mut self, some: std::ops::Range<usize>, phase: Lane, sums: &mut PointSums) {
        let (points, fracture) = (&mut self.points[some.clone()], &mut self.fracture[some]);
        let strain = each!(i in [0, 1, 2] => gather(points, |p| p.strain[i]));
        let state = split::split(self.moduli, self.model.split, strain);
        let (energy, stress) = state.degraded::<false>(self.model.degradation(phase));
        for (lane, (point, cracked)) in points.iter_mut().zip(fracture).enumerate() {
            point.stress = each!(i in [0, 1, 2] => stress[i][lane]);
            sums.elastic_energy += point.volume * energy[lane];
            sums.stress_work += point.volume * contract(point.stress, cracked.strain_increment);
            let excess = phase[lane] * (cracked.history - state.energy_plus[lane]);
            let widening = cracked.phase - phase[lane];
            sums.history_work += point.volume * (excess + cracked.excess) * widening;
            (cracked.excess, cracked.phase) = (excess, phase[lane]);
        }
    }
}
