//! The rigid part of what the grid gives to points.
//!
//! Fit and quadrature keep sums over points to their order only. Taking the difference of the mean, and of
//! the mean rotation, out of accelerations and of changes of velocity keeps momentum and angular momentum to
//! round-off: `Σ m x(n+1) × v = Σ m x(n) × v`, as v × v is zero.

use crate::particles::points::Point;

/// Sum of forces, N/m, and their moment about the origin, N.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Resultant {
    pub force: [f64; 2],
    pub moment: f64,
}

impl Resultant {
    /// Adds a force at a place, m.
    pub(crate) fn add(&mut self, place: [f64; 2], force: [f64; 2]) {
        (0..2).for_each(|c| self.force[c] += force[c]);
        self.moment += cross(place, force);
    }
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The points of a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RigidPart<'a> {
    pub points: &'a [Point],
    /// Density at t = 0, kg/m³.
    pub density: f64,
    /// Components that are held nowhere.
    pub free: [bool; 2],
}

impl RigidPart<'_> {
    /// Takes out of the values of all points (m/s², or m/s if nothing acts) what differs from a resultant:
    /// its mean where a component is held nowhere, and its rotation where none is.
    pub(crate) fn remove_excess(&self, values: &mut [[f64; 2]], acting: Resultant) {
        let Self { points, density, free } = *self;
        let mass = density * points.iter().map(|point| point.volume).sum::<f64>();
        let (mut sum, mut center) = ([0.0; 2], [0.0; 2]);
        for (point, value) in points.iter().zip(&*values) {
            (0..2).for_each(|c| sum[c] += density * point.volume * value[c]);
            (0..2).for_each(|c| center[c] += density * point.volume * point.position[c] / mass);
        }
        let excess = [0, 1].map(|c| if free[c] { (sum[c] - acting.force[c]) / mass } else { 0.0 });
        let mean = fault!("mean-of-the-fit-kept", excess => excess.map(|_| 0.0));
        let (mut moment, mut inertia) = (0.0, 0.0);
        for (point, value) in points.iter().zip(&mut *values) {
            (0..2).for_each(|c| value[c] -= mean[c]);
            let arm = [0, 1].map(|c| point.position[c] - center[c]);
            moment += density * point.volume * cross(arm, *value);
            inertia += density * point.volume * (arm[0] * arm[0] + arm[1] * arm[1]);
        }
        if free != [true; 2] {
            return;
        }
        let spin = (moment - (acting.moment - cross(center, acting.force))) / inertia;
        for (point, value) in points.iter().zip(values) {
            let arm = [0, 1].map(|c| point.position[c] - center[c]);
            value[0] += spin * arm[1];
            value[1] -= spin * arm[0];
        }
    }
}
