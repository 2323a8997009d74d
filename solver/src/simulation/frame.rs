//! The bodies in the frame of their scene.

use crate::dynamics::failure::Failure;
use crate::dynamics::total_frame::bodies::TotalBodies;
use crate::dynamics::updated_frame::UpdatedFrame;
use crate::scene::{self, Scene};

/// The bodies in the frame of their scene.
#[derive(Debug)]
pub(super) enum Bodies {
    Total(Box<TotalBodies>),
    Updated(Box<UpdatedFrame>),
}

/// The same expression for either frame.
macro_rules! either {
    ($frame:expr, $body:ident => $value:expr) => {
        match $frame {
            Bodies::Total($body) => $value,
            Bodies::Updated($body) => $value,
        }
    };
}
pub(super) use either;

impl Bodies {
    pub(super) fn new(scene: &Scene) -> Result<Self, Failure> {
        Ok(match scene.analysis.frame {
            scene::Frame::Total => Self::Total(Box::new(TotalBodies::new(scene)?)),
            scene::Frame::Updated => Self::Updated(Box::new(UpdatedFrame::new(scene)?)),
        })
    }

    /// Makes ready for steps of `dt` seconds.
    pub(super) fn prepare(&mut self, dt: f64) -> Result<(), Failure> {
        match self {
            Self::Total(body) => {
                body.prepare(dt);
                Ok(())
            }
            Self::Updated(body) => body.prepare(dt),
        }
    }

    /// Takes a step of `dt` seconds; a phase field that is `sampled` after it is solved for.
    pub(super) fn step(&mut self, dt: f64, sampled: bool) -> Result<(), Failure> {
        match self {
            Self::Total(bodies) => bodies.step(dt, sampled),
            Self::Updated(body) => body.step(dt),
        }
    }

    pub(super) fn particles(&self) -> usize {
        match self {
            Self::Total(bodies) => bodies.bodies.iter().map(|body| body.lattice.count()).sum(),
            Self::Updated(frame) => frame.fields.iter().map(|field| field.points.len()).sum(),
        }
    }

    /// Control points with mass, counted for each body.
    pub(super) fn control_points(&self) -> usize {
        let massive = |mass: &[f64]| mass.iter().filter(|m| **m > 0.0).count();
        match self {
            Self::Total(bodies) => bodies.bodies.iter().map(|body| massive(&body.mass.row_sums)).sum(),
            Self::Updated(frame) => frame.fields.iter().map(|field| massive(&field.nodes.mass)).sum(),
        }
    }
}
