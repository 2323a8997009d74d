//! One case: run its study, hold what it found against its bounds.

use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

use super::{CaseOutcome, Progress, VerifyError, write_series};
use crate::case::{Case, Check};
use crate::expand::CaseScene;
use crate::measure::Measured;
use crate::measure::grid_convergence::validate;
use crate::record::{Accept, Record, Status, Timing};
use crate::reference::{Library, ReferenceBand};
use crate::study::scene::{FinishedScene, applies, breakdown, describe, evaluate, run_scenes};
use crate::study::{Findings, STUDIES, StudyError, find};

pub(super) fn run_case(
    case: &Case,
    out: &Path,
    library: &Library,
    progress: &dyn Progress,
) -> Result<CaseOutcome, VerifyError> {
    let scenes = case.scenes()?;
    validate(case, &scenes)?;
    if case.study == "scene" {
        let finished = run_scenes(scenes, &|fraction| progress.advanced(fraction));
        return judge_runs(case, &finished, out, library);
    }
    let Some(study) = find(&case.study) else {
        let known: Vec<_> = STUDIES.iter().map(|(name, _)| *name).collect();
        let message = format!("unknown study {:?}", case.study);
        return Err(case.error("study", &message, &format!("known: scene, {}", known.join(", "))).into());
    };
    let start = Instant::now();
    let found = study(case, &scenes);
    let timing = Timing { wall_s: start.elapsed().as_secs_f64(), ..Timing::default() };
    judge_findings(case, &scenes, found, timing, out)
}

/// Checks of a scene study.
fn judge_runs(
    case: &Case,
    finished: &[FinishedScene],
    out: &Path,
    library: &Library,
) -> Result<CaseOutcome, VerifyError> {
    let mut outcome = CaseOutcome { records: Vec::new(), figures: Vec::new(), runs: Vec::new() };
    for run in finished {
        let (info, tables) = describe(case, run);
        outcome.runs.push(info);
        for (stem, table) in tables {
            write_series(out, &stem, &table)?;
        }
    }
    for (index, check) in case.checks.iter().enumerate() {
        let concerned = applies(check, finished);
        if concerned.is_empty() {
            return Err(unknown_variant(case, index));
        }
        for run in concerned {
            let variant = if check.meshes.is_some() { "" } else { &run.case_scene.name };
            let mut record = bare_record(case, check, variant);
            record.timing = run.timing;
            record.parameters = parameters(&run.case_scene);
            record.series = outcome.runs.iter().find(|i| i.variant == run.case_scene.name).map(|i| i.series.clone());
            if let Some(breakdown) = breakdown(check, run, finished) {
                record.status = Status::Error;
                record.message = Some(breakdown.to_string());
            } else {
                let wrong = |message: String| case.error(&format!("check.{index}"), &message, "correct the check");
                let mut measured = evaluate(check, run, finished, library).map_err(wrong)?;
                if let Some(name) = &check.band {
                    let band = find_band(library, name).ok_or_else(|| wrong(format!("no reference band {name:?}")))?;
                    record.accept = bounds_of(band, check.scale);
                    measured.reference = Some(band.reference());
                }
                judge(&mut record, measured);
            }
            outcome.records.push(record);
        }
    }
    Ok(outcome)
}

fn find_band<'a>(library: &'a Library, path: &str) -> Option<&'a ReferenceBand> {
    let (folder, name) = path.split_once('/')?;
    library.band(folder, name)
}

fn bounds_of(band: &ReferenceBand, scale: f64) -> Accept {
    let why = format!("what the sources say: {}", band.sources.join(", "));
    Accept { min: Some(band.min * scale), max: Some(band.max * scale), why }
}

/// Checks of any other study: each names a quantity that the study measured.
fn judge_findings(
    case: &Case,
    scenes: &[CaseScene],
    found: Result<Findings, StudyError>,
    timing: Timing,
    out: &Path,
) -> Result<CaseOutcome, VerifyError> {
    let findings = match found {
        Ok(findings) => findings,
        Err(error) => return Ok(broken(case, &error)),
    };
    for (stem, table) in &findings.series {
        write_series(out, stem, table)?;
    }
    let mut outcome = CaseOutcome { records: Vec::new(), figures: findings.figures.clone(), runs: Vec::new() };
    for (index, check) in case.checks.iter().enumerate() {
        let named = |variant: &str| check.variant.as_deref().is_none_or(|wanted| wanted == variant);
        let matching = findings.measurements.iter().filter(|m| m.quantity == check.quantity && named(&m.variant));
        let before = outcome.records.len();
        for measurement in matching {
            let mut record = bare_record(case, check, &measurement.variant);
            record.timing = timing;
            record.parameters =
                scenes.iter().find(|s| s.name == measurement.variant).map(parameters).unwrap_or_default();
            record.unit.clone_from(&measurement.unit);
            if let (Some([below, above]), Some(value)) =
                (check.around_reference, measurement.reference.as_ref().and_then(|r| r.value))
            {
                record.accept.min = Some(value - below);
                record.accept.max = Some(value + above);
            }
            record.series = findings.series.first().map(|(stem, _)| format!("series/{stem}.csv"));
            let (value, reference) = (measurement.value, measurement.reference.clone());
            judge(&mut record, Measured { value, reference, message: None });
            outcome.records.push(record);
        }
        if outcome.records.len() == before {
            return Err(unknown_quantity(case, index, &findings));
        }
    }
    Ok(outcome)
}

fn unknown_variant(case: &Case, index: usize) -> VerifyError {
    let names: Vec<String> = case.scenes().unwrap_or_default().into_iter().map(|s| s.name).collect();
    let remedy = format!("known variants: {}", names.join("; "));
    case.error(&format!("check.{index}"), "no run of this case is meant", &remedy).into()
}

fn unknown_quantity(case: &Case, index: usize, findings: &Findings) -> VerifyError {
    let mut known: Vec<_> = findings.measurements.iter().map(|m| m.quantity.as_str()).collect();
    known.dedup();
    let remedy = format!("it measures: {}", known.join("; "));
    case.error(&format!("check.{index}.quantity"), "the study does not measure this", &remedy).into()
}

/// Every check of a study that could not be carried out is an error.
fn broken(case: &Case, error: &StudyError) -> CaseOutcome {
    let records = case.checks.iter().map(|check| {
        let mut record = bare_record(case, check, "");
        record.status = Status::Error;
        record.message = Some(error.to_string());
        record
    });
    CaseOutcome { records: records.collect(), figures: Vec::new(), runs: Vec::new() }
}

fn judge(record: &mut Record, measured: Measured) {
    record.value = measured.value;
    record.reference = measured.reference;
    record.status = Record::judge(record.value, &record.accept);
    if record.value.is_none() {
        let otherwise = || "what is measured did not happen within the run".to_string();
        record.message = Some(measured.message.unwrap_or_else(otherwise));
    }
}

fn bare_record(case: &Case, check: &Check, variant: &str) -> Record {
    let middle = if variant.is_empty() { String::new() } else { format!("{variant}/") };
    let full = |id: &String| format!("{}/{}/{middle}{id}", case.suite, case.name);
    Record {
        id: full(&check.id),
        formerly: check.formerly.iter().map(full).collect(),
        suite: case.suite.clone(),
        case: case.name.clone(),
        tier: case.tier.to_string(),
        claim: case.claim.clone(),
        parameters: BTreeMap::new(),
        models: case.models.clone(),
        deviations: case.deviations.clone(),
        quantity: check.quantity.clone(),
        unit: check.unit.clone(),
        value: None,
        reference: None,
        accept: check.accept.clone(),
        status: Status::Info,
        message: None,
        series: None,
        timing: Timing::default(),
    }
}

fn parameters(scene: &CaseScene) -> BTreeMap<String, serde_json::Value> {
    let mut parameters: BTreeMap<_, _> = scene.parameters.iter().cloned().collect();
    let scene = &scene.scene;
    let cells = [0, 1].map(|d| scene.mesh.knots[d].windows(2).filter(|w| w[1] > w[0]).count());
    parameters.insert("degree".into(), serde_json::json!(scene.mesh.degree));
    parameters.insert("cells".into(), serde_json::json!(cells));
    if let Some(body) = scene.bodies.first() {
        parameters.insert("layout".into(), format!("{:?}", body.layout).to_lowercase().into());
        parameters.insert("particles_per_cell".into(), serde_json::json!(body.particles_per_cell));
    }
    parameters.insert("mass".into(), format!("{:?}", scene.analysis.mass).to_lowercase().into());
    parameters.insert("frame".into(), format!("{:?}", scene.analysis.frame).to_lowercase().into());
    parameters
}
