//! The `scene` study: run every scene of a case, keep histories and pictures, evaluate the measures of its
//! checks.

use serde::{Deserialize, Serialize};

use fisura::output::picture::Picture;
use fisura::particles::spans::largest_spans;
use fisura::scene::Scene;

use crate::case::expand::CaseScene;
use crate::case::{Case, Check};
use crate::extremes::{larger, smaller};
use crate::measure::grid_convergence::{over_meshes, span};
use crate::measure::{Measured, Run, fitted_speed, measure};
use crate::output::history::Table;
use crate::record::{Timing, Work};
use crate::reference::Library;
use crate::scene_run::{Progress, SceneRun, run_scene};
use crate::watch::{self, Stopped};

/// What figures need to know of a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunInfo {
    /// Suite of the case that was run.
    pub suite: String,
    /// Name of the case in its suite.
    pub case: String,
    /// Variant within the case, or empty.
    pub variant: String,
    /// Its text in legends.
    pub label: String,
    /// History, relative to the results folder.
    pub series: String,
    /// Columns of the history.
    pub columns: Vec<String>,
    /// Factor from its energies to those of the whole body.
    pub energy_factor: f64,
    /// Resolution in words: degree, h, l0/h, points, steps, dt.
    pub resolution: String,
    /// What differs from the cited source.
    pub deviations: Vec<String>,
    /// Phase-field pictures.
    pub pictures: Vec<PictureInfo>,
}

impl RunInfo {
    /// Series of what is derived from the history, relative to the results folder.
    pub fn derived(&self) -> String {
        self.series.replace(".csv", "-derived.csv")
    }
}

/// A stored phase-field picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PictureInfo {
    /// Simulated time of the picture, s.
    pub time: f64,
    /// Raster, relative to the results folder.
    pub series: String,
    /// Numbers of pixels in x and y.
    pub pixels: [usize; 2],
}

/// A scene of a case, run.
#[derive(Debug)]
pub struct FinishedScene {
    /// The scene and its name.
    pub case_scene: CaseScene,
    /// History, pictures, breakdown.
    pub run: SceneRun,
    /// Numbers of particle-steps, and of solves and iterations of the phase field.
    pub work: Work,
    /// Time that the run took.
    pub timing: Timing,
}

impl FinishedScene {
    /// As measures see it.
    pub fn as_run(&self) -> Run<'_> {
        Run {
            name: &self.case_scene.name,
            scene: &self.case_scene.scene,
            history: &self.run.history,
            frames: &self.run.frames,
            energy_factor: self.case_scene.energy_factor,
            values: &self.case_scene.values,
        }
    }
}

/// Runs the scenes of a case one after the other, until one of them is stopped: those that ended, and why the
/// others did not.
pub fn run_scenes(scenes: &[CaseScene]) -> (Vec<FinishedScene>, Option<Stopped>) {
    let count = scenes.len() as f64;
    let mut finished = Vec::new();
    for (index, case_scene) in scenes.iter().enumerate() {
        let mut progress = |progress: Progress| watch::advanced((index as f64 + progress.fraction()) / count);
        let run = run_scene(&case_scene.scene, &mut progress, &mut |_, _| {});
        if let Err(stopped) = watch::check() {
            return (finished, Some(stopped));
        }
        let particle_steps = run.summary.particles as u64 * run.summary.steps as u64;
        let timing = Timing {
            wall_s: run.summary.wall_s,
            particle_steps,
            ns_per_particle_step: 1e9 * run.summary.wall_s / particle_steps.max(1) as f64,
        };
        let counts = run.summary.phase_field.unwrap_or_default();
        let work = Work {
            particle_steps,
            phase_field_solves: counts.solves as u64,
            phase_field_iterations: counts.iterations as u64,
        };
        finished.push(FinishedScene { case_scene: case_scene.clone(), run, work, timing });
    }
    (finished, None)
}

/// Numbers of the scenes that a check has a record for; the finest for one that combines all meshes.
pub fn concerned(check: &Check, scenes: &[CaseScene]) -> Vec<usize> {
    let about = |index: &usize| match (&check.variant, &check.against) {
        (Some(_), _) => check.is_about(&scenes[*index].name),
        (None, Some(against)) => scenes[*index].name != *against,
        (None, None) => true,
    };
    let all = (0..scenes.len()).filter(about);
    if check.meshes.is_some() {
        let size = |index: &usize| span(&scenes[*index].scene.mesh);
        return all.min_by(|a, b| size(a).total_cmp(&size(b))).into_iter().collect();
    }
    if check.measure.as_deref() == Some("order-in-step") { all.take(1).collect() } else { all.collect() }
}

/// Whether a check on the run `of` needs the run `other` as well.
fn needs(check: &Check, of: &str, other: &str) -> bool {
    let all = check.meshes.is_some() || check.measure.as_deref() == Some("order-in-step");
    all || of == other || check.against.as_deref() == Some(other)
}

/// Evaluates a check on one run; `stopped` says why there are not more.
///
/// # Errors
/// A run that the check needs and that broke down or is missing, or something that is not there.
pub fn evaluate(
    check: &Check,
    of: &CaseScene,
    (scenes, finished): (&[CaseScene], &[FinishedScene]),
    stopped: Option<&Stopped>,
    library: &Library,
) -> Result<Measured, String> {
    for scene in scenes.iter().filter(|scene| needs(check, &of.name, &scene.name)) {
        let run = finished.iter().find(|run| run.case_scene.name == scene.name);
        let ending = match run {
            Some(run) => run.run.breakdown.as_ref().map(ToString::to_string),
            None => Some(stopped.map_or_else(|| "it did not run".to_string(), ToString::to_string)),
        };
        if let Some(ending) = ending {
            return Err(if scene.name == of.name { ending } else { format!("variant {:?}: {ending}", scene.name) });
        }
    }
    let runs: Vec<Run> = finished.iter().map(FinishedScene::as_run).collect();
    match (check.meshes, runs.iter().find(|run| run.name == of.name)) {
        (Some(estimate), _) => over_meshes(estimate, check, &runs, library),
        (None, Some(run)) => measure(check, run, &runs, library),
        (None, None) => Err("it did not run".to_string()),
    }
}

/// File name without ending of the series of a run.
pub fn series_stem(case: &Case, variant: &str) -> String {
    let mut stem = format!("{}-{}", case.suite, case.name);
    if !variant.is_empty() {
        stem.push('-');
        stem.extend(variant.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' }));
    }
    stem
}

/// What figures need to know of a run, and the tables to store for them.
pub fn describe(case: &Case, finished: &FinishedScene) -> (RunInfo, Vec<(String, Table)>) {
    let stem = series_stem(case, &finished.case_scene.name);
    let history = &finished.run.history;
    let mut tables = vec![(stem.clone(), history.clone()), (format!("{stem}-derived"), derived(history))];
    let mut pictures = Vec::new();
    for frame in &finished.run.frames {
        if let Some(phase) = &frame.phase {
            let name = format!("{stem}-phase-{}us", microseconds(frame.time));
            tables.push((name.clone(), raster(frame, phase)));
            let series = format!("series/{name}.csv");
            pictures.push(PictureInfo { time: frame.time, series, pixels: frame.pixels });
        }
    }
    let label = if case.label.is_empty() { case.name.clone() } else { case.label.clone() };
    let variant = &finished.case_scene.name;
    let info = RunInfo {
        suite: case.suite.clone(),
        case: case.name.clone(),
        variant: variant.clone(),
        label: if variant.is_empty() { label } else { format!("{label}, {variant}") },
        series: format!("series/{stem}.csv"),
        columns: finished.run.history.names.clone(),
        energy_factor: finished.case_scene.energy_factor,
        resolution: resolution(finished),
        deviations: case.deviations.clone(),
        pictures,
    };
    (info, tables)
}

/// Quantities derived from a history: what figures show beside its own columns.
fn derived(history: &Table) -> Table {
    let column = |name: &str| history.column(name).unwrap_or_default();
    let largest = ["kinetic_j", "elastic_j", "fracture_j", "external_work_j"]
        .into_iter()
        .flat_map(|name| column(name).iter().map(|v| v.abs()))
        .fold(f64::MIN_POSITIVE, larger);
    let times = column("time_s");
    let end = times.last().copied().unwrap_or(0.0).max(f64::MIN_POSITIVE);
    let rows = times.iter().zip(column("closure_j")).map(|(time, closure)| [*time, time / end, closure / largest]);
    let mut table = Table::of_rows(&["time_s", "time_over_end", "closure_over_largest"], rows);
    if let (Some(energy), Some(x)) = (history.column("fracture_j"), history.column("crack_tip_x_m")) {
        let start = energy.first().copied().unwrap_or(0.0);
        table.names.push("fracture_increment_j".into());
        table.columns.push(energy.iter().map(|e| e - start).collect());
        table.names.push("tip_speed_m_per_s".into());
        table.columns.push(times.iter().map(|t| fitted_speed(times, x, *t)).collect());
    }
    table
}

/// A time in microseconds to the nanosecond, for file names.
pub fn microseconds(time: f64) -> f64 {
    (time * 1e9).round() / 1e3
}

/// Raster of a picture; values rounded to 1e-5, which no colour shows.
pub fn raster(frame: &Picture, values: &[f64]) -> Table {
    let row = |(index, value): (usize, &f64)| {
        let [x, y] = frame.center(index).map(|c| (c * 1e9).round() / 1e9);
        [x, y, (value * 1e5).round() / 1e5]
    };
    Table::of_rows(&["x_m", "y_m", "value"], values.iter().enumerate().map(row))
}

/// Degree, spans, l0/h, points, steps and dt in words.
fn resolution(finished: &FinishedScene) -> String {
    let scene = &finished.case_scene.scene;
    let summary = &finished.run.summary;
    let [hx, hy] = largest_spans(&scene.mesh);
    let [p, q] = scene.mesh.degree;
    let degree = if p == q { format!("p = {p}") } else { format!("p = ({p}, {q})") };
    let ratio = length_scale(scene).map_or(String::new(), |l0| format!(", l0/h = {:.3}", l0 / hx.max(hy)));
    format!(
        "{degree}, h = {:.4} × {:.4} mm{ratio}, {} points, {} control points, {} steps of {:.4e} s",
        hx * 1e3,
        hy * 1e3,
        summary.particles,
        summary.control_points,
        summary.steps,
        summary.time_step_s.unwrap_or(f64::NAN)
    )
}

/// Smallest length scale of the materials in use, m.
pub fn length_scale(scene: &Scene) -> Option<f64> {
    let fractures = scene.materials.values().filter_map(|m| m.fracture.as_ref());
    fractures.map(|f| f.length_scale).reduce(smaller)
}
