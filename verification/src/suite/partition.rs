//! Slices of a plan, for job arrays and CI matrices: `slice:2/3` is the second of three.
//!
//! Cases are dealt by their committed `seconds`, longest first, each to the slice with the least so far. The
//! deal depends on nothing but the cases and the number of slices, so machines need not talk to each other.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::case::Case;

/// One slice of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Slice {
    /// Number of the slice, from 1 to `count`.
    pub index: usize,
    /// How many there are.
    pub count: usize,
}

impl fmt::Display for Slice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "slice:{}/{}", self.index, self.count)
    }
}

impl FromStr for Slice {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.strip_prefix("slice:").and_then(|rest| rest.split_once('/'));
        let parsed = numbers.and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parsed {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            Some((index, count)) => {
                Err(format!("there is no slice {index} of {count}; write slice:1/{count} up to slice:{count}/{count}"))
            }
            None => Err("write slice:K/N, such as slice:1/3 for the first of three".to_string()),
        }
    }
}

impl Slice {
    /// The cases of this slice, in the order of the plan.
    pub fn take(self, cases: Vec<Case>) -> Vec<Case> {
        let costs: Vec<(f64, String)> = cases.iter().map(|case| (case.seconds, case.id())).collect();
        let slices = deal(&costs, self.count);
        cases.into_iter().zip(slices).filter(|(_, slice)| *slice == self.index).map(|(case, _)| case).collect()
    }
}

/// The slice, from 1, of each case given by its cost in seconds and its id.
fn deal(cases: &[(f64, String)], count: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..cases.len()).collect();
    order.sort_by(|&a, &b| cases[b].0.total_cmp(&cases[a].0).then_with(|| cases[a].1.cmp(&cases[b].1)));
    let mut loads = vec![0.0; count];
    let mut slices = vec![0; cases.len()];
    for case in order {
        let lightest = (0..count).min_by(|&a, &b| f64::total_cmp(&loads[a], &loads[b])).unwrap_or(0);
        loads[lightest] += cases[case].0;
        slices[case] = lightest + 1;
    }
    slices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_cases_are_dealt_first() {
        let costs = [5.0, 1.0, 4.0, 3.0, 3.0].map(|s| (s, format!("case-{s}")));
        assert_eq!(deal(&costs, 2), [1, 2, 2, 2, 1], "8 and 8 seconds");
        assert_eq!(deal(&costs[..2], 3), [1, 2], "the third slice is empty");
        let mut reversed = costs.to_vec();
        reversed.reverse();
        let loads = |costs: &[(f64, String)]| {
            let mut loads = [0.0; 2];
            deal(costs, 2).iter().zip(costs).for_each(|(slice, cost)| loads[slice - 1] += cost.0);
            loads
        };
        assert_eq!(loads(&costs), loads(&reversed));
    }

    #[test]
    fn slices_are_read_and_written() {
        let slice: Slice = "slice:2/3".parse().unwrap();
        assert_eq!((slice, slice.to_string().as_str()), (Slice { index: 2, count: 3 }, "slice:2/3"));
        for wrong in ["slice:0/3", "slice:4/3", "slice:1/0", "2/3", "hash:1/2", "slice:1", "slice:-1/2"] {
            let error = wrong.parse::<Slice>().unwrap_err();
            assert!(error.contains("slice:1/") || error.contains("no slice"), "{wrong}: {error}");
        }
    }
}
