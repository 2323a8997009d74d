//! What a crack costs on a mesh: the surface energy of a crack across which rows of quadrature points are
//! broken, `c = 0`, with the matrices of the solver, against an independent program in one dimension.
//!
//! Around broken points the phase field is the spline that minimises
//!
//! ```text
//! Σ_q w_q [(1 − c)²/(4 l0) + l0 |grad c|² + B_q c²/(4 l0)],     B_q = 4 l0 H/Gc
//! ```
//!
//! with B_q so large at the broken points that c vanishes there. The cost counts the first two terms, over
//! Gc.

use fisura::linear_algebra::cholesky::SparseCholesky;
use fisura::linear_algebra::lane::Lane;
use fisura::linear_algebra::stencil::Stencil;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::assembly::{Constant, Integrand, PointCoefficients, add_form};
use fisura::scene::{Layout, Mass, Mesh};
use fisura::splines::patch::Patch;

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::record::{Reference, ReferenceKind};
use crate::scene::plain::PlainScene;

const QUANTITY: &str = "surface energy of a crack across broken rows of points, over Gc";
/// The costs of the independent program.
const TABLE: &str = include_str!("../../../reference-data/derivations/crack-cost.csv");
/// Half width of the body, in l0: exp(−14) of the cost lies outside.
const HALF_WIDTH: f64 = 14.0;
/// Height of the body, in spans: rows that are straight need no more.
const HEIGHT: f64 = 2.0;
/// B of a broken point.
const BROKEN: f64 = 1e9;
/// Degree and points per span and direction.
const RULES: [(usize, usize); 4] = [(1, 2), (2, 2), (2, 3), (3, 3)];
/// Lengths of a span over the length scale l0.
const SPANS: [f64; 3] = [1.0, 0.5, 0.25];
/// Broken rows: column of the table, and their numbers right of the middle knot for n points per span.
const ROWS: [(&str, Rows); 3] = [
    ("one_row", |n| (0..n.div_ceil(2) as isize).map(|row| vec![row]).collect()),
    ("two_rows_across_knot", |_| vec![vec![-1, 0]]),
    ("span", |n| vec![(0..n as isize).collect()]),
];

/// Sets of rows; the cheapest counts.
type Rows = fn(usize) -> Vec<Vec<isize>>;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for setting in all() {
        findings.measure(&setting.variant(), [(QUANTITY, setting.reference())], || {
            let mut cheapest = f64::INFINITY;
            for rows in (setting.rows)(setting.points) {
                cheapest = crate::extremes::smaller(cheapest, setting.cost(&rows)?);
            }
            Ok([cheapest])
        })?;
    }
    Ok(())
}

/// Broken rows on one mesh.
#[derive(Clone, Copy)]
struct Setting {
    degree: usize,
    points: usize,
    /// Length of a span over the length scale l0.
    span: f64,
    name: &'static str,
    rows: Rows,
}

fn all() -> impl Iterator<Item = Setting> {
    RULES.into_iter().flat_map(|(degree, points)| {
        let spans = SPANS.into_iter();
        spans.flat_map(move |span| ROWS.map(|(name, rows)| Setting { degree, points, span, name, rows }))
    })
}

impl Setting {
    fn variant(&self) -> String {
        let Self { degree, points, span, .. } = self;
        format!("p={degree}, {points} points, h={span} l0, {}", self.name.replace('_', " "))
    }

    /// The entry of the table, as printed.
    fn reference(&self) -> Option<Reference> {
        let mut lines = TABLE.lines();
        let column = lines.next()?.split(',').position(|name| name == self.name)?;
        let key = format!("{},{},{},", self.degree, self.points, self.span);
        let value = lines.find(|line| line.starts_with(&key))?.split(',').nth(column)?.parse().ok();
        let source = "reference-data/derivations/crack_cost.py, one dimension";
        Some(Reference::new(value, ReferenceKind::IndependentCode, source))
    }

    /// Surface energy per unit of length over Gc, with l0 = 1.
    fn cost(&self, broken: &[isize]) -> Result<f64, StudyError> {
        let half = (HALF_WIDTH / self.span).round();
        let (low, high) = ([-half * self.span, 0.0], [2.0 * half * self.span, HEIGHT * self.span]);
        let mesh = Mesh::uniform([self.degree; 2], low, high, [2 * half as usize, HEIGHT as usize]);
        let bar = PlainScene::unit_bar(mesh, Mass::Lumped);
        let scene = PlainScene { held: vec![], layout: Layout::Gauss, points: self.points, ..bar }.scene();
        let lattice = Lattice::new(&Patch::new(&scene.mesh), &scene.bodies[0]);
        let (_, energy) = cracked(&lattice, &[], Some(self.strengths(&lattice, broken)))?;
        Ok(energy / (HEIGHT * self.span))
    }

    /// B at the points: rows are numbered by the order of their points along x, from the middle.
    fn strengths(&self, lattice: &Lattice, broken: &[isize]) -> PerPoint {
        let mut places = Vec::new();
        lattice.for_each_point(|_, _, position, _| places.push(position[0]));
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
        let middle = (places.len() / 2) as isize;
        let mut strengths = vec![Lane::ZERO; lattice.batches()];
        lattice.for_each_point(|batch, lane, position, _| {
            let row = places.partition_point(|x| *x < position[0] - 1e-9) as isize - middle;
            strengths[batch][lane] = if broken.contains(&row) { BROKEN } else { 0.0 };
        });
        PerPoint(strengths)
    }
}

/// The phase field, with l0 = 1, that is zero at the control points `held` and small at points of large B, if
/// `strengths` has any: its control values, and its surface energy over Gc.
pub(super) fn cracked(
    lattice: &Lattice,
    held: &[usize],
    strengths: Option<PerPoint>,
) -> Result<(Vec<f64>, f64), StudyError> {
    let grid = lattice.grid;
    let mut matrix = Stencil::zeros(grid, lattice.degree);
    add_form(&mut matrix, lattice, Integrand::Mass, &Constant(1.0));
    add_form(&mut matrix, lattice, Integrand::Diffusion, &Constant(4.0));
    let surface = matrix.clone();
    if let Some(strengths) = strengths {
        add_form(&mut matrix, lattice, Integrand::Mass, &strengths);
    }
    let factor = SparseCholesky::default().factor(&matrix, held);
    let factor = factor.ok_or_else(|| other("the matrix is not positive definite"))?;
    let mut phase = grid.zeros();
    factor.solve(&lattice.integrate(|_, _, _| 1.0), &mut phase);
    let (mut damage, mut image) = (grid.zeros(), grid.zeros());
    grid.indices().for_each(|at| damage[at] = 1.0 - phase[at]);
    let energy = surface.apply(&damage, &mut image) / 4.0;
    Ok((phase, energy))
}

/// A coefficient for each point.
pub(super) struct PerPoint(Vec<Lane>);

impl PointCoefficients for PerPoint {
    fn span(&self, first: usize, weights: &[Lane], out: &mut [Lane]) -> bool {
        for (i, (out, weight)) in out.iter_mut().zip(weights).enumerate() {
            *out = *weight * self.0[first + i];
        }
        true
    }
}
