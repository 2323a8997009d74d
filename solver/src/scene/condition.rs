//! Loads of bodies, and conditions on the sides of the mesh and on edges of bodies.

use super::time::{Formula, TimeFactor};

/// Side of a rectangle, or of a patch: left and right bound its first parametric direction, bottom and top
/// its second.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Side of smallest x, or of the smallest first parameter of a patch.
    Left,
    /// Side of largest x, or of the largest first parameter of a patch.
    Right,
    /// Side of smallest y, or of the smallest second parameter of a patch.
    Bottom,
    /// Side of largest y, or of the largest second parameter of a patch.
    Top,
}

impl Side {
    /// Direction across it, and whether it is the upper end there.
    pub(crate) fn axis(self) -> (usize, bool) {
        match self {
            Side::Left => (0, false),
            Side::Right => (0, true),
            Side::Bottom => (1, false),
            Side::Top => (1, true),
        }
    }

    /// Direction along it.
    pub(crate) fn along(self) -> usize {
        1 - self.axis().0
    }
}

/// Where a traction or a condition acts.
#[derive(Debug, Clone, PartialEq)]
pub enum Edge {
    /// A side of a body that is a rectangle, or of the whole patch.
    Side(Side),
    /// A straight segment, m.
    Segment([[f64; 2]; 2]),
    /// An arc of a circle.
    Arc {
        /// Centre of the circle, m.
        center: [f64; 2],
        /// Radius of the circle, m.
        radius: f64,
        /// Angles between which it lies, anticlockwise from the first, rad.
        angles: [f64; 2],
    },
}

/// The stress components xx, yy and xy (Pa) as functions of the position (m).
pub type StressField = Formula<[f64; 2], [f64; 3]>;

/// What a traction is.
#[derive(Debug, Clone, PartialEq)]
pub enum Load {
    /// A traction vector, Pa.
    Stress([f64; 2]),
    /// A pressure against the outward normal, Pa.
    Pressure(f64),
    /// The traction that a stress field exerts on the boundary as it is at t = 0.
    Field(StressField),
}

impl Load {
    /// The traction (Pa) at a position (m) on a boundary with this outward unit normal.
    pub(crate) fn traction(&self, position: [f64; 2], normal: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Stress(stress) => *stress,
            Self::Pressure(pressure) => normal.map(|n| -fault!("pressure-outwards", *pressure => -*pressure) * n),
            Self::Field(field) => {
                let [xx, yy, xy] = field.value(position);
                let [x, y] = normal;
                [xx * x + fault!("stress-field-without-shear", xy => 0.0) * y, xy * x + yy * y]
            }
        }
    }

    /// Whether it depends on which side of the boundary the material is.
    pub(crate) fn has_side(&self) -> bool {
        !matches!(self, Self::Stress(_))
    }
}

/// Traction on an edge of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Edge on which it acts.
    pub edge: Edge,
    /// What acts there at its full value.
    pub load: Load,
    /// How it varies in time.
    pub time: TimeFactor,
}

impl Traction {
    /// A traction vector (Pa) on a side of a body.
    pub fn on(side: Side, stress: [f64; 2], time: TimeFactor) -> Self {
        Self { edge: Edge::Side(side), load: Load::Stress(stress), time }
    }
}

/// What a condition prescribes, at its full value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Motion {
    /// Velocity in x and y at a time factor of 1, m/s.
    Velocity([f64; 2]),
    /// Displacement in x and y at a time factor of 1, m.
    Displacement([f64; 2]),
}

/// A prescribed motion, and how it varies in time.
#[derive(Debug, Clone, PartialEq)]
pub struct Prescribed {
    /// What is prescribed.
    pub motion: Motion,
    /// How that varies in time.
    pub time: TimeFactor,
}

impl Prescribed {
    /// A velocity that never changes, m/s.
    pub fn velocity(velocity: [f64; 2]) -> Self {
        Self { motion: Motion::Velocity(velocity), time: TimeFactor::default() }
    }

    /// Its value: m/s, or m.
    pub(crate) fn value(&self) -> [f64; 2] {
        let (Motion::Velocity(value) | Motion::Displacement(value)) = self.motion;
        value
    }

    /// Whether it is a displacement.
    pub fn is_displacement(&self) -> bool {
        matches!(self.motion, Motion::Displacement(_))
    }

    /// Whether nothing ever moves.
    pub fn is_at_rest(&self) -> bool {
        self.value() == [0.0; 2]
    }

    /// What a component does: its value, whether that is a displacement, and its factor in time unless it is
    /// at rest.
    pub(crate) fn course(&self, component: usize) -> (f64, bool, Option<&TimeFactor>) {
        let value = self.value()[component];
        if value == 0.0 { (0.0, false, None) } else { (value, self.is_displacement(), Some(&self.time)) }
    }

    /// Displacement (m) and velocity (m/s) at t = 0.
    pub(crate) fn start(&self) -> [[f64; 2]; 2] {
        let value = self.value().map(|value| value * self.time.value(0.0));
        if self.is_displacement() { [value, [0.0; 2]] } else { [[0.0; 2], value] }
    }

    /// Mean velocity (m/s) over a step of `dt` seconds from `time` on.
    pub fn mean_velocity(&self, time: f64, dt: f64) -> [f64; 2] {
        match self.motion {
            Motion::Velocity(velocity) => {
                let factor = self.time.mean([time, time + dt]);
                velocity.map(|v| v * factor)
            }
            Motion::Displacement(displacement) => {
                let ends = fault!("displacement-lags", [time, time + dt] => [time - 3.0 * dt, time - 2.0 * dt]);
                let change = self.time.value(ends[1]) - self.time.value(ends[0]);
                displacement.map(|u| u * change / dt)
            }
        }
    }
}

/// Condition on a side of the mesh, or on a part of one.
#[derive(Debug, Clone, PartialEq)]
pub struct Boundary {
    /// Name of its columns of reaction and work; without one it has none.
    pub name: Option<String>,
    /// Side of the mesh on which the condition acts.
    pub side: Side,
    /// Ends of the part along the side (m, smaller first); absent: the whole side.
    pub part: Option<[f64; 2]>,
    /// Which components are prescribed.
    pub fix: [bool; 2],
    /// Motion of the prescribed components, and its factor over time.
    pub prescribed: Prescribed,
}

impl Boundary {
    /// A side on which components are held.
    pub fn fixed(side: Side, fix: [bool; 2]) -> Self {
        Self::driven(side, fix, [0.0; 2])
    }

    /// A side of which components have a velocity, m/s.
    pub fn driven(side: Side, fix: [bool; 2], velocity: [f64; 2]) -> Self {
        Self { name: None, side, part: None, fix, prescribed: Prescribed::velocity(velocity) }
    }
}

/// What a condition prescribes of the motion of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hold {
    /// Components along x and y.
    Components([bool; 2]),
    /// The component along the normal of the edge as it was at t = 0: a roller.
    Normal,
}

/// Condition on an edge of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct EdgeCondition {
    /// Name of its columns of reaction and work; without one it has none.
    pub name: Option<String>,
    /// Edge that it holds or drives.
    pub edge: Edge,
    /// Which components are prescribed.
    pub hold: Hold,
    /// Motion of the prescribed components, and its factor over time.
    pub prescribed: Prescribed,
}

impl EdgeCondition {
    /// An edge of which components are held.
    pub fn fixed(edge: Edge, hold: Hold) -> Self {
        Self { name: None, edge, hold, prescribed: Prescribed::velocity([0.0; 2]) }
    }

    /// The components of its reaction.
    pub fn components(&self) -> [bool; 2] {
        match self.hold {
            Hold::Components(components) => components,
            Hold::Normal => [true; 2],
        }
    }
}
