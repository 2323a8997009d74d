//! Horizontal bars with their spread: for things that have names instead of abscissae.

use fisura_verification::bench::record::Spread;
use fisura_verification::extremes::larger;
use fisura_verification::record::Scale;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use super::{Exhibit, Plot};
use crate::axis::AxisScale;
use crate::number::pretty;
use crate::series::FigureError;
use crate::style::{AXIS, GRID, INK, LABEL_SIZE, TICK_SIZE, WIDTH, looks, px, text, text_width};
use crate::svg::{self, Drawn, Page};

/// Nominal height of a bar, of the room between rows, and above the first.
const BAR: f64 = 13.0;
const GAP: f64 = 9.0;
const TOP: f64 = 10.0;
/// Room below the bars for the axis.
const BELOW: f64 = 46.0;
/// Height of a line of the legend.
const LINE: f64 = 20.0;

/// Bars of one or more series side by side in named rows.
#[derive(Debug, Clone, PartialEq)]
pub struct BarChart {
    /// Id of the figure: the name of its file without ending.
    pub id: String,
    /// Title, for those who cannot see it.
    pub title: String,
    /// Name and unit of the values.
    pub axis: String,
    /// Names of the series.
    pub series: Vec<String>,
    /// Rows: name, and a value for each series that has one.
    pub rows: Vec<(String, Vec<Option<Spread>>)>,
}

impl BarChart {
    /// The chart with what it says.
    pub fn exhibit(self, caption: impl Into<String>, reading: String) -> Exhibit {
        let svg = render_bars(&self);
        Exhibit::Plot(Plot { id: self.id, title: self.title, caption: caption.into(), reading, svg })
    }
}

/// Draws the chart as SVG.
///
/// # Errors
/// If the drawing library gives up.
pub fn render_bars(chart: &BarChart) -> Result<String, FigureError> {
    let row = chart.series.len() as f64 * BAR + GAP;
    let legend = if chart.series.len() > 1 { LINE } else { 0.0 };
    let height = TOP + row * chart.rows.len() as f64 + BELOW + legend;
    let words: Vec<String> = chart.rows.iter().map(|(name, values)| describe(name, values)).collect();
    let description = format!("Bars of {}. {}.", chart.axis, words.join("; "));
    svg::page(&chart.id, (&chart.title, &description), (WIDTH, height), |page| draw(page, chart, row).map(|()| None))
}

fn describe(name: &str, values: &[Option<Spread>]) -> String {
    let values: Vec<String> = values.iter().map(|v| v.map_or("–".to_string(), |v| pretty(v.median, 3))).collect();
    format!("{name}: {}", values.join(", "))
}

fn draw(page: &Page, chart: &BarChart, row: f64) -> Drawn {
    let widest = chart.rows.iter().map(|(name, _)| text_width(name, TICK_SIZE)).fold(0.0, larger);
    let left = (widest + 14.0).min(0.55 * WIDTH);
    let width = WIDTH - left - 64.0; // room for the number beside the longest bar
    let largest = chart.rows.iter().flat_map(|(_, v)| v.iter().flatten()).map(|v| v.max).fold(0.0, larger);
    let axis = AxisScale::with_range(Scale::Linear, 0.0, if largest > 0.0 { largest } else { 1.0 }, 6);
    let place = |value: f64| left + width * (value / axis.high).clamp(0.0, 1.0);
    let bottom = TOP + row * chart.rows.len() as f64;
    for (value, label) in &axis.ticks {
        let x = px(place(*value));
        page.draw(&PathElement::new(vec![(x, px(TOP)), (x, px(bottom))], GRID.stroke_width(px(0.8) as u32)))?;
        page.draw(&Text::new(label.clone(), (x, px(bottom + 12.0)), text(TICK_SIZE, INK, HPos::Center, VPos::Center)))?;
    }
    let factor = axis.factor.map_or(String::new(), |f| format!(", ×{}", crate::number::power_of_ten(f)));
    let middle = (px(left + 0.5 * width), px(bottom + 32.0));
    let title = format!("{}{factor}", chart.axis);
    page.draw(&Text::new(title, middle, text(LABEL_SIZE, INK, HPos::Center, VPos::Center)))?;
    let colours: Vec<RGBColor> = looks(&vec![fisura_verification::record::CurveStyle::Line; chart.series.len()])
        .into_iter()
        .map(|look| look.colour)
        .collect();
    for (index, (name, values)) in chart.rows.iter().enumerate() {
        let top = TOP + index as f64 * row + 0.5 * GAP;
        let centre = top + 0.5 * (row - GAP);
        page.draw(&Text::new(
            name.clone(),
            (px(left - 8.0), px(centre)),
            text(TICK_SIZE, INK, HPos::Right, VPos::Center),
        ))?;
        for (series, value) in values.iter().enumerate() {
            if let Some(value) = value {
                bar(page, *value, top + series as f64 * BAR, &place, colours[series])?;
            }
        }
    }
    page.draw(&PathElement::new(vec![(px(left), px(TOP)), (px(left), px(bottom))], AXIS.stroke_width(px(1.0) as u32)))?;
    if chart.series.len() > 1 {
        legend(page, chart, left, bottom + BELOW + 4.0, &colours)?;
    }
    Ok(())
}

/// One bar to the median, its extremes as a whisker, and the number.
fn bar(page: &Page, value: Spread, top: f64, place: &impl Fn(f64) -> f64, colour: RGBColor) -> Drawn {
    let (low, high) = (top + 1.5, top + BAR - 1.5);
    let corners = [(px(place(0.0)), px(low)), (px(place(value.median)), px(high))];
    page.draw(&Rectangle::new(corners, colour.mix(0.75).filled()))?;
    let y = px(0.5 * (low + high));
    let stroke = INK.stroke_width(px(1.1) as u32);
    let [from, to] = [value.min, value.max].map(|v| px(place(v)));
    page.draw(&PathElement::new(vec![(from, y), (to, y)], stroke))?;
    for end in [from, to] {
        page.draw(&PathElement::new(vec![(end, px(low + 2.0)), (end, px(high - 2.0))], stroke))?;
    }
    let number = (px(place(value.max) + 6.0), y);
    page.draw(&Text::new(pretty(value.median, 3), number, text(TICK_SIZE, INK, HPos::Left, VPos::Center)))?;
    Ok(())
}

fn legend(page: &Page, chart: &BarChart, left: f64, y: f64, colours: &[RGBColor]) -> Drawn {
    let mut x = left;
    for (name, colour) in chart.series.iter().zip(colours) {
        let corners = [(px(x), px(y - 5.0)), (px(x + 18.0), px(y + 5.0))];
        page.draw(&Rectangle::new(corners, colour.mix(0.75).filled()))?;
        page.draw(&Text::new(name.clone(), (px(x + 24.0), px(y)), text(LABEL_SIZE, INK, HPos::Left, VPos::Center)))?;
        x += 48.0 + text_width(name, LABEL_SIZE);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_have_names_numbers_and_whiskers() {
        let value = |median| Some(Spread { median, min: 0.9 * median, max: 1.2 * median });
        let chart = BarChart {
            id: "timing/bars".into(),
            title: "Bars".into(),
            axis: "time (ns)".into(),
            series: vec!["p = 2".into(), "p = 3".into()],
            rows: vec![("sweep <a>".into(), vec![value(12.0), value(20.0)]), ("grid".into(), vec![value(3.0), None])],
        };
        let svg = render_bars(&chart).unwrap();
        assert_eq!(svg, render_bars(&chart).unwrap());
        for text in
            ["sweep &lt;a&gt;", "grid", "p = 3", "time (ns)", "Bars of time (ns). sweep &lt;a&gt;: 12, 20; grid: 3, –."]
        {
            assert!(svg.contains(text), "{text:?} is missing");
        }
        assert!(render_bars(&BarChart { rows: vec![], ..chart }).is_ok());
    }
}
