//! What can be seen of a body in the total frame at a whole step.
//!
//! Fragments are connected parts of it that are not cracked. A span is whole where the mean of c over its
//! points is at least 1/2, and hangs together with whole spans on its four sides. Parts smaller than the
//! square of 2 l0 are debris and do not count.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::TotalFrame;
use super::domain::ProbePlace;
use super::forced::LatticeForcing;
use crate::dynamics::energy::{FractureSample, ProbeSample, Sample};
use crate::dynamics::forcing::Forcing;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::stress_at;
use crate::material::hencky::{growth, hencky_strain, symmetric};
use crate::output::inspection::InvertedPoint;
use crate::phase_field::fracture::{CrackTip, LatticeFracture, crack_tip, most_broken};
use crate::scene::Kinematics;

/// Mean of c from which on a span is whole.
const WHOLE: f64 = 0.5;

/// Side of the least square that counts, in l0.
const LEAST: f64 = 2.0;

impl TotalFrame {
    /// Position (m) of the fastest control point, and its speed (m/s), infinite if it is no number.
    pub fn fastest_control_point(&self) -> ([f64; 2], f64) {
        let [vx, vy] = &self.velocity;
        let speed = |at: &usize| {
            let speed = vx[*at].hypot(vy[*at]);
            if speed.is_nan() { f64::INFINITY } else { speed }
        };
        let fastest = self.grid.indices().max_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap_or(0);
        (self.control_positions().map(|x| x[fastest]), speed(&fastest))
    }

    /// Coordinates (m) of the control points, copies included, as fields.
    pub fn control_positions(&self) -> VectorField {
        self.lattice.control_positions(&self.patch)
    }

    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at
    /// zero.
    pub fn sample(&self, dt: f64) -> Sample {
        let mut positions = self.control_positions();
        if self.kinematics == Kinematics::Finite {
            let moved = positions.iter_mut().zip(&self.displacement);
            moved.for_each(|(x, u)| x.iter_mut().zip(u).for_each(|(x, u)| *x += u));
        }
        let [x, y] = positions;
        let kinetic = self.mass.half_square(&self.velocity);
        let stagger = fault!("stagger-doubled", 0.25 => 0.5) * dt * dt * self.mass.half_square(&self.acceleration);
        let mut momenta = [self.grid.zeros(), self.grid.zeros()];
        for component in 0..2 {
            self.mass.multiply(&self.velocity[component], &mut momenta[component]);
        }
        let momentum = momenta.each_ref().map(|p| p.iter().sum::<f64>());
        let angular: f64 = self.grid.indices().map(|at| x[at] * momenta[1][at] - y[at] * momenta[0][at]).sum();
        let fracture = self.fracture.as_ref().map(|f| {
            let (energy, min_phase) = f.surface_energy(&self.lattice);
            FractureSample {
                energy,
                works: f.works(self.ledger.history_work, energy),
                crack_tip: self.crack_tip(f),
                min_phase,
                iterations: f.iterations,
            }
        });
        let edges = self.edges.iter().flat_map(|edges| edges.samples());
        let sample = Sample {
            time: self.time,
            kinetic,
            stagger,
            elastic: self.elastic_energy,
            fracture,
            external_work: self.ledger.external_work,
            conditions: self.reactions.samples(&self.constraints).into_iter().chain(edges).collect(),
            probes: self.probes.iter().map(|probe| self.sampled_probe(probe)).collect(),
            j_integrals: self.j_integrals(),
            fragments: self.fragments(),
            momentum,
            angular_momentum: angular,
            time_step: dt,
            ..Sample::default()
        };
        sample.for_thickness(fault!("thickness-forgotten", self.thickness => 1.0))
    }

    fn sampled_probe(&self, probe: &ProbePlace) -> ProbeSample {
        let [ux, uy] = self.displacement.each_ref().map(|u| probe.functions.interpolate(u));
        let [vx, vy] = self.velocity.each_ref().map(|v| probe.functions.interpolate(v).value);
        let (strain, _) = self.strain([ux.gradient, uy.gradient]);
        let fracture = self.fracture.as_ref();
        let fracture = fracture.map(|f| (&f.model, probe.on_patch.interpolate(f.field.control_values()).value));
        let [xx, yy, xy] = stress_at(&self.moduli, strain, fracture);
        ProbeSample::new(&probe.name, [ux.value, uy.value, vx, vy, xx, yy, xy])
    }

    pub(super) fn crack_tip(&self, fracture: &LatticeFracture) -> Option<CrackTip> {
        let phase = fracture.field.control_values();
        let gradient = |position| self.patch.evaluate(phase, position).unwrap_or_default().gradient;
        crack_tip(self.crack_start?, &fracture.broken_points(&self.lattice), gradient)
    }

    /// Remembers where a crack begins that was not there at the start.
    pub(crate) fn note_crack_start(&mut self) {
        if let (None, Some(fracture)) = (self.crack_start, &self.fracture) {
            self.crack_start = most_broken(&fracture.broken_points(&self.lattice));
        }
    }

    /// The point that is turned inside out furthest, if one is; small strains know none.
    pub(crate) fn inverted_point(&self) -> Option<InvertedPoint> {
        let (mut worst, mut point) = (None, 0);
        self.lattice.for_each_point(|batch, lane, position, _| {
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let [x, y] = self.displacement.each_ref().map(|u| functions.interpolate(u));
            let (_, determinant) = self.strain([x.gradient, y.gradient]);
            if determinant <= 0.0 {
                let inverted = InvertedPoint { point, position, determinant };
                worst = Some(worst.map_or(inverted, |worst: InvertedPoint| worst.worse(inverted)));
            }
            point += 1;
        });
        worst
    }

    /// Strain `[xx, yy, xy]` of a displacement gradient, and by how much the volume grew.
    pub fn strain(&self, gradient: [[f64; 2]; 2]) -> ([f64; 3], f64) {
        match self.kinematics {
            Kinematics::Small => (symmetric(gradient), 1.0),
            Kinematics::Finite => (hencky_strain(&gradient), growth(&gradient)),
        }
    }

    /// Stress `[xx, yy, xy]` (Pa) of the undamaged body under a displacement field at a position; NaN outside
    /// the patch. With finite kinematics it is Kirchhoff's.
    pub fn elastic_stress_at(&self, displacement: &[Vec<f64>; 2], position: [f64; 2]) -> [f64; 3] {
        let [x, y] = [0, 1].map(|c| self.patch.evaluate(&displacement[c], position));
        let (Some(x), Some(y)) = (x, y) else { return [f64::NAN; 3] };
        let (strain, _) = self.strain([x.gradient, y.gradient]);
        self.moduli.stress(strain.map(Lane::splat)).map(|s| s[0])
    }

    /// Mass, kg, and momentum, kg m/s, so many seconds ago with the present accelerations.
    pub(super) fn mass_and_momentum(&self, ago: f64) -> (f64, [f64; 2]) {
        let masses = &self.mass.row_sums;
        let momentum = |d: usize| {
            let moving = masses.iter().zip(&self.velocity[d]).zip(&self.acceleration[d]);
            self.thickness * moving.map(|((m, v), a)| m * (v - ago * a)).sum::<f64>()
        };
        (self.thickness * masses.iter().sum::<f64>(), [momentum(0), momentum(1)])
    }

    /// Elastic energy for the thickness of the scene, J.
    pub fn elastic_energy(&self) -> f64 {
        self.elastic_energy * self.thickness
    }

    /// External work so far, J.
    pub fn external_work(&self) -> f64 {
        self.ledger.external_work * self.thickness
    }

    /// Time since the start of the run, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Nodal forces (N/m) of the loads that vary in space, at the present time.
    pub fn forced_loads(&self) -> VectorField {
        let mut forces = [self.grid.zeros(), self.grid.zeros()];
        if let Some(forced) = &self.forced {
            forced.add_to(&mut forces);
        }
        forces
    }

    /// Right-hand side (m²) of the phase-field equation with the source and flux of a forcing at t = 0.
    pub fn phase_load(&self, forcing: Arc<dyn Forcing>) -> Vec<f64> {
        LatticeForcing::new(forcing, &self.patch, &self.lattice, &self.shape).phase_load(&self.lattice, 0.0)
    }

    /// Heap memory of mechanics and of the phase field, bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let fields = 8 * 8 * self.grid.len(); // displacement, velocity, acceleration, internal forces
        let mechanics = fields + self.lattice.bytes() + self.mass.bytes() + self.strip_forces.bytes();
        [mechanics, self.fracture.as_ref().map_or(0, LatticeFracture::bytes)]
    }

    /// Area of every fragment (m²), if they are to be counted.
    pub(super) fn fragments(&self) -> Option<Vec<f64>> {
        let fracture = self.fracture.as_ref().filter(|_| self.counts_fragments)?;
        let control_values = self.lattice.with_copies(fracture.field.control_values().to_vec());
        let number = |d: usize, first: usize| self.patch.spaces[d].spans().partition_point(|span| span.first < first);
        let mut spans: BTreeMap<[usize; 2], Content> = BTreeMap::new();
        for batch in 0..self.lattice.batches() {
            let (area, phase) = (self.lattice.weights_of(batch), self.lattice.value(batch, &control_values));
            for lane in (0..area.0.len()).filter(|&lane| area[lane] > 0.0) {
                let [column, row] = self.lattice.first_of(batch, lane);
                let content = spans.entry([number(0, column), number(1, row)]).or_default();
                content.area += area[lane];
                content.phase += area[lane] * phase[lane];
            }
        }
        let least = (LEAST * fracture.model.length_scale).powi(2);
        spans.retain(|_, content| content.phase >= fault!("cracks-count-as-whole", WHOLE => -1.0) * content.area);
        let mut areas = Vec::new();
        while let Some((seed, content)) = spans.pop_first() {
            let (mut area, mut next) = (content.area, vec![seed]);
            while let Some([column, row]) = next.pop() {
                let [left, down] = [column, row].map(|at| at.wrapping_sub(1)); // beyond the first there is none
                for neighbour in [[column + 1, row], [left, row], [column, row + 1], [column, down]] {
                    if let Some(content) = spans.remove(&neighbour) {
                        area += content.area;
                        next.push(neighbour);
                    }
                }
            }
            areas.extend(Some(area).filter(|area| *area >= least));
        }
        Some(areas)
    }
}

/// What is in a span: its area (m²), and c times that.
#[derive(Debug, Clone, Copy, Default)]
struct Content {
    area: f64,
    phase: f64,
}
