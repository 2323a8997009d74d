//! Progress bars on standard error, only on a terminal.

use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::cli::Common;
use crate::console;

/// What a bar shows before its length is known.
pub const SPINNER: &str = "{spinner} {msg}";

/// A bar of `length` units; invisible where nobody would see it.
pub fn bar(common: &Common, template: &str, length: u64) -> ProgressBar {
    let visible = console::interactive(common);
    let target = if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(length), target).with_style(style(template));
    if visible {
        bar.enable_steady_tick(Duration::from_millis(200));
    }
    bar
}

/// A style; the plain one if indicatif cannot read the template.
pub fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar())
}

/// Room for several bars, one below the other; invisible where nobody would see them.
pub fn bars(common: &Common) -> MultiProgress {
    let visible = console::interactive(common);
    MultiProgress::with_draw_target(if visible { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() })
}
