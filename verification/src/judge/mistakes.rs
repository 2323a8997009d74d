//! Common mistakes, recognised and named; nothing is corrected.
//!
//! A mistake is looked for only where something fails. Columns in the wrong place (`exchanged`) and times
//! with another origin (`origin`) come first, and others are looked for in curves without them. Load and
//! plane state are told from the time before the crack runs: the body is elastic, energies go with the
//! square of the load, and the shapes of the curves tell the plane state.

use super::family::{END, Variant};
use super::model::Plane;
use super::submission::Submission;
use super::table::Curve;
use super::verdict::Finding;
use super::{FRACTURE, KINETIC, QUANTITIES, TIP_X, curves, exchanged, origin};
use crate::output::history::format_number;
use crate::reference::{Library, ReferenceCurve};

/// Part by which a factor may be off and still be that factor.
const NEAR: f64 = 0.12;
/// Rms of what is left after scaling, relative, below which two curves have one shape.
const SHAPE: f64 = 0.20;
/// The same for one quantity by itself.
const ALONE: f64 = 0.06;
/// A result that is off by no more than this times what elements of its spacing are off by may owe that to
/// its mesh alone.
const OFF_BY_MESH: f64 = 1.1;

/// Curves by quantity.
pub(super) type Curves = [Option<Curve>; 6];

/// Looks for a mistake in curves; gives the curves without it.
type Finder<'a> = dyn Fn(&Curves) -> Option<(Finding, Curves)> + 'a;

/// Before the crack runs, s: the body is elastic.
pub(super) const ELASTIC: [f64; 2] = [2e-6, 12e-6];

/// Everything that is recognised. Other problems are looked at only where a whole curve is off: `off` is then
/// what elements of the spacing of the result are off by.
pub fn find(
    submission: &Submission,
    curves: &[Option<Curve>; 6],
    variant: &Variant<'_>,
    library: &Library,
    off: Option<f64>,
) -> Vec<Finding> {
    let mut found = Vec::new();
    if let Some(finding) = time_unit(curves) {
        return vec![finding];
    }
    let mut right = curves.clone();
    let origin = |curves: &Curves| origin::find(submission, curves, variant, library, off.unwrap_or(0.0));
    let finders: [&Finder<'_>; 4] = [
        &origin,
        &|curves| exchanged::energies(submission, curves, variant),
        &exchanged::tip,
        &origin, // columns in the wrong place hide it
    ];
    for find in finders {
        if let Some((finding, without)) = find(&right) {
            found.push(finding);
            right = without;
        }
    }
    let curves = &right;
    let scales: Vec<(usize, f64, f64)> = (0..=FRACTURE)
        .filter_map(|q| Some((q, fit(curves[q].as_ref()?, variant.curves[q]?, window(q))?)))
        .map(|(q, (scale, left))| (q, scale, left))
        .collect();
    found.extend(factors(submission, &scales));
    found.extend(tip(curves[TIP_X].as_ref()));
    found.extend(absolute(curves[FRACTURE].as_ref(), variant.curves[FRACTURE], &found));
    if found.is_empty() {
        found.extend(load_and_plane(submission, curves, variant, library));
        found.extend(off.and_then(|mesh| nearer(curves, variant, library, mesh)));
    }
    found
}

/// From where a quantity is compared as a whole, s.
pub(super) fn window(quantity: usize) -> [f64; 2] {
    [if quantity == FRACTURE { 30e-6 } else { 5e-6 }, END]
}

/// Result and reference at the times of the reference in a window, where the result has them.
pub(super) fn pairs(curve: &Curve, reference: &ReferenceCurve, window: [f64; 2]) -> Vec<(f64, f64)> {
    pairs_at(curve, reference, window, 0.0)
}

/// The same with the result at times that are later by `shift`, s.
pub(super) fn pairs_at(curve: &Curve, reference: &ReferenceCurve, [from, to]: [f64; 2], shift: f64) -> Vec<(f64, f64)> {
    let rows = reference.x.iter().zip(&reference.y).filter(|(t, _)| (from..=to).contains(*t));
    rows.filter_map(|(t, r)| Some((curves::at(curve, *t + shift)?, *r))).collect()
}

/// The factor on the reference that is nearest to the result, and what is left, relative to the scaled
/// reference.
fn fit(curve: &Curve, reference: &ReferenceCurve, window: [f64; 2]) -> Option<(f64, f64)> {
    let pairs = pairs(curve, reference, window);
    let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
    let scale = pairs.iter().map(|(y, r)| y * r).sum::<f64>() / square;
    let left = pairs.iter().map(|(y, r)| (y - scale * r).powi(2)).sum::<f64>() / (scale * scale * square);
    (pairs.len() > 10 && scale.is_finite() && scale != 0.0).then(|| (scale, left.sqrt()))
}

/// The whole power of ten that a positive scale is near to, other than 1.
fn power_of_ten(scale: f64) -> Option<i32> {
    let power = scale.log10().round();
    (power != 0.0 && (scale / 10f64.powf(power)).ln().abs() < NEAR).then_some(power as i32)
}

/// The same, also beside a factor 2 of a half model if it is one of thousands.
fn power_of_unit(scale: f64) -> Option<i32> {
    let beside = |factor: f64| power_of_ten(scale / factor).filter(|power| power % 3 == 0);
    power_of_ten(scale).or_else(|| beside(0.5)).or_else(|| beside(2.0))
}

/// Factors 2 of half models and powers of ten of units, for all energies together or one by one.
fn factors(submission: &Submission, scales: &[(usize, f64, f64)]) -> Vec<Finding> {
    let near = |scale: f64, goal: f64| scale > 0.0 && (scale / goal).ln().abs() < NEAR;
    let name = |q: usize| QUANTITIES[q].words;
    let shaped: Vec<(usize, f64)> = scales.iter().filter(|s| s.2 < SHAPE).map(|s| (s.0, s.1)).collect();
    // what is left of a factor without its power of ten
    let rest = |scale: f64| power_of_unit(scale).map_or(scale, |power| scale / 10f64.powi(power));
    // a factor 2 of one quantity alone may be anything: there its shape has to be that of the reference
    let alone = |q: usize| scales.iter().any(|s| s.0 == q && s.2 < ALONE);
    let mut out = Vec::new();
    let by_thickness = |t: &f64| t.ln().abs() > NEAR && shaped.iter().all(|s| near(s.1, *t) || near(s.1, 1.0 / t));
    let declared = submission.model.thickness.filter(|_| shaped.len() == scales.len() && scales.len() > 1);
    if let Some(thickness) = declared.filter(by_thickness) {
        let text = format!(
            "all energies are off by the declared thickness of {} m: are they per thickness already, or is it not that of \
             the plate? the benchmark wants J per metre of thickness (1 mJ/mm = 1 J/m)",
            format_number(thickness)
        );
        return vec![Finding { id: "thickness".into(), text }];
    }
    for (goal, words) in [(0.5, "half"), (2.0, "twice")] {
        let these: Vec<&str> = shaped.iter().filter(|s| near(rest(s.1), goal)).map(|s| name(s.0)).collect();
        let one = shaped.iter().find(|s| near(rest(s.1), goal)).is_some_and(|s| alone(s.0));
        if these.is_empty() || (these.len() == 1 && !one) {
            continue;
        }
        let model = match (submission.model.half, goal < 1.0) {
            (true, true) => "the model is declared to be a half, so give factor = 2",
            (false, true) => {
                "were they summed over the upper half of the plate? then declare part = \"half\" and factor = 2"
            }
            (true, false) => "is the factor 2 of the half model already in the numbers?",
            (false, false) => "was a factor 2 of a half model applied to the whole plate?",
        };
        let text = format!("{} {words} the reference in shape and size: {model}", list(&these));
        out.push(Finding { id: "half-model-factor".into(), text });
    }
    let powers: Vec<(usize, i32)> = shaped.iter().filter_map(|s| Some((s.0, power_of_unit(s.1)?))).collect();
    let mut seen: Vec<i32> = powers.iter().map(|p| p.1).collect();
    seen.sort_unstable();
    seen.dedup();
    let beside = if out.is_empty() { "" } else { ", beside that factor 2" };
    for power in seen {
        let these: Vec<&str> = powers.iter().filter(|p| p.1 == power).map(|p| name(p.0)).collect();
        let all = these.len() == scales.len() && these.len() > 1;
        if all && power.abs() == 3 {
            let text = format!(
                "all energies are 10^{power} times the reference{beside}: are they per thickness and given as of a plate of some \
                 thickness, or the reverse? the benchmark wants J per metre of thickness (1 mJ/mm = 1 J/m)"
            );
            out.push(Finding { id: "thickness".into(), text });
        } else {
            let these = list(&these);
            let text = format!("{these} 10^{power} times the reference{beside}, in the same shape: is the unit right?");
            out.push(Finding { id: "unit".into(), text });
        }
    }
    for (q, scale) in shaped.iter().filter(|s| s.1 < 0.0) {
        let text = format!("{} has the opposite sign of the reference ({scale:.2} times it)", name(*q));
        out.push(Finding { id: "sign".into(), text });
    }
    out
}

fn list(names: &[&str]) -> String {
    format!("{} {}", names.join(", "), if names.len() == 1 { "is" } else { "are" })
}

/// A time axis off by a power of ten: rows that do not fit the run as given, and do with another unit.
fn time_unit(curves: &[Option<Curve>; 6]) -> Option<Finding> {
    let curve = curves.iter().flatten().next()?;
    let last = curve.t[curve.t.len() - 1];
    let power = (last / END).log10().round();
    if power.abs() < 2.0 || !(0.2..5.0).contains(&(last / END / 10f64.powf(power))) {
        return None;
    }
    let text = format!(
        "the run ends at {last:.3e} s where the benchmark ends at 8e-5 s: the unit of the time is off by 10^{power} \
         (seconds, ms and µs are easily taken for each other)"
    );
    Some(Finding { id: "time-unit".into(), text })
}

/// Units and origin of the tip.
fn tip(curve: Option<&Curve>) -> Option<Finding> {
    let curve = curve?;
    let first = curve.y[0];
    if let Some(power) = (first > 0.0).then(|| power_of_ten(first / 0.05)).flatten() {
        let text = format!("the tip starts at {first:e} m instead of 0.05 m: its unit is off by 10^{power}");
        return Some(Finding { id: "tip-unit".into(), text });
    }
    let shifted = (first.abs() < 2e-3, "the tip of the initial crack");
    let text = format!("the tip starts at {first:e} m: it counts from {}; add offset = 50 in mm", shifted.1);
    shifted.0.then(|| Finding { id: "tip-origin".into(), text })
}

/// Fracture energies that lie above their reference by a constant.
fn absolute(curve: Option<&Curve>, reference: Option<&ReferenceCurve>, found: &[Finding]) -> Option<Finding> {
    let pairs = pairs(curve?, reference?, [5e-6, END]);
    let n = pairs.len() as f64;
    let mean = pairs.iter().map(|(y, r)| y - r).sum::<f64>() / n;
    let spread = (pairs.iter().map(|(y, r)| (y - r - mean).powi(2)).sum::<f64>() / n).sqrt();
    let text = format!(
        "the fracture energy lies {mean:.3} J/m above the reference throughout: absolute values instead of increments"
    );
    let new = found.is_empty() && pairs.len() > 10 && mean > 0.1 && spread < 0.3 * mean;
    new.then(|| Finding { id: "absolute-fracture-energy".into(), text })
}

/// Load and plane state from the energies before the crack runs, where they can be told from a wrong
/// solution.
fn load_and_plane(
    submission: &Submission,
    curves: &[Option<Curve>; 6],
    variant: &Variant<'_>,
    library: &Library,
) -> Option<Finding> {
    let mut best: Option<(f64, f64, Variant<'_>)> = None;
    let mut own = f64::INFINITY;
    for declared in super::family::FAMILY.into_iter().filter(|d| d.slit == variant.declared.slit && d.traction > 0.9e6)
    {
        let candidate = Variant::named(library, declared.name).ok()?;
        let (load, left) = fit_load(curves, &candidate)?;
        if declared.plane == variant.declared.plane {
            own = left;
        }
        if best.as_ref().is_none_or(|b| left < b.1) {
            best = Some((load, left, candidate));
        }
    }
    let (load, left, candidate) = best?;
    let plane = candidate.declared.plane;
    let declared = submission.model.traction.unwrap_or(variant.declared.traction);
    let traction = load * candidate.declared.traction;
    let other_plane = plane != variant.declared.plane && left < 0.6 * own;
    let other_load = (traction / declared - 1.0).abs() > 0.01;
    let another_origin = !other_plane && origin::least(curves, variant).is_some_and(|least| least < left);
    if left > 0.04 || another_origin || !(other_plane || other_load) {
        return None;
    }
    let word = if plane == Plane::Stress { "stress" } else { "strain" };
    let text = format!(
        "before the crack runs, the energies are those of plane {word} with a traction of {:.3} MPa (what is left: {:.1} %); \
         declared is plane {} with {:.3} MPa",
        traction * 1e-6,
        100.0 * left,
        format!("{:?}", submission.model.plane).to_lowercase(),
        declared * 1e-6
    );
    Some(Finding { id: if other_plane { "plane-state" } else { "load" }.into(), text })
}

/// The load over that of a variant which fits all energies before onset, and what is left of them.
pub(super) fn fit_load(curves: &[Option<Curve>; 6], variant: &Variant<'_>) -> Option<(f64, f64)> {
    let (mut top, mut bottom, mut rows) = (0.0, 0.0, Vec::new());
    for quantity in KINETIC..FRACTURE {
        let (Some(curve), Some(reference)) = (&curves[quantity], variant.curves[quantity]) else { continue };
        let pairs = pairs(curve, reference, ELASTIC);
        let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
        top += pairs.iter().map(|(y, r)| y * r).sum::<f64>() / square;
        bottom += 1.0;
        rows.push((pairs, square));
    }
    let scale = top / bottom;
    let left = |(pairs, square): &(Vec<(f64, f64)>, f64)| {
        pairs.iter().map(|(y, r)| (y / scale - r).powi(2)).sum::<f64>() / square
    };
    let left = (rows.iter().map(left).sum::<f64>() / bottom).sqrt();
    (scale > 0.0 && left.is_finite() && bottom > 1.0).then(|| (scale.sqrt(), left))
}

/// Another variant, or a run with a known mistake, that is much nearer; `mesh` is what elements of the
/// spacing
/// of the result are off by.
fn nearer(curves: &[Option<Curve>; 6], variant: &Variant<'_>, library: &Library, mesh: f64) -> Option<Finding> {
    let ids = library.curves("plate-family/kinetic-energy").into_iter().map(|c| (c.id.clone(), c.label.clone()));
    let distance = |id: &str| -> Option<f64> {
        let distances = (KINETIC..=FRACTURE).filter_map(|q| {
            let reference = library.curve(id, &format!("plate-family/{}", QUANTITIES[q].reference))?;
            let pairs = pairs(curves[q].as_ref()?, reference, window(q));
            let square = pairs.iter().map(|(_, r)| r * r).sum::<f64>();
            (pairs.len() > 10).then(|| pairs.iter().map(|(y, r)| (y - r).powi(2)).sum::<f64>() / square)
        });
        let squares: Vec<f64> = distances.collect();
        (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
    };
    let own = distance(&variant.id)?;
    let others = ids.filter(|(id, _)| *id != variant.id).filter_map(|(id, label)| Some((distance(&id)?, label)));
    let (left, label) = others.min_by(|a, b| a.0.total_cmp(&b.0))?;
    let text = format!(
        "the curves are nearer to another problem than to the one declared: {label} ({:.1} % instead of {:.1} %)",
        100.0 * left,
        100.0 * own
    );
    let mistake = label.contains("l taken for l0");
    let id = if mistake { "length-scale-convention" } else { "another-benchmark" };
    let beyond_mesh = mistake || own > OFF_BY_MESH * mesh;
    (left < 0.5 * own && left < 0.1 && beyond_mesh).then(|| Finding { id: id.into(), text })
}
