//! What an error of the benchmarks costs: whole runs of this solver and of the independent finite elements
//! ([`elements`]) in the same rounds, on one thread. Both take nearly their own critical step and solve for
//! the phase field in every step, both with Gc and with Gc/kappa. Where a crack runs both are graded: spans
//! and elements are two and four times as long elsewhere. This solver runs also with equal spans that are
//! halved along the crack. The references are extrapolated from runs of the same elements, some of which are
//! repeated here: this favours them. The plate has a family of its own ([`super::plate`]). The elements of
//! strip, ring and arrest take any quadrilaterals and are not made for speed, so there this solver is alone.
//!
//! The error of a run is the root mean square of the relative errors of the numbers that the case compares
//! with the reference, measured in the same way for both programs. Numbers whose reference is uncertain by
//! more than 5 % do not count.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use fisura::material::mesh_toughness::slope;
use serde::Deserialize;

use super::elements;
use super::peer::program::Program;
use super::plate_scene::open_knots;
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

/// A problem on its meshes, as `templates/scoreboard.toml` has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Contest {
    name: String,
    /// Case whose checks name the reference.
    case: String,
    /// Changes of its scene, on every mesh.
    #[serde(default)]
    set: Vec<String>,
    /// Ends of the parts of a graded mesh in x and y, mm, and the spans in each over the shortest.
    #[serde(default)]
    parts_mm: [Vec<f64>; 2],
    #[serde(default)]
    lengths: Vec<f64>,
    /// Meshes from coarse to fine, and how many of them a quick run has.
    meshes: Vec<Mesh>,
    quick: usize,
    /// What a crack costs; all runs are made with each.
    toughness: Vec<Toughness>,
    elements: Option<Elements>,
}

/// Options of the elements, their sizes in mm from coarse to fine, and how many of them a quick run has.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Elements {
    options: Vec<String>,
    sizes: Vec<f64>,
    quick: usize,
}

/// One of these: spans of the graded mesh that are so short along the crack, mm; as many cells in x
/// and y; as many in each, halved so many times along the crack; the mesh of the case with its spans divided.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
enum Mesh {
    Graded(f64),
    Equal([usize; 2]),
    Halved(usize, usize),
    Divided(usize),
}

/// Seconds that the runs of a contestant may take until it is not run once more.
const REPEATED: f64 = 2.0;

/// All of them, as a file.
const CONTESTS: &str = include_str!("../../templates/scoreboard.toml");

#[derive(Deserialize)]
struct Contests {
    problem: Vec<Contest>,
}

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
    let contests: Contests = toml::from_str(CONTESTS).map_err(|error| BenchError::input(error.to_string()))?;
    pool(1)?.install(|| {
        let mut contestants = Vec::new();
        for problem in &contests.problem {
            let few = |all: usize, quick: usize| if settings.quick { quick } else { all };
            for mesh in &problem.meshes[..few(problem.meshes.len(), problem.quick)] {
                for &toughness in &problem.toughness {
                    contestants.push(ours(settings, problem, mesh, toughness, &library)?);
                }
            }
            let (Some(elements), Ok(program)) = (&problem.elements, built) else { continue };
            for &h in &elements.sizes[..few(elements.sizes.len(), elements.quick)] {
                for &toughness in &problem.toughness {
                    contestants.push(theirs(settings, problem, (program, elements), (h, toughness), &library)?);
                }
            }
        }
        round_robin(contestants, if settings.quick { 1 } else { settings.rounds() }, REPEATED)
    })
}

/// Gc, or Gc over what a crack costs on the mesh; none where nothing cracks.
#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Toughness {
    None,
    Whole,
    OfMesh,
}

impl Toughness {
    /// In labels and in ids.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::None => ["", ""],
            Self::Whole => [", Gc", "-gc"],
            Self::OfMesh => [", Gc/κ", "-kappa"],
        }
    }
}

/// The case of a problem with changes of its scene, and its first scene.
fn load(settings: &Settings, problem: &Contest, set: &[String]) -> Result<(Case, CaseScene), BenchError> {
    let name = format!("benchmarks/{}", problem.case);
    Ok((settings.case(&name, set)?, settings.scene(&name, set)?))
}

fn ours(
    settings: &Settings,
    problem: &Contest,
    mesh: &Mesh,
    toughness: Toughness,
    library: &Arc<Library>,
) -> Result<Contestant<'static>, BenchError> {
    let cells = |nx: usize, ny: usize| format!("mesh.cells=[{nx}, {ny}]");
    let (name, words, key) = match *mesh {
        Mesh::Graded(h) => (format!("{h:.2}"), ", graded".to_string(), cells(64, 64)),
        Mesh::Equal([nx, ny]) => (ny.to_string(), String::new(), cells(nx, ny)),
        Mesh::Halved(n, times) => (format!("{n}-r{times}"), format!(", refined {times}×"), cells(n, n)),
        Mesh::Divided(n) => (n.to_string(), String::new(), format!("mesh.subdivide={n}")),
    };
    let set = [&problem.set[..], &[SAFETY.to_string(), key]].concat();
    let (case, mut scene) = load(settings, problem, &set)?;
    let shape = &mut scene.scene.mesh;
    let degree = shape.degree[0];
    match *mesh {
        Mesh::Graded(h) => {
            shape.knots = problem.parts_mm.each_ref().map(|ends| {
                let parts = ends.windows(2).zip(&problem.lengths);
                let parts = parts.map(|(ends, times)| (1e-3 * ends[0], 1e-3 * ends[1], 1e-3 * h * times));
                open_knots(degree, &parts.collect::<Vec<_>>())
            });
        }
        Mesh::Halved(_, times) => shape.halvings = times,
        Mesh::Equal(_) | Mesh::Divided(_) => {}
    }
    for fracture in scene.scene.materials.values_mut().filter_map(|material| material.fracture.as_mut()) {
        fracture.mesh_toughness = toughness == Toughness::OfMesh;
    }
    let [by, mark] = toughness.words();
    let id = format!("scoreboard/{}/fisura/{name}{mark}", problem.name);
    let label = format!("fisura, p = {degree}{words}{by}");
    let record = BenchRecord::new(id, label, 1.0, "run").with("problem", &*problem.name).with("mesh", name);
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
    (program, elements): (&Path, &Elements),
    (h, toughness): (f64, Toughness),
    library: &Arc<Library>,
) -> Result<Contestant<'static>, BenchError> {
    let (case, scene) = load(settings, problem, &[])?;
    let [by, mark] = toughness.words();
    let label = format!("elements{by}");
    let id = format!("scoreboard/{}/elements/{h}{mark}", problem.name);
    let record =
        BenchRecord::new(id, label, 1.0, "run").with("problem", &*problem.name).with("mesh", format!("{h} mm"));
    let file = settings.workspace.join("target/independent-fem").join(format!("{}.csv", problem.name));
    let mut words = vec![program.display().to_string()];
    words.extend(elements.options.iter().cloned());
    words.extend(["--fraction", "1", "--interval-us", "0.5", "--tolerance", "1e-4"].map(String::from));
    let fracture = scene.scene.materials.values().find_map(|material| material.fracture.as_ref());
    if let Some(fracture) = fracture {
        let slope = slope(fracture.model, 1, 2).filter(|_| toughness == Toughness::OfMesh).unwrap_or(0.0);
        let kappa = 1.0 + slope * 1e-3 * h / fracture.length_scale;
        words.extend(["--toughness".into(), format!("{:.9}", fracture.critical_energy_release_rate / kappa)]);
    }
    words.extend(["--h-mm".into(), h.to_string(), "--out".into()]);
    let (program, library) = (Program::of_words(words, LIMIT), Arc::clone(library));
    let run = move |file: &Path| elements::mean_of_runs(|| program.run(file));
    let answer = move |record: &mut BenchRecord, table: &Table| {
        record.verify_at_most("balance of energies over the largest", open(table), CLOSURE);
        note(record, errors(&case, &scene, &renamed(table), 1.0, &library));
    };
    Ok(elements::written(record, file, run, answer))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_read_and_a_quick_run_has_a_part_of_it() {
        let contests: Contests = toml::from_str(CONTESTS).unwrap();
        for problem in contests.problem {
            assert!(problem.quick <= problem.meshes.len() && !problem.toughness.is_empty(), "{}", problem.name);
            assert!(problem.elements.is_none_or(|e| e.quick <= e.sizes.len()), "{}", problem.name);
            assert!(problem.parts_mm.iter().all(|ends| ends.is_empty() || ends.len() == problem.lengths.len() + 1));
            let case = super::super::own_workspace().join("verification/cases/benchmarks").join(problem.case);
            assert!(case.with_extension("toml").is_file(), "{}", problem.name);
        }
    }
}
