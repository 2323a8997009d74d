//! Guides of convergence charts: triangles with the slope of theory, and floors below which values mean
//! nothing.

use fisura_verification::record::{Axis, Floor, Scale, SlopeTriangle};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::axis::AxisScale;
use crate::frame::{Frame, Place};
use crate::style::{AXIS, INK, REGION, TICK_SIZE, px, text, text_width};
use crate::svg::{Drawn, Page};
use crate::trace::{Point, meets, visible};

/// Height of a label, nominal pixels.
const LINE: f64 = 16.0;

/// Value of the hypotenuse at its right end, in drawn units.
pub fn end(triangle: &SlopeTriangle, axes: [&Axis; 2]) -> f64 {
    let [x, y] = axes.map(|axis| axis.scale);
    let coordinate = |scale, value: f64| if scale == Scale::Log { value.log10() } else { value };
    let run = coordinate(x, triangle.x[1]) - coordinate(x, triangle.x[0]);
    let u = coordinate(y, triangle.y0) + triangle.slope * run;
    if y == Scale::Log { 10f64.powf(u) } else { u }
}

/// Draws the triangles. The right angle lies below the hypotenuse, the label beside the upright leg.
pub fn draw_slopes(page: &Page, frame: &mut Frame, slopes: &[SlopeTriangle], axes: &[AxisScale; 2]) -> Drawn {
    for triangle in slopes {
        let [left, right] = triangle.x.map(|x| axes[0].coordinate(x));
        let low = axes[1].coordinate(triangle.y0);
        let high = low + triangle.slope * (right - left);
        let corners = [(left, low), (right, high), if triangle.slope > 0.0 { (right, low) } else { (left, high) }];
        if !corners.iter().all(|corner| visible(*corner, &axes[0], &axes[1])) {
            continue;
        }
        frame.draw_series([Polygon::new(corners.to_vec(), REGION.mix(0.14).filled())])?;
        let outline: Vec<Point> = corners.iter().chain(&corners[..2]).copied().collect();
        frame.draw_series([PathElement::new(outline, AXIS.stroke_width(px(1.1) as u32))])?;
        let at = frame.backend_coord(&(corners[2].0, 0.5 * (low + high)));
        let (shift, side) = if triangle.slope > 0.0 { (5.0, HPos::Left) } else { (-5.0, HPos::Right) };
        let label =
            Text::new(triangle.label.clone(), (at.0 + px(shift), at.1), text(TICK_SIZE, INK, side, VPos::Center));
        page.draw(&label)?;
    }
    Ok(())
}

/// Draws the floors: a dashed line, what lies below shaded, and a label where none of `lines` (axis
/// coordinates) runs.
pub fn draw_floors(
    page: &Page,
    frame: &mut Frame,
    place: Place,
    floors: &[Floor],
    axes: &[AxisScale; 2],
    lines: &[Vec<Point>],
) -> Drawn {
    let [x, y] = axes;
    for floor in floors {
        let u = y.coordinate(floor.y);
        if !(y.low..=y.high).contains(&u) {
            continue;
        }
        frame.draw_series([Rectangle::new([(x.low, y.low), (x.high, u)], REGION.mix(0.10).filled())])?;
        let line = PathElement::new([(x.low, u), (x.high, u)], AXIS.stroke_width(px(1.1) as u32));
        page.dashed(&[6.0, 4.0], || Ok(frame.draw_series([line]).map(|_| ())?))?;
        let (right, below) = label_place(&floor.label, u, place, axes, lines);
        let (edge, side) = if right { (place.width - 6.0, HPos::Right) } else { (6.0, HPos::Left) };
        let (shift, anchor) = if below { (4.0, VPos::Top) } else { (-4.0, VPos::Bottom) };
        let height = (1.0 - (u - y.low) / (y.high - y.low)) * place.height;
        let at = (px(place.left + edge), px(place.top + height + shift));
        page.draw(&Text::new(floor.label.clone(), at, text(TICK_SIZE, INK, side, anchor)))?;
    }
    Ok(())
}

/// Whether the label of a floor at `u` stands at the right side, and whether below the line: the first place
/// in the frame that no line runs through.
fn label_place(label: &str, u: f64, place: Place, [x, y]: &[AxisScale; 2], lines: &[Vec<Point>]) -> (bool, bool) {
    let width = (text_width(label, TICK_SIZE) + 12.0) / place.width * (x.high - x.low);
    let height = LINE / place.height * (y.high - y.low);
    let choices = [(true, true), (false, true), (true, false), (false, false)];
    let free = |(right, below): &(bool, bool)| {
        let across = if *right { [x.high - width, x.high] } else { [x.low, x.low + width] };
        let along = if *below { [u - height, u] } else { [u, u + height] };
        let inside = along[0] >= y.low && along[1] <= y.high;
        inside && !lines.iter().any(|line| meets(line, across, along))
    };
    choices.into_iter().find(free).unwrap_or((true, u - height >= y.low))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes() -> [AxisScale; 2] {
        [AxisScale::with_range(Scale::Log, -2.0, 0.0, 5), AxisScale::with_range(Scale::Log, -12.0, 0.0, 6)]
    }

    #[test]
    fn a_hypotenuse_ends_where_its_slope_says() {
        let axis = |scale| Axis { label: String::new(), scale, range: None };
        let triangle = SlopeTriangle { x: [0.1, 0.2], y0: 3.0, slope: 2.0, label: "2".into() };
        let (log, linear) = (axis(Scale::Log), axis(Scale::Linear));
        assert!((end(&triangle, [&log, &log]) - 12.0).abs() < 1e-12);
        assert!((end(&triangle, [&linear, &linear]) - 3.2).abs() < 1e-12);
    }

    #[test]
    fn a_label_of_a_floor_gives_way_to_curves() {
        let place = Place { left: 0.0, top: 0.0, width: 600.0, height: 340.0 };
        let at = |lines: &[Vec<Point>], u| label_place("round-off", u, place, &axes(), lines);
        assert_eq!(at(&[], -10.0), (true, true));
        assert_eq!(at(&[vec![(-0.3, -9.0), (-0.1, -11.0)]], -10.0), (false, true), "a curve runs down at the right");
        assert_eq!(at(&[], -11.9), (true, false), "no room below");
    }
}
