//! Moving pictures: one SVG that browsers play by themselves, with axes in millimetres and the time in the
//! frame.
//!
//! Every moment is a group that is visible for its part of the cycle (SMIL, with discrete values). A viewer
//! that does not animate shows the last one. Pictures are coarsened until the file stays below
//! [`MOST_BYTES`].

use std::fmt::Write;

use crate::field::{Raster, figure_of, markup, render_with};
use crate::number::pretty;
use crate::series::FigureError;
use crate::style::{SCALE, px};
use crate::svg::escape;

/// The file stays below this many bytes.
pub const MOST_BYTES: usize = 2_000_000;

/// Time of all moments but the last, s, the longest of one of them, and that of the last, which stays.
const ALL: f64 = 4.0;
const LONGEST: f64 = 0.7;
const LAST: f64 = 1.5;
/// Coarseness of pixels and of colours, from what looks best to what is smallest.
const COARSENESS: [[usize; 2]; 4] = [[1, 2], [2, 4], [3, 4], [4, 8]];

/// A picture and its time, s.
pub type Moment = (f64, Raster);

/// Draws moments one after the other; a title, the label of the colour bar and its range.
///
/// # Errors
/// Fewer than two moments, moments of other places than the first, or so many that the file would be too
/// large.
pub fn render_animation(
    id: &str,
    title: &str,
    moments: &[Moment],
    (label, range): (&str, [f64; 2]),
) -> Result<String, FigureError> {
    let fail = |message: String| FigureError::new(id, message);
    let [(_, first), _, ..] = moments else { return Err(fail("an animation needs at least two pictures".to_string())) };
    if moments
        .iter()
        .any(|(_, raster)| (raster.pixels, raster.low, raster.high) != (first.pixels, first.low, first.high))
    {
        return Err(fail("its pictures show different regions".to_string()));
    }
    let times = moments.iter().map(|(time, _)| format!("{} µs", pretty(1e6 * time, 4)));
    let caption = format!("Moments: {}.", times.collect::<Vec<_>>().join(", "));
    let figure = figure_of([id, title, &caption], first.pixels, (label, range));
    for [pixels, colours] in COARSENESS {
        let svg = render_with(&figure, first, (label, range), |place| {
            let groups = moments.iter().enumerate().map(|(number, (time, raster))| {
                let raster = coarsened(raster, pixels);
                let content = markup(place, &raster.paths(range, colours), raster.pixels);
                let corner = [px(place.left + 0.5 * place.width), px(place.top - 6.0)];
                group(number, moments.len(), &format!("t = {} µs", pretty(1e6 * time, 4)), corner, &content)
            });
            groups.collect()
        })?;
        if svg.len() < MOST_BYTES {
            return Ok(svg);
        }
    }
    Err(fail(format!("{} pictures exceed {MOST_BYTES} bytes: give fewer frames", moments.len())))
}

/// A moment that shows for its part of the cycle, with its time above the frame.
fn group(number: usize, count: usize, time: &str, [x, y]: [i32; 2], content: &str) -> String {
    let moment = (ALL / (count - 1) as f64).min(LONGEST);
    let cycle = moment * (count - 1) as f64 + LAST;
    let [from, to] = [number, number + 1].map(|n| moment * n as f64 / cycle);
    let (values, times) = match number {
        0 => ("visible;hidden".to_string(), format!("0;{to:.5}")),
        _ if number + 1 == count => ("hidden;visible".to_string(), format!("0;{from:.5}")),
        _ => ("hidden;visible;hidden".to_string(), format!("0;{from:.5};{to:.5}")),
    };
    let visibility = if number + 1 == count { "visible" } else { "hidden" };
    let size = 13.0 * SCALE;
    let mut out = format!("<g visibility=\"{visibility}\">\n");
    let _ = writeln!(
        out,
        "<animate attributeName=\"visibility\" calcMode=\"discrete\" dur=\"{cycle:.2}s\" repeatCount=\"indefinite\" \
         values=\"{values}\" keyTimes=\"{times}\"/>"
    );
    let _ = writeln!(
        out,
        "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" font-size=\"{size}\" fill=\"#262626\">{}</text>",
        escape(time)
    );
    out + content + "</g>\n"
}

/// Squares of pixels as one, with the mean of those that have a value; cut where they end.
fn coarsened(raster: &Raster, factor: usize) -> Raster {
    let [nx, ny] = raster.pixels;
    if factor < 2 || nx / factor < 2 || ny / factor < 2 {
        return raster.clone();
    }
    let pixels = [nx.div_ceil(factor), ny.div_ceil(factor)];
    let mut values = Vec::with_capacity(pixels[0] * pixels[1]);
    for row in 0..pixels[1] {
        for column in 0..pixels[0] {
            let [columns, rows] = [(column, nx), (row, ny)].map(|(at, n)| at * factor..((at + 1) * factor).min(n));
            let of_row = |y: usize| raster.values[y * nx..][columns.clone()].iter().copied();
            let inside: Vec<f64> = rows.flat_map(of_row).filter(|value| !value.is_nan()).collect();
            let count = inside.len() as f64;
            values.push(if inside.is_empty() { f64::NAN } else { inside.iter().sum::<f64>() / count });
        }
    }
    Raster { pixels, values, ..raster.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(count: usize, pixels: [usize; 2], value: impl Fn(usize, usize) -> f64) -> Vec<Moment> {
        let raster = |moment| Raster {
            pixels,
            low: [0.0; 2],
            high: [0.1, 0.02],
            values: (0..pixels[0] * pixels[1]).map(|at| value(moment, at)).collect(),
        };
        (0..count).map(|moment| (moment as f64 * 1e-6, raster(moment))).collect()
    }

    fn render(moments: &[Moment]) -> Result<String, FigureError> {
        render_animation("a", "A crack", moments, ("c", [0.0, 1.0]))
    }

    #[test]
    fn every_moment_has_its_time_and_its_turn() {
        let svg = render(&moments(3, [8, 4], |moment, at| if at < moment { 0.0 } else { 1.0 })).unwrap();
        for time in ["t = 0 µs", "t = 1 µs", "t = 2 µs", "x (mm)"] {
            assert!(svg.contains(time), "{time}: {svg}");
        }
        assert_eq!((svg.matches("<animate ").count(), svg.matches("<g visibility=\"visible\">").count()), (3, 1));
        assert!(svg.contains("keyTimes=\"0;0.24138;0.48276\"") && !svg.contains("href"), "{svg}");
    }

    #[test]
    fn what_would_be_too_large_is_coarsened_and_then_refused() {
        let noise = |moment: usize, at: usize| ((at * 7919 + moment * 104_729) % 1000) as f64 / 1000.0;
        let svg = render(&moments(10, [300, 100], noise)).unwrap();
        assert!(svg.len() < MOST_BYTES, "{}", svg.len());
        let error = render(&moments(200, [300, 100], noise)).unwrap_err().to_string();
        assert!(error.contains("fewer frames"), "{error}");
        assert!(render(&moments(1, [8, 4], |_, _| 1.0)).is_err());
    }
}
