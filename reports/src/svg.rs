//! From what plotters writes to an SVG that scales, speaks and stays small.

use fisura_verification::output::foreign::steers;
use plotters::prelude::*;

use crate::series::FigureError;
use crate::style::{SCALE, px};

/// A drawing area of plotters that ends in a string.
pub type Page<'a> = DrawingArea<SVGBackend<'a>, plotters::coord::Shift>;
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
    let mut buffer = String::new();
    let size = (px(width) as u32, px(height) as u32);
    let drawn = || -> Drawn<Option<String>> {
        let root = SVGBackend::with_string(&mut buffer, size).into_drawing_area();
        let below = draw(&root)?;
        root.present()?;
        Ok(below)
    };
    let below = drawn().map_err(|e| FigureError::Drawing { figure: figure.to_string(), message: e.to_string() })?;
    Ok(finish(&buffer, figure, title, description, (width, height), below.as_deref().unwrap_or("")))
}

/// Gives the document its nominal size, a title and a description, and drops attributes that say nothing and
/// the round-off of sizes of fonts, which plotters divides by a factor that `style` multiplies them with.
fn finish(raw: &str, id: &str, title: &str, description: &str, size: (f64, f64), below: &str) -> String {
    let body = raw.split_once(">\n").map_or(raw, |(_, body)| body);
    let body = body
        .replace(" opacity=\"1\"", "")
        .replace(" font-family=\"sans-serif\"", "")
        .replace(" \"/>", "\"/>")
        .replace(".00000000000001\"", "\"");
    let body = crate::compact::compact(&body);
    let id = slug(id);
    let (width, height) = size;
    let (outer_width, outer_height) = (width * SCALE, height * SCALE);
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {outer_width} {outer_height}\" role=\"img\" aria-labelledby=\"{id}-title {id}-desc\" \
         font-family=\"sans-serif\" stroke-linejoin=\"round\">\n\
         <title id=\"{id}-title\">{}</title>\n<desc id=\"{id}-desc\">{}</desc>\n\
         <rect width=\"{outer_width}\" height=\"{outer_height}\" fill=\"#fff\"/>\n{below}{body}",
        escape(title),
        escape(description)
    )
}

/// An identifier for an anchor: letters, digits and single hyphens.
pub fn slug(text: &str) -> String {
    let mut slug = String::new();
    for c in text.chars() {
        match c {
            c if c.is_ascii_alphanumeric() => slug.push(c.to_ascii_lowercase()),
            _ if slug.is_empty() || slug.ends_with('-') => {}
            _ => slug.push('-'),
        }
    }
    slug.trim_end_matches('-').to_string()
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
