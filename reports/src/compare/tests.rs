//! What counts as unchanged, minor and major.

use fisura_verification::record::{Accept, Record, ReferenceKind, Status};

use super::*;
use crate::example::results;

/// A record with these bounds.
fn record(value: f64, min: Option<f64>, max: Option<f64>) -> Record {
    let mut record = results().records.remove(0);
    record.reference = None;
    record.accept = Accept { min, max, why: "a test".into(), regression: false };
    record.value = Some(value);
    record.status = record.status_of(record.value);
    record
}

fn changed(base: &Record, value: f64) -> (Change, Effect) {
    let new = Record { value: Some(value), status: base.status_of(Some(value)), ..base.clone() };
    let (change, effect, _) = accuracy(base, &new);
    (change, effect)
}

#[test]
fn a_set_against_itself_is_unchanged() {
    let set = results();
    let compared = compare(&set, &set);
    assert!(compared.is_unchanged(), "{}", render_text(&compared));
    assert_eq!(compared.major_losses, 0);
    assert!(render_text(&compared).contains(&format!("No change: {} records unchanged", set.records.len())));
}

#[test]
fn changes_count_by_verdict_tolerance_and_room() {
    use Change::{Major, Minor, Unchanged};
    use Effect::{Better, Neutral, Worse};
    let [at_most, closure] = [10.0, 1e-12].map(|max| move |value: f64| record(value, None, Some(max)));
    let band = |value: f64| record(value, Some(2.9), Some(3.5));
    let reference = Some(Reference::new(Some(4.0), ReferenceKind::Theory, "p + 1"));
    let order = Record { reference, ..record(3.99, Some(3.9), None) };
    let free = record(0.25, None, None);
    for (base, value, expected, what) in [
        (at_most(3.0), 11.0, (Major, Worse), "a verdict is lost"),
        (at_most(11.0), 3.0, (Major, Better), "a verdict is gained"),
        (closure(3e-16), 9e-16, (Unchanged, Neutral), "round-off far inside"),
        (closure(3e-16), 1e-13, (Minor, Worse), "a tenth of the tolerance"),
        (closure(3e-16), 6e-13, (Major, Worse), "more than half of it"),
        (at_most(9.5), 9.8, (Minor, Worse), "60 % of the room, but 3 % of the tolerance"),
        (at_most(9.5), 5.0, (Minor, Better), "away from the bound"),
        (band(3.05), 3.051, (Unchanged, Neutral), "next to nothing"),
        (band(3.05), 2.95, (Major, Worse), "two thirds of the room, a third of the tolerance"),
        (band(3.05), 3.2, (Minor, Better), "to the middle"),
        (order, 3.93, (Major, Worse), "the tolerance is 0.1"),
        (free.clone(), 0.25 * (1.0 + 1e-9), (Unchanged, Neutral), "round-off"),
        (free, 2.5, (Minor, Neutral), "a value without bounds is never major"),
    ] {
        assert_eq!(changed(&base, value), expected, "{what}");
    }
}

#[test]
fn what_broke_down_and_looser_or_dropped_bounds_do_not_hide_a_loss() {
    let (base, free) = (record(9.0, None, Some(10.0)), record(0.25, None, None));
    assert_eq!(accuracy(&base, &Record { value: None, status: Status::Error, ..base.clone() }).0, Change::Major);
    assert_eq!(accuracy(&free, &Record { value: None, ..free.clone() }).0, Change::Minor, "the value is gone");
    let (change, effect, why) = accuracy(&base, &record(12.0, None, Some(20.0)));
    assert_eq!((change, effect), (Change::Major, Effect::Worse));
    assert!(why.contains("bounds of the base"), "{why}");
    assert_eq!(accuracy(&base, &record(9.0, None, None)).0, Change::Major);
    assert_eq!(accuracy(&base, &record(9.0, None, Some(20.0))).0, Change::Minor, "other bounds, same value");
}

#[test]
fn missing_and_new_records_are_named_and_a_new_one_that_fails_is_a_loss() {
    let (base, mut new) = (results(), results());
    new.records.retain(|r| r.status != Status::Info);
    let mut added = record(11.0, None, Some(10.0));
    added.id = "plate/impact/added".into();
    new.records.push(added);
    let compared = compare(&base, &new);
    let gone = base.records.len() + 1 - new.records.len();
    assert_eq!((compared.count(Change::Missing), compared.count(Change::New), compared.major_losses), (gone, 1, 1));
    let lost = compared.records.iter().filter(|r| r.accuracy == Change::Missing && r.effect == Effect::Worse);
    assert_eq!(lost.count(), 0, "what is gone was not judged");
    let text = render_markdown(&compared);
    assert!(text.contains("## missing") && text.contains("`plate/impact/added`"), "{text}");
}

#[test]
fn a_check_that_is_gone_is_a_loss_unless_another_one_was_it_formerly() {
    let (base, mut new) = (results(), results());
    let old = new.records[0].id.clone();
    new.records[0].id = "plate/impact/p2/slope".into();
    let reworded = compare(&base, &new);
    assert_eq!(reworded.major_losses, 1, "{}", render_text(&reworded));
    assert!(reworded.records[0].why.contains("formerly"), "the remedy is named: {:?}", reworded.records[0]);
    new.records[0].formerly = vec!["plate/impact/p2/never".into(), old.clone()];
    let renamed = compare(&base, &new);
    assert_eq!((renamed.major_losses, renamed.count(Change::Missing), renamed.count(Change::New)), (0, 0, 0));
    let record = &renamed.records[0];
    assert_eq!((record.id.as_str(), record.accuracy), ("plate/impact/p2/slope", Change::Minor));
    assert!(record.why.contains(&old), "{record:?}");
    new.records[0].value = Some(0.0);
    new.records[0].status = Status::Fail;
    assert_eq!(compare(&base, &new).major_losses, 1, "a new name hides nothing");
    new.records.remove(0);
    assert_eq!(compare(&base, &new).major_losses, 1);
    let mut broken = results();
    broken.records.retain(|r| r.status == Status::Error);
    new.records.retain(|r| r.status != Status::Error);
    assert_eq!(compare(&broken, &new).major_losses, 2, "what broke down may go; two new records do not hold");
}

#[test]
fn one_heir_stands_for_one_check_and_twins_for_each_other() {
    let mut base = results();
    base.records = vec![record(1.0, None, Some(10.0)), record(2.0, None, Some(10.0))];
    let twins = compare(&base, &base);
    assert!(twins.is_unchanged(), "an id that is there twice: {}", render_text(&twins));
    let mut new = base.clone();
    new.records.truncate(1);
    assert_eq!(compare(&base, &new).major_losses, 1, "one of two is gone");
    (base.records[0].id, base.records[1].id) = ("a/b/one".into(), "a/b/two".into());
    new.records[0].id = "a/b/three".into();
    new.records[0].formerly = vec!["a/b/one".into(), "a/b/two".into()];
    let merged = compare(&base, &new);
    assert_eq!((merged.count(Change::Missing), merged.major_losses), (1, 1));
}

#[test]
fn another_unit_is_reported_and_its_numbers_are_not_compared() {
    let base = record(9.0, None, Some(10.0));
    let other = Record { unit: "mm".into(), value: Some(9000.0), ..record(9000.0, None, Some(10_000.0)) };
    let (change, effect, why) = accuracy(&base, &other);
    assert_eq!((change, effect), (Change::Major, Effect::Worse));
    assert!(why.contains("\"mm\"") && why.contains(&format!("{:?}", base.unit)), "{why}");
    let shown = record(0.25, None, None);
    assert_eq!(accuracy(&shown, &Record { unit: "mm".into(), ..shown.clone() }).0, Change::Minor);
    let mut words = results();
    words.records[0].quantity = "the same in other words".into();
    let compared = compare(&results(), &words);
    assert_eq!((compared.records[0].accuracy, compared.major_losses), (Change::Minor, 0));
}

#[test]
fn times_are_held_against_their_spread() {
    let timed = |walls: &[f64]| {
        let mut set = results();
        let records = walls.iter().enumerate().map(|(i, wall)| {
            let mut record = record(1.0, None, Some(10.0));
            record.id = format!("energy/bar-{i}/closure");
            record.case = format!("bar-{i}");
            record.timing.wall_s = *wall;
            record
        });
        set.records = records.collect();
        set
    };
    let change = |base: &[f64], new: &[f64]| {
        let compared = compare(&timed(base), &timed(new));
        compared.speed.runs.iter().map(|run| run.change).collect::<Vec<_>>()
    };
    use Change::{Major, Minor, Unchanged};
    let base = [10.0, 20.0, 5.0, 8.0, 4.0];
    assert_eq!(change(&base, &[10.5, 21.0, 5.2, 8.1, 9.9]), [Unchanged, Unchanged, Unchanged, Unchanged, Major]);
    assert_eq!(change(&base, &[10.5, 21.0, 5.2, 8.1, 6.8]).last(), Some(&Minor));
    assert_eq!(change(&base, &[4.0, 40.0, 2.0, 20.0, 9.9]).last(), Some(&Unchanged), "all times scatter like that");
    assert_eq!(change(&base, &base.map(|t| 3.0 * t)), [Major; 5], "everything is slower");
    assert_eq!(change(&[0.1, 0.2], &[0.9, 0.8]), [], "below the floor");
    let mut elsewhere = timed(&base.map(|t| 3.0 * t));
    elsewhere.environment.cpu = "another".into();
    let compared = compare(&timed(&base), &elsewhere);
    assert_eq!((compared.major_losses, compared.records[0].speed.is_none()), (0, true));
    assert!(compare(&timed(&base), &timed(&base.map(|t| 3.0 * t))).major_losses == 5);
}
