//! Marked regions of a chart: shaded, with labels where no curve runs.

use fisura_verification::record::Region;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, VPos};

use crate::axis::AxisScale;
use crate::frame::{Frame, Place};
use crate::style::{AXIS, INK, REGION, TICK_SIZE, px, text, text_width};
use crate::svg::{Drawn, Page};

/// Height of one row of labels above the frame.
const ROW: f64 = 16.0;

/// Where the labels go: those of upright bands in rows above the frame, those of level bands right of it.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Labels {
    /// Text, nominal centre measured from the left side of the frame, row counted upwards.
    above: Vec<(String, f64, usize)>,
    /// Text and index of the region.
    beside: Vec<(String, usize)>,
}

impl Labels {
    /// Places the labels above a frame of nominal `width`, in as many rows as it takes to keep them apart.
    pub fn place(regions: &[Region], x: &AxisScale, width: f64) -> Self {
        let mut labels = Self::default();
        let mut taken: Vec<Vec<(f64, f64)>> = Vec::new();
        for (index, region) in regions.iter().enumerate() {
            let Some(range) = region.x else {
                labels.beside.push((region.label.clone(), index));
                continue;
            };
            let [low, high] = extent(Some(range), x);
            let half = 0.5 * text_width(&region.label, TICK_SIZE) + 4.0;
            let middle = (0.5 * (low + high) - x.low) / (x.high - x.low) * width;
            let centre = middle.min(width - half).max(half);
            let span = (centre - half, centre + half);
            let free = |row: &Vec<(f64, f64)>| row.iter().all(|t| span.1 <= t.0 || span.0 >= t.1);
            let row = taken.iter().position(free).unwrap_or(taken.len());
            if row == taken.len() {
                taken.push(Vec::new());
            }
            taken[row].push(span);
            labels.above.push((region.label.clone(), centre, row));
        }
        labels
    }

    /// Nominal height that the labels need above the frame.
    pub fn height(&self) -> f64 {
        self.above.iter().map(|l| (l.2 + 1) as f64 * ROW).fold(0.0, f64::max)
    }

    /// Nominal width that the labels need right of the frame.
    pub fn width(&self) -> f64 {
        self.beside.iter().map(|l| text_width(&l.0, TICK_SIZE) + 6.0).fold(0.0, f64::max)
    }

    /// Prints the labels around the frame.
    pub fn draw(&self, page: &Page, place: Place, regions: &[Region], y: &AxisScale) -> Drawn {
        for (label, centre, row) in &self.above {
            let bottom = place.top - 3.0 - *row as f64 * ROW;
            let at = (px(place.left + centre), px(bottom));
            page.draw(&Text::new(label.clone(), at, text(TICK_SIZE, INK, HPos::Center, VPos::Bottom)))?;
            if *row > 0 {
                let stem = vec![(at.0, px(place.top)), (at.0, px(bottom - 1.0))];
                page.draw(&PathElement::new(stem, AXIS.mix(0.35).stroke_width(px(0.6) as u32)))?;
            }
        }
        for (label, index) in &self.beside {
            let [low, high] = extent(regions[*index].y, y);
            let fraction = (0.5 * (low + high) - y.low) / (y.high - y.low);
            let at = (px(place.left + place.width + 6.0), px(place.top + (1.0 - fraction) * place.height));
            page.draw(&Text::new(label.clone(), at, text(TICK_SIZE, INK, HPos::Left, VPos::Center)))?;
        }
        Ok(())
    }
}

/// Shades the regions, below the curves.
pub fn shade(frame: &mut Frame, regions: &[Region], axes: &[AxisScale; 2]) -> Drawn {
    for region in regions {
        let ([x0, x1], [y0, y1]) = (extent(region.x, &axes[0]), extent(region.y, &axes[1]));
        let corners = [(x0, y0), (x1, y1)];
        frame.draw_series([Rectangle::new(corners, REGION.mix(0.17).filled())])?;
        let edge = REGION.mix(0.6).stroke_width(px(0.7) as u32);
        if region.x.is_some() {
            frame.draw_series([x0, x1].map(|x| PathElement::new(vec![(x, y0), (x, y1)], edge)))?;
        }
        if region.y.is_some() {
            frame.draw_series([y0, y1].map(|y| PathElement::new(vec![(x0, y), (x1, y)], edge)))?;
        }
    }
    Ok(())
}

/// A range in axis coordinates within the axis; the whole axis where there is none.
fn extent(range: Option<[f64; 2]>, axis: &AxisScale) -> [f64; 2] {
    let Some([a, b]) = range else { return [axis.low, axis.high] };
    let place = |v: f64, otherwise: f64| {
        let u = axis.coordinate(v);
        if u.is_nan() { otherwise } else { u.clamp(axis.low, axis.high) }
    };
    [place(a.min(b), axis.low), place(a.max(b), axis.high)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fisura_verification::record::Scale;

    #[test]
    fn labels_that_would_touch_move_up() {
        let axis = AxisScale::with_range(Scale::Linear, 0.0, 80.0, 5);
        let region = |a: f64| Region { label: "crack leaves the axis".into(), x: Some([a, a + 1.0]), y: None };
        let labels = Labels::place(&[region(30.0), region(31.0), region(79.0)], &axis, 600.0);
        let rows: Vec<usize> = labels.above.iter().map(|l| l.2).collect();
        assert_eq!(rows, [0, 1, 0]);
        assert!(labels.above[2].1 < 560.0, "kept within the frame");
        assert_eq!(labels.height(), 2.0 * ROW);
    }
}
