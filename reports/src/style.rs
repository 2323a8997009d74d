//! The look of every figure: sizes, colours, dashes, markers, and how wide a text will be.
//!
//! Plotters draws in whole pixels, so a figure is drawn [`SCALE`] times too large and shown at its nominal
//! size by the view box of the SVG. All sizes below are nominal pixels; [`px`] converts them.

use fisura_verification::record::CurveStyle;
use plotters::prelude::{FontDesc, RGBColor, TextStyle};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Drawing units per nominal pixel.
pub const SCALE: f64 = 10.0;
/// Nominal width of a figure.
pub const WIDTH: f64 = 720.0;
/// Size of axis titles and legends.
pub const LABEL_SIZE: f64 = 13.0;
/// Size of tick labels and region labels.
pub const TICK_SIZE: f64 = 12.0;
/// Width of a curve, nominal pixels.
pub const CURVE_WIDTH: f64 = 1.8;
/// Colour of all text in a figure.
pub const INK: RGBColor = RGBColor(0x26, 0x26, 0x26);
/// Colour of the lines of axes and of the outlines of guides.
pub const AXIS: RGBColor = RGBColor(0x59, 0x59, 0x59);
/// Colour of the grid lines.
pub const GRID: RGBColor = RGBColor(0xe6, 0xe6, 0xe6);
/// Colour of marked regions and guides, which are drawn translucent.
pub const REGION: RGBColor = RGBColor(0x8c, 0x8c, 0x8c);

/// Nominal pixels in drawing units.
pub fn px(nominal: f64) -> i32 {
    (nominal * SCALE).round() as i32
}

/// Estimated width in nominal pixels of `text` in a sans-serif face of `size`, on the generous side.
pub fn text_width(text: &str, size: f64) -> f64 {
    let em = |c: char| match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.30,
        ' ' | 'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.38,
        '⁰'..='⁹' | '¹' | '²' | '³' | '⁻' => 0.42,
        'm' | 'w' | 'M' | 'W' | '—' | '%' | '@' => 0.92,
        '−' | '×' | '=' | '+' | '<' | '>' | '≤' | '≥' => 0.66,
        c if c.is_uppercase() => 0.70,
        _ => 0.58,
    };
    text.chars().map(em).sum::<f64>() * size
}

/// Breaks `text` at spaces into lines of at most `width` nominal pixels; a longer word stands alone.
pub fn wrap(text: &str, size: f64, width: f64) -> Vec<String> {
    wrap_by(text, |line| text_width(line, size) <= width)
}

/// Breaks `text` at spaces into lines of at most `columns` characters.
pub fn wrap_columns(text: &str, columns: usize) -> Vec<String> {
    wrap_by(text, |line| line.chars().count() <= columns)
}

fn wrap_by(text: &str, fits: impl Fn(&str) -> bool) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}")).filter(|line| fits(line));
        match (longer, lines.last_mut()) {
            (Some(longer), Some(line)) => *line = longer,
            _ => lines.push(word.to_string()),
        }
    }
    lines
}

/// Text style of a nominal size, anchored at the given side.
pub fn text(size: f64, colour: RGBColor, horizontal: HPos, vertical: VPos) -> TextStyle<'static> {
    FontDesc::from(("sans-serif", size * SCALE)).color(&colour).pos(Pos::new(horizontal, vertical))
}

/// Shape of the marker at a point of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Disc around the point.
    Circle,
    /// A square with sides along the axes.
    Square,
    /// Triangle that points up.
    Triangle,
    /// Square on its corner.
    Diamond,
    /// Triangle that points down.
    Wedge,
}

impl Marker {
    const ALL: [Self; 5] = [Self::Circle, Self::Square, Self::Triangle, Self::Diamond, Self::Wedge];

    /// Corners around the centre in drawing units for a marker of nominal radius `r`; empty for a disc.
    pub fn corners(self, r: f64) -> Vec<(i32, i32)> {
        let (square, half) = (0.88 * r, 0.62 * r);
        let corners: &[(f64, f64)] = match self {
            Self::Circle => &[],
            Self::Square => &[(-square, -square), (square, -square), (square, square), (-square, square)],
            Self::Triangle => &[(0.0, -1.2 * r), (1.1 * r, half), (-1.1 * r, half)],
            Self::Diamond => &[(0.0, -1.25 * r), (1.25 * r, 0.0), (0.0, 1.25 * r), (-1.25 * r, 0.0)],
            Self::Wedge => &[(0.0, 1.2 * r), (1.1 * r, -half), (-1.1 * r, -half)],
        };
        corners.iter().map(|(x, y)| (px(*x), px(*y))).collect()
    }
}

/// How one curve looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Colour of the line and its markers.
    pub colour: RGBColor,
    /// Lengths of dashes and gaps in nominal pixels; empty for a solid line.
    pub dashes: &'static [f64],
    /// Marker at points of the curve; absent if it has none.
    pub marker: Option<Marker>,
}

/// Okabe and Ito's palette without yellow, which is lost on white; results take it from the front.
const RESULTS: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0x56, 0xb4, 0xe9),
    RGBColor(0xe6, 0x9f, 0x00),
];

/// References: grey first, then the palette from its other end.
const REFERENCES: [RGBColor; 6] =
    [RGBColor(0x3c, 0x3c, 0x3c), RESULTS[5], RESULTS[3], RESULTS[4], RESULTS[2], RESULTS[1]];

const DASHES: [&[f64]; 5] =
    [&[7.0, 4.0], &[2.0, 3.0], &[11.0, 3.5, 2.0, 3.5], &[13.0, 5.0], &[6.0, 2.5, 1.5, 2.5, 1.5, 2.5]];

/// The look of each curve of a chart: colour differs together with dash or marker, so that neither is needed
/// alone.
pub fn looks(styles: &[CurveStyle]) -> Vec<Look> {
    let mut seen = [0; 2]; // results, and references
    let look = |style: &CurveStyle| {
        let is_reference = matches!(style, CurveStyle::Reference | CurveStyle::Points);
        let n = seen[usize::from(is_reference)];
        seen[usize::from(is_reference)] += 1;
        let colour = if is_reference { REFERENCES[n % 6] } else { RESULTS[n % 6] };
        let (dashes, marker): (&[f64], _) = match style {
            // the first line is bare, later ones carry a few markers
            CurveStyle::Line => (&[], n.checked_sub(1).map(|n| Marker::ALL[n % 5])),
            CurveStyle::Markers => (n.checked_sub(1).map_or(&[], |n| DASHES[n % 5]), Some(Marker::ALL[n % 5])),
            CurveStyle::Reference => (DASHES[n % 5], None),
            CurveStyle::Points => (&[], Some(Marker::ALL[(n + 3) % 5])),
        };
        Look { colour, dashes, marker }
    };
    styles.iter().map(look).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_curves_of_a_style_look_alike() {
        let styles = [CurveStyle::Line, CurveStyle::Reference, CurveStyle::Markers, CurveStyle::Points].repeat(4);
        let looks: Vec<_> = looks(&styles).into_iter().zip(&styles).collect();
        for (i, a) in looks.iter().enumerate() {
            assert!(looks[i + 1..].iter().all(|b| a != b), "curve {i} has a twin");
        }
    }

    #[test]
    fn long_texts_are_broken_at_spaces() {
        let lines = wrap("a sentence that is rather long for its place", 12.0, 120.0);
        assert!(lines.len() > 1 && lines.iter().all(|l| text_width(l, 12.0) <= 120.0), "{lines:?}");
        assert_eq!(lines.join(" "), "a sentence that is rather long for its place");
    }
}
