//! Errors against an exact field, integrated over another, finer set of points than those of the body.

use fisura::fault;
use fisura::linear_algebra::lane::LANES;
use fisura::particles::lattice::Lattice;
use fisura::scene::{Body, Layout};
use fisura::splines::patch::Patch;

/// Points per span and direction beyond those of the body.
const FINER: usize = 3;

/// Quadrature points for errors on the patch of a body.
pub(crate) struct ErrorPoints {
    lattice: Lattice,
}

/// Squares of an error and of the exact field, integrated, m² times their units squared.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Squares {
    error: [f64; 2],
    exact: [f64; 2],
}

impl Squares {
    /// Relative error in L2.
    pub fn l2(&self) -> f64 {
        let square = self.error[0] / self.exact[0];
        fault!("norm-without-root", square.sqrt() => square)
    }

    /// Relative error of the gradient in L2: in the H1 seminorm.
    pub fn h1(&self) -> f64 {
        (self.error[1] / self.exact[1]).sqrt()
    }
}

impl std::iter::Sum for Squares {
    fn sum<I: Iterator<Item = Self>>(parts: I) -> Self {
        parts.fold(Self::default(), |sum, part| Self {
            error: [0, 1].map(|i| sum.error[i] + part.error[i]),
            exact: [0, 1].map(|i| sum.exact[i] + part.exact[i]),
        })
    }
}

impl ErrorPoints {
    pub fn new(patch: &Patch, body: &Body) -> Self {
        let most = body.particles_per_cell.into_iter().max().unwrap_or(1);
        let degree = patch.spaces.iter().map(|s| s.degree()).max().unwrap_or(1);
        let finer = Body {
            layout: Layout::Gauss,
            particles_per_cell: [(most.max(degree + 1) + FINER).min(fisura::splines::quadrature::MAX_POINTS); 2],
            ..body.clone()
        };
        Self { lattice: Lattice::new(patch, &finer) }
    }

    /// Area of the body, m².
    pub fn area(&self) -> f64 {
        let mut area = 0.0;
        self.lattice.for_each_point(|_, _, _, weight| area += weight);
        area
    }

    /// A field of control values against an exact field, given as value and gradient at a position.
    pub fn squares(&self, field: &[f64], exact: impl Fn([f64; 2]) -> (f64, [f64; 2])) -> Squares {
        let lattice = &self.lattice;
        let mut sums = Squares::default();
        for batch in 0..lattice.batches() {
            let (value, gradient) = lattice.interpolate(batch, field);
            let weight = lattice.weights_of(batch);
            for lane in (0..LANES).filter(|&lane| weight[lane] > 0.0) {
                let (exact_value, exact_gradient) = exact(lattice.position(batch, lane));
                let square = |x: f64| weight[lane] * x * x;
                sums.error[0] += square(value[lane] - exact_value);
                sums.exact[0] += square(exact_value);
                for d in 0..2 {
                    sums.error[1] += square(gradient[d][lane] - exact_gradient[d]);
                    sums.exact[1] += square(exact_gradient[d]);
                }
            }
        }
        sums
    }

    /// Squares of a vector field whose exact value and gradient (`[i][j]`, of component i along j) are known.
    pub fn vector_squares(
        &self,
        field: &[Vec<f64>; 2],
        exact: impl Fn([f64; 2]) -> ([f64; 2], [[f64; 2]; 2]),
    ) -> Squares {
        let component = |i: usize| {
            let of_component = |x| {
                let (value, gradient) = exact(x);
                (value[i], gradient[i])
            };
            self.squares(&field[i], of_component)
        };
        (0..2).map(component).sum()
    }
}
