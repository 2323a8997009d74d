//! Columns given for another quantity than the one they hold.
//!
//! Each energy is held against the references of all energies, before the crack runs and over the run: the
//! kinetic energy is half the work at first and within a tenth of it later. One that is near to another
//! reference and far from its own is in the wrong place: exchanged with others if they are in each other's
//! place, else given twice.

use super::events::AXIS;
use super::family::Variant;
use super::mistakes::{Curves, ELASTIC, pairs, window};
use super::submission::Submission;
use super::table::Curve;
use super::verdict::Finding;
use super::{FRACTURE, KINETIC, QUANTITIES, TIP_X, TIP_Y};
use crate::extremes::larger;

/// Relative rms within which an energy is that of a reference.
const NEAR: f64 = 0.2;
/// Part of the distance to its own reference within which another one has to be.
const NEARER: f64 = 0.5;
/// Half width about the axis in which a tip starts that is given by its height, m.
const ABOUT_AXIS: f64 = 1e-3;
/// Heights of a tip, m: the plate is 40 mm high.
const HEIGHTS: [f64; 2] = [0.01, 0.041];
/// Places of a tip along the plate, m: from the end of the initial crack to the right edge.
const PLACES: [f64; 2] = [0.045, 0.105];

/// An energy in the wrong place.
struct Moved {
    given: usize,
    is: usize,
    /// Distance from the reference of what it is, and from that of what it is given for.
    off: [f64; 2],
}

/// Energies that are those of other quantities, and the curves with each in its place.
pub(super) fn energies(submission: &Submission, curves: &Curves, variant: &Variant<'_>) -> Option<(Finding, Curves)> {
    let given: Vec<usize> = (KINETIC..=FRACTURE).filter(|&q| curves[q].is_some()).collect();
    let off = |q: usize, is: usize| off(&taken_as(submission, curves, q, is)?, variant, is);
    let moved: Vec<Moved> = given.iter().filter_map(|&q| moved(q, &off)).collect();
    let mut places: [Vec<usize>; 2] = [moved.iter().map(|m| m.given).collect(), moved.iter().map(|m| m.is).collect()];
    places.iter_mut().for_each(|places| places.sort_unstable());
    let stays = |q: &&usize| !places[0].contains(q);
    let exchanged = places[0] == places[1];
    let others_fit = given.iter().filter(stays).all(|&q| off(q, q).is_some_and(|off| off < NEAR));
    if moved.is_empty() || !(exchanged || others_fit) {
        return None;
    }
    let says = |m: &Moved| {
        let [is, own] = m.off.map(|off| 100.0 * off);
        let [given, what] = [m.given, m.is].map(|q| QUANTITIES[q].words);
        format!("what is given as {given} is the {what} ({is:.1} % off it, {own:.1} % off the {given})")
    };
    let says = moved.iter().map(says).collect::<Vec<_>>().join("; ");
    let (id, remedy) = if exchanged {
        ("exchanged-columns", "exchange the columns in [curves]")
    } else {
        ("wrong-column", "is the column right?")
    };
    let mut right = curves.clone();
    moved.iter().for_each(|m| right[m.given] = None);
    moved.iter().filter(|_| exchanged).for_each(|m| right[m.is] = taken_as(submission, curves, m.given, m.is));
    Some((Finding { id: id.into(), text: format!("{says}: {remedy}") }, right))
}

/// Where an energy belongs, if that is elsewhere.
fn moved(given: usize, off: &impl Fn(usize, usize) -> Option<f64>) -> Option<Moved> {
    let own = off(given, given)?;
    let all = (KINETIC..=FRACTURE).filter_map(|is| Some((is, off(given, is)?)));
    let (is, least) = all.min_by(|a, b| a.1.total_cmp(&b.1))?;
    (is != given && least < NEAR && least < NEARER * own).then_some(Moved { given, is, off: [least, own] })
}

/// A curve as another quantity: its first value is subtracted where it would be a fracture energy.
fn taken_as(submission: &Submission, curves: &Curves, given: usize, is: usize) -> Option<Curve> {
    let mut curve = curves[given].clone()?;
    let increment = submission.curves[FRACTURE].as_ref().is_some_and(|mapping| mapping.increment);
    if is == FRACTURE && given != FRACTURE && !increment {
        let first = curve.y[0];
        curve.y.iter_mut().for_each(|y| *y -= first);
    }
    Some(curve)
}

/// The larger of the relative rms between a curve and the reference of a quantity before the crack runs and
/// over the run. The fracture energy counts over the run alone: at first it tells how the crack was made.
fn off(curve: &Curve, variant: &Variant<'_>, quantity: usize) -> Option<f64> {
    let reference = variant.curves[quantity]?;
    let of = |window| {
        let pairs = pairs(curve, reference, window);
        let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
        let off = pairs.iter().map(|(y, r)| (y - r).powi(2)).sum::<f64>() / square;
        (pairs.len() > 10 && off.is_finite()).then(|| off.sqrt())
    };
    let run = of(window(quantity))?;
    if quantity == FRACTURE { Some(run) } else { Some(larger(run, of(ELASTIC)?)) }
}

/// Which part of a tip is in the wrong place, and the curves put right.
pub(super) fn tip(curves: &Curves) -> Option<(Finding, Curves)> {
    let last = |q: usize| curves[q].as_ref()?.y.iter().rfind(|y| y.is_finite()).copied();
    let within = |value: Option<f64>, [from, to]: [f64; 2]| value.is_some_and(|v| (from..=to).contains(&v));
    let (x, y) = (last(TIP_X), last(TIP_Y));
    let starts_on_axis = curves[TIP_X].as_ref().is_some_and(|x| (x.y[0] - AXIS).abs() < ABOUT_AXIS);
    let height = "tip_x is the height of the tip: the initial crack ends at x = 50 mm";
    let place = "tip_y is the place of the tip along the plate, which is 40 mm high";
    let (id, text) = if within(x, HEIGHTS) && within(y, PLACES) {
        ("exchanged-columns", format!("{height}; {place}: exchange the columns in [curves]"))
    } else if within(x, HEIGHTS) && starts_on_axis {
        ("wrong-column", format!("{height}; is the column right?"))
    } else if within(x, PLACES) && within(y, PLACES) {
        ("wrong-column", format!("{place}; is the column right?"))
    } else {
        return None;
    };
    let mut right = curves.clone();
    match (id, within(x, HEIGHTS)) {
        ("exchanged-columns", _) => right.swap(TIP_X, TIP_Y),
        (_, true) => right[TIP_X] = None,
        (_, false) => right[TIP_Y] = None,
    }
    Some((Finding { id: id.into(), text }, right))
}
