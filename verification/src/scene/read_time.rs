//! From the tree of a document to factors over time, and to conditions.

use fisura::scene::time::{Course, TimeFactor, TimeFormula};
use fisura::scene::{Boundary, EdgeCondition, Hold, Motion, Prescribed};

use super::fields::Fields;
use super::fields::Item;
use super::read::{length, number, time};
use super::read_body::edge;
use super::read_file::rows_of_file;
use super::units::{self, Dimension};
use crate::arithmetic::Arithmetic;

const COURSES: [&str; 5] = ["ramp", "smooth", "table", "file", "formula"];

/// `[[boundary]]` tables in order.
pub(super) fn boundaries(item: &Item<'_>) -> Option<Vec<Boundary>> {
    let read: Vec<Option<Boundary>> = item.tables()?.iter().map(boundary).collect();
    read.into_iter().collect()
}

fn boundary(item: &Item<'_>) -> Option<Boundary> {
    let fields = item.fields(&["name", "side", "from", "to", "fix", "velocity", "displacement", "time"])?;
    let name = fields.maybe("name", Item::words);
    let side = fields.need("side", "side = \"left\"", Item::word);
    let part = match (fields.get("from"), fields.get("to")) {
        (None, None) => Some(None),
        (Some(from), Some(to)) => length(&from).zip(length(&to)).map(|(from, to)| Some([from, to])),
        (Some(_), None) => item.missing("to", "to = \"25 mm\", the other end of the part"),
        (None, Some(_)) => item.missing("from", "from = 0.0, the other end of the part"),
    };
    let components = fields.need("fix", "fix = [\"x\"], the fixed components", |item| {
        item.each(|component| component.choice(&[("x", 0), ("y", 1)]))
    });
    let prescribed = prescribed(&fields);
    let components = components?;
    let fix = [0, 1].map(|d| components.contains(&d));
    Some(Boundary { name: name?, side: side?, part: part?, fix, prescribed: prescribed? })
}

/// `[[body.condition]]`.
pub(super) fn edge_condition(item: &Item<'_>) -> Option<EdgeCondition> {
    let fields = item.fields(&["name", "edge", "segment", "arc", "fix", "velocity", "displacement", "time"])?;
    let name = fields.maybe("name", Item::words);
    let edge = edge(&fields);
    let hold = fields.need("fix", "fix = [\"x\"], the fixed components, or fix = [\"normal\"]", hold);
    let prescribed = prescribed(&fields);
    Some(EdgeCondition { name: name?, edge: edge?, hold: hold?, prescribed: prescribed? })
}

fn hold(item: &Item<'_>) -> Option<Hold> {
    let components = item.each(|component| component.choice(&[("x", Some(0)), ("y", Some(1)), ("normal", None)]))?;
    match components.as_slice() {
        [None] => Some(Hold::Normal),
        given if given.contains(&None) => {
            item.fail("the normal beside other components", "give fix = [\"normal\"], or fix = [\"x\", \"y\"]")
        }
        given => Some(Hold::Components([0, 1].map(|d| given.contains(&Some(d))))),
    }
}

/// What a condition prescribes, and when: at rest if nothing is given.
fn prescribed(fields: &Fields<'_>) -> Option<Prescribed> {
    let velocity = fields.maybe("velocity", |item| item.vector(Dimension::VELOCITY));
    let displacement = fields.maybe("displacement", |item| item.vector(Dimension::LENGTH));
    let time = fields.or("time", TimeFactor::default(), factor);
    let motion = match (velocity?, displacement?) {
        (Some(_), Some(_)) => {
            let given = fields.get("displacement")?;
            return given.fail("both velocity and displacement are given", "remove one of the two");
        }
        (None, Some(displacement)) => Motion::Displacement(displacement),
        (velocity, None) => Motion::Velocity(velocity.unwrap_or_default()),
    };
    Some(Prescribed { motion, time: time? })
}

/// A factor over time: `{ ramp = "1 us", until = "5 us" }`.
pub(super) fn factor(item: &Item<'_>) -> Option<TimeFactor> {
    let fields = item.fields(&["ramp", "smooth", "table", "file", "formula", "until"])?;
    let until = fields.maybe("until", time);
    let given: Vec<Item<'_>> = COURSES.iter().filter_map(|course| fields.get(course)).collect();
    let course = match given.as_slice() {
        [] => Some(Course::Constant),
        [course] => match course.path.rsplit('.').next()? {
            "ramp" => time(course).map(Course::Ramp),
            "smooth" => time(course).map(Course::Smooth),
            "table" => course.each(row).map(Course::Table),
            "file" => {
                let remedy = "give a CSV file beside the scene with rows of time (s) and factor";
                rows_of_file(course, remedy).map(Course::Table)
            }
            _ => formula(course).map(Course::Formula),
        },
        [_, second, ..] => second.fail("a second course in time", format!("give one of {}", COURSES.join(", "))),
    };
    Some(TimeFactor { course: course?, until: until? })
}

/// A row of a table: a time and a factor.
fn row(item: &Item<'_>) -> Option<[f64; 2]> {
    let entries = item.list()?;
    let [at, value] = entries.as_slice() else {
        return item.fail("expected a time and a factor", "give rows such as [\"1 us\", 0.5]");
    };
    time(at).zip(number(value)).map(|(time, value)| [time, value])
}

/// A formula of t (s), in which numbers may have units of time: `exp(-t / 100 us)`.
fn formula(item: &Item<'_>) -> Option<TimeFormula> {
    let text = item.words()?;
    let remedy = "give a formula of t (s), such as \"exp(-t / 100 us)\"";
    let parsed = plain_numbers(&text).and_then(|plain| plain.parse::<Arithmetic>());
    let arithmetic = match parsed {
        Ok(arithmetic) => arithmetic,
        Err(message) => return item.fail(message, remedy),
    };
    if let Some(name) = arithmetic.names().iter().find(|name| *name != "t") {
        return item.fail(format!("unknown name {name:?} in a formula of t"), remedy);
    }
    let varies = !arithmetic.names().is_empty();
    Some(TimeFormula::new(text, move |t| if varies { arithmetic.value(&[t]) } else { arithmetic.value(&[]) }))
}

/// A formula without units: numbers that have one are in seconds.
fn plain_numbers(text: &str) -> Result<String, String> {
    let mut plain = String::new();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit() || c == '.') {
        let (before, number) = rest.split_at(start);
        plain.push_str(before);
        let in_a_name = plain.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_');
        let end = if in_a_name { 1 } else { units::number_end(number).max(1) };
        let after = &number[end..];
        let gap = after.len() - after.trim_start_matches(' ').len();
        let unit = after[gap..].find(|c: char| !c.is_alphabetic()).map_or(&after[gap..], |end| &after[gap..gap + end]);
        if in_a_name || unit.is_empty() {
            plain.push_str(&number[..end]);
            rest = after;
        } else {
            let quantity = format!("{} {unit}", &number[..end]);
            let seconds = units::parse_as(&quantity, Dimension::TIME).map_err(|e| e.message)?;
            plain.push_str(&format!("{seconds:e}"));
            rest = &after[gap + unit.len()..];
        }
    }
    plain.push_str(rest);
    Ok(plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_formula_may_have_units_of_time() {
        let seconds = |text: &str| plain_numbers(text).unwrap().parse::<Arithmetic>().unwrap().value(&[2e-6]);
        assert_eq!(seconds("t / 1 us"), 2.0);
        assert_eq!(seconds("min(t / 4e0 us, 1) + 0.5*t/2e-6"), 1.0);
        assert!(plain_numbers("t / 1 mm").is_err());
    }
}
