//! Gauss quadrature on the spans of the updated frame: order p + 1 with points that cross spans.
//!
//! Points that integrate do so with an error that does not fall with the mesh, because the shape functions
//! have kinks at knots. Here points carry mass, velocity and their reference position as a label, and spans
//! integrate. With the displacement `d(x)` of the material that is at x now, one step is
//!
//! ```text
//! A D = Σ m_p N (x_p − X_p)                fit of the displacement:  A_ij = Σ m_p N_i N_j + ε ρ h² Jᵀ J
//! F = (I − ∇d)⁻¹                           at the Gauss points of span ∩ body, no product of increments
//! M a = − Σ w sigma ∇N                     M_ij = Σ w rho N_i N_j + γ ρ h² Jᵀ J
//! v_p ← v_p + β (v(x_p) − v_p)             where A U = Σ m_p N v_p; once in a span's time of a wave
//! v_p ← v_p + dt (a(x_p) − s + b_p)        s: what makes Σ m_p a_p the sum of the forces; b_p: body force
//! x_p ← x_p + dt v_p
//! ```
//!
//! J are the jumps of the p-th derivative at knots ([`penalty`]), span ∩ body follows the motion of the
//! boundary ([`boundary`], [`rule`]). The fit reproduces polynomials of degree p whatever the weights of the
//! points, so points need not be a quadrature rule of the spans they are in; only forces and inertia must be
//! integrated well. Without the relaxation by β what the grid does not see of the velocities would grow.
//!
//! A control point of a side that is held keeps a displacement of zero. Without one held, s and the mean
//! of the relaxation are taken out per component, and of a free body the mean rotation too, so that momentum
//! and angular momentum are kept to round-off ([`rigid`]).
//!
//! Boundaries that meet push each other apart by a potential of the gap, with friction ([`contact`],
//! [`crate::contact::gap_potential`]), which adds to the forces before `M a` is solved.
//!
//! # The energy ledger
//!
//! Points are a leapfrog of their own: `Δ(kinetic − stagger) = dt/2 Σ m (a(n) + a(n+1)) · v(n+1/2)`,
//! exactly. The share of body forces is external work. What the relaxation takes is measured where it
//! happens ([`TransferLosses::relaxation`](super::losses::TransferLosses)). Closure is what the work of
//! the stresses on the motion of the points differs from the elastic energy at the Gauss points: an error
//! of fit and quadrature that falls with the mesh, not round-off.
//!
//! The idea of a fit of what points carry and a quadrature by spans is that of Wobbes, Tielen, Möller & Vuik
//! (2021, *Comparison and unification of material-point and optimal transportation meshfree methods*,
//! Computational Particle Mechanics 8) and of Sulsky & Gong (2016, *Improving the material-point method*,
//! Innovative Numerical Approaches for Multi-Field and Multi-Scale Problems). F from the gradient of a map
//! back to the reference positions is known on fixed grids from Kamrin, Rycroft & Nave (2012, *Reference map
//! technique for finite-strain elasticity and fluid-solid interaction*, J. Mech. Phys. Solids 60).

pub(crate) mod balance;
pub(crate) mod boundary;
pub(crate) mod contact;
pub(crate) mod fit;
pub(crate) mod map;
pub(crate) mod penalty;
pub(crate) mod rigid;
pub(crate) mod rule;
pub(crate) mod state;
pub(crate) mod step;
pub(crate) mod stiffness;
pub(crate) mod system;

use balance::SpanBalance;
use boundary::{MovingBoundary, edges};
use fit::PointFit;
use map::{InverseMap, displacement_gradient};
use rigid::{Resultant, RigidPart};
use rule::GaussPoints;
use system::{Accuracy, MassSystem};

use super::grid::NodalFields;
use crate::dynamics::failure::Failure;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::hencky_strain;
use crate::particles::points::{Cells, Point};
use crate::scene::{Mesh, Shape};
use crate::splines::patch::Patch;

/// Weight γ of the penalty in the inertia. Measured in one and two dimensions: a tenth lets the errors of
/// cut spans grow with p = 3, thrice as much costs accuracy on coarse meshes.
const INERTIA_PENALTY: f64 = 0.01;
/// Weight ε of the penalty in the fit, for quadratics and for higher degrees.
const FIT_PENALTY: [f64; 2] = [0.005, 0.0005];
/// Errors of the solves for displacement, velocity and acceleration, relative to their solutions. They bound
/// the error of a smooth motion from below: with p = 3 the axis-aligned displacement stays at 4e-6 from 64
/// spans per direction on, and goes on at order 4 with a tenth of them, which takes 5 to 11 % more time.
const TOLERANCES: [f64; 3] = [1e-7, 1e-5, 1e-5];

/// Way of a point after which the critical step is taken anew, spans: the penalty keeps it whatever the
/// boundary cuts, so it changes with the strain alone, and a point on its way vibrates by less than a span.
pub(crate) const WAY_BETWEEN_STEPS: f64 = 4.0;

/// What a body has besides its points if spans integrate.
#[derive(Debug, Clone)]
pub(crate) struct SpanQuadrature {
    gauss: GaussPoints,
    boundary: MovingBoundary,
    fit: MassSystem,
    inertia: MassSystem,
    /// Control values of the displacement less its mean, m, and those of the two steps before.
    displacement: [VectorField; 3],
    /// Control values of the acceleration, m/s², and those of the two steps before.
    acceleration: [VectorField; 3],
    /// Control values of the velocity less its mean, m/s, when it was last fitted.
    velocity: VectorField,
    /// Right-hand sides.
    load: VectorField,
    force: VectorField,
    /// Acceleration of each point by the stresses, m/s².
    point_acceleration: Vec<[f64; 2]>,
    /// Control points at which a component is held.
    held: [Vec<usize>; 2],
    /// Springs of the boundary, if it may meet others, and the sum of forces there, N/m.
    springs: Option<BoundarySprings>,
    pushed: Resultant,
    /// Steps since the velocities were last relaxed.
    since_relaxation: usize,
    moduli: ElasticModuli,
    density: f64,
}

/// Springs of a boundary that may meet others.
#[derive(Debug, Clone, Copy)]
struct BoundarySprings {
    /// κ, Pa/m.
    stiffness: f64,
    /// Whether contact has friction.
    friction: bool,
}

/// Points of a body on its part of the patch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnPatch<'a> {
    /// Part of the patch.
    pub patch: &'a Patch,
    /// Order of the points.
    pub cells: &'a Cells,
    /// The points.
    pub points: &'a [Point],
}

impl SpanQuadrature {
    /// A body of `shape` at rest; `None` of a shape whose boundary has no rule.
    pub(crate) fn new(
        (mesh, shape): (&Mesh, &Shape),
        patch: &Patch,
        nodes: &NodalFields,
        moduli: ElasticModuli,
        density: f64,
    ) -> Option<Self> {
        let boundary = MovingBoundary::new(edges(shape, mesh)?, patch.shortest_span(), patch.spaces[0].degree());
        Some(Self::on(patch, nodes, boundary, moduli, density))
    }

    fn on(patch: &Patch, nodes: &NodalFields, boundary: MovingBoundary, moduli: ElasticModuli, density: f64) -> Self {
        let (grid, h) = (patch.control_grid(), patch.shortest_span());
        let field = || [grid.zeros(), grid.zeros()];
        let [quadratic, higher] = FIT_PENALTY;
        let fit_penalty = if patch.spaces[0].degree() > 2 { higher } else { quadratic };
        Self {
            gauss: GaussPoints::new(patch),
            boundary,
            fit: MassSystem::new(patch, fit_penalty * density * h * h),
            inertia: MassSystem::new(patch, INERTIA_PENALTY * density * h * h),
            displacement: [field(), field(), field()],
            acceleration: [field(), field(), field()],
            velocity: field(),
            load: field(),
            force: field(),
            point_acceleration: Vec::new(),
            held: [0, 1].map(|c| nodes.fixed().iter().filter(|(_, component)| *component == c).map(|f| f.0).collect()),
            springs: None,
            pushed: Resultant::default(),
            since_relaxation: 0,
            moduli,
            density,
        }
    }

    /// The fit, and the forces of the stresses at the present positions; the elastic energy, J/m.
    ///
    /// # Errors
    /// If the fit does not converge because points no longer hold the displacement, or that has turned inside
    /// out on the boundary.
    pub(crate) fn find_forces(&mut self, on: OnPatch<'_>) -> Result<f64, Failure> {
        let patch = on.patch;
        let mean = self.begin_fit(on);
        let accuracy = self.accuracy(patch, 0);
        extrapolate(&mut self.displacement);
        self.fit.solve(&self.load, &mut self.displacement[0], accuracy).map_err(Failure::Spans)?;
        let displacement = &self.displacement[0];
        let map = InverseMap::new(patch, displacement, mean);
        self.gauss.enclose(&mut self.boundary, &map)?;
        let balance = SpanBalance { gauss: &self.gauss, displacement, moduli: self.moduli, density: self.density };
        self.pushed = Resultant::default();
        Ok(balance.assemble(&mut self.inertia.matrix, &mut self.force))
    }

    /// The accelerations by these forces, and by those of contact.
    ///
    /// # Errors
    /// If the solve does not converge.
    pub(crate) fn accelerate(&mut self, OnPatch { patch, cells, points }: OnPatch<'_>) -> Result<(), Failure> {
        self.inertia.begin(self.gauss.marks(patch.control_grid()), &self.held);
        extrapolate(&mut self.acceleration);
        let accuracy = self.accuracy(patch, 2);
        let solved = self.inertia.solve(&self.force, &mut self.acceleration[0], accuracy);
        solved.map_err(Failure::Spans)?;
        let fit = PointFit { patch, cells, points, density: self.density };
        fit.at_points(&self.acceleration[0], &mut self.point_acceleration);
        let rigid = RigidPart { points, density: self.density, free: self.held.each_ref().map(Vec::is_empty) };
        rigid.remove_excess(&mut self.point_acceleration, self.pushed);
        Ok(())
    }

    /// Matrix and right-hand side of the fit at the present positions; the mean displacement, m.
    pub(crate) fn begin_fit(&mut self, OnPatch { patch, cells, points }: OnPatch<'_>) -> [f64; 2] {
        let mean = self.mean(points, |at| points[at].displacement);
        let fit = PointFit { patch, cells, points, density: self.density };
        fit.assemble(&mut self.fit.matrix, &mut self.load, mean);
        self.fit.begin(around(patch, cells), &self.held);
        mean
    }

    /// Hencky strain `[xx, yy, xy]` at a position, m.
    pub(crate) fn strain_at(&self, patch: &Patch, position: [f64; 2]) -> [f64; 3] {
        let displacement = &self.displacement[0];
        let map = InverseMap::new(patch, displacement, [0.0; 2]);
        hencky_strain(&displacement_gradient(&map.at(position).1))
    }

    /// Brings the velocities of the points by β towards that of the grid; the kinetic energy this takes,
    /// J/m.
    ///
    /// # Errors
    /// If the solve does not converge.
    fn relax(&mut self, patch: &Patch, cells: &Cells, points: &mut [Point], beta: f64) -> Result<f64, SolveFailure> {
        let mean = self.fit_velocity(OnPatch { patch, cells, points })?;
        let mut changes = Vec::new();
        PointFit { patch, cells, points, density: self.density }.at_points(&self.velocity, &mut changes);
        for (change, point) in changes.iter_mut().zip(&*points) {
            (0..2).for_each(|c| change[c] += mean[c] - point.velocity[c]);
        }
        let rigid = RigidPart { points, density: self.density, free: self.held.each_ref().map(Vec::is_empty) };
        rigid.remove_excess(&mut changes, Resultant::default());
        let mut loss = 0.0;
        for (point, change) in points.iter_mut().zip(&changes) {
            for c in 0..2 {
                let before = point.velocity[c];
                point.velocity[c] += beta * change[c];
                loss += 0.5 * self.density * point.volume * (before * before - point.velocity[c].powi(2));
            }
        }
        Ok(loss)
    }

    /// Fits the velocity of the points less its mean, which it returns, m/s.
    ///
    /// # Errors
    /// If the solve does not converge.
    fn fit_velocity(&mut self, OnPatch { patch, cells, points }: OnPatch<'_>) -> Result<[f64; 2], SolveFailure> {
        let mean = self.mean(points, |at| points[at].velocity);
        let fit = PointFit { patch, cells, points, density: self.density };
        fit.load(|point| [0, 1].map(|c| point.velocity[c] - mean[c]), &mut self.load);
        let accuracy = self.accuracy(patch, 1);
        self.fit.solve(&self.load, &mut self.velocity, accuracy)?;
        Ok(mean)
    }

    /// Control values of the velocity that fits the points now, m/s; NaN if there is none.
    pub(crate) fn fitted_velocity(&self, on: OnPatch<'_>) -> VectorField {
        let mut copy = self.clone(); // the run goes on from its own last fit
        let mean = copy.fit_velocity(on).unwrap_or([f64::NAN; 2]);
        for (velocity, mean) in copy.velocity.iter_mut().zip(mean) {
            velocity.iter_mut().enumerate().filter(|(at, _)| self.fit.takes(*at)).for_each(|(_, v)| *v += mean);
        }
        copy.velocity
    }

    /// When the solve for the derivative of that order of the displacement ends: what is left is round-off of
    /// positions, times the frequency of a span for each derivative.
    fn accuracy(&self, patch: &Patch, order: usize) -> Accuracy {
        let size = patch.spaces.iter().flat_map(|space| space.spans()).fold(0.0, |most, s| larger(most, s.right.abs()));
        let frequency = self.moduli.dilatational_speed(self.density) / patch.shortest_span();
        Accuracy { tolerance: TOLERANCES[order], round_off: f64::EPSILON * size * frequency.powi(order as i32) }
    }

    /// Mean over the mass of the points, of a component that is held nowhere; zero of others.
    fn mean(&self, points: &[Point], value: impl Fn(usize) -> [f64; 2]) -> [f64; 2] {
        let mass: f64 = points.iter().map(|point| point.volume).sum();
        let mut sum = [0.0; 2];
        for (at, point) in points.iter().enumerate() {
            let value = value(at);
            (0..2).for_each(|c| sum[c] += point.volume * value[c]);
        }
        [0, 1].map(|c| if self.held[c].is_empty() { sum[c] / mass } else { 0.0 })
    }
}

/// The next of three fields by a parabola; the oldest is dropped.
fn extrapolate(fields: &mut [VectorField; 3]) {
    fields.rotate_right(1);
    let [next, a, b] = fields;
    // `next` holds the oldest.
    for (next, (a, b)) in next.iter_mut().zip(a.iter().zip(b)) {
        for (next, (a, b)) in next.iter_mut().zip(a.iter().zip(b)) {
            *next += 3.0 * (*a - *b);
        }
    }
}

/// Control points of the spans with points and of those around them: the boundary may be ahead of the
/// points.
fn around(patch: &Patch, cells: &Cells) -> Vec<bool> {
    let grid = patch.control_grid();
    let order = [0, 1].map(|d| patch.spaces[d].degree() + 1);
    let mut marks = vec![false; grid.len()];
    for cell in &cells.cells {
        let first = cell.first.map(|first| first.saturating_sub(1));
        let end = [0, 1].map(|d| cell.first[d] + order[d] + 1);
        for row in first[1]..end[1].min(grid.rows) {
            marks[grid.index(first[0], row)..grid.index(end[0].min(grid.columns), row)].fill(true);
        }
    }
    marks
}
