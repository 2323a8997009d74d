//! Marked regions of a chart: shaded, with labels where no curve runs.

use fisura_verification::extremes::larger;
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
    /// Places the labels above a frame of nominal `width`: centred on their bands, pushed apart where two
    /// would touch, in a further row where that does not help.
    pub fn place(regions: &[Region], x: &AxisScale, width: f64) -> Self {
        let mut labels = Self::default();
        let mut upright: Vec<(usize, [f64; 2])> = Vec::new();
        for (index, region) in regions.iter().enumerate() {
            match region.x {
                None => labels.beside.push((region.label.clone(), index)),
                range => upright.push((index, extent(range, x).map(|u| (u - x.low) / (x.high - x.low) * width))),
            }
        }
        upright.sort_by(|a, b| (a.1[0] + a.1[1]).total_cmp(&(b.1[0] + b.1[1])));
        let mut rows: Vec<Vec<Span>> = Vec::new();
        for (index, band) in upright {
            let span = Span::new(index, band, 0.5 * text_width(&regions[index].label, TICK_SIZE) + 4.0, width);
            if !rows.iter_mut().any(|row| span.join(row, width)) {
                rows.push(vec![span]);
            }
        }
        for (number, row) in rows.iter().enumerate() {
            labels.above.extend(row.iter().map(|s| (regions[s.index].label.clone(), s.centre, number)));
        }
        labels
    }

    /// Nominal height that the labels need above the frame.
    pub fn height(&self) -> f64 {
        self.above.iter().map(|l| (l.2 + 1) as f64 * ROW).fold(0.0, larger)
    }

    /// Nominal width that the labels need right of the frame.
    pub fn width(&self) -> f64 {
        self.beside.iter().map(|l| text_width(&l.0, TICK_SIZE) + 6.0).fold(0.0, larger)
    }

    /// Prints the labels around the frame.
    pub fn draw(&self, page: &Page, place: Place, regions: &[Region], y: &AxisScale) -> Drawn {
        for (label, centre, row) in &self.above {
            let bottom = place.top - 3.0 - *row as f64 * ROW;
            let at = (px(place.left + centre), px(bottom));
            page.draw(&Text::new(label.clone(), at, text(TICK_SIZE, INK, HPos::Center, VPos::Bottom)))?;
            let covered =
                |l: &(String, f64, usize)| l.2 < *row && (l.1 - centre).abs() < 0.5 * text_width(&l.0, TICK_SIZE);
            if *row > 0 && !self.above.iter().any(covered) {
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

/// A label on its way to a row.
#[derive(Debug, Clone, Copy)]
struct Span {
    index: usize,
    band: [f64; 2],
    centre: f64,
    half: f64,
}

impl Span {
    fn new(index: usize, band: [f64; 2], half: f64, width: f64) -> Self {
        Self { index, band, centre: 0.0, half }.at(0.5 * (band[0] + band[1]), width)
    }

    fn at(self, centre: f64, width: f64) -> Self {
        Self { centre: centre.min(width - self.half).max(self.half), ..self }
    }

    /// Joins a row, if need be by starting with its band while the label before ends with its own.
    fn join(self, row: &mut Vec<Span>, width: f64) -> bool {
        let clear = |a: &Span, b: &Span| a.centre + a.half <= b.centre - b.half;
        let Some(last) = row.last().copied() else { return false };
        let before = row.len().checked_sub(2).map(|i| row[i]);
        let moved = last.at(last.band[1] - last.half, width);
        let moved_fits = before.is_none_or(|b| clear(&b, &moved));
        for own in [self, self.at(self.band[0] + self.half, width)] {
            for previous in [Some(last), moved_fits.then_some(moved)].into_iter().flatten() {
                if clear(&previous, &own) {
                    row.pop();
                    row.extend([previous, own]);
                    return true;
                }
            }
        }
        false
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
    fn labels_that_would_touch_move_apart_then_up() {
        let axis = AxisScale::with_range(Scale::Linear, 0.0, 80.0, 5);
        let region = |a: f64| Region { label: "crack leaves the axis".into(), x: Some([a, a + 1.0]), y: None };
        let rows = |starts: &[f64]| {
            let regions: Vec<Region> = starts.iter().map(|a| region(*a)).collect();
            let labels = Labels::place(&regions, &axis, 600.0);
            assert!(labels.above.iter().all(|l| l.1 < 560.0), "kept within the frame");
            (labels.above.iter().map(|l| l.2).collect::<Vec<_>>(), labels.height())
        };
        assert_eq!(rows(&[20.0, 60.0, 79.0]), (vec![0, 0, 0], ROW));
        assert_eq!(rows(&[30.0, 34.0]), (vec![0, 0], ROW));
        assert_eq!(rows(&[30.0, 30.5, 31.0]), (vec![0, 0, 1], 2.0 * ROW));
    }
}
