//! The frame of a figure: axes, ticks, grid, axis titles.

use fisura_verification::extremes::larger;
use plotters::coord::cartesian::Cartesian2d;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::axis::AxisScale;
use crate::canvas::Canvas;
use crate::number::power_of_ten;
use crate::style::{AXIS, GRID, INK, LABEL_SIZE, TICK_SIZE, px, text, text_width};
use crate::svg::{Drawn, Page};

/// Chart of plotters over our own axes.
pub type Frame<'a> = ChartContext<'a, Canvas, Cartesian2d<AxisScale, AxisScale>>;

/// Room below the frame for tick labels and the title of the abscissa.
pub const BELOW: f64 = 42.0;
/// Length of a minor tick.
const MINOR: f64 = 2.5;
/// Free room at the left edge of the page.
pub const EDGE: f64 = 6.0;

/// Nominal place of the frame on its page.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Distance of the frame from the left edge of the page, nominal pixels.
    pub left: f64,
    /// Distance of the frame from the upper edge of the page, nominal pixels.
    pub top: f64,
    /// Width of the rectangle.
    pub width: f64,
    /// Height of the rectangle.
    pub height: f64,
}

/// Room left of the frame for the labels and the title of the ordinate.
pub fn room_left(y: &AxisScale) -> f64 {
    let widest = y.ticks.iter().map(|t| text_width(&t.1, TICK_SIZE)).fold(0.0, larger);
    (widest + LABEL_SIZE + 26.0).round()
}

/// Draws axes, grid and titles; the frame returned takes curves in axis coordinates.
pub fn draw<'a>(
    page: &'a Page,
    place: Place,
    axes: &[AxisScale; 2],
    titles: [&str; 2],
    grid: bool,
) -> Drawn<Frame<'a>> {
    let left = room_left(&axes[1]);
    let (width, _) = page.dim_in_pixel();
    let area = (**page).clone().shrink(
        (px(place.left - left), px(place.top)),
        ((px(left + place.width)).min(width as i32) as u32, px(place.height + BELOW) as u32),
    );
    let mut frame = ChartBuilder::on(&area)
        .set_label_area_size(LabelAreaPosition::Left, px(left))
        .set_label_area_size(LabelAreaPosition::Bottom, px(BELOW))
        .build_cartesian_2d(axes[0].clone(), axes[1].clone())?;
    let tick = text(TICK_SIZE, INK, HPos::Center, VPos::Center);
    let line = if grid { GRID.stroke_width(px(0.8) as u32) } else { TRANSPARENT.into() };
    frame
        .configure_mesh()
        .axis_style(AXIS.stroke_width(px(1.0) as u32))
        .bold_line_style(line)
        .light_line_style(TRANSPARENT)
        .label_style(tick)
        .axis_desc_style(text(LABEL_SIZE, INK, HPos::Center, VPos::Center))
        .set_all_tick_mark_size(px(4.0))
        .x_desc(titles[0])
        .y_desc(titles[1])
        .draw()?;
    minor_ticks(page, place, axes)?;
    factors(page, place, axes)?;
    Ok(frame)
}

/// Short marks at the unlabelled ticks of logarithmic axes.
fn minor_ticks(page: &Page, place: Place, axes: &[AxisScale; 2]) -> Drawn {
    let fraction = |axis: &AxisScale, u: f64| (u - axis.low) / (axis.high - axis.low);
    let (left, bottom) = (place.left, place.top + place.height);
    let along = axes[0].minor.iter().map(|u| left + fraction(&axes[0], *u) * place.width);
    let along = along.map(|x| [(x, bottom), (x, bottom + MINOR)]);
    let across = axes[1].minor.iter().map(|u| bottom - fraction(&axes[1], *u) * place.height);
    let across = across.map(|y| [(left - MINOR, y), (left, y)]);
    for ends in along.chain(across) {
        let line = ends.map(|(x, y)| (px(x), px(y))).to_vec();
        page.draw(&PathElement::new(line, AXIS.stroke_width(px(0.8) as u32)))?;
    }
    Ok(())
}

/// Prints the common powers of ten at the ends of the axes.
fn factors(page: &Page, place: Place, axes: &[AxisScale; 2]) -> Drawn {
    let words = |factor: i32| format!("×{}", power_of_ten(factor));
    if let Some(factor) = axes[0].factor {
        let at = (px(place.left + place.width), px(place.top + place.height + BELOW));
        page.draw(&Text::new(words(factor), at, text(TICK_SIZE, INK, HPos::Right, VPos::Bottom)))?;
    }
    if let Some(factor) = axes[1].factor {
        let at = (px(place.left - 8.0), px(place.top - 9.0));
        page.draw(&Text::new(words(factor), at, text(TICK_SIZE, INK, HPos::Right, VPos::Bottom)))?;
    }
    Ok(())
}
