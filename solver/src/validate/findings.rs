//! What the checks of a scene found so far.

use crate::scene::Side;
use crate::scene::error::{SceneError, SceneWarning};

/// What the checks found so far.
#[derive(Default)]
pub(super) struct Findings {
    pub errors: Vec<SceneError>,
    pub warnings: Vec<SceneWarning>,
}

impl Findings {
    pub(super) fn error(&mut self, key: impl Into<String>, message: impl Into<String>, remedy: impl Into<String>) {
        self.errors.push(SceneError { key: key.into(), message: message.into(), remedy: remedy.into() });
    }

    pub(super) fn warn(&mut self, key: impl Into<String>, message: impl Into<String>) {
        self.warnings.push(SceneWarning { key: key.into(), message: message.into() });
    }

    /// An error unless `value` is positive and finite; `like` is an example with its unit.
    pub(super) fn positive(&mut self, key: impl Into<String>, value: f64, like: &str) -> bool {
        let holds = value > 0.0 && value.is_finite();
        if !holds {
            self.error(key, format!("{value} is not positive"), format!("give a positive value such as {like}"));
        }
        holds
    }

    /// An error unless all values are finite.
    pub(super) fn finite(&mut self, key: impl Into<String>, values: &[f64]) -> bool {
        let holds = values.iter().all(|v| v.is_finite());
        if !holds {
            self.error(key, "not a finite number", "give finite numbers");
        }
        holds
    }
}

/// A side, as a scene file names it.
pub(super) fn side_name(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
        Side::Bottom => "bottom",
        Side::Top => "top",
    }
}
