//! What an error of the benchmarks costs: whole runs of this solver and of the independent finite elements
//! ([`elements`]) in the same rounds, on one thread. Both have a uniform mesh where the crack runs, nearly
//! their own critical step, and solve for the phase field in every step. This solver has long spans at the
//! free sides, and runs once more with spans that are halved along the crack. The references are
//! extrapolated from runs of the same elements, two of which are repeated here: this favours them. The
//! plate, whose elements are graded, has a family of its own ([`super::plate`]). Strip, ring and arrest are
//! not here: their elements take any quadrilaterals and are not made for speed.
//!
//! The error of a run is the root mean square of the relative errors of the numbers that the case compares
//! with the reference, measured in the same way for both programs. Numbers whose reference is uncertain by
//! more than 5 % do not count.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use super::elements;
use super::peer::program::Program;
use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, pool, round_robin, whole_run};
use super::{BenchError, Settings};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::extremes::largest;
use crate::measure::{Run, measure};
use crate::output::history::Table;
use crate::reference::Library;

/// Time that one run may take.
const LIMIT: Duration = Duration::from_secs(1800);
/// Step of this solver over its critical one: a critical step that was found by iteration is not exact.
const SAFETY: &str = "analysis.safety=0.95";
/// Open part of the balance of energies over the largest.
const CLOSURE: f64 = 2e-2;

/// Largest uncertainty of a reference that counts, relative.
const KNOWN: f64 = 0.05;

/// A problem on its meshes.
struct Contest {
    name: &'static str,
    /// Case whose checks name the reference.
    case: &'static str,
    /// Cells in each direction and how often they are halved along the crack, from coarse to fine.
    meshes: &'static [(usize, usize)],
    /// Sides with long spans.
    long_ends: &'static str,
    /// Options of the elements, and their sizes in mm.
    elements: (&'static [&'static str], &'static [&'static str]),
}

/// All of them; a quick run has the first meshes of each.
const PROBLEMS: [Contest; 1] = [Contest {
    name: "kalthoff",
    case: "kalthoff-at1-fine",
    meshes: &[(128, 0), (64, 1), (192, 0), (96, 1), (48, 2), (256, 0), (128, 1), (64, 2), (384, 0), (192, 1)],
    long_ends: r#"["left", "right", "top"]"#,
    elements: (
        &["--kalthoff", "--at1", "--length-scale-mm", "0.75", "--toughness", "22130", "--end-us", "48"],
        &["0.5", "0.25", "0.2"],
    ),
}];

/// Columns of the elements, and the names and factors to SI that the cases know them by.
const COLUMNS: [(&str, &str, f64); 7] = [
    ("time_us", "time_s", 1e-6),
    ("external_work_j_per_m", "work_impactor_j", 1.0),
    ("kinetic_j_per_m", "kinetic_j", 1.0),
    ("elastic_j_per_m", "elastic_j", 1.0),
    ("fracture_j_per_m", "fracture_j", 1.0),
    ("tip_x_mm", "crack_tip_x_m", 1e-3),
    ("tip_y_mm", "crack_tip_y_m", 1e-3),
];

/// Times every problem on its meshes.
///
/// # Errors
/// If a case or the reference is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let library = Arc::new(settings.library()?);
    let built = settings.elements.get_or_init(|| elements::build(&settings.workspace));
    pool(1)?.install(|| {
        let mut contestants = Vec::new();
        for problem in &PROBLEMS {
            let (meshes, (_, sizes)) = (problem.meshes, problem.elements);
            for &mesh in &meshes[..if settings.quick { 4 } else { meshes.len() }] {
                contestants.push(ours(settings, problem, mesh, &library)?);
            }
            for h in &sizes[..if settings.quick { 1 } else { sizes.len() }] {
                if let Ok(program) = built {
                    contestants.push(theirs(settings, problem, program, h, &library)?);
                }
            }
        }
        round_robin(contestants, 1, settings.budget())
    })
}

/// The case of a problem on one mesh, and its first scene without pictures.
fn load(settings: &Settings, problem: &Contest, mesh: &[String]) -> Result<(Case, CaseScene), BenchError> {
    let name = format!("benchmarks/{}", problem.case);
    Ok((settings.case(&name, mesh)?, settings.scene(&name, mesh)?))
}

fn ours(
    settings: &Settings,
    problem: &Contest,
    (cells, halvings): (usize, usize),
    library: &Arc<Library>,
) -> Result<Contestant<'static>, BenchError> {
    let ends = format!("mesh.long_ends={}", problem.long_ends);
    let mesh = format!("mesh.cells=[{cells}, {cells}]");
    let (case, mut scene) = load(settings, problem, &[mesh, ends, SAFETY.to_string()])?;
    scene.scene.mesh.halvings = halvings;
    let degree = scene.scene.mesh.degree[0];
    let [mark, words] =
        if halvings > 0 { [format!("-r{halvings}"), format!(", refined {halvings}×")] } else { Default::default() };
    let mesh = format!("{cells} × {cells}{words}");
    let id = format!("scoreboard/{}/fisura/{cells}{mark}", problem.name);
    let label = format!("{}: fisura, p = {degree}{words}", problem.name);
    let record = BenchRecord::new(id, label, 1.0, "run").with("problem", problem.name).with("mesh", mesh);
    let library = Arc::clone(library);
    let (simulated, factor) = (scene.scene.clone(), scene.energy_factor);
    let answer = move |record: &mut BenchRecord, history: &Table| {
        note(record, errors(&case, &scene, history, factor, &library));
    };
    Ok(whole_run(record, simulated, CLOSURE, answer))
}

fn theirs(
    settings: &Settings,
    problem: &Contest,
    program: &Path,
    h: &str,
    library: &Arc<Library>,
) -> Result<Contestant<'static>, BenchError> {
    let (case, scene) = load(settings, problem, &[])?;
    let label = format!("{}: elements", problem.name);
    let id = format!("scoreboard/{}/elements/{h}", problem.name);
    let record = BenchRecord::new(id, label, 1.0, "run").with("problem", problem.name).with("mesh", format!("{h} mm"));
    let file = settings.workspace.join("target/independent-fem").join(format!("{}.csv", problem.name));
    let mut words = vec![program.display().to_string()];
    words.extend(problem.elements.0.iter().map(|word| word.to_string()));
    words.extend(["--fraction", "1", "--interval-us", "0.25", "--h-mm", h, "--out"].map(String::from));
    let (program, library) = (Program::of_words(words, LIMIT), Arc::clone(library));
    let answer = move |record: &mut BenchRecord, table: &Table| {
        record.verify_at_most("balance of energies over the largest", open(table), CLOSURE);
        note(record, errors(&case, &scene, &renamed(table), 1.0, &library));
    };
    Ok(elements::written(record, file, move |file| program.run(file), answer))
}

/// A history of the elements with the columns of this solver.
fn renamed(table: &Table) -> Table {
    let found = COLUMNS.iter().filter_map(|(theirs, ours, factor)| {
        let values = table.column(theirs)?.iter().map(|value| factor * value).collect();
        Some((ours.to_string(), values))
    });
    let (names, columns) = found.unzip();
    Table { names, columns }
}

/// Largest change of work less energies of the elements, over the largest of them.
fn open(table: &Table) -> f64 {
    let [work, kinetic, elastic, fracture] =
        ["external_work_j_per_m", "kinetic_j_per_m", "elastic_j_per_m", "fracture_j_per_m"]
            .map(|name| table.column(name).unwrap_or_default());
    if [work, kinetic, elastic, fracture].iter().any(|column| column.is_empty()) {
        return f64::NAN; // a column is missing
    }
    let balance: Vec<f64> = (0..table.rows()).map(|i| work[i] - kinetic[i] - elastic[i] - fracture[i]).collect();
    let change = largest(balance.iter().map(|b| (b - balance[0]).abs()));
    change / largest([work, kinetic, elastic, fracture].into_iter().flatten().map(|e| e.abs()))
}

/// Notes the errors of an answer, or why there are none.
fn note(record: &mut BenchRecord, errors: Result<Vec<AnswerError>, String>) {
    match errors {
        Ok(errors) => record.note_errors(Some(errors)),
        Err(message) => record.verify(false, message),
    }
}

/// The root mean square of the relative errors of all numbers with a known reference, then each of them.
///
/// # Errors
/// A number that cannot be measured, in words.
fn errors(
    case: &Case,
    scene: &CaseScene,
    history: &Table,
    energy_factor: f64,
    library: &Library,
) -> Result<Vec<AnswerError>, String> {
    let run =
        Run { name: &scene.name, scene: &scene.scene, history, frames: &[], energy_factor, values: &scene.values };
    let mut each = Vec::new();
    for check in case.checks.iter().filter(|check| check.reference.is_some()) {
        let measured = measure(check, &run, &[run], library)?;
        let Some((reference, value)) = measured.reference.zip(measured.value) else {
            return Err(format!("{}: {}", check.quantity, measured.message.unwrap_or_default()));
        };
        let known = reference.value.ok_or_else(|| format!("{}: a curve as reference", check.quantity))?;
        let uncertainty = reference.uncertainty.unwrap_or(0.0) / known.abs();
        if uncertainty > KNOWN {
            continue;
        }
        let error = AnswerError::relative(&check.quantity, (value / known - 1.0).abs(), &reference.source);
        each.push(AnswerError { uncertainty, ..error });
    }
    let mean = |of: fn(&AnswerError) -> f64| {
        (each.iter().map(|error| of(error).powi(2)).sum::<f64>() / each.len() as f64).sqrt()
    };
    let quantity = "root mean square of the relative errors";
    let all = AnswerError::relative(quantity, mean(|error| error.value), "elements extrapolated to h = 0");
    let all = AnswerError { uncertainty: mean(|error| error.uncertainty), ..all };
    if each.is_empty() { Err("no reference is known well".into()) } else { Ok([all].into_iter().chain(each).collect()) }
}
