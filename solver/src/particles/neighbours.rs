//! Which of many places are near a place.

/// Places in squares, sorted by row and column.
#[derive(Debug, Clone)]
pub(crate) struct Neighbours {
    side: f64,
    sorted: Vec<([i32; 2], u32)>,
}

impl Neighbours {
    /// Of places, m; `side` is that of a square, m.
    pub(crate) fn new(places: impl Iterator<Item = [f64; 2]>, side: f64) -> Self {
        let mut sorted: Vec<_> = places.enumerate().map(|(at, place)| (square(place, side), at as u32)).collect();
        sorted.sort_unstable();
        Self { side, sorted }
    }

    /// Numbers of the places in the nine squares around a place: of all within a side of it, and some more.
    pub(crate) fn near(&self, place: [f64; 2]) -> impl Iterator<Item = usize> + '_ {
        let [row, column] = square(place, self.side);
        (row - 1..=row + 1).flat_map(move |row| {
            let first = self.sorted.partition_point(|(square, _)| *square < [row, column - 1]);
            let in_row = self.sorted[first..].iter().take_while(move |(square, _)| *square <= [row, column + 1]);
            in_row.map(|(_, at)| *at as usize)
        })
    }
}

/// Row and column of the square of a place; those far off share the outermost.
fn square(place: [f64; 2], side: f64) -> [i32; 2] {
    let number = |x: f64| ((x / side).floor().clamp(-1e9, 1e9)) as i32;
    [number(place[1]), number(place[0])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_places_within_a_side_are_near() {
        let places: Vec<[f64; 2]> =
            (0..400).map(|i| [f64::from(i % 20) * 0.37 - 3.0, f64::from(i / 20) * 0.41 - 4.0]).collect();
        let neighbours = Neighbours::new(places.iter().copied(), 0.9);
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        for place in &places {
            let mut found: Vec<usize> =
                neighbours.near(*place).filter(|at| distance(*place, places[*at]) <= 0.9).collect();
            found.sort_unstable();
            let all: Vec<usize> = (0..places.len()).filter(|at| distance(*place, places[*at]) <= 0.9).collect();
            assert_eq!(found, all);
        }
    }
}
