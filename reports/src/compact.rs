//! Shapes of one look that plotters draws one after the other, as one path with relative coordinates: every
//! dash and every grid line is an element of its own otherwise, and a report has many. Points of a curve that
//! nobody could see go (Ramer 1972; Douglas and Peucker 1973).

use std::fmt::Write;

use crate::style::SCALE;

type Point = (i64, i64);

/// How far a curve may move where points are left out: a tenth of a pixel of the nominal size.
const TOLERANCE: f64 = 0.1 * SCALE;

/// Points of a curve that are simplified together.
const PIECE: usize = 2000;

/// One line of an SVG that is a shape made of straight lines.
struct Shape<'a> {
    /// Attributes that say how it looks.
    look: &'a str,
    closed: bool,
    points: Vec<Point>,
}

/// A path that grows while shapes look alike.
#[derive(Default)]
struct Path {
    look: String,
    data: String,
    /// The pen, for relative coordinates.
    at: Point,
    open: bool,
}

/// The body of an SVG, line by line, with shapes of one look joined.
pub fn compact(body: &str) -> String {
    let mut out = String::with_capacity(body.len() / 2);
    let mut path = Path::default();
    let mut within_text = false;
    for line in body.lines() {
        match Shape::parse(line) {
            Some(shape) => path.add(&shape, &mut out),
            None => {
                path.finish(&mut out);
                out.push_str(line);
                within_text = line.starts_with("<text") || within_text && !line.starts_with('<');
                if !within_text {
                    out.push('\n');
                }
            }
        }
    }
    path.finish(&mut out);
    out
}

impl<'a> Shape<'a> {
    /// A line, polyline or polygon with whole coordinates; `None` for anything else.
    fn parse(line: &'a str) -> Option<Self> {
        let (name, rest) = line.strip_prefix('<')?.strip_suffix("/>")?.split_once(' ')?;
        if name == "line" {
            let (look, rest) = rest.split_once(" x1=\"")?;
            let numbers: Vec<i64> = rest
                .split(['"', ' '])
                .filter(|word| !word.is_empty() && !word.ends_with('='))
                .map(|word| word.parse().ok())
                .collect::<Option<_>>()?;
            let [x1, y1, x2, y2] = numbers[..] else { return None };
            return Some(Self { look, closed: false, points: vec![(x1, y1), (x2, y2)] });
        }
        let (look, rest) = rest.split_once(" points=\"")?;
        let look = if name == "polyline" { look.strip_prefix("fill=\"none\" ")? } else { look };
        let pairs = rest.strip_suffix('"')?.split(' ').filter(|pair| !pair.is_empty());
        let point = |pair: &str| pair.split_once(',').and_then(|(x, y)| Some((x.parse().ok()?, y.parse().ok()?)));
        let points = pairs.map(point).collect::<Option<Vec<Point>>>()?;
        let closed = name == "polygon";
        let points = if closed { points } else { simplified(&points) };
        (!points.is_empty() && (closed || name == "polyline")).then_some(Self { look, closed, points })
    }
}

/// The points of a curve that it needs to stay within the tolerance of itself. Of long curves pieces are
/// looked at one by one, since the time grows with the square of the points where every one of them counts.
fn simplified(points: &[Point]) -> Vec<Point> {
    let mut kept = vec![false; points.len()];
    let mut open: Vec<[usize; 2]> = Vec::new();
    for start in (0..points.len()).step_by(PIECE) {
        open.push([start, (start + PIECE).min(points.len() - 1)]);
    }
    while let Some([first, last]) = open.pop() {
        (kept[first], kept[last]) = (true, true);
        let (start, end) = (points[first], points[last]);
        let distance = |&(x, y): &Point| {
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

impl Path {
    fn add(&mut self, shape: &Shape, out: &mut String) {
        let look = if shape.closed { shape.look.to_string() } else { format!("fill=\"none\" {}", shape.look) };
        if !self.open || look != self.look {
            self.finish(out);
            *self = Self { look, open: true, ..Self::default() };
        }
        let start = shape.points[0];
        self.command('m', start);
        let mut first = true;
        for &point in &shape.points[1..] {
            self.command(if first { 'l' } else { ' ' }, point);
            first = false;
        }
        if shape.closed {
            self.data.push('z');
            self.at = start;
        }
    }

    /// A relative move to a point; a space continues the command before, and a minus sign needs none.
    fn command(&mut self, letter: char, to: Point) {
        let (dx, dy) = (to.0 - self.at.0, to.1 - self.at.1);
        if letter != ' ' {
            self.data.push(letter);
        } else if dx >= 0 {
            self.data.push(' ');
        }
        let between = if dy < 0 { "" } else { " " };
        let _ = write!(self.data, "{dx}{between}{dy}"); // writing into a string succeeds
        self.at = to;
    }

    fn finish(&mut self, out: &mut String) {
        if self.open {
            let _ = writeln!(out, "<path {} d=\"{}\"/>", self.look, self.data);
            self.open = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_one_look_are_one_path() {
        let body = "<line stroke=\"#E6E6E6\" stroke-width=\"6\" x1=\"10\" y1=\"20\" x2=\"10\" y2=\"5\"/>\n\
                    <line stroke=\"#E6E6E6\" stroke-width=\"6\" x1=\"20\" y1=\"20\" x2=\"20\" y2=\"5\"/>\n\
                    <text x=\"1\">\nwords\n</text>\n\
                    <polyline fill=\"none\" stroke=\"#000\" points=\"0,0 5,5 10,0\"/>\n\
                    <polygon fill=\"#000\" points=\"0,0 5,5 10,0\"/>\n\
                    <polygon fill=\"#000\" points=\"10,10 15,15 20,10\"/>\n\
                    <circle cx=\"1\" cy=\"1\" r=\"1\"/>\n";
        let expected = "<path fill=\"none\" stroke=\"#E6E6E6\" stroke-width=\"6\" d=\"m10 20l0-15m10 15l0-15\"/>\n\
                        <text x=\"1\">words</text>\n\
                        <path fill=\"none\" stroke=\"#000\" d=\"m0 0l5 5 5-5\"/>\n\
                        <path fill=\"#000\" d=\"m0 0l5 5 5-5zm10 10l5 5 5-5z\"/>\n\
                        <circle cx=\"1\" cy=\"1\" r=\"1\"/>\n";
        assert_eq!(compact(body), expected);
    }

    #[test]
    fn a_curve_keeps_its_shape_with_fewer_points() {
        let wave: Vec<Point> = (0..=6000).map(|x| (x, (1000.0 * (x as f64 / 500.0).sin()).round() as i64)).collect();
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

    #[test]
    fn what_is_no_such_shape_stays() {
        let body = "<polyline fill=\"none\" stroke=\"#000\" points=\"0.5,0 5,5\"/>\n<rect width=\"3\"/>\n";
        assert_eq!(compact(body), body);
    }
}
