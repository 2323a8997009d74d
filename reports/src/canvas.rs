//! Where plotters draws: an SVG with shapes of one look joined to one path of relative coordinates, since a
//! report has many dashes, markers and grid lines. Points of a curve that nobody could see go (Ramer 1972;
//! Douglas and Peucker 1973).

use std::cell::{Cell, RefCell};
use std::convert::Infallible;
use std::fmt::Write;
use std::rc::Rc;

use plotters::style::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    FontTransform,
};

use crate::style::{SCALE, px};
use crate::svg::escape;

/// How far a curve may move where points are left out: a tenth of a pixel of the nominal size.
const TOLERANCE: f64 = 0.1 * SCALE;
/// Points of a curve that are simplified together.
const PIECE: usize = 2000;
/// Half the height of a small letter over the size of the font, in the usual fonts without serifs.
const HALF_X: f64 = 0.265;

type Outcome = Result<(), DrawingErrorKind<Infallible>>;

/// Elements that are drawn, how lines are dashed from now on, and how wide the rim of areas is.
#[derive(Debug, Clone, Default)]
pub struct Canvas {
    size: (u32, u32),
    drawn: Rc<RefCell<Elements>>,
    dashes: Rc<Cell<&'static [f64]>>,
    rim: Rc<Cell<f64>>,
}

/// Finished elements, and the path that grows while shapes look alike.
#[derive(Debug, Default)]
struct Elements {
    finished: String,
    /// Texts met since the open path began: they are drawn above it.
    texts: String,
    look: String,
    path: String,
    /// The pen, for relative coordinates.
    at: BackendCoord,
}

impl Canvas {
    /// An empty canvas of `size` units.
    pub fn new(size: (u32, u32)) -> Self {
        Self { size, ..Self::default() }
    }

    /// Sets lengths of dashes and gaps in nominal pixels for the lines that follow; none for solid ones.
    pub fn dash(&self, pattern: &'static [f64]) {
        self.dashes.set(pattern);
    }

    /// Sets the nominal width of the white rim around the areas that follow, below all of those that touch.
    pub fn rim(&self, width: f64) {
        self.rim.set(width);
    }

    /// The elements drawn so far.
    pub fn markup(&self) -> String {
        let mut drawn = self.drawn.borrow_mut();
        drawn.close();
        drawn.finished.clone()
    }

    fn fill(&self, color: BackendColor, corners: &[BackendCoord]) {
        if color.alpha == 0.0 || corners.is_empty() {
            return;
        }
        let mut look = format!("fill=\"{}\"{}", hex(color), opacity(color));
        if self.rim.get() > 0.0 {
            let width = px(2.0 * self.rim.get());
            let _ = write!(look, " stroke=\"#FFFFFF\" stroke-width=\"{width}\" paint-order=\"stroke\""); // cannot fail
        }
        self.drawn.borrow_mut().shape(&look, corners, true);
    }

    fn stroke(&self, style: &impl BackendStyle, points: &[BackendCoord]) {
        let (color, width) = (style.color(), style.stroke_width());
        if color.alpha == 0.0 || points.is_empty() {
            return;
        }
        let mut look = line(color, width);
        let dashes = self.dashes.get();
        if !dashes.is_empty() {
            let lengths: Vec<String> = dashes.iter().map(|length| px(*length).to_string()).collect();
            let _ = write!(look, " stroke-dasharray=\"{}\"", lengths.join(" ")); // cannot fail
        }
        self.drawn.borrow_mut().shape(&look, &simplified(points), false);
    }
}

impl Elements {
    fn shape(&mut self, look: &str, points: &[BackendCoord], closed: bool) {
        self.take_up(look);
        let [first, last] = [points[0], points[points.len() - 1]];
        let distance = |end: BackendCoord| (end.0 - self.at.0).abs() + (end.1 - self.at.1).abs();
        let backwards = !self.path.is_empty() && !closed && points.len() == 2 && distance(last) < distance(first);
        let start = if backwards { last } else { first };
        self.step('m', start);
        if backwards {
            self.step('l', first);
        } else {
            points[1..].iter().for_each(|point| self.step('l', *point));
        }
        if closed {
            self.path.push('z');
            self.at = start;
        }
    }

    /// A disc: a line without length and with round ends.
    fn disc(&mut self, color: BackendColor, radius: u32, centre: BackendCoord) {
        self.take_up(&format!("{} stroke-linecap=\"round\"", line(color, 2 * radius)));
        self.step('m', centre);
        self.path.push_str("h0");
    }

    /// Makes the open path one of this look.
    fn take_up(&mut self, look: &str) {
        if self.path.is_empty() || self.look != look {
            self.close();
            self.look = look.to_string();
            self.at = (0, 0);
        }
    }

    /// A relative move to a point; a command like the one before needs no letter, a minus sign no space.
    fn step(&mut self, command: char, to: BackendCoord) {
        let (dx, dy) = (to.0 - self.at.0, to.1 - self.at.1);
        self.at = to;
        let (command, numbers) = match (command, dx, dy) {
            ('l', 0, dy) => ('v', vec![dy]),
            ('l', dx, 0) => ('h', vec![dx]),
            _ => (command, vec![dx, dy]),
        };
        let last = self.path.rfind(|c: char| c.is_ascii_alphabetic());
        let goes_on = command == 'l' && last.is_some_and(|at| self.path[at..].starts_with('l'));
        if !goes_on {
            self.path.push(command);
        }
        for number in numbers {
            if number >= 0 && self.path.ends_with(|c: char| c.is_ascii_digit()) {
                self.path.push(' ');
            }
            let _ = write!(self.path, "{number}"); // writing into a string succeeds
        }
    }

    fn close(&mut self) {
        if !self.path.is_empty() {
            let _ = writeln!(self.finished, "<path {} d=\"{}\"/>", self.look, self.path);
            self.path.clear();
        }
        self.finished.push_str(&self.texts);
        self.texts.clear();
    }
}

impl DrawingBackend for Canvas {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Outcome {
        Ok(())
    }

    fn present(&mut self) -> Outcome {
        Ok(())
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Outcome {
        self.fill(color, &[(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)]);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Outcome {
        self.stroke(style, &[from, to]);
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(&mut self, a: BackendCoord, b: BackendCoord, style: &S, fill: bool) -> Outcome {
        let corners = [a, (b.0, a.1), b, (a.0, b.1), a];
        if fill {
            self.fill(style.color(), &corners[..4])
        } else {
            self.stroke(style, &corners)
        }
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        self.stroke(style, &path.into_iter().collect::<Vec<_>>());
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Outcome {
        self.fill(style.color(), &path.into_iter().collect::<Vec<_>>());
        Ok(())
    }

    /// Discs only: no figure has circles that are not filled.
    fn draw_circle<S: BackendStyle>(&mut self, centre: BackendCoord, radius: u32, style: &S, _: bool) -> Outcome {
        self.drawn.borrow_mut().disc(style.color(), radius, centre);
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Outcome {
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Right => "end",
            HPos::Center => "middle",
        };
        let size = style.size().round();
        let base = match style.anchor().v_pos {
            VPos::Top => 0.76 * size,
            VPos::Center => HALF_X * size,
            VPos::Bottom => -HALF_X * size,
        };
        let base = y + base.round() as i32;
        let turned = match style.transform() {
            FontTransform::Rotate270 => format!(" transform=\"rotate(270, {x}, {y})\""),
            FontTransform::Rotate90 => format!(" transform=\"rotate(90, {x}, {y})\""),
            _ => String::new(),
        };
        let weight = if matches!(style.style(), FontStyle::Bold) { " font-weight=\"bold\"" } else { "" };
        let color = style.color();
        let _ = writeln!(
            self.drawn.borrow_mut().texts,
            "<text x=\"{x}\" y=\"{base}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{} fill=\"{}\"{weight}{turned}>{}</text>",
            opacity(color),
            hex(color),
            escape(text)
        );
        Ok(())
    }
}

fn line(color: BackendColor, width: u32) -> String {
    format!("fill=\"none\"{} stroke=\"{}\" stroke-width=\"{width}\"", opacity(color), hex(color))
}

fn hex(BackendColor { rgb: (r, g, b), .. }: BackendColor) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

fn opacity(color: BackendColor) -> String {
    if color.alpha < 1.0 { format!(" opacity=\"{}\"", color.alpha) } else { String::new() }
}

/// The points of a curve that it needs to stay within the tolerance of itself. Of long curves pieces are
/// looked at one by one, since the time grows with the square of the points where every one of them counts.
fn simplified(points: &[BackendCoord]) -> Vec<BackendCoord> {
    let mut kept = vec![false; points.len()];
    let mut open: Vec<[usize; 2]> = Vec::new();
    for start in (0..points.len()).step_by(PIECE) {
        open.push([start, (start + PIECE).min(points.len() - 1)]);
    }
    while let Some([first, last]) = open.pop() {
        (kept[first], kept[last]) = (true, true);
        let (start, end) = (points[first], points[last]);
        let distance = |&(x, y): &BackendCoord| {
            let [dx, dy, ex, ey] = [x - start.0, y - start.1, end.0 - start.0, end.1 - start.1].map(|n| n as f64);
            let along = ((dx * ex + dy * ey) / (ex * ex + ey * ey).max(1.0)).clamp(0.0, 1.0);
            (dx - along * ex).hypot(dy - along * ey)
        };
        let inner = (first + 1..last).map(|at| (at, distance(&points[at])));
        if let Some((at, furthest)) = inner.max_by(|a, b| a.1.total_cmp(&b.1))
            && furthest > TOLERANCE
        {
            open.extend([[first, at], [at, last]]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

#[cfg(test)]
mod tests {
    use plotters::prelude::*;

    use super::*;
    use crate::style::text;

    #[test]
    fn shapes_of_one_look_are_one_path() {
        let canvas = Canvas::new((2000, 2000));
        let page = canvas.clone().into_drawing_area();
        let grid = ShapeStyle { color: BLACK.into(), filled: false, stroke_width: 6 };
        page.draw(&PathElement::new([(10, 20), (10, 5)], grid)).unwrap();
        page.draw(&Text::new("a < b", (1, 2), text(12.0, BLACK, HPos::Left, VPos::Center))).unwrap();
        page.draw(&PathElement::new([(20, 20), (20, 5)], grid)).unwrap();
        canvas.dash(&[3.0, 2.0]);
        page.draw(&PathElement::new([(0, 0), (500, 500), (1000, 0)], BLACK.mix(0.5))).unwrap();
        canvas.dash(&[]);
        page.draw(&Polygon::new([(0, 0), (5, 5), (10, 0)], RED.filled())).unwrap();
        page.draw(&Polygon::new([(10, 10), (15, 15), (20, 10)], RED.filled())).unwrap();
        page.draw(&Circle::new((1, 1), 4, RED.filled())).unwrap();
        page.draw(&Circle::new((9, 1), 4, RED.filled())).unwrap();
        let expected = "<path fill=\"none\" stroke=\"#000000\" stroke-width=\"6\" d=\"m10 20v-15m10 0v15\"/>\n\
            <text x=\"1\" y=\"34\" text-anchor=\"start\" font-size=\"120\" fill=\"#000000\">a &lt; b</text>\n\
            <path fill=\"none\" opacity=\"0.5\" stroke=\"#000000\" stroke-width=\"1\" stroke-dasharray=\"30 20\" d=\"m0 0l500 500 500-500\"/>\n\
            <path fill=\"#FF0000\" d=\"m0 0l5 5 5-5zm10 10l5 5 5-5z\"/>\n\
            <path fill=\"none\" stroke=\"#FF0000\" stroke-width=\"8\" stroke-linecap=\"round\" d=\"m1 1h0m8 0h0\"/>\n";
        assert_eq!(canvas.markup(), expected);
    }

    #[test]
    fn a_curve_keeps_its_shape_with_fewer_points() {
        let wave: Vec<BackendCoord> =
            (0..=6000).map(|x| (x, (1000.0 * (x as f64 / 500.0).sin()).round() as i32)).collect();
        let fewer = simplified(&wave);
        assert!(fewer.len() < 250, "{}", fewer.len());
        assert_eq!((fewer[0], fewer.last()), (wave[0], wave.last()));
        for ends in fewer.windows(2) {
            for &(x, y) in &wave[ends[0].0 as usize..=ends[1].0 as usize] {
                let slope = (ends[1].1 - ends[0].1) as f64 / (ends[1].0 - ends[0].0) as f64;
                let off = (y - ends[0].1) as f64 - slope * (x - ends[0].0) as f64;
                assert!(off.abs() / slope.hypot(1.0) <= TOLERANCE + 1e-9, "{off} at {x}");
            }
        }
        let there_and_back = [(0, 0), (100, 0), (0, 0)];
        assert_eq!(simplified(&there_and_back), there_and_back);
    }
}
