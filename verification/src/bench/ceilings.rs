//! What this machine can do, measured in the same run: bandwidth of memory and rate of arithmetic on one
//! thread; and what the elastic sweep and step need of both.
//!
//! Bytes and operations are counted from the code, not by hardware. Per point of a sweep with n × n points
//! per span ([`flops`]): partial sums in x of the one control row that a row of spans adds, sums in y and the
//! physics at the point, and the way back. Bytes count what a step streams through memory if nothing stays in
//! a cache ([`sweep_bytes`]).

use std::hint::black_box;

use fisura::linear_algebra::lane::{Vectorised, add_product, dispatch};
use fisura::particles::points::Point;
use fisura::transfer::sweep::StripForces;

use super::block::Block;
use super::record::BenchRecord;
use super::timing::{Contestant, pool, round_robin};
use super::{BenchError, Settings};
use crate::extremes::largest;

/// Points per span and direction.
const POINTS: usize = 2;
/// Numbers whose polynomials are evaluated: few enough for the innermost cache, enough for every vector unit.
const NUMBERS: usize = 512;
/// Multiply-adds of each number between its load and its store.
const DEGREE: usize = 32;
/// Evaluations of each polynomial in a call.
const REPEATS: usize = 100;
/// Stress, energy and weight of a point.
const PHYSICS: f64 = 28.0;

/// Measures the ceilings and the elastic sweep below them.
///
/// # Errors
/// If a block cannot be prepared.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let (numbers, cells) = if settings.quick { (8 << 20, 128) } else { (32 << 20, 256) };
    pool(1)?.install(|| {
        let blocks = [Block::new(2, POINTS, cells, 0)?, Block::new(3, POINTS, cells, 0)?];
        let mut contestants = vec![triad(numbers), multiply_add()];
        contestants.extend(blocks.iter().map(elastic_sweep));
        round_robin(contestants, settings.rounds(), settings.budget())
    })
}

/// Three arrays far larger than any cache: `a = b + s c`, counted as 24 bytes a number; the line of `a` that
/// is read before it is written is not counted, as is customary.
fn triad(numbers: usize) -> Contestant<'static> {
    let (mut a, b, c) = (vec![0.0; numbers], vec![1.0; numbers], vec![2.0; numbers]);
    let mut record = BenchRecord::new("ceilings/triad", "memory bandwidth (triad)", 24.0 * numbers as f64, "byte");
    record.memory_bytes = 24 * numbers as u64;
    let mut add = move || {
        let s = black_box(3.0);
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = b + s * c;
        }
        black_box(a[numbers / 2])
    };
    let value = add();
    record.verify(value == 7.0, format!("1 + 3 · 2 = {value}"));
    Contestant::short(record, move || {
        black_box(add());
    })
}

/// Polynomials in Horner's form of numbers in the innermost cache, compiled as the sweeps are: the numbers do
/// not depend on each other, and a load and a store are shared by [`DEGREE`] multiply-adds.
struct Polynomials<'a> {
    numbers: &'a mut [f64],
    factor: f64,
}

impl Vectorised for Polynomials<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const FMA: bool>(self) {
        for _ in 0..REPEATS {
            for number in &mut *self.numbers {
                for _ in 0..DEGREE {
                    *number = add_product::<FMA, _>(1.0, *number, self.factor);
                }
            }
        }
    }
}

fn multiply_add() -> Contestant<'static> {
    let flops = (2 * NUMBERS * DEGREE * REPEATS) as f64;
    let mut record = BenchRecord::new("ceilings/multiply-add", "arithmetic (multiply-add)", flops, "flop");
    let mut numbers = vec![0.0; NUMBERS];
    let mut evaluate = move || {
        dispatch(Polynomials { numbers: black_box(&mut numbers), factor: black_box(0.5) });
        black_box(largest(numbers.iter().map(|number| (number - 2.0).abs())))
    };
    record.verify_at_most("limit of x ← 1 + x/2, less 2", evaluate(), 1e-14);
    Contestant::short(record, move || {
        evaluate();
    })
}

fn elastic_sweep(block: &Block) -> Contestant<'_> {
    let degree = block.lattice.degree[0];
    let mut strips = StripForces::new(&block.lattice);
    block.elastic_sweep(&mut strips);
    let name = format!("ceilings/elastic-sweep/p{degree}");
    let mut record =
        BenchRecord::new(name, format!("elastic sweep, p = {degree}"), block.points as f64, "particle-step")
            .with("degree", degree)
            .with("flops_per_point", flops(degree, POINTS))
            .with("bytes_per_point", sweep_bytes(POINTS))
            .with("bytes_per_point_of_moving_points", 3.0 * size_of::<Point>() as f64);
    record.verify_at_most("total of the forces over their size", block.force_imbalance(&strips), 1e-12);
    Contestant::short(record, move || block.elastic_sweep(&mut strips))
}

/// Floating-point operations of an elastic sweep per point, of degree `p` with `n` × `n` points per span.
pub fn flops(p: usize, n: usize) -> f64 {
    let (k, n) = ((p + 1) as f64, n as f64);
    let along_x = 2.0 * 4.0 * n * k + (2.0 * 4.0 * n + 2.0) * k; // to the points, and back to two components
    let along_y = 2.0 * 4.0 * k + 2.0 * 4.0 * k;
    along_x / (n * n) + along_y + PHYSICS
}

/// Bytes an elastic sweep streams per point, with `n` × `n` points per span: two displacements read, two
/// forces set to zero, read and written.
pub fn sweep_bytes(n: usize) -> f64 {
    (2.0 * 8.0 + 2.0 * 3.0 * 8.0) / (n * n) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_are_counted_per_point() {
        assert_eq!(flops(2, 2), (48.0 + 54.0) / 4.0 + 48.0 + 28.0);
        assert_eq!(flops(3, 2), (64.0 + 72.0) / 4.0 + 64.0 + 28.0);
        assert_eq!(sweep_bytes(2), 16.0);
    }
}
