//! Studies of hard cases: steps near the critical one, cut spans, nearly incompressible material, strains at
//! the ends of what numbers hold, points on knots, other units, and runs that have to be the same.

pub(super) mod boundary_points;
pub(super) mod critical_step;
pub(super) mod growth;
pub(super) mod incompressible;
pub(super) mod repeatability;
pub(super) mod split_families;
pub(super) mod units;
pub(super) mod unloading;

use fisura::Simulation;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::{Scene, TimeStep};

use super::scene::series_stem;
use super::{StudyError, other};
use crate::case::Case;
use crate::record::{Axis, Curve, Figure, FigureBody};

/// The body of a scene without a phase field in the total frame.
fn total_frame(scene: &Scene) -> Result<TotalFrame, StudyError> {
    TotalFrame::new(scene).map_err(|_| other("the initial phase field did not converge"))
}

/// A chart with logarithmic axes.
fn logarithmic(case: &Case, name: &str, title: &str, caption: &str, axes: [&str; 2], curves: Vec<Curve>) -> Figure {
    let body = FigureBody::chart(axes.map(Axis::logarithmic), curves, Vec::new());
    Figure::new(&case.suite, [&series_stem(case, name), title, caption], body)
}

/// A run of so many steps of `dt` (s), sampled every hundredth step.
fn with_step(scene: &Scene, dt: f64, steps: usize) -> Result<Simulation, StudyError> {
    let mut scene = scene.clone();
    scene.analysis.time_step = TimeStep::Fixed(dt);
    scene.analysis.end_time = dt * steps as f64;
    scene.output.samples = steps.div_ceil(100);
    Ok(Simulation::new(&scene)?)
}
