//! Pictures of a field on a regular raster, in millimetres, with a colour bar.

use std::fmt::Write;

use fisura_verification::extremes::larger;
use fisura_verification::record::{Axis, Figure, FigureBody, Scale};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::axis::{AxisScale, is_range};
use crate::colour::{LEVELS, level, level_colour};
use crate::frame::{self, BELOW, EDGE, Place};
use crate::series::{FigureError, SeriesSet};
use crate::style::{AXIS, INK, LABEL_SIZE, SCALE, TICK_SIZE, WIDTH, px, text, text_width};
use crate::svg::{self, Drawn, Page};

/// Largest nominal height of the body.
const TALLEST: f64 = 460.0;
/// Most pixels in all, and along one direction.
const MOST: [usize; 2] = [1_000_000, 10_000];
/// Largest ratio of the sides of a picture.
const SLIMMEST: f64 = 1000.0;
/// Bytes above which a picture is drawn with half of the levels of the colour bar.
const LARGE: usize = 32_000;
/// Nominal width of the colour bar.
const BAR: f64 = 16.0;
/// Nominal distance of the colour bar from the frame.
const GAP: f64 = 18.0;

/// Values on a regular raster, x fastest, from the lower left corner.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// Pixels per direction.
    pub pixels: [usize; 2],
    /// Smallest coordinates of the raster, m.
    pub low: [f64; 2],
    /// Largest coordinates of the raster, m.
    pub high: [f64; 2],
    /// Values; not-a-number outside the body.
    pub values: Vec<f64>,
}

impl Raster {
    /// Reads a series with the columns `x_m`, `y_m`, `value`.
    pub fn read(figure: &str, series: &str, pixels: [usize; 2], set: &SeriesSet) -> Result<Self, FigureError> {
        let [x, y, value] = ["x_m", "y_m", "value"].map(|name| set.column(figure, series, name));
        Self::new(pixels, x?, y?, value?).map_err(|message| FigureError::raster(figure, series, &message))
    }

    fn new(pixels: [usize; 2], x: &[f64], y: &[f64], value: &[f64]) -> Result<Self, String> {
        let [nx, ny] = pixels;
        if nx < 2 || ny < 2 || nx.checked_mul(ny) != Some(value.len()) {
            return Err(format!(
                "{nx} x {ny} pixels are declared (at least 2 x 2), but the file has {} rows",
                value.len()
            ));
        }
        if nx * ny > MOST[0] || nx.max(ny) > MOST[1] {
            return Err(format!("{nx} x {ny} pixels; at most {} are drawn, and {} along a side", MOST[0], MOST[1]));
        }
        let (last_x, last_y) = (x[nx - 1], y[nx * (ny - 1)]);
        let step = [(last_x - x[0]) / (nx - 1) as f64, (last_y - y[0]) / (ny - 1) as f64];
        let tolerance = 1e-3 * step[0].abs().min(step[1].abs());
        let off = (0..nx * ny).find(|i| {
            let expected = (x[0] + step[0] * (i % nx) as f64, y[0] + step[1] * (i / nx) as f64);
            !((x[*i] - expected.0).abs() <= tolerance && (y[*i] - expected.1).abs() <= tolerance)
        });
        if let Some(row) = off {
            return Err(format!("row {} at ({}, {}) is not on the grid of pixels", row + 1, x[row], y[row]));
        }
        if step[0] <= 0.0 || step[1] == 0.0 {
            return Err("the pixels do not advance in x, then in y".to_string());
        }
        let mut rows: Vec<&[f64]> = value.chunks(nx).collect();
        if step[1] < 0.0 {
            rows.reverse();
        }
        let half = [0.5 * step[0], 0.5 * step[1].abs()];
        let low = [x[0] - half[0], y[0].min(last_y) - half[1]];
        let high = [last_x + half[0], y[0].max(last_y) + half[1]];
        let ratio = (high[1] - low[1]) / (high[0] - low[0]);
        let fits = [0, 1].into_iter().all(|k| is_range(1e3 * low[k], 1e3 * high[k]));
        if !fits || !(1.0 / SLIMMEST..=SLIMMEST).contains(&ratio) {
            return Err(format!("a picture from {low:?} to {high:?} m cannot be shown with equal scales"));
        }
        Ok(Self { pixels, low, high, values: rows.concat() })
    }

    /// One path per colour, in units of pixels from the upper left corner. Runs of one colour in a row are
    /// one rectangle, and so are equal runs in rows on top of each other. Of the levels of the colour bar
    /// only every `coarse`-th is used.
    pub(crate) fn paths(&self, range: [f64; 2], coarse: usize) -> String {
        let [nx, ny] = self.pixels;
        let mut paths = vec![(String::new(), (0, 0)); LEVELS];
        let mut open: Vec<Run> = Vec::new();
        for row in 0..ny {
            let mut next = runs(&self.values[(ny - 1 - row) * nx..][..nx], row, (range, coarse));
            for run in open {
                let same = next.binary_search_by_key(&run.start, |n| n.start).ok().map(|at| &mut next[at]);
                match same.filter(|n| (n.level, n.end) == (run.level, run.end)) {
                    Some(same) => same.top = run.top,
                    None => run.close(row, &mut paths),
                }
            }
            open = next;
        }
        for run in open {
            run.close(ny, &mut paths);
        }
        let filled = paths.iter().enumerate().filter(|(_, (path, _))| !path.is_empty());
        filled.fold(String::new(), |mut out, (level, (path, _))| {
            let _ = writeln!(out, "<path fill=\"{}\" d=\"{path}\"/>", level_colour(level));
            out
        })
    }
}

/// Neighbouring pixels of one colour.
struct Run {
    level: usize,
    start: usize,
    end: usize,
    top: usize,
}

impl Run {
    /// Adds the rectangle to the path of its colour, from the corner where the one before began.
    fn close(self, bottom: usize, paths: &mut [(String, (isize, isize))]) {
        let (width, height) = (self.end - self.start, bottom - self.top);
        let (path, at) = &mut paths[self.level];
        let corner = (self.start as isize, self.top as isize);
        let (across, down) = (corner.0 - at.0, corner.1 - at.1);
        let between = if down < 0 { "" } else { " " };
        let _ = write!(path, "m{across}{between}{down}h{width}v{height}h-{width}z"); // cannot fail
        *at = corner;
    }
}

fn runs(values: &[f64], top: usize, (range, coarse): ([f64; 2], usize)) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (i, value) in values.iter().enumerate().filter(|(_, v)| !v.is_nan()) {
        let level = (level(*value, range) / coarse * coarse + coarse / 2).min(LEVELS - 1);
        match runs.last_mut() {
            Some(run) if run.end == i && run.level == level => run.end = i + 1,
            _ => runs.push(Run { level, start: i, end: i + 1, top }),
        }
    }
    runs
}

/// Draws a raster as SVG with equal scales in x and y.
///
/// # Errors
/// A range of the colour bar that is empty or not finite.
pub fn render_field(figure: &Figure, raster: &Raster, label: &str, range: [f64; 2]) -> Result<String, FigureError> {
    let mut paths = raster.paths(range, 1);
    if paths.len() > LARGE {
        paths = raster.paths(range, 2);
    }
    render_with(figure, raster, (label, range), |place| markup(place, &paths, raster.pixels))
}

/// The figure of a raster that stands in no results: id, title and caption, and the colour bar.
pub(crate) fn figure_of(words: [&str; 3], pixels: [usize; 2], (label, range): (&str, [f64; 2])) -> Figure {
    Figure::new("", words, FigureBody::Field { series: String::new(), pixels, label: label.into(), range })
}

/// Draws a raster that stands in no results: its id, title and caption, and the label of the colour bar with
/// its range.
///
/// # Errors
/// As [`render_field`].
pub fn render_raster(words: [&str; 3], raster: &Raster, bar: (&str, [f64; 2])) -> Result<String, FigureError> {
    render_field(&figure_of(words, raster.pixels, bar), raster, bar.0, bar.1)
}

/// The axes of a raster and the colour bar, with `content` in their frame.
pub(crate) fn render_with(
    figure: &Figure,
    raster: &Raster,
    (label, range): (&str, [f64; 2]),
    content: impl FnOnce(Place) -> String,
) -> Result<String, FigureError> {
    if !is_range(range[0], range[1]) {
        let message = format!("the colour bar cannot range from {} to {}", range[0], range[1]);
        return Err(FigureError::new(&figure.id, message));
    }
    let axes = [0, 1].map(|k| AxisScale::with_range(Scale::Linear, 1e3 * raster.low[k], 1e3 * raster.high[k], 6));
    let none = Axis { label: String::new(), scale: Scale::Linear, range: Some(range) };
    let bar = AxisScale::fit(&none, [], 0.0, 5);
    let labels = bar.ticks.iter().map(|t| text_width(&t.1, TICK_SIZE)).fold(0.0, larger);
    let left = frame::room_left(&axes[1]) + EDGE;
    let room = WIDTH - left - GAP - BAR - 10.0 - labels - LABEL_SIZE - 16.0;
    let ratio = (axes[1].high - axes[1].low) / (axes[0].high - axes[0].low);
    let width = room.min(TALLEST / ratio).round().max(1.0);
    // a narrow picture stands in the middle
    let left = left + (0.5 * (room - width)).round();
    let place = Place { left, top: 20.0, width, height: (width * ratio).round().max(40.0) };
    let size = (WIDTH, place.top + place.height + BELOW + 10.0);
    let description = format!("Picture of {label} over x and y in mm. {}", crate::figure::words(figure));
    svg::page(&figure.id, (&figure.title, &description), size, |page| {
        frame::draw(page, place, &axes, ["x (mm)", "y (mm)"], false)?;
        outline(page, place)?;
        let beside = Place { left: place.left + place.width + GAP, width: BAR, ..place };
        draw_bar(page, beside, &bar, label, labels)?;
        Ok(Some(content(place) + &bar_markup(beside)))
    })
}

/// The coloured pixels, stretched onto the frame.
pub(crate) fn markup(place: Place, paths: &str, pixels: [usize; 2]) -> String {
    let scale = |length: f64, n: usize| length * SCALE / n as f64;
    format!(
        "<g transform=\"translate({} {}) scale({} {})\" shape-rendering=\"crispEdges\">\n{paths}</g>\n",
        px(place.left),
        px(place.top),
        scale(place.width, pixels[0]),
        scale(place.height, pixels[1])
    )
}

fn bar_markup(bar: Place) -> String {
    let step = bar.height * SCALE / LEVELS as f64;
    let mut out = String::from("<g shape-rendering=\"crispEdges\">\n");
    for level in 0..LEVELS {
        let y = f64::from(px(bar.top)) + step * (LEVELS - 1 - level) as f64;
        let (x, width, fill) = (px(bar.left), px(bar.width), level_colour(level));
        let _ = writeln!(out, "<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{step}\" fill=\"{fill}\"/>");
    }
    out + "</g>\n"
}

/// Closes the frame above and to the right.
fn outline(page: &Page, place: Place) -> Drawn {
    let (right, top) = (px(place.left + place.width), px(place.top));
    let corner = vec![(px(place.left), top), (right, top), (right, px(place.top + place.height))];
    page.draw(&PathElement::new(corner, AXIS.stroke_width(px(1.0) as u32)))?;
    Ok(())
}

fn draw_bar(page: &Page, bar: Place, axis: &AxisScale, label: &str, widest: f64) -> Drawn {
    let (left, right) = (px(bar.left), px(bar.left + bar.width));
    let (top, bottom) = (px(bar.top), px(bar.top + bar.height));
    let stroke = AXIS.stroke_width(px(1.0) as u32);
    let border = vec![(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
    page.draw(&PathElement::new(border, stroke))?;
    for (value, words) in &axis.ticks {
        let fraction = (value - axis.low) / (axis.high - axis.low);
        let y = px(bar.top + (1.0 - fraction) * bar.height);
        page.draw(&PathElement::new(vec![(right, y), (right + px(4.0), y)], stroke))?;
        let style = text(TICK_SIZE, INK, HPos::Left, VPos::Center);
        page.draw(&Text::new(words.clone(), (right + px(8.0), y), style))?;
    }
    if let Some(factor) = axis.factor {
        let words = format!("×{}", crate::number::power_of_ten(factor));
        page.draw(&Text::new(words, (left, top - px(6.0)), text(TICK_SIZE, INK, HPos::Left, VPos::Bottom)))?;
    }
    let style = text(LABEL_SIZE, INK, HPos::Center, VPos::Top).transform(FontTransform::Rotate270);
    let at = (right + px(8.0 + widest + 6.0), px(bar.top + 0.5 * bar.height));
    page.draw(&Text::new(label.to_string(), at, style))?;
    Ok(())
}
