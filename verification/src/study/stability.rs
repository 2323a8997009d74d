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

use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::Scene;

use super::StudyError;
use super::scene::series_stem;
use crate::case::Case;
use crate::record::{Axis, Curve, Figure, FigureBody, Reference, ReferenceKind};

/// The body of a scene without a phase field in the total frame.
fn total_frame(scene: &Scene) -> Result<TotalFrame, StudyError> {
    TotalFrame::new(scene).map_err(|_| StudyError::Other("the initial phase field did not converge".into()))
}

fn exact(value: f64, source: &str) -> Option<Reference> {
    Some(Reference::new(Some(value), ReferenceKind::Exact, source))
}

fn theory(value: f64, source: &str) -> Option<Reference> {
    Some(Reference::new(Some(value), ReferenceKind::Theory, source))
}

/// A chart with logarithmic axes.
fn logarithmic(case: &Case, name: &str, title: &str, caption: &str, axes: [&str; 2], curves: Vec<Curve>) -> Figure {
    let body = FigureBody::chart(axes.map(Axis::logarithmic), curves, Vec::new());
    Figure::new(&case.suite, [&series_stem(case, name), title, caption], body)
}
