//! Which record of the new results is compared with which of the base.

use std::collections::{HashMap, VecDeque};

use fisura_verification::record::{Record, normal_id};

/// For each record of the base the place of the new one with its id, else of one that names this id among its
/// former ones. Ids are compared in their normal form, which those of earlier versions do not have. An id
/// that is there twice is found twice, in the same order.
pub(super) fn partners(base: &[Record], new: &[Record]) -> Vec<Option<usize>> {
    let mut present: HashMap<String, VecDeque<usize>> = HashMap::new();
    let mut former: HashMap<String, VecDeque<usize>> = HashMap::new();
    for (at, record) in new.iter().enumerate() {
        present.entry(normal_id(&record.id)).or_default().push_back(at);
        record.formerly.iter().for_each(|id| former.entry(normal_id(id)).or_default().push_back(at));
    }
    let mut taken = vec![false; new.len()];
    let mut found: Vec<Option<usize>> =
        base.iter().map(|record| present.get_mut(&normal_id(&record.id))?.pop_front()).collect();
    found.iter().flatten().for_each(|at| taken[*at] = true);
    for (record, partner) in base.iter().zip(&mut found).filter(|(_, partner)| partner.is_none()) {
        let heirs = former.get_mut(&normal_id(&record.id));
        *partner = heirs.and_then(|heirs| std::iter::from_fn(|| heirs.pop_front()).find(|at| !taken[*at]));
        partner.iter().for_each(|at| taken[*at] = true);
    }
    found
}
