//! The background patch (E 13): a tensor product of two spline spaces.
//!
//! Over a rectangle the knots are coordinates in metres. Any other patch has a [`NurbsPatch`] as its
//! geometry, and its knots are parameters.

use std::ops::Range;

use crate::linear_algebra::control_grid::ControlGrid;
use crate::linear_algebra::extremes::{around, smaller};
use crate::scene::{Geometry, Mesh, Side};
use crate::splines::nurbs::locate::Location;
use crate::splines::nurbs::{NurbsError, NurbsPatch, PointValue, RationalFunctions, products};
use crate::splines::quadrature::Rule;
use crate::splines::spline::SplineSpace;

/// Tensor-product patch.
#[derive(Debug, Clone)]
pub struct Patch {
    /// Spline spaces of the two parametric directions: x and y, on knots in metres, over a rectangle.
    pub spaces: [SplineSpace; 2],
    /// Geometry of a patch that is not a rectangle.
    pub geometry: Option<Box<NurbsPatch>>,
}

impl Patch {
    /// The patch of a mesh.
    ///
    /// # Panics
    /// If the mesh is not valid (see [`crate::validate::validate`]).
    pub fn new(mesh: &Mesh) -> Self {
        Self {
            spaces: [0, 1].map(|d| SplineSpace::new(mesh.degree[d], &mesh.knots[d])),
            geometry: mesh.nurbs().map(|patch| Box::new(patch.expect("the geometry of a valid mesh"))),
        }
    }

    /// The part of a patch over a rectangle that some neighbouring spans in x and y cover.
    pub fn part(&self, spans: &[Range<usize>; 2]) -> Self {
        debug_assert!(self.geometry.is_none(), "parts are taken of rectangles");
        Self { spaces: [0, 1].map(|d| self.spaces[d].part(spans[d].clone())), geometry: None }
    }

    /// Layout of fields on its control points.
    pub fn control_grid(&self) -> ControlGrid {
        let [columns, rows] = [0, 1].map(|d| self.spaces[d].dimension());
        ControlGrid::new(columns, rows)
    }

    /// Coordinates (m) of the control points, as fields: the control values of x and of y.
    pub fn control_positions(&self) -> [Vec<f64>; 2] {
        let grid = self.control_grid();
        let mut positions = [grid.zeros(), grid.zeros()];
        let greville = [0, 1].map(|d| self.spaces[d].greville());
        for (n, at) in grid.indices().enumerate() {
            let point = match &self.geometry {
                None => [greville[0][grid.column_of(at)], greville[1][grid.row_of(at)]],
                Some(geometry) => geometry.control_points()[n],
            };
            for d in 0..2 {
                positions[d][at] = point[d];
            }
        }
        positions
    }

    /// Lower left and upper right corner of the box around the control points, m.
    pub fn bounding_box(&self) -> ([f64; 2], [f64; 2]) {
        let [x, y] = self.control_positions();
        around(self.control_grid().indices().map(|at| [[x[at], y[at]]; 2])).into()
    }

    /// Length of the shortest span in the parameters, m where the patch has no geometry.
    pub(crate) fn shortest_span(&self) -> f64 {
        let spans = self.spaces.iter().flat_map(|space| space.spans());
        spans.map(|span| span.length()).fold(f64::INFINITY, smaller)
    }

    /// Length of the span at a position (m) in a direction of unit length, m; `None` outside the patch.
    pub(crate) fn span_across(&self, position: [f64; 2], direction: [f64; 2]) -> Option<f64> {
        let at = self.locate(position)?;
        let [x, y] = [0, 1].map(|d| self.spaces[d].spans()[at.span[d]].length());
        let [[xx, xy], [yx, yy]] = match &self.geometry {
            None => [[1.0, 0.0], [0.0, 1.0]],
            Some(patch) => patch.map(&patch.shape_functions(at.span, at.parameters)).jacobian,
        };
        let part = |column: [f64; 2]| (column[0] * direction[0] + column[1] * direction[1]).abs();
        Some(x * part([xx, yx]) + y * part([xy, yy]))
    }

    /// Points along a side with a rule in every span of it.
    pub fn boundary(&self, side: Side, rule: &Rule) -> Vec<BoundaryPoint> {
        self.boundary_cut(side, rule, &[])
    }

    /// Points along a side with a rule in every part of a span between `cuts`, in increasing order.
    pub(crate) fn boundary_cut(&self, side: Side, rule: &Rule, cuts: &[f64]) -> Vec<BoundaryPoint> {
        let (across, upper) = side.axis();
        let along = 1 - across;
        let ends = self.spaces[across].spans();
        let (fixed_span, fixed) = if upper { (ends.len() - 1, ends[ends.len() - 1].right) } else { (0, ends[0].left) };
        let sign = if upper { 1.0 } else { -1.0 };
        let mut points = Vec::new();
        let parts = self.spaces[along].spans().iter().enumerate().flat_map(|(index, span)| {
            let inner = cuts.iter().copied().filter(|x| (span.left..span.right).contains(x) && *x > span.left);
            let ends: Vec<f64> = std::iter::once(span.left).chain(inner).chain([span.right]).collect();
            ends.windows(2).map(|ends| (index, ends[0], ends[1] - ends[0])).collect::<Vec<_>>()
        });
        for (index, left, part) in parts {
            for (t, weight) in rule.points.iter().zip(&rule.weights) {
                let (mut at, mut parameters) = ([fixed_span; 2], [fixed; 2]);
                at[along] = index;
                parameters[along] = left + t * part;
                let tangent = match &self.geometry {
                    None => [0, 1].map(|i| f64::from(u8::from(i == along))),
                    Some(patch) => patch.map(&patch.shape_functions(at, parameters)).jacobian.map(|row| row[along]),
                };
                let speed = tangent[0].hypot(tangent[1]);
                // The tangent of the first direction has the patch to its left, that of the second to its
                // right.
                let turn = if along == 0 { -sign } else { sign };
                points.push(BoundaryPoint {
                    normal: [turn * tangent[1] / speed, -turn * tangent[0] / speed],
                    length: weight * part * speed,
                    functions: self.functions(Location { span: at, parameters }),
                });
            }
        }
        points
    }
}

/// Values of shape functions with their control points as indices of fields.
fn on_grid(grid: ControlGrid, functions: &RationalFunctions) -> Vec<(usize, f64)> {
    let index = |control: usize| grid.index(control % grid.columns, control / grid.columns);
    (0..functions.count).map(|n| (index(functions.control[n]), functions.value[n])).collect()
}

/// Indices of the control points on a side, in increasing order.
pub fn control_points_on(side: Side, grid: ControlGrid) -> Vec<usize> {
    let ((across, upper), counts) = (side.axis(), [grid.columns, grid.rows]);
    let end = if upper { counts[across] - 1 } else { 0 };
    let at = |along: usize| if across == 0 { grid.index(end, along) } else { grid.index(along, end) };
    (0..counts[side.along()]).map(at).collect()
}

impl Mesh {
    /// The mesh of a patch, as a general one.
    pub fn of(patch: &NurbsPatch) -> Self {
        let [x, y] = patch.spaces();
        let (control_points, weights) = (patch.control_points().to_vec(), patch.weights().to_vec());
        Self {
            degree: [x.degree(), y.degree()],
            knots: [x.knot_vector().to_vec(), y.knot_vector().to_vec()],
            geometry: Some(Geometry { control_points, weights }),
            halvings: 0,
        }
    }

    /// The patch of the geometry, if there is one.
    pub fn nurbs(&self) -> Option<Result<NurbsPatch, NurbsError>> {
        let geometry = self.geometry.as_ref()?;
        let knots = [&self.knots[0][..], &self.knots[1][..]];
        Some(NurbsPatch::new(self.degree, knots, geometry.control_points.clone(), geometry.weights.clone()))
    }
}

/// A point on a side of a patch.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundaryPoint {
    /// Outward unit normal.
    pub normal: [f64; 2],
    /// Length it stands for, m.
    pub length: f64,
    /// Its position, and the shape functions there.
    pub functions: PointFunctions,
}

impl Patch {
    /// A field of control values at a position (m); `None` outside the patch.
    pub fn evaluate(&self, field: &[f64], position: [f64; 2]) -> Option<PointValue> {
        Some(self.functions_at(position)?.interpolate(field))
    }

    /// Shape functions at a position (m); `None` outside the patch.
    pub(crate) fn functions_at(&self, position: [f64; 2]) -> Option<PointFunctions> {
        Some(self.functions(self.locate(position)?))
    }

    /// Span and parameters of a position (m); `None` outside the patch.
    pub fn locate(&self, position: [f64; 2]) -> Option<Location> {
        match &self.geometry {
            None => {
                let span = [self.spaces[0].find_span(position[0])?, self.spaces[1].find_span(position[1])?];
                Some(Location { span, parameters: position })
            }
            Some(patch) => patch.locate(position, None).ok(),
        }
    }

    /// Control point of the first function that does not vanish in a span.
    pub(crate) fn first_function(&self, span: [usize; 2]) -> usize {
        let [column, row] = [0, 1].map(|d| self.spaces[d].spans()[span[d]].first);
        self.control_grid().index(column, row)
    }

    /// Whether something `holds` for all control points whose functions do not vanish in a span.
    pub(crate) fn all_functions(&self, span: [usize; 2], holds: impl Fn(usize) -> bool) -> bool {
        let grid = self.control_grid();
        let [columns, rows] = [0, 1].map(|d| {
            let first = self.spaces[d].spans()[span[d]].first;
            first..=first + self.spaces[d].degree()
        });
        rows.into_iter().all(|row| columns.clone().all(|column| holds(grid.index(column, row))))
    }

    /// Shape functions at a place.
    pub(crate) fn functions(&self, Location { span, parameters }: Location) -> PointFunctions {
        let (functions, position, gradient) = match &self.geometry {
            None => {
                let functions = products(&self.spaces, span, parameters);
                (functions, parameters, functions.gradient)
            }
            Some(patch) => {
                let functions = patch.shape_functions(span, parameters);
                let image = patch.map(&functions);
                (functions, image.position, functions.physical_gradients(&image))
            }
        };
        let values = on_grid(self.control_grid(), &functions);
        PointFunctions { position, values, gradients: gradient[..functions.count].to_vec() }
    }
}

/// Shape functions at a position.
#[derive(Debug, Clone, PartialEq)]
pub struct PointFunctions {
    /// Position where the functions are evaluated, m.
    pub position: [f64; 2],
    /// Index in a field and value of those that do not vanish.
    pub values: Vec<(usize, f64)>,
    /// Their gradients, 1/m.
    pub gradients: Vec<[f64; 2]>,
}

impl PointFunctions {
    /// Takes control points that lie this far behind in fields.
    pub(crate) fn lift(&mut self, distance: usize) {
        self.values.iter_mut().for_each(|(at, _)| *at += distance);
    }

    /// A field of control values.
    pub(crate) fn interpolate(&self, field: &[f64]) -> PointValue {
        let mut result = PointValue::default();
        for (&(at, value), gradient) in self.values.iter().zip(&self.gradients) {
            result.value += value * field[at];
            for d in 0..2 {
                result.gradient[d] += gradient[d] * field[at];
            }
        }
        result
    }
}
