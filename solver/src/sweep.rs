//! One pass over the material points of a body: control values to points, physics at the points, points to nodes.
//!
//! In the total frame the transfers G2P and P2G (E 15–18) are interpolation from and integration onto control points
//! that never move, and both factor over the directions. A sweep walks down a column of tiles with the partial sums in x
//! of the last `q + 1` control rows at hand, so every control value is read and every nodal force written once per
//! strip. What happens at the points is a [`PointKernel`]; what it does not ask for is not interpolated.

use rayon::prelude::*;

use crate::lane::{Lane, Vectorised, dispatch};
use crate::lattice::{Lattice, MappedPoint, Row, Tile};
use crate::quadrature::MAX_POINTS;
use crate::spline::MAX_ORDER;

/// What the fields are at a batch of points.
#[derive(Debug, Clone, Copy)]
pub struct PointValues {
    /// Displacement gradient: `[du_x/dx, du_x/dy, du_y/dx, du_y/dy]`.
    pub gradient: [Lane; 4],
    /// Phase field.
    pub phase: Lane,
    /// Its gradient, 1/m.
    pub phase_gradient: [Lane; 2],
}

/// In-plane stress of a batch of points, Pa: work-conjugate to the displacement gradient, so `xy` is the force in x on a
/// face with normal y. Only a first Piola–Kirchhoff stress has `xy` and `yx` that differ.
#[derive(Debug, Clone, Copy)]
pub struct Stress {
    /// Normal stress in x.
    pub xx: Lane,
    /// Shear stress, force in x.
    pub xy: Lane,
    /// Shear stress, force in y.
    pub yx: Lane,
    /// Normal stress in y.
    pub yy: Lane,
}

impl Stress {
    /// No stress.
    pub const ZERO: Self = Self::symmetric([Lane::ZERO; 3]);

    /// A symmetric stress `[xx, yy, xy]`.
    #[inline(always)]
    pub const fn symmetric([xx, yy, xy]: [Lane; 3]) -> Self {
        Self { xx, xy, yx: xy, yy }
    }
}

/// Physics at the points of a strip.
pub trait PointKernel: Send {
    /// Whether the displacement gradient is needed.
    const DISPLACEMENT: bool;
    /// Whether the phase field is needed.
    const PHASE: bool;
    /// Whether its gradient is needed.
    const PHASE_GRADIENT: bool;
    /// Whether the returned stress is to be integrated into nodal forces.
    const STRESS: bool;

    /// One batch: `at` counts batches from the start of the strip, `weight` is in m² and zero where there is no point.
    fn points<const FMA: bool>(&mut self, at: usize, weight: Lane, values: &PointValues) -> Stress;
}

/// Control fields a sweep reads; a field that its kernel does not need may be empty.
#[derive(Debug, Clone, Copy)]
pub struct Fields<'a> {
    /// Displacement components, m.
    pub displacement: [&'a [f64]; 2],
    /// Phase field.
    pub phase: &'a [f64],
}

/// Nodal forces strip by strip; neighbouring strips share control rows and are added in a fixed order.
#[derive(Debug, Clone)]
pub struct StripForces {
    strips: Vec<StripForce>,
}

#[derive(Debug, Clone)]
struct StripForce {
    first_row: usize,
    components: [Vec<f64>; 2],
}

impl StripForces {
    /// Room for the forces on the control points of `lattice`.
    pub fn new(lattice: &Lattice) -> Self {
        let strips = (0..lattice.strips()).map(|strip| {
            let rows = lattice.strip_control_rows(strip);
            let length = rows.len() * lattice.grid.stride;
            StripForce { first_row: rows.start, components: [vec![0.0; length], vec![0.0; length]] }
        });
        Self { strips: strips.collect() }
    }

    /// Adds the strips up, per unit thickness: N/m, into fields on the control points.
    pub fn assemble(&self, stride: usize, out: &mut [Vec<f64>; 2]) {
        let [x, y] = out;
        x.par_chunks_mut(stride).zip(y.par_chunks_mut(stride)).enumerate().for_each(|(row, (x, y))| {
            x.fill(0.0);
            y.fill(0.0);
            for strip in &self.strips {
                if row < strip.first_row || (row - strip.first_row) * stride >= strip.components[0].len() {
                    continue;
                }
                let part = (row - strip.first_row) * stride..(row - strip.first_row + 1) * stride;
                for (out, component) in [&mut *x, &mut *y].into_iter().zip(&strip.components) {
                    for (value, add) in out.iter_mut().zip(&component[part.clone()]) {
                        *value += add;
                    }
                }
            }
        });
    }

    /// Heap memory, bytes.
    pub fn bytes(&self) -> usize {
        self.strips.iter().map(|s| 16 * s.components[0].len()).sum()
    }
}

/// Runs one kernel per strip over the points of `lattice`; `forces` receives the integrated stresses.
pub fn sweep<K: PointKernel>(lattice: &Lattice, fields: Fields, kernels: &mut [K], forces: Option<&mut StripForces>) {
    assert_eq!(kernels.len(), lattice.strips(), "one kernel per strip");
    match forces {
        Some(forces) if K::STRESS => {
            kernels.par_iter_mut().zip(&mut forces.strips).enumerate().for_each(|(strip, (kernel, force))| {
                force.components.iter_mut().for_each(|c| c.fill(0.0));
                dispatch(StripSweep { lattice, fields, strip, kernel, force: Some(force) });
            });
        }
        _ => kernels.par_iter_mut().enumerate().for_each(|(strip, kernel)| {
            dispatch(StripSweep { lattice, fields, strip, kernel, force: None });
        }),
    }
}

struct StripSweep<'a, K> {
    lattice: &'a Lattice,
    fields: Fields<'a>,
    strip: usize,
    kernel: &'a mut K,
    force: Option<&'a mut StripForce>,
}

impl<K: PointKernel> Vectorised for StripSweep<'_, K> {
    type Output = ();

    /// The usual degrees and numbers of points over a rectangle get loops of constant length; any other runs the same code.
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Lattice { degree: [p, q], points: [nx, ny], .. } = *self.lattice;
        if self.lattice.mapping.is_some() {
            return self.walk::<FMA, true>(p + 1, q + 1, nx, ny);
        }
        match (p, q, nx, ny) {
            (1, 1, 2, 2) => self.walk::<FMA, false>(2, 2, 2, 2),
            (2, 2, 2, 2) => self.walk::<FMA, false>(3, 3, 2, 2),
            (2, 2, 3, 3) => self.walk::<FMA, false>(3, 3, 3, 3),
            (3, 3, 2, 2) => self.walk::<FMA, false>(4, 4, 2, 2),
            (3, 3, 3, 3) => self.walk::<FMA, false>(4, 4, 3, 3),
            (3, 3, 4, 4) => self.walk::<FMA, false>(4, 4, 4, 4),
            _ => self.walk::<FMA, false>(p + 1, q + 1, nx, ny),
        }
    }
}

/// Partial sums of one control row: per point column a and field.
const FIELDS: usize = 3;
/// Slots of partial sums per control row: values and slopes of three fields, two stress sums per force component.
const SUMS: usize = 2 * FIELDS + 4;

impl<K: PointKernel> StripSweep<'_, K> {
    #[inline(always)]
    fn walk<const FMA: bool, const MAPPED: bool>(mut self, kx: usize, ky: usize, nx: usize, ny: usize) {
        let mut sums = [Lane::ZERO; MAX_ORDER * SUMS * MAX_POINTS];
        let lattice = self.lattice;
        let rows = lattice.strip_rows(self.strip);
        for tile_index in 0..lattice.tiles.len() {
            let tile = &lattice.tiles[tile_index];
            let mut loaded = lattice.rows[rows.start].first;
            let mut flushed = loaded;
            for row_index in rows.clone() {
                let row = &lattice.rows[row_index];
                self.flush::<FMA, MAPPED>(&sums, tile, flushed..row.first.min(loaded), kx, ky, nx);
                flushed = row.first;
                loaded = loaded.max(row.first);
                for control_row in loaded..row.first + ky {
                    let at = (control_row % ky) * SUMS * nx;
                    self.load::<FMA, MAPPED>(&mut sums[at..at + SUMS * nx], tile, control_row, kx, nx);
                }
                loaded = row.first + ky;
                let at = (((row_index - rows.start) * lattice.tiles.len()) + tile_index) * nx * ny;
                self.span_row::<FMA, MAPPED>(&mut sums, row, [row_index, tile_index], at, ky, [nx, ny]);
            }
            self.flush::<FMA, MAPPED>(&sums, tile, flushed..loaded, kx, ky, nx);
        }
    }

    /// Partial sums in x of a control row: interpolated values and slopes at each point column.
    #[inline(always)]
    fn load<const FMA: bool, const MAPPED: bool>(
        &self,
        sums: &mut [Lane],
        tile: &Tile,
        control_row: usize,
        kx: usize,
        nx: usize,
    ) {
        let base = self.lattice.grid.index(tile.first, control_row);
        let fields = [self.fields.displacement[0], self.fields.displacement[1], self.fields.phase];
        for (f, field) in fields.into_iter().enumerate() {
            let phase = f == 2;
            if (phase && !K::PHASE) || (!phase && !K::DISPLACEMENT) {
                continue;
            }
            let slopes = !phase || K::PHASE_GRADIENT;
            for a in 0..nx {
                let (mut value, mut slope) = (Lane::ZERO, Lane::ZERO);
                for k in 0..kx {
                    let mut control = Lane::load(field, base + k);
                    if MAPPED {
                        control = control * self.lattice.weights(base + k);
                    }
                    value = value.add_product::<FMA>(control, tile.value[a * kx + k]);
                    if slopes {
                        slope = slope.add_product::<FMA>(control, tile.derivative[a * kx + k]);
                    }
                }
                sums[2 * f * nx + a] = value;
                sums[(2 * f + 1) * nx + a] = slope;
            }
        }
        if K::STRESS {
            sums[2 * FIELDS * nx..].fill(Lane::ZERO);
        }
    }

    /// Sums in y, physics, and the stress back into the partial sums, for one span row of a tile.
    #[inline(always)]
    fn span_row<const FMA: bool, const MAPPED: bool>(
        &mut self,
        sums: &mut [Lane],
        row: &Row,
        [row_index, tile_index]: [usize; 2],
        at: usize,
        ky: usize,
        [nx, ny]: [usize; 2],
    ) {
        let mapped = self.lattice.mapping.as_ref().filter(|_| MAPPED);
        for b in 0..ny {
            let (value, derivative) = (&row.value[b], &row.derivative[b]);
            for a in 0..nx {
                let mut point =
                    PointValues { gradient: [Lane::ZERO; 4], phase: Lane::ZERO, phase_gradient: [Lane::ZERO; 2] };
                let mut displacement = [Lane::ZERO; 2]; // needed for rational gradients only
                for k in 0..ky {
                    let slot = &sums[((row.first + k) % ky) * SUMS * nx..][..SUMS * nx];
                    let (n, d) = (value[k], derivative[k]);
                    if K::DISPLACEMENT {
                        let g = &mut point.gradient;
                        g[0] = g[0].add_scaled::<FMA>(slot[nx + a], n);
                        g[1] = g[1].add_scaled::<FMA>(slot[a], d);
                        g[2] = g[2].add_scaled::<FMA>(slot[3 * nx + a], n);
                        g[3] = g[3].add_scaled::<FMA>(slot[2 * nx + a], d);
                        if MAPPED {
                            for i in 0..2 {
                                displacement[i] = displacement[i].add_scaled::<FMA>(slot[2 * i * nx + a], n);
                            }
                        }
                    }
                    if K::PHASE {
                        point.phase = point.phase.add_scaled::<FMA>(slot[4 * nx + a], n);
                    }
                    if K::PHASE_GRADIENT {
                        let g = &mut point.phase_gradient;
                        g[0] = g[0].add_scaled::<FMA>(slot[5 * nx + a], n);
                        g[1] = g[1].add_scaled::<FMA>(slot[4 * nx + a], d);
                    }
                }
                let map = mapped.map(|mapping| &mapping.points[self.lattice.batch(row_index, tile_index, b, a)]);
                if let Some(map) = map {
                    point = rational::<K>(map, displacement, &point);
                }
                let weight = self.lattice.weight(row_index, tile_index, b, a);
                let stress = self.kernel.points::<FMA>(at + b * nx + a, weight, &point);
                if K::STRESS {
                    let Stress { xx, xy, yx, yy } = stress;
                    let (mut force, mut stress) =
                        ([Lane::ZERO; 2], [[xx, xy], [yx, yy]].map(|s| s.map(|s| s * weight)));
                    if let Some(map) = map {
                        for i in 0..2 {
                            (force[i], stress[i]) = map.adjoint(Lane::ZERO, stress[i]);
                        }
                    }
                    let [[xx, xy], [yx, yy]] = stress;
                    for k in 0..ky {
                        let slot = &mut sums[((row.first + k) % ky) * SUMS * nx..][..SUMS * nx];
                        let (n, d) = (value[k], derivative[k]);
                        slot[6 * nx + a] = slot[6 * nx + a].add_scaled::<FMA>(xx, n);
                        slot[7 * nx + a] = slot[7 * nx + a].add_scaled::<FMA>(xy, d);
                        slot[8 * nx + a] = slot[8 * nx + a].add_scaled::<FMA>(yx, n);
                        slot[9 * nx + a] = slot[9 * nx + a].add_scaled::<FMA>(yy, d);
                        if MAPPED {
                            for i in 0..2 {
                                let at = (7 + 2 * i) * nx + a;
                                slot[at] = slot[at].add_scaled::<FMA>(force[i], n);
                            }
                        }
                    }
                }
            }
        }
    }

    /// Writes the forces of control rows that no later span row touches.
    #[inline(always)]
    fn flush<const FMA: bool, const MAPPED: bool>(
        &mut self,
        sums: &[Lane],
        tile: &Tile,
        control_rows: std::ops::Range<usize>,
        kx: usize,
        ky: usize,
        nx: usize,
    ) {
        let Some(force) = self.force.as_deref_mut() else { return };
        for control_row in control_rows {
            let slot = &sums[(control_row % ky) * SUMS * nx..][..SUMS * nx];
            let base = self.lattice.grid.index(tile.first, control_row - force.first_row);
            for (component, out) in force.components.iter_mut().enumerate() {
                for k in 0..kx {
                    let mut sum = Lane::ZERO;
                    for a in 0..nx {
                        let at = (6 + 2 * component) * nx + a;
                        sum = sum.add_product::<FMA>(slot[at], tile.derivative[a * kx + k]);
                        sum = sum.add_product::<FMA>(slot[at + nx], tile.value[a * kx + k]);
                    }
                    if MAPPED {
                        sum = sum * self.lattice.weights(self.lattice.grid.index(tile.first + k, control_row));
                    }
                    sum.add_to(out, base + k);
                }
            }
        }
    }
}

/// Fields of a patch with a geometry that a kernel needs, from the spline sums and their parametric slopes.
#[inline(always)]
fn rational<K: PointKernel>(map: &MappedPoint, displacement: [Lane; 2], sums: &PointValues) -> PointValues {
    let mut values = *sums;
    if K::DISPLACEMENT {
        let [xu, xv, yu, yv] = sums.gradient;
        let (_, [xx, xy]) = map.field(displacement[0], [xu, xv]);
        let (_, [yx, yy]) = map.field(displacement[1], [yu, yv]);
        values.gradient = [xx, xy, yx, yy];
    }
    if K::PHASE_GRADIENT {
        (values.phase, values.phase_gradient) = map.field(sums.phase, sums.phase_gradient);
    } else if K::PHASE {
        values.phase = sums.phase * map.inverse_weight;
    }
    values
}
