//! Assembly where points or functions do not factor over the directions, on a patch with a geometry and in
//! spans that the boundary cuts: the sum over the points of a span is done for every pair of functions.

use super::form::{Integrand, PointCoefficients};
use crate::linear_algebra::lane::Lane;
use crate::linear_algebra::stencil::Stencil;
use crate::particles::lattice::{BatchFunctions, Lattice};
use crate::splines::quadrature::MAX_POINTS;
use crate::splines::spline::MAX_FUNCTIONS;

/// Adds the form of a strip to its `window` of the matrix, which begins at control row `first_row`.
pub(super) fn assemble<C: PointCoefficients>(
    lattice: &Lattice,
    form: Integrand,
    coefficients: &C,
    strip: usize,
    first_row: usize,
    window: &mut [f64],
) {
    let [nx, ny] = lattice.points;
    let span = nx * ny;
    let mut weights = [Lane::ZERO; MAX_POINTS * MAX_POINTS];
    let mut scaled = [Lane::ZERO; MAX_POINTS * MAX_POINTS];
    let count = (lattice.degree[0] + 1) * (lattice.degree[1] + 1);
    let mut pairs = vec![Lane::ZERO; count * (count + 1) / 2];
    for row in lattice.strip_rows(strip) {
        for tile in (0..lattice.tiles.len()).filter(|&tile| lattice.is_occupied(strip, tile)) {
            for b in 0..ny {
                for a in 0..nx {
                    weights[b * nx + a] = lattice.weight(row, tile, b, a);
                }
            }
            let first = lattice.batch(row, tile, 0, 0);
            if !coefficients.span(first, &weights[..span], &mut scaled[..span]) {
                continue;
            }
            pairs.fill(Lane::ZERO);
            for point in 0..span {
                add_point(&lattice.shape_functions(first + point), form, scaled[point], count, &mut pairs);
            }
            let first = [lattice.tiles[tile].first, lattice.rows[row].first - lattice.rows[row].lift];
            scatter(lattice, first, &pairs, first_row, |pair, at| pair.add_to(window, at));
        }
    }
}

/// Products of every pair of functions `m <= n` at a batch of points.
fn add_point(functions: &BatchFunctions, form: Integrand, coefficient: Lane, count: usize, pairs: &mut [Lane]) {
    let mut scaled = [[Lane::ZERO; 2]; MAX_FUNCTIONS];
    for n in 0..count {
        scaled[n] = match form {
            Integrand::Mass => [functions.value[n] * coefficient, Lane::ZERO],
            Integrand::Diffusion => functions.gradient[n].map(|g| g * coefficient),
            Integrand::Anisotropic([xx, yy, xy]) => {
                let [x, y] = functions.gradient[n].map(|g| g * coefficient);
                let mixed = fault!("tensor-without-its-mixed-term", xy => 0.0);
                [x * xx + y * mixed, x * mixed + y * yy]
            }
        };
    }
    let mut pair = 0;
    for m in 0..count {
        for n in m..count {
            pairs[pair] += match form {
                Integrand::Mass => functions.value[m] * scaled[n][0],
                Integrand::Diffusion | Integrand::Anisotropic(_) => {
                    functions.gradient[m][0] * scaled[n][0] + functions.gradient[m][1] * scaled[n][1]
                }
            };
            pair += 1;
        }
    }
}

/// Adds the form of a strip of cut spans to its `window` of the matrix, which begins at control row
/// `first_row`.
pub(super) fn assemble_cut<C: PointCoefficients>(
    lattice: &Lattice,
    form: Integrand,
    coefficients: &C,
    strip: usize,
    first_row: usize,
    window: &mut [f64],
) {
    let span = lattice.points_per_span();
    let mut scaled = [Lane::ZERO; MAX_POINTS * MAX_POINTS];
    let count = (lattice.degree[0] + 1) * (lattice.degree[1] + 1);
    let mut pairs = vec![Lane::ZERO; count * (count + 1) / 2];
    for (number, batches) in lattice.cut_strip(strip).chunks(span).enumerate() {
        let first = strip * lattice.strip_batches() + number * span;
        let weights: Vec<Lane> = batches.iter().map(|batch| batch.weight).collect();
        if !coefficients.span(first, &weights, &mut scaled[..span]) {
            continue;
        }
        pairs.fill(Lane::ZERO);
        for (n, batch) in batches.iter().enumerate() {
            add_point(&lattice.shape_functions(first + n), form, scaled[n], count, &mut pairs);
            if batches.get(n + 1).is_none_or(|next| next.first != batch.first) {
                scatter(lattice, batch.first, &pairs, first_row, |pair, at| {
                    window[at] += fault!("cut-phase-field-of-one-point", pair.sum() => pair[0]);
                });
                pairs.fill(Lane::ZERO);
            }
        }
    }
}

/// Gives the pairs of a span, by the column and row of its first function, to the couplings of the half
/// stencil.
fn scatter(
    lattice: &Lattice,
    [column, row]: [usize; 2],
    pairs: &[Lane],
    first_row: usize,
    mut add: impl FnMut(Lane, usize),
) {
    let [p, q] = lattice.degree;
    let stride = lattice.grid.stride;
    let couplings = p + 1 + q * (2 * p + 1);
    let count = (p + 1) * (q + 1);
    let mut pair = 0;
    for m in 0..count {
        let control_row = row + m / (p + 1) - first_row;
        let base = control_row * couplings * stride + lattice.grid.index(column, 0);
        for n in m..count {
            let (columns, rows) = ((n % (p + 1)) as isize - (m % (p + 1)) as isize, n / (p + 1) - m / (p + 1));
            let ahead = Stencil::offset_index([p, q], columns, rows);
            add(pairs[pair], base + ahead * stride + m % (p + 1));
            pair += 1;
        }
    }
}
