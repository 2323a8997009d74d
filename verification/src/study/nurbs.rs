//! NURBS patches: rational bases on random knots and weights, refinement that changes nothing, exact circles,
//! inverse map.
//!
//! Knots and weights come from a fixed linear congruential sequence: span ratios up to 100, every third inner
//! knot repeated, weights from 0.1 to 10. Basis and gradients are looked at with the full range of weights.
//! Where a geometry is needed, a bent unit square, bend and weights are tamed (powers of the weights) until
//! it is not folded; how far is reported.

use fisura::splines::nurbs::{LocateError, NurbsError, NurbsPatch, RationalFunctions, rational_functions};
use fisura::splines::spline::SplineSpace;

use super::{Case, CaseScene, Findings, StudyError, other};
use crate::extremes::{larger, largest};
use crate::study::random::Random;

const PATCHES: u64 = 20;
const SPANS: usize = 8;
/// Positions in a span, as fractions; the ends are knots.
const FRACTIONS: [f64; 6] = [0.0, 0.11, 0.35, 0.5, 0.72, 1.0];
/// Step of the differences, in span lengths: weights 100 apart make the basis change over a hundredth of a
/// span.
const STEP: f64 = 3e-6;
const ARC_POINTS: usize = 1000;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in 1..=4 {
        let variant = format!("p={degree}");
        let found = findings.compute(|| random_patches(degree))?;
        let mut add = |quantity: &str, value: fn(&Worst) -> f64| {
            findings.add(&variant, quantity, found.as_ref().map(value), None);
        };
        add("partition of unity, largest error", |worst| worst.unity);
        add("sum of gradients, largest error times span length", |worst| worst.gradient_sum);
        add("gradients against differences, largest error times span length", |worst| worst.difference);
        add("linear field, largest error", |worst| worst.linear);
        add("gradient of a linear field, largest error times length", |worst| worst.linear_gradient);
        add("knot insertion, largest change of the geometry", |worst| worst.insertion);
        if degree < 4 {
            add("degree elevation, largest change of the geometry", |worst| worst.elevation);
        }
        add("equal weights against the general path, largest difference", |worst| worst.equal_weights);
        add("affine grid against the general path, largest difference", |worst| worst.affine);
        add("inverse map, largest distance", |worst| worst.inverse);
        add("patches with weights tamed to keep them unfolded", |worst| f64::from(worst.tamed));
        if degree > 1 {
            let arcs = ["quarter annulus", "refined quarter annulus"];
            let quantities = arcs.map(|name| (format!("{name}, largest relative error of a radius"), None));
            findings.measure(&variant, quantities, || circles(degree).map_err(other))?;
        }
    }
    Ok(())
}

/// Degree p in the first direction, 1 + p mod 4 in the second, so that every degree meets another.
fn random_patches(degree: usize) -> Result<Worst, StudyError> {
    let mut worst = Worst::default();
    for seed in 0..PATCHES {
        crate::watch::check()?;
        let mut random = Random::scrambled(seed + 1000 * degree as u64);
        let degrees = [degree, 1 + degree % 4];
        let knots = degrees.map(|p| random.knots(p, SPANS, true));
        let spaces = [0, 1].map(|d| SplineSpace::new(degrees[d], &knots[d]));
        let count = spaces[0].dimension() * spaces[1].dimension();
        let weights: Vec<f64> = (0..count).map(|_| 10f64.powf(2.0 * random.unit() - 1.0)).collect();
        worst.look_at_basis(&spaces, &weights);
        let (patch, tame) = bent(&spaces, &weights).map_err(other)?;
        worst.tamed += u32::from(tame < 1.0);
        worst.look_at_geometry(&patch);
        worst.look_at_refinement(&patch, &mut random).map_err(other)?;
        worst.look_at_fast_paths(&spaces).map_err(other)?;
        worst.look_at_inverse_map(&patch, &mut random).map_err(other)?;
    }
    Ok(worst)
}

/// Square with bent edges on the Greville abscissae, and the factor by which bend and weights were tamed.
fn bent(spaces: &[SplineSpace; 2], weights: &[f64]) -> Result<(NurbsPatch, f64), NurbsError> {
    let degree = [0, 1].map(|d| spaces[d].degree());
    let knots = [0, 1].map(|d| spaces[d].knot_vector());
    let [gx, gy] = [0, 1].map(|d| spaces[d].greville());
    let mut tame = 1.0;
    loop {
        let bend = |u: f64, v: f64| [u + 0.3 * tame * v * v, v + 0.4 * tame * u * (1.0 - u) + 0.2 * tame * u * v];
        let control = gy.iter().flat_map(|&v| gx.iter().map(move |&u| bend(u, v))).collect();
        let tamed = weights.iter().map(|w| w.powf(tame)).collect();
        // Halved spans show folds between the Gauss points of whole ones.
        match NurbsPatch::new(degree, knots, control, tamed).and_then(|patch| patch.subdivide(2).map(|_| patch)) {
            Ok(patch) => return Ok((patch, tame)),
            Err(NurbsError::Folded { .. }) if tame > 1e-3 => tame *= 0.5,
            Err(error) => return Err(error),
        }
    }
}

/// Errors of a quarter annulus of a degree along the arc, as built or raised, and with knots inserted.
fn circles(degree: usize) -> Result<[f64; 2], NurbsError> {
    let mut patch = NurbsPatch::quarter_annulus(1.0, 2.0)?;
    for _ in 2..degree {
        patch = patch.elevate(1)?;
    }
    let mut random = Random::scrambled(degree as u64);
    let new: Vec<f64> = (0..20).map(|_| random.unit()).collect();
    let refined = patch.insert_knots(1, &new)?.insert_knots(0, &new)?;
    Ok([off_circle(&patch), off_circle(&refined)])
}

/// Largest relative error of the radius on the arcs of a quarter annulus of radii 1 and 2.
fn off_circle(patch: &NurbsPatch) -> f64 {
    let mut worst = 0.0_f64;
    for n in 0..=ARC_POINTS {
        for xi in [0.0, 0.5, 1.0] {
            let [x, y] = position(patch, [xi, n as f64 / ARC_POINTS as f64]);
            worst = larger(worst, (x.hypot(y) / (1.0 + xi) - 1.0).abs());
        }
    }
    worst
}

fn functions(patch: &NurbsPatch, parameters: [f64; 2]) -> RationalFunctions {
    patch.shape_functions(patch.find_span(parameters).expect("on the patch"), parameters)
}

fn position(patch: &NurbsPatch, parameters: [f64; 2]) -> [f64; 2] {
    patch.map(&functions(patch, parameters)).position
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

fn sum(f: &RationalFunctions, term: impl Fn(usize) -> f64) -> f64 {
    (0..f.count).map(term).sum()
}

/// A place in a span of some lengths.
struct Place {
    span: [usize; 2],
    parameters: [f64; 2],
    length: [f64; 2],
}

/// Places at fixed fractions of every span.
fn places(spaces: &[SplineSpace; 2]) -> Vec<Place> {
    let mut places = vec![];
    for (j, t) in spaces[1].spans().iter().enumerate() {
        for (i, s) in spaces[0].spans().iter().enumerate() {
            for b in FRACTIONS {
                for a in FRACTIONS {
                    let parameters = [(s, a), (t, b)].map(|(s, a)| (s.left + a * s.length()).min(s.right));
                    places.push(Place { span: [i, j], parameters, length: [s.length(), t.length()] });
                }
            }
        }
    }
    places
}

#[derive(Default)]
struct Worst {
    unity: f64,
    gradient_sum: f64,
    difference: f64,
    linear: f64,
    linear_gradient: f64,
    insertion: f64,
    elevation: f64,
    equal_weights: f64,
    affine: f64,
    inverse: f64,
    tamed: u32,
}

impl Worst {
    fn look_at_basis(&mut self, spaces: &[SplineSpace; 2], weights: &[f64]) {
        for Place { span, parameters, length } in places(spaces) {
            let f = rational_functions(spaces, weights, span, parameters);
            self.unity = larger(self.unity, (sum(&f, |n| f.value[n]) - 1.0).abs());
            for d in 0..2 {
                self.gradient_sum = larger(self.gradient_sum, length[d] * sum(&f, |n| f.gradient[n][d]).abs());
                // Central differences of two steps, extrapolated: error O(step^4). Powers of two, so that the
                // parameters are not rounded to unequal steps on both sides, which the curvature would make
                // an error of first order.
                let difference = |step: f64| {
                    let step = (step * length[d]).log2().round().exp2();
                    let [plus, minus] = [step, -step].map(|step| {
                        let mut moved = parameters;
                        moved[d] += step;
                        rational_functions(spaces, weights, span, moved).value
                    });
                    move |n: usize| (plus[n] - minus[n]) * length[d] / (2.0 * step)
                };
                let (narrow, wide) = (difference(STEP), difference(2.0 * STEP));
                for n in 0..f.count {
                    let slope = (4.0 * narrow(n) - wide(n)) / 3.0;
                    self.difference = larger(self.difference, (length[d] * f.gradient[n][d] - slope).abs());
                }
            }
        }
    }

    /// A linear field, whose length is that over which a basis function changes: one over its largest
    /// physical gradient.
    fn look_at_geometry(&mut self, patch: &NurbsPatch) {
        let value = |[x, y]: [f64; 2]| 3.0 + 2.0 * x - y;
        let field: Vec<f64> = patch.control_points().iter().map(|&p| value(p)).collect();
        for place in places(patch.spaces()) {
            let f = patch.shape_functions(place.span, place.parameters);
            let point = patch.map(&f);
            self.linear = larger(self.linear, (f.interpolate(&field) - value(point.position)).abs());
            let gradient = f.physical_gradients(&point);
            let inverse = largest(point.jacobian.as_flattened().iter().map(|x| x.abs())) / point.determinant();
            let length = 1.0 / (inverse * largest(f.gradient[..f.count].as_flattened().iter().map(|x| x.abs())));
            for (d, expected) in [2.0, -1.0].into_iter().enumerate() {
                let error = (sum(&f, |n| gradient[n][d] * field[f.control[n]]) - expected).abs();
                self.linear_gradient = larger(self.linear_gradient, length * error);
            }
        }
    }

    fn look_at_refinement(&mut self, patch: &NurbsPatch, random: &mut Random) -> Result<(), NurbsError> {
        let new: Vec<f64> = (0..5).map(|_| random.unit()).collect();
        let inserted = patch.insert_knots(0, &new)?.insert_knots(1, &new)?;
        let raised = if patch.spaces()[0].degree() < 4 { Some(patch.elevate(0)?) } else { None };
        for place in places(inserted.spaces()) {
            let before = position(patch, place.parameters);
            self.insertion = larger(self.insertion, distance(position(&inserted, place.parameters), before));
            if let Some(raised) = &raised {
                self.elevation = larger(self.elevation, distance(position(raised, place.parameters), before));
            }
        }
        Ok(())
    }

    /// Values, and gradients times span length, of patches with and without their fast path.
    fn look_at_fast_paths(&mut self, spaces: &[SplineSpace; 2]) -> Result<(), NurbsError> {
        let degree = [0, 1].map(|d| spaces[d].degree());
        let knots = [0, 1].map(|d| spaces[d].knot_vector());
        let affine = NurbsPatch::rectangle(degree, knots, [0.5, -1.0], [2.0, 1.0])?;
        let count = spaces[0].dimension() * spaces[1].dimension();
        let (polynomial, _) = bent(spaces, &vec![0.7; count])?;
        for place in places(spaces) {
            for (patch, worst) in [(&polynomial, &mut self.equal_weights), (&affine, &mut self.affine)] {
                let general = patch.general();
                let [f, g] = [patch, &general].map(|p| p.shape_functions(place.span, place.parameters));
                let [a, b] = [patch.map(&f), general.map(&g)];
                *worst = larger(*worst, distance(a.position, b.position));
                for n in 0..f.count {
                    *worst = larger(*worst, (f.value[n] - g.value[n]).abs());
                }
                for d in 0..2 {
                    let gradients = (0..f.count).map(|n| f.gradient[n][d] - g.gradient[n][d]);
                    let jacobian = (0..2).map(|i| a.jacobian[i][d] - b.jacobian[i][d]);
                    *worst = gradients.chain(jacobian).map(|x| place.length[d] * x.abs()).fold(*worst, larger);
                }
            }
        }
        Ok(())
    }

    /// Images of random parameters, searched from nowhere and from other random parameters.
    fn look_at_inverse_map(&mut self, patch: &NurbsPatch, random: &mut Random) -> Result<(), LocateError> {
        for _ in 0..100 {
            let [at, from] = [[random.unit(), random.unit()], [random.unit(), random.unit()]];
            let point = position(patch, at);
            for start in [None, Some(from)] {
                let found = patch.locate(point, start)?;
                self.inverse = larger(self.inverse, distance(position(patch, found.parameters), point));
            }
        }
        Ok(())
    }
}
