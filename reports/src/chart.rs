//! Line charts: curves over common axes, reference bands, marked regions, slopes of theory, a legend below.

use fisura_verification::extremes::larger;
use fisura_verification::record::{Axis, Curve, CurveStyle, Figure, Floor, Region, SlopeTriangle};
use plotters::prelude::*;

use crate::axis::AxisScale;
use crate::frame::{self, BELOW, EDGE, Frame, Place};
use crate::guides;
use crate::legend::{BAND, Legend, draw_markers};
use crate::regions::{self, Labels};
use crate::series::{FigureError, SeriesSet};
use crate::style::{AXIS, CURVE_WIDTH, TICK_SIZE, WIDTH, looks, px, text_width};
use crate::svg::{self, Drawn, Page};
use crate::thin::{drawable, markable, thin};
use crate::trace::{Point, Trace, pieces, visible};

/// Nominal height of the frame.
const HEIGHT: f64 = 340.0;
/// Least width of the frame, whatever stands beside it.
const NARROWEST: f64 = 120.0;
/// Most curves, and most regions, slopes and floors of each.
const MOST: [usize; 2] = [500, 100];
/// Markers on a line that has them only to be told apart.
const SPARSE: usize = 9;

/// What a chart shows beside its curves.
#[derive(Debug, Clone, Copy)]
pub struct Marks<'a> {
    /// Regions that are shaded, such as those in which an event should fall.
    pub regions: &'a [Region],
    /// Triangles that show the slopes of theory.
    pub slopes: &'a [SlopeTriangle],
    /// Levels below which values mean nothing.
    pub floors: &'a [Floor],
}

/// Everything needed to draw a chart.
struct Chart<'a> {
    titles: [&'a str; 2],
    axes: [AxisScale; 2],
    traces: Vec<Trace>,
    marks: Marks<'a>,
    labels: Labels,
    legend: Legend,
    place: Place,
}

/// Draws the chart of a figure as SVG. The series named by its curves must be in `set`.
///
/// # Errors
/// A missing series or column, or a curve without a row that can be drawn, is named.
pub fn render_chart(
    figure: &Figure,
    axes: [&Axis; 2],
    curves: &[Curve],
    marks: Marks,
    set: &SeriesSet,
) -> Result<String, FigureError> {
    let counts = [curves.len(), marks.regions.len().max(marks.slopes.len()).max(marks.floors.len())];
    if counts[0] > MOST[0] || counts[1] > MOST[1] {
        let ([curves, marks], [most, most_marks]) = (counts, MOST);
        let message = format!("{curves} curves and {marks} marks of a kind; at most {most} and {most_marks} are drawn");
        return Err(FigureError::new(&figure.id, message));
    }
    let chart = Chart::prepare(&figure.id, axes, curves, marks, set)?;
    let labels: Vec<&str> = curves.iter().map(|c| c.label.as_str()).collect();
    let theory: Vec<&str> = marks.slopes.iter().map(|s| s.label.as_str()).collect();
    let description = format!(
        "Chart of {} against {}. Curves: {}. {}{}",
        axes[1].label,
        axes[0].label,
        labels.join("; "),
        if theory.is_empty() { String::new() } else { format!("Slopes of theory: {}. ", theory.join(", ")) },
        crate::figure::words(figure)
    );
    svg::page(&figure.id, (&figure.title, &description), chart.size(), |page| chart.draw(page).map(|()| None))
}

impl<'a> Chart<'a> {
    fn prepare(
        id: &str,
        axes: [&'a Axis; 2],
        curves: &[Curve],
        marks: Marks<'a>,
        set: &SeriesSet,
    ) -> Result<Self, FigureError> {
        let Marks { regions, slopes, floors } = marks;
        let looks = looks(&curves.iter().map(|c| c.style).collect::<Vec<_>>());
        let scales = axes.map(|a| a.scale);
        let traces = curves.iter().zip(looks).map(|(c, look)| Trace::read(id, c, look, scales, set));
        let traces = traces.collect::<Result<Vec<_>, _>>()?;
        let marked = curves.iter().any(|c| matches!(c.style, CurveStyle::Markers | CurveStyle::Points));
        let abscissae = traces.iter().flat_map(|t| t.points.iter().map(|p| p.0));
        let abscissae = abscissae.chain(traces.iter().flat_map(|t| t.spread.iter().copied().flatten()));
        let abscissae = abscissae.chain(regions.iter().flat_map(|r| r.x.into_iter().flatten()));
        let abscissae = abscissae.chain(slopes.iter().flat_map(|s| s.x));
        let x = AxisScale::fit(axes[0], abscissae, if marked { 0.04 } else { 0.0 }, 7);
        let ordinates = traces.iter().flat_map(Trace::ordinates);
        let ordinates = ordinates.chain(regions.iter().flat_map(|r| r.y.into_iter().flatten()));
        let ordinates = ordinates.chain(slopes.iter().flat_map(|s| [s.y0, guides::end(s, axes)]));
        let ordinates = ordinates.chain(floors.iter().map(|f| f.y));
        let y = AxisScale::fit(axes[1], ordinates, 0.05, 6);

        let left = frame::room_left(&y) + EDGE;
        let last = x.ticks.last().map_or(0.0, |t| 0.5 * text_width(&t.1, TICK_SIZE));
        let beside = Labels::place(regions, &x, WIDTH).width();
        let width = (WIDTH - left - 8.0 - (beside + 4.0).max(last + 6.0)).round().max(NARROWEST);
        let labels = Labels::place(regions, &x, width);
        let top = (12.0 + labels.height()).max(if y.factor.is_some() { 28.0 } else { 0.0 });
        let legend = Legend::arrange(&traces, WIDTH - left - 20.0);
        let place = Place { left, top, width, height: HEIGHT };
        Ok(Self { titles: axes.map(|a| a.label.as_str()), axes: [x, y], traces, marks, labels, legend, place })
    }

    fn size(&self) -> (f64, f64) {
        (WIDTH, (self.place.top + HEIGHT + BELOW + 14.0 + self.legend.height + 8.0).round())
    }

    fn draw(&self, page: &Page) -> Drawn {
        let mut frame = frame::draw(page, self.place, &self.axes, self.titles, true)?;
        regions::shade(&mut frame, self.marks.regions, &self.axes)?;
        self.labels.draw(page, self.place, self.marks.regions, &self.axes[1])?;
        let [x, y] = &self.axes;
        let lines: Vec<Vec<Point>> = self.traces.iter().map(|t| t.coordinates(x, y)).collect();
        guides::draw_floors(page, &mut frame, self.place, self.marks.floors, &self.axes, &lines)?;
        guides::draw_slopes(page, &mut frame, self.marks.slopes, &self.axes)?;
        if self.axes[1].crosses_zero() {
            let ends = vec![(self.axes[0].low, 0.0), (self.axes[0].high, 0.0)];
            frame.draw_series([PathElement::new(ends, AXIS.mix(0.7).stroke_width(px(0.8) as u32))])?;
        }
        let bands = self.traces.iter().filter(|t| t.style == CurveStyle::Reference);
        for trace in bands {
            let fill = trace.look.colour.mix(BAND).filled();
            let outlines = trace.band(&self.axes[0], &self.axes[1], self.place.width);
            bounded(trace, drawable(&outlines, &self.axes[0], &self.axes[1], (self.place.width, self.place.height)))?;
            frame.draw_series(outlines.into_iter().map(|outline| Polygon::new(outline, fill)))?;
        }
        for trace in &self.traces {
            self.draw_trace(page, &mut frame, trace)?;
        }
        self.legend.draw(page, (self.place.left, self.place.top + HEIGHT + BELOW + 14.0))
    }

    fn draw_trace(&self, page: &Page, frame: &mut Frame, trace: &Trace) -> Drawn {
        let [x, y] = &self.axes;
        let points = trace.coordinates(x, y);
        let width = if trace.style == CurveStyle::Reference { 0.85 * CURVE_WIDTH } else { CURVE_WIDTH };
        let stroke = trace.look.colour.stroke_width(px(width) as u32);
        if trace.style == CurveStyle::Points {
            self.draw_bars(frame, trace)?;
        } else {
            let size = (self.place.width, self.place.height);
            let lines: Vec<_> = pieces(&points, x, y).into_iter().map(|line| thin(line, x, y, size)).collect();
            bounded(trace, drawable(&lines, x, y, size))?;
            let lines = lines.into_iter().map(|line| PathElement::new(line, stroke));
            page.dashed(trace.look.dashes, || Ok(frame.draw_series(lines).map(|_| ())?))?;
        }
        self.draw_spread(frame, trace)?;
        let seen: Vec<Point> = points.into_iter().filter(|p| visible(*p, x, y)).collect();
        let marker = trace.look.marker.or((seen.len() == 1).then_some(crate::style::Marker::Circle));
        let Some(marker) = marker else { return Ok(()) };
        let marked = marked(&seen, trace, &self.traces);
        bounded(trace, markable(marked.len()))?;
        let radius = if marked.len() > 24 { 2.6 } else { 3.6 };
        let floor = self.marks.floors.iter().map(|f| y.coordinate(f.y)).fold(f64::NEG_INFINITY, larger);
        let places: Vec<_> = marked.iter().map(|p| (frame.backend_coord(p), p.1 <= floor)).collect();
        draw_markers(page, &places, marker, radius, trace.look.colour)
    }

    /// Bars along the abscissa from the least to the largest of repeated measurements.
    fn draw_spread(&self, frame: &mut Frame, trace: &Trace) -> Drawn {
        let [x, y] = &self.axes;
        let stroke = trace.look.colour.stroke_width(px(1.2) as u32);
        let cap = 3.0 / self.place.height * (y.high - y.low);
        bounded(trace, markable(trace.spread.len()))?;
        for (point, ends) in trace.points.iter().zip(&trace.spread) {
            let (at, ends) = (y.coordinate(point.1), ends.map(|end| x.coordinate(end).clamp(x.low, x.high)));
            if !visible((x.coordinate(point.0), at), x, y) || ends.iter().any(|end| !end.is_finite()) {
                continue;
            }
            let caps = ends.map(|end| PathElement::new(vec![(end, at - cap), (end, at + cap)], stroke));
            frame.draw_series([PathElement::new(ends.map(|end| (end, at)).to_vec(), stroke)])?;
            frame.draw_series(caps)?;
        }
        Ok(())
    }

    fn draw_bars(&self, frame: &mut Frame, trace: &Trace) -> Drawn {
        let [x, y] = &self.axes;
        let stroke = trace.look.colour.stroke_width(px(1.2) as u32);
        let cap = 3.0 / self.place.width * (x.high - x.low);
        bounded(trace, markable(trace.half_widths.len()))?;
        for (p, half) in trace.points.iter().zip(&trace.half_widths) {
            let at = x.coordinate(p.0);
            if !visible((at, y.low), x, y) || !y.coordinate(p.1).is_finite() {
                continue;
            }
            let place = |v: f64| y.coordinate(v).max(y.low).min(y.high);
            let (low, high) = (place(p.1 - half), place(p.1 + half));
            let caps = [low, high].map(|v| PathElement::new(vec![(at - cap, v), (at + cap, v)], stroke));
            frame.draw_series([PathElement::new(vec![(at, low), (at, high)], stroke)])?;
            frame.draw_series(caps)?;
        }
        Ok(())
    }
}

/// The same with the name of the curve.
fn bounded(trace: &Trace, outcome: Result<(), String>) -> Drawn {
    Ok(outcome.map_err(|why| format!("{:?}: {why}", trace.label))?)
}

/// Points that get a marker: all of them, or a few along a plain line, shifted from line to line.
fn marked(seen: &[Point], trace: &Trace, all: &[Trace]) -> Vec<Point> {
    if trace.style != CurveStyle::Line || seen.len() <= SPARSE {
        return seen.to_vec();
    }
    let lines = all.iter().filter(|t| t.style == CurveStyle::Line);
    let place = lines.take_while(|t| t.look != trace.look).count();
    let stride = seen.len() / SPARSE;
    seen.iter().skip(stride * (2 * place + 1) / 7 % stride).step_by(stride.max(1)).copied().collect()
}
