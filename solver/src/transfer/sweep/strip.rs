//! The sweep over one strip: control fields to points and stresses back to control points, by sum
//! factorisation.

use std::ops::Range;

use crate::linear_algebra::lane::{LANES, Lane, Vectorised, prefetch};
use crate::particles::lattice::{Lattice, MappedPoint, Row, Tile};
use crate::splines::quadrature::MAX_POINTS;
use crate::splines::spline::MAX_ORDER;
use crate::transfer::point_kernel::{Fields, PointKernel, PointValues, Stress};

/// Nodal forces of a strip, from its first control row on.
#[derive(Debug, Clone)]
pub(super) struct StripForce {
    pub first_row: usize,
    /// Places in a row of a field that it may write to.
    pub columns: Range<usize>,
    pub components: [Vec<f64>; 2],
}

/// One kernel on its way over the points of a strip.
pub(super) struct StripSweep<'a, K> {
    pub lattice: &'a Lattice,
    pub fields: Fields<'a>,
    pub strip: usize,
    pub kernel: &'a mut K,
    pub force: Option<&'a mut StripForce>,
}

impl<K: PointKernel> Vectorised for StripSweep<'_, K> {
    type Output = ();
    const WIDEST: bool = K::EVERY_STEP;

    /// On wide processors, kernels of every step get loops of constant length for the usual degrees and
    /// numbers of points over a rectangle; any other runs the same code.
    #[inline(always)]
    fn run<const FMA: bool>(self) {
        let Lattice { degree: [p, q], points: [nx, ny], .. } = *self.lattice;
        if self.strip >= self.lattice.table_strips() {
            return self.cut_spans::<FMA>(p + 1, q + 1);
        }
        if self.lattice.mapping.is_some() {
            return self.walk::<FMA, true>(p + 1, q + 1, nx, ny);
        }
        if !(FMA && K::EVERY_STEP) {
            return self.walk::<FMA, false>(p + 1, q + 1, nx, ny);
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
/// Slots of partial sums per control row: values and slopes of three fields, two stress sums per force
/// component.
const SUMS: usize = 2 * FIELDS + 4;

impl<K: PointKernel> StripSweep<'_, K> {
    #[inline(always)]
    fn walk<const FMA: bool, const MAPPED: bool>(mut self, kx: usize, ky: usize, nx: usize, ny: usize) {
        let mut sums = [Lane::ZERO; MAX_ORDER * SUMS * MAX_POINTS];
        let lattice = self.lattice;
        let rows = lattice.strip_rows(self.strip);
        for tile_index in 0..lattice.tiles.len() {
            if !lattice.is_occupied(self.strip, tile_index) || self.kernel.skips(tile_index) {
                continue;
            }
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
                    self.load::<FMA, MAPPED>(&mut sums[at..at + SUMS * nx], tile, [control_row, row.lift], kx, nx);
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
        [control_row, lift]: [usize; 2],
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
            let base = if phase { base - lift * self.lattice.grid.stride } else { base };
            for ahead in [0, kx + LANES - 2] {
                prefetch(field, base + self.lattice.grid.stride + ahead); // the next row
            }
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
                let mut point = PointValues::default();
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
                self.kernel.prefetch(at + self.lattice.tiles.len() * nx * ny + b * nx + a); // the next row
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
