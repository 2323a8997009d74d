//! Curves of any number of rows, drawn with a bounded number of points.

use crate::axis::AxisScale;
use crate::trace::Point;

/// Lines with more points are reduced column by column of the page.
const MOST_OF_A_LINE: usize = 4000;
/// Most points of the lines of one curve.
const MOST_POINTS: usize = 50_000;
/// Longest way of one curve, nominal pixels: a line three times up and down every column of a page is half of
/// it.
const LONGEST: f64 = 1e6;
/// Most rows that have a marker or a bar each.
const MOST_MARKED: usize = 5000;

/// Drops points that lie within a third of a nominal pixel of the one before, so that a long history stays a
/// small file; the ends are kept. What is still long keeps the first, lowest, highest and last point of every
/// column of pixels, which shows the same (Jugel et al. 2014).
pub fn thin(line: Vec<Point>, x: &AxisScale, y: &AxisScale, size: (f64, f64)) -> Vec<Point> {
    let (unit_x, unit_y) = units(x, y, size);
    let last = line.len().saturating_sub(1);
    let mut kept: Vec<Point> = Vec::new();
    for (i, p) in line.into_iter().enumerate() {
        let far = kept.last().is_none_or(|k| ((p.0 - k.0) * unit_x).hypot((p.1 - k.1) * unit_y) > 1.0 / 3.0);
        if far || i == last {
            kept.push(p);
        }
    }
    by_column(kept, x, size.0)
}

/// The first, lowest, highest and last point of every column of pixels, for a line of many points.
pub fn by_column(line: Vec<Point>, x: &AxisScale, width: f64) -> Vec<Point> {
    if line.len() <= MOST_OF_A_LINE {
        return line;
    }
    let column = |p: &Point| ((p.0 - x.low) / (x.high - x.low) * width).floor();
    let mut kept = Vec::new();
    for group in line.chunk_by(|a, b| column(a) == column(b)) {
        let height = |i: &usize, j: &usize| group[*i].1.total_cmp(&group[*j].1);
        let lowest = (0..group.len()).min_by(height).unwrap_or(0);
        let highest = (0..group.len()).max_by(height).unwrap_or(0);
        let mut places = vec![0, lowest, highest, group.len() - 1];
        places.sort_unstable();
        places.dedup();
        kept.extend(places.into_iter().map(|i| group[i]));
    }
    kept
}

/// Whether the lines of a curve can be drawn with bounded work; says why not.
pub fn drawable(lines: &[Vec<Point>], x: &AxisScale, y: &AxisScale, size: (f64, f64)) -> Result<(), String> {
    let (unit_x, unit_y) = units(x, y, size);
    let length = |pair: &[Point]| ((pair[1].0 - pair[0].0) * unit_x).hypot((pair[1].1 - pair[0].1) * unit_y);
    let points: usize = lines.iter().map(Vec::len).sum();
    let way: f64 = lines.iter().flat_map(|line| line.windows(2).map(length)).sum();
    if points > MOST_POINTS || way > LONGEST {
        return Err(format!(
            "it has {points} distinct points on a path of {way:.0} pixels; at most {MOST_POINTS} points on {LONGEST} pixels are drawn"
        ));
    }
    Ok(())
}

/// Whether so many rows can have a marker or a bar each; says why not.
pub fn markable(rows: usize) -> Result<(), String> {
    if rows > MOST_MARKED {
        return Err(format!("{rows} rows have markers or bars; at most {MOST_MARKED} are drawn"));
    }
    Ok(())
}

/// Nominal pixels per unit of either axis.
fn units(x: &AxisScale, y: &AxisScale, size: (f64, f64)) -> (f64, f64) {
    (size.0 / (x.high - x.low), size.1 / (y.high - y.low))
}

#[cfg(test)]
mod tests {
    use super::*;
    use fisura_verification::record::Scale;

    const SIZE: (f64, f64) = (600.0, 300.0);

    fn unit() -> AxisScale {
        AxisScale::with_range(Scale::Linear, 0.0, 1.0, 5)
    }

    #[test]
    fn a_long_history_is_thinned_to_the_pixels() {
        let line: Vec<Point> = (0..=100_000).map(|i| (i as f64 * 1e-5, 0.5)).collect();
        let thin = thin(line.clone(), &unit(), &unit(), SIZE);
        assert!(thin.len() < 2000, "{}", thin.len());
        assert_eq!((thin[0], thin[thin.len() - 1]), (line[0], line[100_000]));
    }

    #[test]
    fn a_saw_tooth_of_two_million_rows_keeps_its_envelope() {
        let tooth = |i: u32| (f64::from(i) / 2e6, if i.is_multiple_of(2) { 0.1 } else { 0.9 });
        let lines = [thin((0..=2_000_000).map(tooth).collect(), &unit(), &unit(), SIZE)];
        assert!(lines[0].len() <= 4 * 601, "{}", lines[0].len());
        for column in lines[0].chunk_by(|a, b| (a.0 * 600.0).floor() == (b.0 * 600.0).floor()).skip(1) {
            let heights: Vec<f64> = column.iter().map(|p| p.1).collect();
            assert!(heights.contains(&0.1) && (heights.contains(&0.9) || column[0].0 == 1.0), "{column:?}");
        }
        assert_eq!(drawable(&lines, &unit(), &unit(), SIZE), Ok(()));
    }

    #[test]
    fn what_runs_to_and_fro_without_end_is_refused() {
        let sway = |i: u32| (if i.is_multiple_of(2) { 0.1 } else { 0.9 }, f64::from(i) / 2e6);
        let lines = [thin((0..2_000_000).map(sway).collect(), &unit(), &unit(), SIZE)];
        assert!(drawable(&lines, &unit(), &unit(), SIZE).unwrap_err().contains("2000000 distinct points"));
        assert!(markable(5000).is_ok() && markable(5001).is_err());
    }
}
