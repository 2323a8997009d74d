//! Gauss points of the spans that a body covers, and their weights in the part inside.

use super::boundary::{MovingBoundary, Piece};
use super::map::{Folded, InverseMap};
use crate::linear_algebra::control_grid::ControlGrid;
use crate::particles::points::{Cell, Strip};
use crate::scene::Layout;
use crate::splines::patch::Patch;
use crate::splines::quadrature::Rule;
use crate::splines::spline::{MAX_DEGREE, ShapeFunctions};

/// Rows of spans in a strip: every second strip has control points of its own.
const STRIP_ROWS: usize = MAX_DEGREE;
/// Parts of a span smaller than this are none, and all but this are all.
const SLIVER: f64 = 1e-11;

/// Most Gauss points per direction in a span that the boundary cuts.
const MOST: usize = 2 * MAX_DEGREE + 1;

/// Gauss points of the spans of a body: p + 1 per direction, and 2 p + 1 where the boundary cuts a span. Only
/// these integrate the products of shape functions over the part inside exactly, so that its mass matrix has
/// no negative eigenvalue however small it is.
#[derive(Debug, Clone)]
pub(crate) struct GaussPoints {
    /// Layout of the control points.
    pub grid: ControlGrid,
    /// Points per direction of a span inside.
    pub count: usize,
    /// Spans of the body; their points are those of [`Self::weights`], x fastest.
    pub cells: Vec<Cell>,
    /// Strips of those spans.
    pub strips: Vec<Strip>,
    /// Area per point, m².
    pub weights: Vec<f64>,
    /// Rules of spans inside and of those that are cut, and shape functions at their points, per direction
    /// and span.
    rules: [Rule; 2],
    tables: [[Vec<Vec<ShapeFunctions>>; 2]; 2],
    /// Lagrange polynomials of the points of a cut span by powers of the local coordinate.
    lagrange: Vec<Vec<f64>>,
    /// Per span: what boundary passes to the right, `∫ ℓ_b dy` over the length of the span.
    passing: Vec<[f64; MOST]>,
    /// Per span that the boundary cuts: `∮ L_a ℓ_b dy` over the area of the span.
    cut: Vec<Option<Box<[f64]>>>,
}

impl GaussPoints {
    /// Tables of a patch, for no body yet.
    pub(crate) fn new(patch: &Patch) -> Self {
        let count = patch.spaces[0].degree() + 1;
        let rules = [count, 2 * count - 1].map(|n| Rule::new(Layout::Gauss, n));
        let table = |rule: &Rule, d: usize| -> Vec<Vec<ShapeFunctions>> {
            let space = &patch.spaces[d];
            let at = |span: usize, t: f64| {
                let s = &space.spans()[span];
                space.shape_functions(span, s.left + t * s.length())
            };
            let spans = 0..space.spans().len();
            spans.map(|span| rule.points.iter().map(|t| at(span, *t)).collect()).collect()
        };
        let spans = patch.spaces[0].spans().len() * patch.spaces[1].spans().len();
        Self {
            grid: patch.control_grid(),
            count,
            cells: Vec::new(),
            strips: Vec::new(),
            weights: Vec::new(),
            tables: rules.each_ref().map(|rule| [table(rule, 0), table(rule, 1)]),
            lagrange: lagrange(&rules[1].points),
            rules,
            passing: vec![[0.0; MOST]; spans],
            cut: vec![None; spans],
        }
    }

    /// Weights inside a boundary that follows the motion.
    ///
    /// # Errors
    /// If the motion has no inverse somewhere on the boundary.
    pub(crate) fn enclose(&mut self, boundary: &mut MovingBoundary, map: &InverseMap<'_>) -> Result<(), Folded> {
        self.passing.fill([0.0; MOST]);
        self.cut.fill(None);
        boundary.follow(map, |piece| self.add(map.patch, &piece))?;
        self.list(map.patch);
        Ok(())
    }

    /// Whether the boundary cuts a span of the body.
    #[inline(always)]
    pub(crate) fn is_cut(&self, cell: &Cell) -> bool {
        cell.points.len() > self.count * self.count
    }

    /// Shape functions at the Gauss points of a span, in x and in y.
    #[inline(always)]
    pub(crate) fn tables(&self, cell: &Cell) -> [&[ShapeFunctions]; 2] {
        let tables = &self.tables[usize::from(self.is_cut(cell))];
        [&tables[0][cell.span[0]], &tables[1][cell.span[1]]]
    }

    /// Heap memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let tables: usize =
            self.tables.iter().flatten().flatten().map(|span| span.len() * size_of::<ShapeFunctions>()).sum();
        let lists = self.cells.len() * size_of::<Cell>() + self.passing.len() * size_of::<[f64; MOST]>();
        tables + lists + 8 * self.weights.len()
    }

    /// Control points whose functions see a part of the body.
    pub(crate) fn marks(&self, grid: ControlGrid) -> Vec<bool> {
        let mut marks = vec![false; grid.len()];
        for cell in &self.cells {
            for l in 0..self.count {
                marks[grid.index(cell.first[0], cell.first[1] + l)..][..self.count].fill(true);
            }
        }
        marks
    }

    fn add(&mut self, patch: &Patch, piece: &Piece<'_>) {
        let Self { lagrange, passing, cut, .. } = self;
        let n = lagrange.len();
        let [i, j] = piece.span;
        let spans = [&patch.spaces[0].spans()[i], &patch.spaces[1].spans()[j]];
        let at = j * patch.spaces[0].spans().len() + i;
        let cut = cut[at].get_or_insert_with(|| vec![0.0; n * n].into_boxed_slice());
        for (x, dy) in piece.points {
            let t = [0, 1].map(|d: usize| (x[d] - spans[d].left) / spans[d].length());
            let dy = dy / spans[1].length();
            let left: Vec<f64> = lagrange.iter().map(|polynomial| integral(polynomial, t[0])).collect();
            for (b, polynomial) in lagrange.iter().enumerate() {
                let across = dy * value(polynomial, t[1]);
                passing[at][b] += across;
                cut[b * n..][..n].iter_mut().zip(&left).for_each(|(cut, left)| *cut += across * left);
            }
        }
    }

    /// Cells, strips and weights from what the boundary left.
    fn list(&mut self, patch: &Patch) {
        let Self { count, cells, strips, weights, rules: [inside_rule, cut_rule], passing, cut, .. } = self;
        let [columns, rows] = [0, 1].map(|d| patch.spaces[d].spans());
        cells.clear();
        strips.clear();
        weights.clear();
        let mut found = Vec::new();
        for index in 0..rows.len().div_ceil(STRIP_ROWS) {
            let rows_of = index * STRIP_ROWS..((index + 1) * STRIP_ROWS).min(rows.len());
            let (first_cell, first_point) = (cells.len(), weights.len());
            for j in rows_of.clone() {
                let mut beyond = [0.0; MOST];
                found.clear();
                for i in (0..columns.len()).rev() {
                    let at = j * columns.len() + i;
                    let area = columns[i].length() * rows[j].length();
                    let n = cut_rule.weights.len();
                    let part = cut[at].as_ref().map(|cut| {
                        let full = beyond[..n].iter().flat_map(|b| cut_rule.weights.iter().map(move |a| a * b));
                        let inside = |part: f64| fault!("cut-spans-half-way", part => 0.5 * part);
                        full.zip(cut).map(|(full, part)| area * (full + inside(*part))).collect::<Vec<f64>>()
                    });
                    let covered = part.as_ref().map_or_else(
                        || beyond[..n].iter().sum::<f64>().round(),
                        |part| part.iter().sum::<f64>() / area,
                    );
                    if covered > SLIVER {
                        found.push((i, area, part.filter(|_| (1.0 - covered).abs() >= SLIVER)));
                    }
                    (0..n).for_each(|b| beyond[b] += passing[at][b]);
                }
                for (i, area, part) in found.iter().rev() {
                    let first = weights.len();
                    match part {
                        Some(part) => weights.extend_from_slice(part),
                        None => weights.extend(
                            inside_rule
                                .weights
                                .iter()
                                .flat_map(|b| inside_rule.weights.iter().map(move |a| area * a * b)),
                        ),
                    }
                    let points = first..weights.len();
                    cells.push(Cell { span: [*i, j], first: [columns[*i].first, rows[j].first], points });
                }
            }
            if cells.len() > first_cell {
                strips.push(Strip {
                    index,
                    cells: first_cell..cells.len(),
                    points: first_point..weights.len(),
                    control_rows: rows[rows_of.start].first..rows[rows_of.end - 1].first + *count,
                });
            }
        }
    }
}

/// Lagrange polynomials of some points, by powers.
fn lagrange(points: &[f64]) -> Vec<Vec<f64>> {
    let one = |own: usize| {
        let mut polynomial = vec![1.0];
        for (other, t) in points.iter().enumerate().filter(|(other, _)| *other != own) {
            let scale = 1.0 / (points[own] - points[other]);
            let mut next = vec![0.0; polynomial.len() + 1];
            for (m, c) in polynomial.iter().enumerate() {
                next[m + 1] += scale * c;
                next[m] -= scale * c * t;
            }
            polynomial = next;
        }
        polynomial
    };
    (0..points.len()).map(one).collect()
}

fn value(polynomial: &[f64], t: f64) -> f64 {
    polynomial.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// Integral from 0 to t.
fn integral(polynomial: &[f64], t: f64) -> f64 {
    polynomial.iter().enumerate().rev().fold(0.0, |sum, (m, c)| (sum * t) + c / (m + 1) as f64) * t
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::updated_frame::gauss::boundary::edges;
    use crate::scene::{Mesh, Shape};

    /// Sum over the Gauss points of `x^a y^b` inside a shape at rest.
    fn moment(shape: &Shape, degree: usize, [a, b]: [i32; 2]) -> f64 {
        let mesh = Mesh::uniform([degree; 2], [-1.5, -1.4], [3.0, 2.8], [13, 11]);
        let patch = Patch::new(&mesh);
        let mut gauss = GaussPoints::new(&patch);
        let zeros = [gauss.grid.zeros(), gauss.grid.zeros()];
        let map = InverseMap::new(&patch, &zeros, [0.0; 2]);
        let mut boundary = MovingBoundary::new(edges(shape, &mesh).unwrap(), patch.shortest_span(), degree);
        gauss.enclose(&mut boundary, &map).unwrap();
        let mut sum = 0.0;
        for cell in &gauss.cells {
            let rule = &gauss.rules[usize::from(gauss.is_cut(cell))].points;
            for (n, weight) in gauss.weights[cell.points.clone()].iter().enumerate() {
                let at = [n % rule.len(), n / rule.len()];
                let x = [0, 1].map(|d: usize| {
                    let span = &patch.spaces[d].spans()[cell.span[d]];
                    span.left + rule[at[d]] * span.length()
                });
                sum += weight * x[0].powi(a) * x[1].powi(b);
            }
        }
        sum
    }

    #[test]
    fn a_boundary_that_just_crosses_a_knot_and_turns_back_is_divided_there() {
        // The mesh of `moment` has a knot at y = 0.89090909…; the disc reaches beyond it by `past`.
        let knot = -1.4 + 9.0 * 2.8 / 11.0;
        for past in [1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 0.0, -1e-9] {
            let radius = 0.9;
            let disk = Shape::Disk { center: [0.1, knot + past - radius], radius };
            for degree in [2, 3] {
                let area = moment(&disk, degree, [0, 0]);
                let exact = std::f64::consts::PI * radius * radius;
                assert!((area - exact).abs() <= 1e-8, "p = {degree}, {past:e}: {area} instead of {exact}");
            }
        }
    }

    #[test]
    fn what_a_boundary_encloses_is_integrated_up_to_the_degree() {
        let rectangle = Shape::Rectangle { min: [-0.71, -0.33], max: [0.64, 1.05] };
        let triangle = Shape::Polygon { points: vec![[0.9, -0.8], [-1.1, -0.6], [0.2, 1.1]] };
        let disk = Shape::Disk { center: [0.1, -0.2], radius: 0.9 };
        let ring = Shape::Annulus { center: [0.0; 2], inner_radius: 0.4, outer_radius: 1.1 };
        let power = |from: f64, to: f64, n: i32| (to.powi(n + 1) - from.powi(n + 1)) / f64::from(n + 1);
        let pi = std::f64::consts::PI;
        for degree in [2, 3] {
            for [a, b] in [[0, 0], [1, 0], [0, 1], [2, 0], [1, 2], [2, 2]] {
                let exact = power(-0.71, 0.64, a) * power(-0.33, 1.05, b);
                assert!((moment(&rectangle, degree, [a, b]) - exact).abs() <= 1e-13, "{a} {b}");
            }
            let area = 1.83; // half of (−2, 0.2) × (−0.7, 1.9)
            assert!((moment(&triangle, degree, [0, 0]) - area).abs() <= 1e-12);
            // pieces of circles are integrated by Gauss points along them, not exactly
            let near = |found: f64, exact: f64| assert!((found - exact).abs() <= 1e-8, "{found} instead of {exact}");
            near(moment(&disk, degree, [0, 0]), pi * 0.81);
            near(moment(&disk, degree, [2, 0]), pi * (0.9_f64.powi(4) / 4.0 + 0.81 * 0.01));
            near(moment(&ring, degree, [0, 0]), pi * (1.21 - 0.16));
            near(moment(&ring, degree, [0, 2]), pi * (1.1_f64.powi(4) - 0.4_f64.powi(4)) / 4.0);
        }
    }
}
