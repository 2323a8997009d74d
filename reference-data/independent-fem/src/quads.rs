//! Meshes of quadrilaterals that follow a shape, and what the Gauss points of bilinear elements need.

use std::collections::BTreeMap;

use crate::element::{HIGH, LOW};

/// Nodes and elements; corners counter-clockwise.
#[derive(Debug, Clone, Default)]
pub struct Quads {
    /// Places of the nodes, m.
    pub nodes: Vec<[f64; 2]>,
    /// Nodes of the elements.
    pub elements: Vec<[usize; 4]>,
}

/// A round hole in a tensor-product mesh: the elements of a square about it run to the circle.
#[derive(Debug, Clone, Copy)]
pub struct Hole {
    /// Centre, m.
    pub centre: [f64; 2],
    /// Radius, m.
    pub radius: f64,
    /// Half the side of the square, whose sides are node lines, m.
    pub half: f64,
    /// Elements between the square and the circle.
    pub layers: usize,
}

impl Quads {
    /// A rectangle between node lines.
    pub fn between(x: &[f64], y: &[f64]) -> Self {
        let nodes = y.iter().flat_map(|&y| x.iter().map(move |&x| [x, y])).collect();
        let columns = x.len();
        let element = |i: usize, j: usize| {
            let first = j * columns + i;
            [first, first + 1, first + columns + 1, first + columns]
        };
        let elements = (0..y.len() - 1).flat_map(|j| (0..columns - 1).map(move |i| element(i, j))).collect();
        Self { nodes, elements }
    }

    /// A whole ring about the origin: elements over the thickness and around.
    pub fn ring(inner: f64, outer: f64, [over, around]: [usize; 2]) -> Self {
        let place = |i: usize, k: usize| {
            let (radius, angle) =
                (inner + (outer - inner) * i as f64 / over as f64, std::f64::consts::TAU * k as f64 / around as f64);
            [radius * angle.cos(), radius * angle.sin()]
        };
        let nodes = (0..around).flat_map(|k| (0..=over).map(move |i| place(i, k))).collect();
        let node = |i: usize, k: usize| (k % around) * (over + 1) + i;
        let element = |i: usize, k: usize| [node(i, k), node(i + 1, k), node(i + 1, k + 1), node(i, k + 1)];
        let elements = (0..around).flat_map(|k| (0..over).map(move |i| element(i, k))).collect();
        Self { nodes, elements }
    }

    /// Cuts a hole into a mesh that came from [`Self::between`].
    pub fn cut(&mut self, x: &[f64], y: &[f64], hole: Hole) {
        let line = |lines: &[f64], at: f64| {
            let distance = |k: &usize| (lines[*k] - at).abs();
            (0..lines.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
        };
        let [left, right] = [-1.0, 1.0].map(|sign| line(x, hole.centre[0] + sign * hole.half));
        let [lower, upper] = [-1.0, 1.0].map(|sign| line(y, hole.centre[1] + sign * hole.half));
        let node = |i: usize, j: usize| j * x.len() + i;
        let square: Vec<usize> = (left..right)
            .map(|i| node(i, lower))
            .chain((lower..upper).map(|j| node(right, j)))
            .chain((left + 1..=right).rev().map(|i| node(i, upper)))
            .chain((lower + 1..=upper).rev().map(|j| node(left, j)))
            .collect();
        let inside = |p: [f64; 2]| (0..2).all(|d| (p[d] - hole.centre[d]).abs() < hole.half);
        let nodes = &self.nodes;
        self.elements.retain(|corners| {
            let centre = [0, 1].map(|d| corners.iter().map(|&n| 0.25 * nodes[n][d]).sum());
            !inside(centre)
        });
        let mut outer = square.clone();
        for layer in 1..=hole.layers {
            let first = self.nodes.len();
            for &n in &square {
                let arm = [0, 1].map(|d| self.nodes[n][d] - hole.centre[d]);
                let part = layer as f64 / hole.layers as f64;
                let scale = 1.0 - part + part * hole.radius / arm[0].hypot(arm[1]);
                self.nodes.push([0, 1].map(|d| hole.centre[d] + scale * arm[d]));
            }
            let inner: Vec<usize> = (first..self.nodes.len()).collect();
            for k in 0..square.len() {
                let next = (k + 1) % square.len();
                self.elements.push([outer[k], outer[next], inner[next], inner[k]]);
            }
            outer = inner;
        }
    }

    /// Removes the elements whose centre is `gone`, and nodes that no element has.
    pub fn without(mut self, gone: impl Fn([f64; 2]) -> bool) -> Self {
        let nodes = &self.nodes;
        self.elements.retain(|corners| !gone([0, 1].map(|d| corners.iter().map(|&n| 0.25 * nodes[n][d]).sum())));
        let mut number = BTreeMap::new();
        for corner in self.elements.iter().flatten() {
            number.entry(*corner).or_insert(0);
        }
        number.values_mut().enumerate().for_each(|(k, number)| *number = k);
        Self {
            nodes: number.keys().map(|&n| self.nodes[n]).collect(),
            elements: self.elements.iter().map(|corners| corners.map(|n| number[&n])).collect(),
        }
    }

    /// Sides that one element has, with the body on their left.
    pub fn boundary(&self) -> Vec<[usize; 2]> {
        let mut sides = BTreeMap::new();
        for corners in &self.elements {
            for k in 0..4 {
                let [a, b] = [corners[k], corners[(k + 1) % 4]];
                sides.entry([a.min(b), a.max(b)]).or_insert_with(Vec::new).push([a, b]);
            }
        }
        sides.into_values().filter(|of| of.len() == 1).flatten().collect()
    }
}

/// A Gauss point: slopes of the four corner functions along x and y (1/m), their values, area (m²).
#[derive(Debug, Clone, Copy)]
pub struct GaussPoint {
    /// Gradients of the functions, 1/m.
    pub slopes: [[f64; 2]; 4],
    /// Values of the functions.
    pub values: [f64; 4],
    /// Area that the point stands for, m².
    pub area: f64,
}

/// The 2 × 2 Gauss points of an element.
///
/// # Panics
/// If the element is turned inside out.
pub fn gauss_points(corners: [[f64; 2]; 4]) -> [GaussPoint; 4] {
    [[LOW, LOW], [HIGH, LOW], [HIGH, HIGH], [LOW, HIGH]].map(|[s, t]| {
        let values = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
        let reference = [[t - 1.0, s - 1.0], [1.0 - t, -s], [t, s], [-t, 1.0 - s]];
        let sum = |of: usize, along: usize| (0..4).map(|k| reference[k][along] * corners[k][of]).sum::<f64>();
        let [[xs, xt], [ys, yt]] = [0, 1].map(|of| [0, 1].map(|along| sum(of, along)));
        let determinant = xs * yt - xt * ys;
        assert!(determinant > 0.0, "an element is turned inside out");
        let slope = |[s, t]: [f64; 2]| [(s * yt - t * ys) / determinant, (t * xs - s * xt) / determinant];
        GaussPoint { slopes: reference.map(slope), values, area: 0.25 * determinant }
    })
}
