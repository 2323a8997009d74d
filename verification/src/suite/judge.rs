//! One case: run its study, hold what it found against its bounds.

use std::collections::BTreeMap;
use std::time::Instant;

use fisura::fault;

use super::prepare::{Planned, Prepared, find_band};
use super::{CaseOutcome, VerifyError, write_series};
use crate::case::expand::CaseScene;
use crate::case::{Case, Check};
use crate::measure::{Measured, expected};
use crate::output::OutputFolder;
use crate::record::{Accept, Record, Status, Timing};
use crate::reference::Library;
use crate::study::charts;
use crate::study::scene::{FinishedScene, describe, evaluate, run_scenes};
use crate::study::{Findings, Study, find};
use crate::watch::{self, Stopped};

/// Every record of the plan, whatever becomes of the study.
pub(super) fn run_case(
    case: &Case,
    prepared: &Prepared,
    out: &OutputFolder,
    library: &Library,
) -> Result<CaseOutcome, VerifyError> {
    match find(&case.study) {
        None => {
            let (finished, stopped) = run_scenes(&prepared.scenes);
            judge_runs(case, prepared, &finished, stopped.as_ref(), out, library)
        }
        Some(study) => judge_study(case, prepared, study, out),
    }
}

/// A case that gave nothing: each of its records is an error.
pub(super) fn broken(case: &Case, prepared: &Prepared, message: &str) -> CaseOutcome {
    let records = prepared.records.iter().map(|planned| failed(bare_record(case, planned), message));
    CaseOutcome { records: records.collect(), figures: Vec::new(), runs: Vec::new() }
}

/// Checks of a scene study.
fn judge_runs(
    case: &Case,
    Prepared { scenes, records }: &Prepared,
    finished: &[FinishedScene],
    stopped: Option<&Stopped>,
    out: &OutputFolder,
    library: &Library,
) -> Result<CaseOutcome, VerifyError> {
    let mut outcome = CaseOutcome { records: Vec::new(), figures: Vec::new(), runs: Vec::new() };
    for run in finished {
        let (info, tables) = describe(case, run);
        outcome.runs.push(info);
        for (stem, table) in tables {
            watch::unless_left(|| write_series(out, &stem, &table))?;
        }
    }
    let (figures, series) = charts::of_case(case, finished);
    outcome.figures = figures;
    for (stem, table) in series {
        watch::unless_left(|| write_series(out, &stem, &table))?;
    }
    for planned in records {
        let scene = &scenes[planned.scene.unwrap_or_default()];
        let check = &case.checks[planned.check];
        let mut record = bare_record(case, planned);
        if let Some(run) = finished.iter().find(|run| run.case_scene.name == scene.name) {
            (record.work, record.timing) = (Some(run.work), run.timing);
        }
        record.parameters = parameters(scene);
        record.series = outcome.runs.iter().find(|run| run.variant == scene.name).map(|run| run.series.clone());
        let found = evaluate(check, scene, (scenes, finished), stopped, library);
        outcome.records.push(match found.and_then(|measured| in_band(&mut record, check, measured, library)) {
            Ok(measured) => judge(record, check, measured),
            Err(message) => failed(record, &message),
        });
    }
    Ok(outcome)
}

/// The bounds of a reference band, for a check that names one.
fn in_band(record: &mut Record, check: &Check, measured: Measured, library: &Library) -> Result<Measured, String> {
    let Some(path) = &check.band else { return Ok(measured) };
    let band = find_band(library, path).ok_or_else(|| format!("no reference band {path:?}"))?;
    record.accept.why = band.why();
    Ok(Measured { reference: Some(band.reference(check.scale)), ..measured })
}

/// Checks of any other study: each names a quantity that the study measures.
fn judge_study(
    case: &Case,
    prepared: &Prepared,
    study: &Study,
    out: &OutputFolder,
) -> Result<CaseOutcome, VerifyError> {
    let start = Instant::now();
    let found = study.run(case, &prepared.scenes).and_then(|findings| {
        watch::check()?;
        Ok(findings)
    });
    let timing = Timing { wall_s: start.elapsed().as_secs_f64(), ..Timing::default() };
    let findings = match found {
        Ok(findings) => findings,
        Err(error) => return Ok(broken(case, prepared, &error.to_string())),
    };
    for (stem, table) in &findings.series {
        watch::unless_left(|| write_series(out, stem, table))?;
    }
    let series = findings.series.first().map(|(stem, _)| format!("series/{stem}.csv"));
    let judged = prepared.records.iter().map(|planned| {
        let mut record = bare_record(case, planned);
        (record.timing, record.series) = (timing, series.clone());
        let scene = prepared.scenes.iter().find(|scene| scene.name == planned.variant);
        record.parameters = scene.map(parameters).unwrap_or_default();
        judge_finding(record, &case.checks[planned.check], planned, &findings)
    });
    let records = judged.collect();
    Ok(CaseOutcome { records, figures: findings.figures.clone(), runs: Vec::new() })
}

fn judge_finding(mut record: Record, check: &Check, planned: &Planned, findings: &Findings) -> Record {
    let mut all = findings.measurements.iter();
    let of_variant = |variant: &str| fault!("value-of-another-variant", variant == planned.variant => true);
    let found = all.find(|m| m.quantity == check.quantity && of_variant(&m.variant));
    let Some(measurement) = found else { return failed(record, "the study did not measure this quantity") };
    record.unit.clone_from(&measurement.unit);
    let reference = expected(check, 1.0).or_else(|| measurement.reference.clone());
    judge(record, check, Measured { value: measurement.value, reference, ..Measured::default() })
}

/// A record of what could not be measured.
fn failed(mut record: Record, message: &str) -> Record {
    record.status = Status::Error;
    record.message = Some(message.to_string());
    record
}

fn judge(mut record: Record, check: &Check, measured: Measured) -> Record {
    match check.bounds_around(measured.reference.as_ref()) {
        Ok(None) => (),
        Ok(Some([min, max])) => (record.accept.min, record.accept.max) = (Some(min), Some(max)),
        Err(message) => return failed(record, &message),
    }
    record.value = measured.value;
    record.reference = measured.reference;
    record.discretisation = measured.discretisation;
    if record.uncertainty().is_some() && (record.accept.min.is_some() || record.accept.max.is_some()) {
        return failed(record, "bounds in addition to those of an uncertainty: write them as limit");
    }
    match &check.shown {
        Some(why) => {
            record.accept = Accept { why: why.clone(), ..Accept::default() };
            record.limit = None;
        }
        None => record.decide(),
    }
    if record.value.is_none() {
        let otherwise = || "the measured event did not occur in the run".to_string();
        record.message = Some(measured.message.unwrap_or_else(otherwise));
    }
    record
}

fn bare_record(case: &Case, planned: &Planned) -> Record {
    let check = &case.checks[planned.check];
    Record {
        id: planned.id(case),
        formerly: planned.formerly(case),
        suite: case.suite.clone(),
        case: case.name.clone(),
        tier: case.tier.to_string(),
        claim: case.claim.clone(),
        models: case.models.clone(),
        deviations: case.deviations.clone(),
        quantity: check.quantity.clone(),
        unit: check.unit.clone(),
        accept: check.accept.clone(),
        limit: check.limit.clone(),
        ..Record::default()
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
