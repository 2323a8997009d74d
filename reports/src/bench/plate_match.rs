//! Finite elements against fisura on the plate: what the best of each takes to an error, quantity by
//! quantity, won or lost.

use fisura_verification::bench::plate_error::{QUANTITIES, Quantity};
use fisura_verification::bench::record::{BenchRecord, Spread};

use super::pareto::cost_to_reach;
use super::plate::{ELEMENTS, EQUAL, GRADED, error_in, shown};
use super::ratios::{Found, Target};
use super::work_precision::{Line, lines};
use super::{Exhibit, Records, range};
use crate::number::plain;

/// Errors that are compared: relative, and in mm.
const RELATIVE: [f64; 7] = [0.1, 0.05, 0.04, 0.02, 0.01, 0.005, 0.003];
const LENGTHS: [f64; 5] = [4.0, 2.0, 1.0, 0.5, 0.25];
/// The smallest error that is compared, and the least of the others, in uncertainties of the reference.
const UNCERTAINTIES: [f64; 2] = [2.0, 2.05];

/// Quantities, errors, and how many times less time fisura should take at them; elsewhere not more.
const TARGETS: [([&str; 2], &[f64], f64); 3] = [
    (["kinetic energy", "external work"], &[0.01], 4.0),
    (["kinetic energy", "external work"], &[0.005, 0.003], 8.0),
    (["elastic energy", "fracture energy"], &[0.04, 0.02], 4.0),
];

/// Reason of the first targets.
const SEVERAL_TIMES: &str = "to be several times as fast as elements of the same error is the aim of this program. If fracture \
                             cost nothing, the ratio would be that of a step of the plate over an elastic step times as large";
const AHEAD: &str = "at errors below 10 % fisura should not be slower. At large errors it is bounded by the time of its coarsest \
                     mesh, h = 4 l0, beyond which a crack is refused";

/// What the best way of a code is called, and its time, s: from medians, and from the least and the greatest
/// of every mesh.
type Best = (String, Spread);

/// The best of both at one error of one quantity; none where no way reaches it.
struct Match {
    quantity: &'static Quantity,
    error: f64,
    uncertainty: f64,
    ours: Option<Best>,
    elements: Option<Best>,
}

impl Match {
    /// Time of the finite elements over that of fisura, if both reach the error; the range is that of the
    /// least of one over the greatest of the other.
    fn ratio(&self) -> Option<Spread> {
        let (elements, ours) = (self.elements.as_ref()?.1, self.ours.as_ref()?.1);
        let [median, min, max] = [elements.median / ours.median, elements.min / ours.max, elements.max / ours.min];
        Some(Spread { median, min, max })
    }

    fn target(&self) -> Target {
        let asked =
            |names: &[&str; 2], errors: &[f64]| names.contains(&self.quantity.name) && errors.contains(&self.error);
        let target = TARGETS.iter().find(|(names, errors, _)| asked(names, errors));
        match target {
            Some(target) => Target::AtLeast(target.2),
            None if self.quantity.unit.is_empty() && self.error >= RELATIVE[0] => Target::None,
            None => Target::AtLeast(1.0),
        }
    }

    fn found(&self) -> Option<Found> {
        let error = shown(self.error, self.quantity.unit);
        let what = format!("finite elements over fisura, plate, {} to {error}", self.quantity.name);
        let why = if self.target() == Target::AtLeast(1.0) { AHEAD } else { SEVERAL_TIMES };
        Some(Found { what, value: self.ratio()?, target: self.target(), verified: true, why: why.into() })
    }

    fn words(&self) -> String {
        format!("{} to {}", self.quantity.name, shown(self.error, self.quantity.unit))
    }
}

/// Every quantity at every error that the reference can tell from none, down to twice its uncertainty.
fn matches(records: Records) -> Vec<Match> {
    let mut matches = Vec::new();
    for quantity in &QUANTITIES {
        let all = [EQUAL, GRADED, ELEMENTS].map(|id| records.below(id)).concat();
        let Some(error) = all.iter().find_map(|record| error_in(record, quantity)) else { continue };
        let levels = if error.unit.is_empty() { &RELATIVE[..] } else { &LENGTHS[..] };
        let uncertainty = error.uncertainty;
        let ranked = levels.iter().copied().filter(|level| *level >= UNCERTAINTIES[1] * uncertainty);
        for error in ranked.chain([UNCERTAINTIES[0] * uncertainty]) {
            let ours = best(records, &[EQUAL, GRADED], quantity, error);
            let elements = best(records, &[ELEMENTS], quantity, error);
            matches.push(Match { quantity, error, uncertainty, ours, elements });
        }
    }
    matches
}

/// The way that reaches an error in the least time.
fn best(records: Records, ids: &[&str], quantity: &Quantity, error: f64) -> Option<Best> {
    let lines = lines(ids.iter().flat_map(|id| records.below(id)));
    let cost = |line: &Line| {
        let reach = |time: fn(&Spread) -> f64| {
            let point = |r: &&BenchRecord| Some((time(&r.cpu_s), error_in(r, quantity)?.value));
            let points: Vec<(f64, f64)> = line.records.iter().filter_map(point).collect();
            cost_to_reach(&points, error)
        };
        let (median, min, max) = (reach(|cpu| cpu.median)?, reach(|cpu| cpu.min)?, reach(|cpu| cpu.max)?);
        Some((line.label.clone(), Spread { median, min, max }))
    };
    lines.iter().filter_map(cost).min_by(|a, b| a.1.median.total_cmp(&b.1.median))
}

/// The ratios, for the table of targets.
pub fn targets(records: Records) -> Vec<Found> {
    matches(records).iter().filter_map(Match::found).filter(|found| found.target != Target::None).collect()
}

/// Targets that are not judged, since the reference of the quantity is not known well enough, in words.
pub fn not_judged(records: Records) -> String {
    let all = matches(records);
    let known = |name: &str, error: f64| all.iter().any(|m| m.quantity.name == name && m.error <= error);
    let targets = TARGETS.iter().flat_map(|(names, errors, _)| names.iter().map(move |name| (name, errors)));
    let unknown = targets.flat_map(|(name, errors)| errors.iter().map(move |error| (*name, *error)));
    let unknown = unknown.filter(|(name, error)| all.iter().any(|m| m.quantity.name == *name) && !known(name, *error));
    unknown.map(|(name, error)| format!("{name} to {}", shown(error, ""))).collect::<Vec<_>>().join(", ")
}

/// Wins and losses; where the finite elements could not be built, why.
pub fn table(records: Records, unbuilt: Option<&str>) -> Exhibit {
    let all = matches(records);
    let row = |m: &Match| {
        let (ratio, (ours, elements)) = (m.ratio()?, m.ours.as_ref().zip(m.elements.as_ref())?);
        let way = |(label, seconds): &Best| format!("{label}: {} s", plain(seconds.median, 3));
        let found = m.found()?;
        let outcome = if ratio.median >= 1.0 { "fisura ahead" } else { "fisura behind" };
        Some(vec![
            m.quantity.name.to_string(),
            shown(m.error, m.quantity.unit),
            shown(m.uncertainty, m.quantity.unit),
            way(ours),
            way(elements),
            plain(ratio.median, 3),
            range(ratio),
            outcome.into(),
            found.target.words(),
            found.word().into(),
        ])
    };
    let head =
        ["quantity", "error", "U", "fisura", "finite elements", "ratio", "range", "outcome", "target", "verdict"];
    let title = "Finite elements over fisura: the best of each at equal error";
    Exhibit::grid(title, &head, all.iter().filter_map(row), note(&all, unbuilt))
}

fn note(all: &[Match], unbuilt: Option<&str>) -> String {
    let alone = |ours: bool| {
        let of = |m: &&Match| m.ours.is_some() == ours && m.elements.is_some() != ours;
        all.iter().filter(of).map(Match::words).collect::<Vec<_>>().join(", ")
    };
    let mut note = "Processor time of one thread on this machine, in the same rounds; times between two meshes are those of a power law. \
                    The range of a ratio is from the least and greatest times of each mesh; a mesh that ran once has no spread. \
                    κ: a crack on a mesh costs κ Gc, and both codes may run with Gc/κ. An error counts for a mesh if no finer one of the same \
                    way has a larger error. No error below twice the uncertainty U of the reference is compared."
        .to_string();
    for (who, ours) in [("fisura", true), ("the finite elements", false)] {
        let words = alone(ours);
        if !words.is_empty() {
            note += &format!(" Only {who} reached: {words}.");
        }
    }
    note + &unbuilt.map_or(String::new(), |why| format!(" The finite elements could not be built here: {why}."))
}

/// Wins and losses in a sentence.
pub fn reading(records: Records, unbuilt: Option<&str>) -> String {
    let all = matches(records);
    let mut ratios: Vec<(f64, String)> = all.iter().filter_map(|m| Some((m.ratio()?.median, m.words()))).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(least), Some(most)) = (ratios.first(), ratios.last()) else {
        let why = unbuilt.map_or(String::new(), |why| format!(" The finite elements could not be built here: {why}."));
        return format!("There is no error that both codes reach.{why}");
    };
    let ahead = ratios.iter().filter(|(ratio, _)| *ratio >= 1.0).count();
    let [least, most] = [least, most].map(|(ratio, words)| format!("{} ({words})", plain(*ratio, 2)));
    format!(
        "Of {} errors that both reach, fisura takes less processor time than the finite elements at {ahead}. The time of the \
         elements over that of fisura is between {least} and {most}.",
        ratios.len()
    )
}
