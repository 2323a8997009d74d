//! The order in which cases run, and on how many threads.
//!
//! Most cases run side by side, on one thread each, the longest first. A case that would still run when all
//! others are done, or that needs much memory, runs before them on all threads. No result depends on the
//! order or on the threads.

use fisura::validate::expected_size;

use super::prepare::Prepared;
use super::seconds::Seconds;
use crate::case::Case;
use crate::case::expand::CaseScene;

/// Memory, bytes, that a case beside others may need.
const SIDE_BY_SIDE: usize = 1 << 30;

/// What is known of a case before it runs.
#[derive(Debug, Clone, Copy)]
struct Cost {
    seconds: f64,
    bytes: usize,
}

/// Numbers of cases in the order in which they run.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Schedule {
    /// One after the other, on all threads.
    pub alone: Vec<usize>,
    /// Then these, on one thread each.
    pub side_by_side: Vec<usize>,
}

impl Schedule {
    /// For cases on a number of threads.
    pub(super) fn new<'a>(
        cases: impl Iterator<Item = (&'a Case, &'a Prepared)>,
        seconds: &Seconds,
        threads: usize,
    ) -> Self {
        let cost = |(case, prepared): (&Case, &Prepared)| Cost {
            seconds: seconds.of(case),
            bytes: prepared.scenes.iter().map(bytes).max().unwrap_or(0),
        };
        Self::of_costs(&cases.map(cost).collect::<Vec<_>>(), threads)
    }

    fn of_costs(costs: &[Cost], threads: usize) -> Self {
        let mut order: Vec<usize> = (0..costs.len()).collect();
        if threads == 1 {
            return Self { alone: order, side_by_side: Vec::new() };
        }
        order.sort_by(|&a, &b| costs[b].seconds.total_cmp(&costs[a].seconds));
        let mut left: f64 = costs.iter().map(|cost| cost.seconds).sum();
        let mut schedule = Self::default();
        for case in order {
            let Cost { seconds, bytes } = costs[case];
            if seconds * threads as f64 > left || bytes > SIDE_BY_SIDE {
                schedule.alone.push(case);
                left -= seconds;
            } else {
                schedule.side_by_side.push(case);
            }
        }
        schedule
    }
}

fn bytes(scene: &CaseScene) -> usize {
    let size = expected_size(&scene.scene);
    size.mechanics_bytes.saturating_add(size.phase_field_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(costs: &[(f64, usize)], threads: usize) -> (Vec<usize>, Vec<usize>) {
        let costs: Vec<Cost> = costs.iter().map(|&(seconds, bytes)| Cost { seconds, bytes }).collect();
        let Schedule { alone, side_by_side } = Schedule::of_costs(&costs, threads);
        (alone, side_by_side)
    }

    #[test]
    fn the_longest_start_first_and_those_that_would_be_left_over_run_on_all_threads() {
        assert_eq!(of(&[(1.0, 0), (3.0, 0), (2.0, 0)], 2), (vec![], vec![1, 2, 0]));
        assert_eq!(of(&[(1.0, 0), (9.0, 0), (2.0, 0), (2.0, 0)], 2), (vec![1], vec![2, 3, 0]));
        assert_eq!(of(&[(5.0, 0)], 2), (vec![0], vec![]), "a single case has the machine to itself");
    }

    #[test]
    fn what_needs_much_memory_runs_alone_and_one_thread_keeps_the_order() {
        assert_eq!(of(&[(1.0, 0), (1.0, 3 << 30), (1.0, 0)], 2), (vec![1], vec![0, 2]));
        assert_eq!(of(&[(1.0, 0), (3.0, 0), (2.0, 0)], 1), (vec![0, 1, 2], vec![]));
    }
}
