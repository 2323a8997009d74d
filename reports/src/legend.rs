//! The legend, in columns below the frame, so that it never covers a curve.

use fisura_verification::extremes::larger;
use fisura_verification::record::CurveStyle;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::style::{CURVE_WIDTH, INK, LABEL_SIZE, Look, Marker, px, text, text_width, wrap};
use crate::svg::{Drawn, Page};
use crate::trace::Trace;

/// Nominal length of a sample.
const SAMPLE: f64 = 34.0;
/// Nominal distance of lines of text.
const LINE: f64 = 18.0;
/// Transparency of uncertainty bands.
pub const BAND: f64 = 0.18;

/// Entries with their places, nominal, from the upper left corner of the legend.
#[derive(Debug, Clone, Default)]
pub struct Legend {
    entries: Vec<Entry>,
    /// Height of the whole legend, nominal pixels.
    pub height: f64,
}

#[derive(Debug, Clone)]
struct Entry {
    lines: Vec<String>,
    at: (f64, f64),
    look: Look,
    style: CurveStyle,
    band: bool,
}

impl Legend {
    /// Arranges entries in as many columns as fit in `width`.
    pub fn arrange(traces: &[Trace], width: f64) -> Self {
        let label = |trace: &Trace| {
            let band = trace.style == CurveStyle::Reference && !trace.half_widths.is_empty();
            if band { format!("{} (band: uncertainty)", trace.label) } else { trace.label.clone() }
        };
        let widest = traces.iter().map(|t| text_width(&label(t), LABEL_SIZE)).fold(0.0, larger);
        let cell = SAMPLE + 10.0 + widest + 22.0;
        let columns = ((width + 22.0) / cell).floor().clamp(1.0, 4.0) as usize;
        let cell = if columns == 1 { width } else { (width / columns as f64).max(cell) };
        let rows = traces.len().div_ceil(columns);
        let wrapped: Vec<Vec<String>> =
            traces.iter().map(|t| wrap(&label(t), LABEL_SIZE, cell - SAMPLE - 10.0)).collect();
        let heights: Vec<f64> = (0..rows)
            .map(|r| (r..traces.len()).step_by(rows.max(1)).map(|i| wrapped[i].len().max(1)).max().unwrap_or(1))
            .map(|lines| lines as f64 * LINE + 2.0)
            .collect();
        let mut legend = Self { entries: Vec::new(), height: heights.iter().sum() };
        for (i, (trace, lines)) in traces.iter().zip(wrapped).enumerate() {
            let (column, row) = (i / rows, i % rows);
            let at = (column as f64 * cell, heights[..row].iter().sum::<f64>() + 0.5 * LINE);
            let band = trace.style == CurveStyle::Reference && !trace.half_widths.is_empty();
            legend.entries.push(Entry { lines, at, look: trace.look, style: trace.style, band });
        }
        legend
    }

    /// Draws the legend with its upper left corner at `origin`.
    pub fn draw(&self, page: &Page, origin: (f64, f64)) -> Drawn {
        for entry in &self.entries {
            let (x, y) = (origin.0 + entry.at.0, origin.1 + entry.at.1);
            entry.sample(page, x, y)?;
            for (i, line) in entry.lines.iter().enumerate() {
                let at = (px(x + SAMPLE + 10.0), px(y + i as f64 * LINE));
                page.draw(&Text::new(line.clone(), at, text(LABEL_SIZE, INK, HPos::Left, VPos::Center)))?;
            }
        }
        Ok(())
    }
}

impl Entry {
    fn sample(&self, page: &Page, x: f64, y: f64) -> Drawn {
        let look = &self.look;
        if self.band {
            let corners = [(px(x), px(y - 6.0)), (px(x + SAMPLE), px(y + 6.0))];
            page.draw(&Rectangle::new(corners, look.colour.mix(BAND).filled()))?;
        }
        if self.style == CurveStyle::Points {
            let bar = vec![(px(x + 0.5 * SAMPLE), px(y - 7.0)), (px(x + 0.5 * SAMPLE), px(y + 7.0))];
            page.draw(&PathElement::new(bar, look.colour.stroke_width(px(1.2) as u32)))?;
        } else {
            let line = vec![(px(x), px(y)), (px(x + SAMPLE), px(y))];
            let line = PathElement::new(line, look.colour.stroke_width(px(CURVE_WIDTH) as u32));
            page.dashed(look.dashes, || Ok(page.draw(&line)?))?;
        }
        match look.marker {
            Some(marker) => draw_markers(page, &[((px(x + 0.5 * SAMPLE), px(y)), false)], marker, 3.6, look.colour),
            None => Ok(()),
        }
    }
}

/// Nominal width of the rim of a marker.
const RIM: f64 = 0.9;

/// Draws markers of nominal `radius` at places on the page, some of them hollow, with a thin white rim that
/// sets them off from lines.
pub fn draw_markers(
    page: &Page,
    places: &[((i32, i32), bool)],
    marker: Marker,
    radius: f64,
    colour: RGBColor,
) -> Drawn {
    let hollow: Vec<_> = places.iter().filter(|(_, hollow)| *hollow).copied().collect();
    if marker == Marker::Circle {
        for (radius, colour, places) in
            [(radius + RIM, WHITE, places), (radius, colour, places), (radius - 1.4, WHITE, &hollow)]
        {
            places.iter().try_for_each(|(at, _)| page.draw(&Circle::new(*at, px(radius), colour.filled())))?;
        }
        return Ok(());
    }
    let draw = |radius: f64, colour: RGBColor, places: &[((i32, i32), bool)]| -> Drawn {
        let corners = marker.corners(radius);
        let shape = |at: (i32, i32)| corners.iter().map(|c| (at.0 + c.0, at.1 + c.1)).collect::<Vec<_>>();
        Ok(places.iter().try_for_each(|(at, _)| page.draw(&Polygon::new(shape(*at), colour.filled())))?)
    };
    page.rimmed(RIM, || draw(radius, colour, places))?;
    draw(radius - 1.4, WHITE, &hollow)
}
