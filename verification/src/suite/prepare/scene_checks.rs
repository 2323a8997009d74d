//! Checks of a scene study before it runs: measures, columns, windows, references, variants.

use fisura::dynamics::body_sample::BodySamples;
use fisura::dynamics::energy::{ConditionSample, ContactSample, FractureSample, ProbeSample, Sample};
use fisura::dynamics::total_frame::domain::column;
use fisura::material::degradation::FractureModel;
use fisura::scene::{Frame, PhaseFieldInterval, Scene};

use super::{MEASURED, Wrong, distinct, find_band, grid_convergence};
use crate::case::Check;
use crate::case::expand::CaseScene;
use crate::measure::{LooksAt, Measure, Run, find};
use crate::output::history::Table;
use crate::reference::{Library, relative_uncertainty};
use crate::scene::suggest::hint;
use crate::study::scene::concerned;

/// Times that differ by less than this part are the same.
const SLACK: f64 = 1e-9;

/// Notes what is wrong with a check.
pub(super) fn look(wrong: &mut Wrong<'_>, index: usize, check: &Check, scenes: &[CaseScene], library: &Library) {
    let at = |name: &str| format!("check.{index}.{name}");
    let measure = match find(check.measure.as_deref()) {
        Ok(measure) => measure,
        Err(message) => return wrong.note(at("measure"), message, "name one of them"),
    };
    let reads = [&MEASURED[..], measure.needs, measure.takes].concat();
    wrong.look_at_keys(index, &format!("the measure {:?}", measure.name), &reads);
    let table = wrong.case.document.root.at(&format!("check.{index}"));
    for key in measure.needs.iter().filter(|key| table.is_none_or(|table| table.get(key).is_none())) {
        wrong.note(at(key), format!("the measure {:?} needs {key}", measure.name), format!("add {key} = …"));
    }
    look_at_reference(wrong, index, measure, check, library);
    look_at_band(wrong, index, check, library);
    if !look_at_variants(wrong, index, check, scenes) {
        return;
    }
    for scene in concerned(check, scenes) {
        if let Err((key, message, remedy)) = look_at_run(measure, check, &scenes[scene]) {
            wrong.note(at(key), message, remedy);
            break; // the other runs of the check would say the same
        }
    }
}

/// Curves of measures that compare with one, and numbers or points of curves that other measures are held
/// against.
fn look_at_reference(wrong: &mut Wrong<'_>, index: usize, measure: &Measure, check: &Check, library: &Library) {
    let Some(path) = &check.reference else { return };
    let at = |name: &str| format!("check.{index}.{name}");
    if !measure.compares_curves() {
        if check.expect.is_some() {
            wrong.note(at("expect"), "a reference and an expected value", "remove one of the two");
        }
        match library.reference(path, check.at, 1.0) {
            Err(message) => {
                wrong.note(at("reference"), message, "write reference = \"folder/name\" as in reference-data");
            }
            Ok(reference) => look_at_bounds(wrong, index, check, reference.uncertainty),
        }
        return;
    }
    let Some(curve) = path.split_once('/').and_then(|(folder, quantity)| library.curve(folder, quantity)) else {
        let remedy = "write reference = \"folder/quantity\" as in reference-data";
        return wrong.note(at("reference"), format!("no reference curve {path:?}"), remedy);
    };
    let [from, to] = check.window;
    if !curve.x.iter().any(|x| (from..=to).contains(x)) {
        let [first, last] = curve.range();
        let remedy = format!("choose from and to between {first:e} s and {last:e} s");
        wrong.note(at("from"), "the reference curve has no point between from and to", remedy);
    } else {
        look_at_bounds(wrong, index, check, relative_uncertainty(curve, from, to));
    }
}

/// A reference with an uncertainty bounds the value itself.
fn look_at_bounds(wrong: &mut Wrong<'_>, index: usize, check: &Check, uncertainty: Option<f64>) {
    let bounded = check.accept.min.is_some() || check.accept.max.is_some() || check.around_reference.is_some();
    if uncertainty.is_some() && bounded {
        let remedy = "write them as limit = { max = …, why = \"…\" }";
        let message = "bounds in addition to those of the uncertainty of the reference";
        wrong.note(format!("check.{index}"), message, remedy);
    }
}

fn look_at_band(wrong: &mut Wrong<'_>, index: usize, check: &Check, library: &Library) {
    let at = |name: &str| format!("check.{index}.{name}");
    if let Some(path) = &check.band
        && find_band(library, path).is_none()
    {
        let bands = library.bands().iter().map(|band| format!("{}/{}", band.id, band.name)).collect::<Vec<_>>();
        wrong.note(at("band"), format!("no reference band {path:?}"), format!("known: {}", bands.join(", ")));
    }
    if check.band.is_some() && check.expect.is_some() {
        wrong.note(at("expect"), "a band and an expected value", "remove one of the two");
    }
    if check.around_reference.is_some() && check.expect.is_none() {
        let remedy = "add expect, or give min and max";
        wrong.note(at("below"), "below and above need a reference value", remedy);
    }
}

/// Whether the check names variants that there are.
fn look_at_variants(wrong: &mut Wrong<'_>, index: usize, check: &Check, scenes: &[CaseScene]) -> bool {
    let at = |name: &str| format!("check.{index}.{name}");
    let before = wrong.problems.len();
    let known = distinct(scenes.iter().map(|scene| scene.name.as_str()));
    let patterned = scenes.iter().any(|scene| check.is_about(&scene.name));
    for (key, name) in [("variant", &check.variant), ("against", &check.against)] {
        if let Some(name) = name.as_deref().filter(|name| !(known.contains(name) || key == "variant" && patterned)) {
            let remedy = format!("{}known variants: {}", hint(name, &known), known.join("; "));
            wrong.note(at(key), format!("no run of this case matches {name:?}"), remedy);
        }
    }
    if check.against.is_some() && check.variant == check.against {
        wrong.note(at("against"), "a run compared with itself", "name two variants");
    }
    if check.order.is_some() && check.meshes.is_none() {
        let remedy = "add meshes = \"richardson\" or remove it";
        wrong.note(at("order"), "an order of theory without meshes", remedy);
    }
    if let Some(estimate) = check.meshes
        && let Err((message, remedy)) = grid_convergence::usable(check, estimate, scenes)
    {
        wrong.note(at("meshes"), message, remedy);
    }
    if wrong.problems.len() == before && concerned(check, scenes).is_empty() {
        wrong.note(at("against"), "there is no other run to compare", "add a [[variant]], or remove the check");
    }
    wrong.problems.len() == before
}

/// Notes names in charts that no run has.
pub(super) fn look_at_charts(wrong: &mut Wrong<'_>, scenes: &[CaseScene]) {
    let case = wrong.case;
    for (index, chart) in case.charts.iter().enumerate() {
        let curves = chart.curves.iter().enumerate().map(|(i, curve)| (format!("curves.{i}.column"), &curve.column));
        for (key, formula) in std::iter::once(("x".to_string(), &chart.x)).chain(curves) {
            let missing = scenes.iter().find_map(|scene| on_blank_run(scene, |run| run.column(&formula.0).err()));
            if let Some(message) = missing {
                wrong.note(format!("chart.{index}.{key}"), message, "name a column, or a value of the case");
            }
        }
    }
}

/// Looks at a run of a scene whose numbers are not known yet.
fn on_blank_run<T>(of: &CaseScene, look: impl FnOnce(&Run<'_>) -> T) -> T {
    let CaseScene { name, scene, values, energy_factor, .. } = of;
    let history = blank_history(scene);
    look(&Run { name, scene, history: &history, frames: &[], energy_factor: *energy_factor, values })
}

/// What a run would not have: key, message, remedy.
type Lacking = (&'static str, String, String);

/// What one run would not have.
fn look_at_run(measure: &Measure, check: &Check, of: &CaseScene) -> Result<(), Lacking> {
    let scene = &of.scene;
    let known = |run: &Run<'_>| -> Result<(Check, bool), Lacking> {
        if let Some(column) = &check.column {
            run.column(column)
                .map_err(|message| ("column", message, "name a column, or a value of the case".into()))?;
        }
        let numbers = check.with_numbers(&|formula| run.number(formula)).map_err(|(key, message)| {
            (key, message, "use values of the case, and {initial …}, {final …}, {largest …} of columns".into())
        })?;
        Ok((numbers, run.history.column("min_phase_field").is_some()))
    };
    let (check, fractures) = on_blank_run(of, known)?;
    if matches!(measure.looks_at, LooksAt::Tip | LooksAt::PhaseField) && !fractures {
        let remedy = "add [scene.material.NAME.fracture], or choose another measure";
        return Err(("measure", format!("{:?} needs a crack, but nothing fractures", measure.name), remedy.into()));
    }
    if matches!(measure.looks_at, LooksAt::Pictures | LooksAt::PhaseField) && scene.output.frames.is_empty() {
        let message = format!("{:?} needs pictures, but there are none", measure.name);
        return Err(("measure", message, "add scene.output.frames".into()));
    }
    look_at_times(measure, &check, scene)
}

/// Times outside the run.
fn look_at_times(measure: &Measure, check: &Check, scene: &Scene) -> Result<(), Lacking> {
    let end = scene.analysis.end_time;
    let slack = SLACK * end;
    if matches!(measure.name, "value-at" | "increment-at")
        && let Some(time) = check.at.filter(|time| !time.is_nan() && !(-slack..=end + slack).contains(time))
    {
        return Err(("at", format!("{time:e} s is outside the run"), format!("choose a time from 0 to {end:e} s")));
    }
    let interval = end / scene.output.samples.max(1) as f64;
    let [from, to] = check.window.map(|time| time.clamp(-interval, end + interval));
    let first = (((from - slack) / interval).ceil() * interval).max(0.0);
    if first > (to + slack).min(end + slack) {
        let remedy = format!("the run ends at {end:e} s and has a sample every {interval:e} s");
        return Err(("from", "no sample lies between from and to".into(), remedy));
    }
    Ok(())
}

fn blank_conditions(scene: &Scene) -> Vec<ConditionSample> {
    let sides = scene.boundaries.iter().map(|boundary| (&boundary.name, boundary.fix));
    let edges = scene.bodies.iter().flat_map(|body| &body.conditions);
    let edges = edges.map(|condition| (&condition.name, condition.components()));
    let named = sides.chain(edges).filter_map(|(name, fix)| Some((name.as_deref()?, fix)));
    named.map(|(name, fix)| ConditionSample::new(name, fix, [0.0; 2], 0.0)).collect()
}

/// A history of one row with the columns that a scene will have; none of its numbers is known.
fn blank_history(scene: &Scene) -> Table {
    let moving = scene.bodies.iter().filter(|body| !body.rigid);
    let mut materials = moving.filter_map(|body| scene.materials.get(&body.material));
    let lags = scene.solver.phase_field_interval != PhaseFieldInterval::Steps(1);
    let fracture = |model: FractureModel| FractureSample {
        energy: 0.0,
        works: model.columns_of_work(lags).into_iter().map(|name| (name, 0.0)).collect(),
        crack_tip: None,
        min_phase: 1.0,
        iterations: 0,
    };
    let sample = Sample {
        fracture: materials.find_map(FractureModel::of).map(fracture),
        contact: scene.contact.is_some().then_some(ContactSample { loss: 0.0, friction: 0.0 }),
        transfer_loss: (scene.analysis.frame == Frame::Updated).then_some(0.0),
        refinement: (scene.mesh.halvings > 0).then_some(0.0),
        fragments: (scene.output.fragments || scene.contact.as_ref().is_some_and(|contact| contact.fragments))
            .then(Vec::new),
        conditions: blank_conditions(scene),
        probes: scene.output.probes.iter().map(|probe| ProbeSample::new(&probe.name, [0.0; 7])).collect(),
        j_integrals: scene.output.j_integrals.iter().map(|j| (column(j), f64::NAN)).collect(),
        bodies: scene.output.bodies.then(|| BodySamples::blank(scene)),
        ..Sample::default()
    };
    let names: Vec<_> = sample.named_values().into_iter().map(|(name, _)| name).collect();
    let mut table = Table::new(&names);
    table.push(&vec![f64::NAN; names.len()]);
    table
}
