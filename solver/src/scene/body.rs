//! Bodies of a scene, their materials and initial cracks.

use std::f64::consts::FRAC_2_PI;

use super::condition::{EdgeCondition, Traction};
use super::shape::{Shape, distance_to_segment};
use super::time::TimeFactor;
use super::toughness::{Anisotropy, RandomToughness};
use crate::linear_algebra::extremes::smaller;

/// Isotropic linear elastic material, brittle if it has a fracture table.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Young's modulus, Pa.
    pub young_modulus: f64,
    /// Poisson's ratio ν, without a unit.
    pub poisson_ratio: f64,
    /// Density of the undeformed material, kg/m³.
    pub density: f64,
    /// Brittle fracture, if modelled.
    pub fracture: Option<Fracture>,
}

/// Which part of the elastic energy drives and feels the phase field.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Split {
    /// Tensile part by principal strains (Miehe et al. 2010).
    Spectral,
    /// Expansion and distortion (Amor et al. 2009).
    VolumetricDeviatoric,
    /// Expansion and distortion, less this times the energy of compression (Vicentini et al. 2024).
    StarConvex(f64),
    /// Driven by the largest principal stress; all of the energy is degraded (Wu 2017).
    Rankine,
    /// No split: all of the elastic energy drives the phase field, and all of it is degraded.
    None,
}

/// How the stress across a cohesive crack falls with its opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Softening {
    /// The stress falls linearly to zero.
    Linear,
    /// The stress decays exponentially.
    Exponential,
    /// As in concrete (Cornelissen et al. 1986).
    Cornelissen,
}

impl Softening {
    /// Its word in scenes.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Exponential => "exponential",
            Self::Cornelissen => "cornelissen",
        }
    }
}

/// Which surface energy a crack has, and how it degrades the material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrackModel {
    /// Quadratic in the damage: it begins to grow with the first load (Bourdin et al. 2000).
    At2,
    /// Linear in the damage: elastic up to a threshold (Pham et al. 2011).
    At1,
    /// Cohesive: elastic up to a tensile strength that does not depend on the length scale (Wu 2017).
    PfCzm {
        /// Tensile strength, Pa.
        tensile_strength: f64,
        /// How the stress falls with the opening once it has reached the tensile strength.
        softening: Softening,
    },
}

impl CrackModel {
    /// Whether material is elastic up to a threshold.
    pub fn has_threshold(self) -> bool {
        self != Self::At2
    }

    /// Its word in scenes.
    pub const fn word(self) -> &'static str {
        match self {
            Self::At2 => "at2",
            Self::At1 => "at1",
            Self::PfCzm { .. } => "pf-czm",
        }
    }
}

/// Phase field in Borden's convention.
#[derive(Debug, Clone, PartialEq)]
pub struct Fracture {
    /// Surface energy of a crack, and how a crack degrades the material.
    pub model: CrackModel,
    /// Critical energy release rate Gc, J/m².
    pub critical_energy_release_rate: f64,
    /// Length scale l0 (half the l of the d²/l form), m.
    pub length_scale: f64,
    /// Residual stiffness k.
    pub residual_stiffness: f64,
    /// Split of the elastic energy.
    pub split: Split,
    /// How Gc depends on the direction of a crack, if it does.
    pub anisotropy: Option<Anisotropy>,
    /// How Gc varies from place to place about its mean, if it does.
    pub random: Option<RandomToughness>,
    /// Whether Gc is over the cost of a crack on the mesh, where that is known.
    pub mesh_toughness: bool,
}

impl Fracture {
    /// AT2 with a critical energy release rate (J/m²), a length scale (m) and the spectral split.
    pub const fn at2(critical_energy_release_rate: f64, length_scale: f64) -> Self {
        Self {
            model: CrackModel::At2,
            critical_energy_release_rate,
            length_scale,
            residual_stiffness: 0.0,
            split: Split::Spectral,
            anisotropy: None,
            random: None,
            mesh_toughness: false,
        }
    }

    /// Length scale in the direction in which it is shortest, m: of a crack that costs least.
    pub fn shortest_length(&self) -> f64 {
        self.length_scale * self.anisotropy.map_or(1.0, |anisotropy| anisotropy.smallest().sqrt())
    }

    /// a1 of a cohesive crack, `2 E Gc/(π l0 ft²)` with Young's modulus E (Pa); none of the other models.
    pub fn brittleness(&self, young_modulus: f64) -> Option<f64> {
        let CrackModel::PfCzm { tensile_strength, .. } = self.model else { return None };
        let length = young_modulus * self.critical_energy_release_rate / (tensile_strength * tensile_strength);
        Some(fault!("cohesive-length-doubled", FRAC_2_PI => 2.0 * FRAC_2_PI) * length / self.length_scale)
    }
}

/// Arrangement of material points in a span.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Gauss–Legendre points with their weights as volumes.
    Gauss,
    /// Equally spaced points of equal volume.
    Uniform,
    /// Equally spaced points with Maclaurin weights as volumes.
    Maclaurin,
}

/// What an initial crack is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum CrackKind {
    /// Material that is broken, but transmits pressure, and shear with the spectral split. With AT2 an
    /// initial history field of this half width (m), by default half the length scale; with a threshold the
    /// bound c = 0 on the line.
    Seed(Option<f64>),
    /// A discontinuity of the displacement: nothing is transmitted across it (total frame).
    Slit,
    /// A seed that grows along its points from the first on with this speed (m/s), from t = 0. The phase
    /// field of its body answers to its seeds alone, not to the strain (total frame, AT2).
    Driven(f64),
}

/// A crack that is there from t = 0, or that is driven along a line from then on.
#[derive(Debug, Clone, PartialEq)]
pub struct Crack {
    /// Corners of a polyline, m: at least the two ends.
    pub points: Vec<[f64; 2]>,
    /// How the crack is modelled: as broken material, as a slit, or as a seed that grows.
    pub kind: CrackKind,
}

impl Crack {
    /// A straight seed with the default half width.
    pub fn seed(from: [f64; 2], to: [f64; 2]) -> Self {
        Self::wide_seed(from, to, None)
    }

    /// A straight seed with a half width, m.
    pub fn wide_seed(from: [f64; 2], to: [f64; 2], half_width: Option<f64>) -> Self {
        Self { points: vec![from, to], kind: CrackKind::Seed(half_width) }
    }

    /// Whether it is a slit.
    pub fn is_slit(&self) -> bool {
        self.kind == CrackKind::Slit
    }

    /// What there is of it at a time, s; `None` if nothing is.
    pub(crate) fn grown(&self, time: f64) -> Option<Self> {
        let CrackKind::Driven(speed) = self.kind else { return Some(self.clone()) };
        let mut left = fault!("driven-crack-too-fast", speed => 1.02 * speed) * time;
        let mut points = vec![self.points[0]];
        for [from, to] in self.segments() {
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            if left > 0.0 {
                let part = smaller(left / length, 1.0);
                points.push([0, 1].map(|d| from[d] + part * (to[d] - from[d])));
            }
            left -= length;
        }
        (points.len() > 1).then_some(Self { points, kind: self.kind })
    }

    /// Distance of a position from it, m.
    pub(crate) fn distance(&self, position: [f64; 2]) -> f64 {
        self.segments().map(|[from, to]| distance_to_segment(position, from, to)).fold(f64::INFINITY, smaller)
    }

    /// Places along it at most `step` (m) apart, ends included, each with the normal there.
    pub(crate) fn places(&self, step: f64) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        self.segments().flat_map(move |[from, to]| {
            let along = [0, 1].map(|d| to[d] - from[d]);
            let length = along[0].hypot(along[1]);
            let steps = (length / step).ceil();
            let place = move |n: usize| [0, 1].map(|d| from[d] + along[d] * (n as f64 / steps).min(1.0));
            (0..=steps as usize).map(move |n| [place(n), [-along[1] / length, along[0] / length]])
        })
    }

    /// Its straight parts, m.
    pub fn segments(&self) -> impl Iterator<Item = [[f64; 2]; 2]> + '_ {
        self.points.windows(2).map(|ends| [ends[0], ends[1]])
    }
}

/// A body of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name of the body, for messages and columns.
    pub name: String,
    /// Name of its material.
    pub material: String,
    /// Region that the body fills at t = 0.
    pub shape: Shape,
    /// Material points per span and direction.
    pub particles_per_cell: [usize; 2],
    /// Arrangement of the points.
    pub layout: Layout,
    /// Initial velocity, m/s.
    pub velocity: [f64; 2],
    /// Initial angular velocity about the centre of mass, rad/s.
    pub angular_velocity: f64,
    /// Gradient of the initial velocity about the centre of mass, added to both, 1/s.
    pub velocity_gradient: [[f64; 2]; 2],
    /// Moves with its velocity, unaffected.
    pub rigid: bool,
    /// How velocity and angular velocity of a rigid body vary in time.
    pub time: TimeFactor,
    /// Tractions on its edges.
    pub tractions: Vec<Traction>,
    /// Conditions on its edges.
    pub conditions: Vec<EdgeCondition>,
    /// Cracks that are there from t = 0, or that are driven along lines from then on.
    pub cracks: Vec<Crack>,
}

impl Body {
    /// Cracks of the body that are slits: discontinuities of the displacement.
    pub(crate) fn slits(&self) -> impl Iterator<Item = &Crack> {
        self.cracks.iter().filter(|crack| crack.is_slit())
    }

    /// A deformable body at rest with 2 × 2 Gauss points per span, without loads and cracks.
    pub fn at_rest(name: &str, material: &str, shape: Shape) -> Self {
        Self {
            name: name.to_string(),
            material: material.to_string(),
            shape,
            particles_per_cell: [2, 2],
            layout: Layout::Gauss,
            velocity: [0.0; 2],
            angular_velocity: 0.0,
            velocity_gradient: [[0.0; 2]; 2],
            rigid: false,
            time: TimeFactor::default(),
            tractions: Vec::new(),
            conditions: Vec::new(),
            cracks: Vec::new(),
        }
    }

    /// Whether its initial velocity is the same everywhere.
    pub(crate) fn is_translated(&self) -> bool {
        self.angular_velocity == 0.0 && self.velocity_gradient == [[0.0; 2]; 2]
    }

    /// Initial velocity (m/s) at an offset (m) from its centre of mass, less that of the centre.
    pub(crate) fn relative_velocity(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [[xx, xy], [yx, yy]] = self.velocity_gradient;
        let spin = self.angular_velocity;
        [(xx * x + xy * y) - spin * y, (yx * x + yy * y) + spin * x]
    }
}
