//! A figure as an SVG that scales, has words for those who cannot see it, and stays small.

use std::ops::Deref;

use fisura_verification::output::foreign::steers;
use plotters::coord::Shift;
use plotters::prelude::*;

use crate::canvas::Canvas;
use crate::series::FigureError;
use crate::style::{SCALE, px};

/// A drawing area of plotters, and the canvas below it.
pub struct Page {
    area: DrawingArea<Canvas, Shift>,
    canvas: Canvas,
}

/// What a drawing function returns.
pub type Drawn<T = ()> = Result<T, Box<dyn std::error::Error>>;

/// Draws on a white page of nominal size and returns the finished SVG, with `title` and `description` for
/// readers who cannot see it. `draw` may return markup that is laid on the page before everything else.
pub fn page(
    figure: &str,
    (title, description): (&str, &str),
    (width, height): (f64, f64),
    draw: impl FnOnce(&Page) -> Drawn<Option<String>>,
) -> Result<String, FigureError> {
    let canvas = Canvas::new((px(width) as u32, px(height) as u32));
    let failed = |e: Box<dyn std::error::Error>| FigureError::new(figure, format!("drawing failed: {e}"));
    let page = Page { area: canvas.clone().into_drawing_area(), canvas: canvas.clone() };
    let below = draw(&page).map_err(failed)?.unwrap_or_default();
    let (id, body) = (slug(figure), canvas.markup());
    let (outer_width, outer_height) = (width * SCALE, height * SCALE);
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {outer_width} {outer_height}\" role=\"img\" aria-labelledby=\"{id}-title {id}-desc\" \
         font-family=\"sans-serif\" stroke-linejoin=\"round\">\n\
         <title id=\"{id}-title\">{}</title>\n<desc id=\"{id}-desc\">{}</desc>\n\
         <rect width=\"{outer_width}\" height=\"{outer_height}\" fill=\"#fff\"/>\n{below}{body}</svg>\n",
        escape(title),
        escape(description)
    ))
}

impl Page {
    /// Draws with lines dashed by a pattern, lengths of dashes and gaps in nominal pixels.
    pub fn dashed(&self, pattern: &'static [f64], draw: impl FnOnce() -> Drawn) -> Drawn {
        self.canvas.dash(pattern);
        let drawn = draw();
        self.canvas.dash(&[]);
        drawn
    }

    /// Draws areas with a white rim of a nominal width that sets them off from lines.
    pub fn rimmed(&self, width: f64, draw: impl FnOnce() -> Drawn) -> Drawn {
        self.canvas.rim(width);
        let drawn = draw();
        self.canvas.rim(0.0);
        drawn
    }
}

impl Deref for Page {
    type Target = DrawingArea<Canvas, Shift>;

    fn deref(&self) -> &Self::Target {
        &self.area
    }
}

/// An identifier for an anchor: letters, digits and single hyphens.
pub fn slug(text: &str) -> String {
    let words: Vec<&str> = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty()).collect();
    words.join("-").to_ascii_lowercase()
}

/// Text for SVG, without the characters that XML forbids.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if steers(c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_plain() {
        assert_eq!(slug("timing/Plate: p = 2, h = l0/2"), "timing-plate-p-2-h-l0-2");
        assert_eq!(escape("a < b & \"c\"\n"), "a &lt; b &amp; &quot;c&quot; ");
    }
}
