//! The passes between points and grid of the updated frame (E 15–18). With the fraction k of its velocity
//! that a point keeps, the increment Δv and the motion of [`velocity_transfer`](super::velocity_transfer),
//!
//! ```text
//! v_p ← k v_p + Σ N_I Δv_I,      x_p ← x_p + dt Σ N_I motion_I,      A = dt Σ motion_I ⊗ grad N_I
//! ```
//!
//! N_I and grad N_I are means over the domain of the point: a box of its volume that deforms with it
//! (Bardenhagen and Kober 2004 for hat functions). Values at the point itself would leave a constant stress
//! with forces of its own wherever the points do not lie as they did at the start. Those soften or stiffen a
//! body that is stretched or pressed, until it comes apart.
//!
//! The ends of domains that touch must stay together too. The point, a centre of mass, moves with the mean
//! velocity of its domain; the middle of the domain moves with the average velocity of its two ends, in each
//! direction, and gradients are means about that middle. Without this offset a stress acts on the domains as
//! a negative stiffness of fourth order, `−σ (w²/3) ∫ N_I'' N_J''` with half the width w: a bar that is
//! pulled slowly by a fifth then tears.
//!
//! Strain and deformation gradient follow from A in [`strain`](super::strain). Where the transfer carries
//! velocity gradients C, they come and go with the velocities ([`affine`](super::affine)).
//!
//! Shape functions are products of two one-dimensional ones (`SplineSpace::mean_functions`). Fields stand
//! side by side in both passes: four numbers of a control point travel together through the inner loops,
//! which is what the vector instructions of every processor in question hold.

use super::affine::AffineView;
use super::strain::StrainUpdate;
use super::windows::{ControlSums, Reach, Window, control_sums};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::{LANES, Lane, Vectorised, each};
use crate::material::elasticity::ElasticModuli;
use crate::material::hencky::Gradient;
use crate::particles::points::{Cell, FracturePoint, Point};
use crate::splines::patch::Patch;
use crate::splines::spline::MAX_REACH;

/// Instantiates a walk over the usual degrees with loops of constant length on wide processors; any other
/// runs the same code.
macro_rules! walks {
    ([$($generic:tt)*] $kernel:ty => $output:ty) => {
        impl $($generic)* Vectorised for $kernel {
            type Output = $output;

            #[inline(always)]
            fn run<const FMA: bool>(self) -> $output {
                match self.patch.spaces.each_ref().map(|space| space.degree()) {
                    [p, q] if !FMA => self.walk::<FMA>(p + 1, q + 1),
                    [1, 1] => self.walk::<FMA>(2, 2),
                    [2, 2] => self.walk::<FMA>(3, 3),
                    [3, 3] => self.walk::<FMA>(4, 4),
                    [p, q] => self.walk::<FMA>(p + 1, q + 1),
                }
            }
        }
    };
}
pub(super) use walks;

/// P2G: mass, momentum and internal force of the points of a strip.
pub struct PointsToGrid<'a> {
    /// Part of the background patch that the nodal fields of the body cover.
    pub patch: &'a Patch,
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Density of the undeformed material, kg/m³.
    pub density: f64,
    /// Cells of the strip.
    pub cells: &'a [Cell],
    /// All points of the body, sorted by span.
    pub points: &'a [Point],
    /// Their velocity gradients, if they carry such.
    pub affine: Option<(AffineView<'a>, &'a [Gradient])>,
    /// Momentum x and y, force x and y (minus the internal force), and mass, per unit thickness.
    pub window: Window<'a, [f64; 5], 1>,
}

walks!([] PointsToGrid<'_> => ());

impl PointsToGrid<'_> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) {
        let Window { first_row, fields: [sums] } = &mut self.window;
        for cell in self.cells {
            for at in cell.points.clone() {
                let point = &self.points[at];
                let functions = point.mean_functions::<false>(self.patch, cell, [kx, ky]);
                let [sx, sy] = &functions;
                let m = self.density * point.volume;
                let [px, py] = each!(c in [0, 1] => m * point.velocity[c]);
                let [xx, yy, xy] = each!(i in [0, 1, 2] => -point.stress[i] * point.volume);
                let ([lx, ly], [[vx_x, vx_y], [vy_x, vy_y]]) = match self.affine {
                    Some((view, gradients)) => {
                        let gradient = each!(c in [0, 1] => each!(d in [0, 1] => {
                            m * fault!("affine-transposed", gradients[at][c][d] => gradients[at][d][c])
                        }));
                        (view.levers(cell, &functions, point.position, [kx, ky]), gradient)
                    }
                    None => ([[0.0; MAX_REACH]; 2], [[0.0; 2]; 2]),
                };
                let reach = Reach::new(self.grid, cell, &functions, [kx, ky], *first_row);
                for l in 0..reach.rows {
                    let (n, d) = (sy.value[l], sy.derivative[l]);
                    let by_value = [(px + vx_y * ly[l]) * n, (py + vy_y * ly[l]) * n, xy * d, yy * d];
                    let by_slope = [vx_x * n, vy_x * n, xx * n, fault!("shear-force-one-sided", xy * n => 0.0)];
                    for (k, sums) in sums[reach.row(l)].iter_mut().enumerate() {
                        sums[4] += m * n * sx.value[k];
                        let of_lever = sx.value[k] * lx[k];
                        let slope = [of_lever, of_lever, sx.derivative[k], sx.derivative[k]];
                        for c in 0..4 {
                            sums[c] += sx.value[k] * by_value[c] + slope[c] * by_slope[c];
                        }
                    }
                }
            }
        }
    }
}

/// G2P: velocity, position and strain of the points of a strip, and stress and energy where nothing
/// fractures.
pub struct GridToPoints<'a, K> {
    /// Part of the background patch that the nodal fields of the body cover.
    pub patch: &'a Patch,
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Length of the time step, s.
    pub dt: f64,
    /// Velocity of the control points with which the points move and strain, m/s, and what the points take up
    /// into their velocity, m/s.
    pub fields: &'a [[f64; 4]],
    /// Part of its own velocity that a point keeps.
    pub kept_fraction: f64,
    /// Velocity gradients of the points of the strip, if they carry such.
    pub affine: Option<(AffineView<'a>, &'a mut [Gradient])>,
    /// Strains the points of the strip.
    pub kinematics: K,
    /// Moduli if the body is elastic: its stress follows at once.
    pub elastic: Option<ElasticModuli>,
    /// Cells of the strip.
    pub cells: &'a [Cell],
    /// Points of the strip.
    pub points: &'a mut [Point],
    /// What they carry besides if the body fractures, else empty.
    pub fracture: &'a mut [FracturePoint],
}

/// Sums and findings of a strip.
#[derive(Debug, Clone, Copy, Default)]
pub struct StripMotion {
    /// Whether a point left its span.
    pub left_span: bool,
    /// Largest square of a speed, m²/s².
    pub fastest: f64,
    /// Elastic energy, J/m; only of an elastic body.
    pub elastic_energy: f64,
    /// Work `Σ V sigma(n+1) : de`, J/m; only of an elastic body.
    pub stress_work: f64,
}

/// What a step does to a point.
struct PointMotion {
    /// Strain of the step that the new stress works on.
    strain_increment: [f64; 3],
    /// Displacement of the step, m.
    moved: [f64; 2],
}

walks!([<K: StrainUpdate>] GridToPoints<'_, K> => StripMotion);

impl<K: StrainUpdate> GridToPoints<'_, K> {
    #[inline(always)]
    fn walk<const FMA: bool>(mut self, kx: usize, ky: usize) -> StripMotion {
        let mut motion = StripMotion::default();
        let offset = self.cells.first().map_or(0, |cell| cell.points.start);
        let mut increments = [[0.0; 3]; LANES];
        for cell in self.cells {
            let all = cell.points.start - offset..cell.points.end - offset;
            for first in all.clone().step_by(LANES) {
                let some = first..(first + LANES).min(all.end);
                for at in some.clone() {
                    let PointMotion { strain_increment, moved } = self.move_point(cell, at, [kx, ky], &mut motion);
                    increments[at - first] = strain_increment;
                    if let Some(fracture) = self.fracture.get_mut(at) {
                        (fracture.strain_increment, fracture.moved) = (strain_increment, moved);
                    }
                }
                if let Some(moduli) = self.elastic {
                    elastic_stress(&moduli, &mut self.points[some], &increments, &mut motion);
                }
            }
        }
        motion
    }

    /// Moves and strains one point.
    #[inline(always)]
    fn move_point(&mut self, cell: &Cell, at: usize, order: [usize; 2], motion: &mut StripMotion) -> PointMotion {
        let Self { patch, grid, dt, fields, .. } = *self;
        let point = &mut self.points[at];
        let functions = point.mean_functions::<true>(patch, cell, order);
        let reach = Reach::new(grid, cell, &functions, order, 0);
        // A constant velocity has no gradient, whatever rounding does to the factors of the fit.
        let ([.., x, y], slopes) = match &self.affine {
            Some((view, _)) => {
                let levers = view.levers(cell, &functions, point.position, order);
                (fields[reach.row(reach.rows / 2).start], view.slopes(patch, cell, &functions, &levers, order))
            }
            None => ([0.0; 4], [[0.0; MAX_REACH]; 2]),
        };
        let reference = [0.0, 0.0, x, y];
        let sums = control_sums(&functions, &slopes, fields, reference, reach);
        let ControlSums { value, along_x, along_y, ends_less_mean } = sums;
        let step = each!(c in [0, 1] => [dt * along_x[c], dt * along_y[c]]);
        let before = point.half_width;
        let strain_increment = self.kinematics.strain(at, point, &step);
        if let Some((view, gradients)) = &mut self.affine {
            let (kept, taken) = (gradients[at], sums.affine());
            let gradient = each!(c in [0, 1] => each!(d in [0, 1] => self.kept_fraction * kept[c][d] + taken[c][d]));
            gradients[at] = view.rescaled(gradient, patch, cell, [before, point.half_width]);
        }
        let moved = each!(d in [0, 1] => dt * value[d]);
        for d in 0..2 {
            point.velocity[d] = self.kept_fraction * point.velocity[d] + (reference[2 + d] + value[2 + d]);
            point.displacement[d] += moved[d];
            point.offset[d] += fault!("domain-stays-about-its-point", dt * ends_less_mean[d] => 0.0);
            point.position[d] += fault!("points-move-half-way", moved[d] => 0.5 * moved[d]);
        }
        motion.fastest = larger(motion.fastest, value[0] * value[0] + value[1] * value[1]);
        let spans = each!(d in [0, 1] => &patch.spaces[d].spans()[cell.span[d]]);
        motion.left_span |= (0..2).any(|d| !(spans[d].left <= point.position[d] && point.position[d] < spans[d].right));
        PointMotion { strain_increment, moved }
    }
}

/// Stress of at most eight intact points, their energy and the work of the new stress over the step.
#[inline(always)]
fn elastic_stress(
    moduli: &ElasticModuli,
    points: &mut [Point],
    increments: &[[f64; 3]; LANES],
    motion: &mut StripMotion,
) {
    let strain = each!(i in [0, 1, 2] => gather(points, |p| p.strain[i]));
    let stress = moduli.stress(strain);
    let energy = moduli.energy(strain);
    for (lane, point) in points.iter_mut().enumerate() {
        point.stress = each!(i in [0, 1, 2] => stress[i][lane]);
        motion.elastic_energy += point.volume * energy[lane];
        motion.stress_work += point.volume * contract(point.stress, increments[lane]);
    }
}

/// `a : b` of two symmetric tensors `[xx, yy, xy]`.
#[inline(always)]
pub fn contract(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + 2.0 * a[2] * b[2]
}

/// One number of each of at most eight points; zero in the lanes beyond.
#[inline(always)]
pub(crate) fn gather<T>(items: &[T], value: impl Fn(&T) -> f64) -> Lane {
    let mut lanes = Lane::ZERO;
    for (lane, item) in items.iter().enumerate() {
        lanes[lane] = value(item);
    }
    lanes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::updated_frame::windows::scatter;
    use crate::particles::points::Cells;
    use crate::scene::Mesh;

    /// Forces of a constant stress in a block of 8 x 8 spans of 1 m, 2 x 2 points each, that was moved and
    /// stretched; the largest away from the edges of the block, and the largest of all, N/m.
    fn forces(degree: usize, stretch: [f64; 2], shift: [f64; 2]) -> [f64; 2] {
        let patch = Patch::new(&Mesh::uniform([degree; 2], [0.0; 2], [20.0; 2], [20; 2]));
        let (grid, stress) = (patch.control_grid(), [3.0, -2.0, 1.0]);
        let mut points = Vec::new();
        for n in 0..256 {
            let at = [(n % 16) as f64 * 0.5 + 0.25, (n / 16) as f64 * 0.5 + 0.25];
            let position = [0, 1].map(|d| 3.0 + shift[d] + stretch[d] * at[d]);
            let mut point = Point { stress, ..Point::at_rest(position, [0.5, 0.5]) };
            point.deform_domain(&[[stretch[0] - 1.0, 0.0], [0.0, stretch[1] - 1.0]]);
            points.push(point);
        }
        let mut cells = Cells::default();
        cells.sort(&patch, &mut points).unwrap();
        let mut sums = vec![[0.0; 5]; grid.len()];
        scatter(&cells.strips, [&mut sums[..]], [grid.stride], |strip, window| {
            let cells = &cells.cells[strip.cells.clone()];
            PointsToGrid { patch: &patch, grid, density: 1.0, cells, points: &points, affine: None, window }
                .run::<false>();
        });
        let greville = [0, 1].map(|d| patch.spaces[d].greville());
        let reach = 0.5 * (degree + 1) as f64;
        let inside = |at: usize| {
            let x = [greville[0][grid.column_of(at)], greville[1][grid.row_of(at)]];
            (0..2).all(|d| {
                let from = x[d] - 3.0 - shift[d];
                from - reach > 0.0 && from + reach < 8.0 * stretch[d]
            })
        };
        assert!((sums.iter().map(|sums| sums[4]).sum::<f64>() - 64.0).abs() < 1e-12, "the mass is that of the points");
        let most = |some: &dyn Fn(usize) -> bool| {
            grid.indices().filter(|&at| some(at)).map(|at| sums[at][2].abs().max(sums[at][3].abs())).fold(0.0, larger)
        };
        [most(&inside), most(&|_| true)]
    }

    #[test]
    fn a_constant_stress_has_no_forces_inside_a_body_wherever_its_points_have_gone() {
        for degree in 1..=4 {
            for (stretch, shift) in [
                ([1.0, 1.0], [0.0, 0.0]),
                ([1.0, 1.0], [0.137, -0.41]),
                ([1.27, 0.83], [0.2, 0.33]),
                ([0.55, 1.5], [0.9, -0.7]),
                ([1.5, 0.5], [-0.61, 0.05]),
            ] {
                let [inside, largest] = forces(degree, stretch, shift);
                assert!(inside < 1e-13 && largest > 0.3, "p = {degree}, {stretch:?}, {shift:?}: {inside:e}");
            }
        }
    }
}
