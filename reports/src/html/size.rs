//! What a page that would be too large leaves out.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use fisura_verification::record::{Figure, ResultSet, Status};

use super::Drawings;

/// At most what stands in the place of a figure that is left out.
const NOTE_BYTES: usize = 500;

/// A part of the records and figures; records that do not hold come first, the rest is in the same order.
pub(super) fn reduced(set: &ResultSet, part: f64) -> ResultSet {
    let count = |all: usize| (part * all as f64) as usize;
    let mut places: Vec<usize> = (0..set.records.len()).collect();
    places.sort_by_key(|&at| matches!(set.records[at].status, Status::Pass | Status::KnownLimit | Status::Info));
    places.truncate(count(set.records.len()));
    places.sort_unstable();
    ResultSet {
        records: places.into_iter().map(|at| set.records[at].clone()).collect(),
        figures: set.figures[..count(set.figures.len())].to_vec(),
        inputs: BTreeMap::new(),
        ..set.clone()
    }
}

/// Figures to leave out so that the page becomes `excess` bytes shorter: those that show the curves of
/// another one once more over the unknowns, then those of the suites with the most figures, in both the
/// largest first.
pub(super) fn left_out<'a>(set: &'a ResultSet, drawings: &Drawings, excess: usize) -> BTreeSet<&'a str> {
    let drawn = |figure: &'a Figure| Some((figure, drawings.get(&figure.id)?.as_ref().ok()?.len()));
    let of_suite = |suite: &str| set.figures.iter().filter(|figure| figure.suite == suite).count();
    let mut candidates: Vec<(&Figure, usize)> = set.figures.iter().filter_map(drawn).collect();
    candidates.retain(|(_, length)| *length > NOTE_BYTES);
    candidates.sort_by_cached_key(|(figure, length)| {
        (!figure.id.ends_with("-unknowns"), Reverse(of_suite(&figure.suite)), Reverse(*length))
    });
    let mut saved = 0;
    let enough = candidates.into_iter().take_while(|(_, length)| {
        let needed = saved < excess;
        saved += length - NOTE_BYTES;
        needed
    });
    enough.map(|(figure, _)| figure.id.as_str()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::results;

    #[test]
    fn twins_over_the_unknowns_are_left_out_first_then_figures_of_the_suites_with_most() {
        let mut set = results();
        let template = set.figures[0].clone();
        let figure = |(suite, id): (&str, &str)| Figure { id: id.into(), suite: suite.into(), ..template.clone() };
        set.figures = [("s", "a"), ("t", "b"), ("t", "c"), ("t", "broken"), ("s", "a-unknowns")].map(figure).to_vec();
        let drawing = |id: &str, length: usize| (id.to_string(), Ok("x".repeat(length)));
        let mut drawings = Drawings::from([drawing("a", 9_000), drawing("b", 3_000), drawing("c", 4_000)]);
        drawings.extend([drawing("a-unknowns", 2_000), ("broken".into(), Err("no such column".into()))]);
        let names = |excess| left_out(&set, &drawings, excess).into_iter().collect::<Vec<_>>();
        assert_eq!(names(1_500), ["a-unknowns"]);
        assert_eq!(names(1_501), ["a-unknowns", "c"]);
        assert_eq!(names(5_001), ["a-unknowns", "b", "c"]);
        assert_eq!(names(1_000_000), ["a", "a-unknowns", "b", "c"]);
    }
}
