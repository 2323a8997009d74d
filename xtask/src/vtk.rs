//! Files for ParaView (`run --vtk`): points and spans of every frame, and collections of them with their
//! times.
//!
//! Files are written as soon as their frame is reached and named by its number, so that a run that is taken
//! up again goes on with those of before.

use fisura::output::inspection::PointState;
use fisura::output::span_grid::Corner;
use fisura::scene::Scene;
use fisura::simulation::Simulation;
use fisura_reports::vtk::{Cells, Field, Piece, pvd, vtu};
use fisura_verification::output::{OutputError, OutputFolder};
use fisura_verification::scene_run::frame_steps;

use crate::cli::Common;
use crate::console;

/// First part of the names of the files with material points.
const POINTS: &str = "points";
/// First part of the names of the files with spans of the mesh.
const GRID: &str = "grid";
const KINDS: [&str; 2] = [POINTS, GRID];

/// Phase field of a body that does not fracture, beside one that does.
const INTACT: f64 = 1.0;

/// Name, numbers per point, numbers.
type Column = (&'static str, usize, Vec<f64>);

/// The files of a run.
#[derive(Debug)]
pub struct Files<'a> {
    folder: &'a OutputFolder,
    /// Times of the frames as the scene declares them, s.
    times: &'a [f64],
    common: &'a Common,
    /// The first file that could not be written. The run goes on: it has more to give.
    pub failed: Option<OutputError>,
}

impl<'a> Files<'a> {
    /// Files of a run of `scene` in `folder`, of which none is written yet.
    pub fn new(folder: &'a OutputFolder, scene: &'a Scene, common: &'a Common) -> Self {
        Self { folder, times: &scene.output.frames, common, failed: None }
    }

    /// Writes the files of a frame, and the collections up to it.
    pub fn write(&mut self, number: usize, simulation: &Simulation) {
        if let Err(error) = KINDS.iter().try_for_each(|kind| self.write_kind(kind, number, simulation)) {
            console::note(self.common, &format!("warning: {error}; the run continues"));
            self.failed.get_or_insert(error);
        }
    }

    fn write_kind(&self, kind: &str, number: usize, simulation: &Simulation) -> Result<(), OutputError> {
        let bytes = if kind == POINTS { points(simulation) } else { grid(simulation) };
        self.folder.write(&file_name(kind, number), bytes)?;
        let plan = simulation.plan();
        let (steps, _) = frame_steps(self.times, plan.step, plan.steps());
        let there = (0..=number).filter(|&n| self.has(kind, n));
        let frames: Vec<_> = there.map(|n| (steps[n] as f64 * plan.step, 0, file_name(kind, n))).collect();
        self.folder.write(&collection_name(kind), pvd(&frames))
    }

    fn has(&self, kind: &str, number: usize) -> bool {
        self.folder.path().join(file_name(kind, number)).is_file()
    }

    /// Names of the files that are there after `frames` frames; says so if some are not.
    pub fn after(&self, frames: usize) -> Vec<String> {
        let missing = (0..frames).filter(|&n| KINDS.iter().any(|kind| !self.has(kind, n))).count();
        if missing > 0 && self.failed.is_none() {
            let message = format!(
                "warning: {missing} of {frames} frames have no files for ParaView: they were computed without --vtk"
            );
            console::note(self.common, &message);
        }
        let of_kind = |kind: &&str| {
            let numbers = (0..frames).filter(|&n| self.has(kind, n));
            let mut names: Vec<String> = numbers.map(|n| file_name(kind, n)).collect();
            if !names.is_empty() {
                names.push(collection_name(kind));
            }
            names
        };
        KINDS.iter().flat_map(of_kind).collect()
    }
}

/// Whether a file of an output folder is one of these.
pub fn is_file_of_run(name: &str) -> bool {
    let number = |kind| name.strip_prefix(kind)?.strip_prefix('-')?.strip_suffix(".vtu")?.parse().ok();
    KINDS.iter().any(|kind| name == collection_name(kind) || number(kind).is_some_and(|n| name == file_name(kind, n)))
}

/// Those in an output folder.
pub fn files_of_run(folder: &OutputFolder) -> Vec<String> {
    folder.files().into_iter().filter(|name| is_file_of_run(name)).collect()
}

/// Removes those of the part of a run that was interrupted, and had them.
///
/// # Errors
/// One that was changed, or cannot be removed.
pub fn remove(folder: &OutputFolder, common: &Common) -> Result<(), OutputError> {
    let files = files_of_run(folder);
    files.iter().try_for_each(|name| folder.remove(name))?;
    note_removed(files.len(), folder, common);
    Ok(())
}

/// Says how many of an earlier run are gone.
pub fn note_removed(count: usize, folder: &OutputFolder, common: &Common) {
    if count > 0 {
        let folder = folder.path().display();
        console::note(common, &format!("{count} files for ParaView of an earlier run in {folder} are removed"));
    }
}

fn file_name(kind: &str, number: usize) -> String {
    format!("{kind}-{number}.vtu")
}

fn collection_name(kind: &str) -> String {
    format!("{kind}.pvd")
}

/// Material points at their present positions with what they carry.
fn points(simulation: &Simulation) -> Vec<u8> {
    let mut states: Vec<PointState> = Vec::with_capacity(simulation.extent().particles);
    simulation.for_each_point(&mut |state| states.push(state));
    let scalars = |value: fn(&PointState) -> f64| states.iter().map(value).collect();
    let vectors = |value: fn(&PointState) -> [f64; 2]| states.iter().flat_map(value).collect();
    let mut columns: Vec<Column> = vec![
        ("displacement (m)", 2, vectors(|p| p.displacement)),
        ("velocity (m/s)", 2, vectors(|p| p.velocity)),
        ("strain xx", 1, scalars(|p| p.strain[0])),
        ("strain yy", 1, scalars(|p| p.strain[1])),
        ("strain xy", 1, scalars(|p| p.strain[2])),
        ("stress xx (Pa)", 1, scalars(|p| p.stress[0])),
        ("stress yy (Pa)", 1, scalars(|p| p.stress[1])),
        ("stress xy (Pa)", 1, scalars(|p| p.stress[2])),
        ("stress zz (Pa)", 1, scalars(|p| p.stress_out_of_plane)),
        ("von Mises stress (Pa)", 1, scalars(PointState::von_mises)),
        ("body", 1, scalars(|p| p.body as f64)),
    ];
    if states.iter().any(|p| p.fracture.is_some()) {
        columns.push(("phase field", 1, scalars(|p| p.fracture.map_or(INTACT, |f| f.phase))));
        columns.push(("history energy (J/m^3)", 1, scalars(|p| p.fracture.map_or(0.0, |f| f.history))));
    }
    let positions: Vec<[f64; 2]> = states.iter().map(|p| p.present).collect();
    encode(&positions, Cells::Points, &columns)
}

/// Spans with material, and the fields of the control points at their corners.
fn grid(simulation: &Simulation) -> Vec<u8> {
    let grid = simulation.span_grid();
    let corners = &grid.corners;
    let scalars = |value: fn(&Corner) -> f64| corners.iter().map(value).collect();
    let mut columns: Vec<Column> = vec![
        ("velocity (m/s)", 2, corners.iter().flat_map(|c| c.velocity).collect()),
        ("body", 1, scalars(|c| c.body as f64)),
    ];
    if corners.iter().any(|c| c.phase.is_some()) {
        columns.push(("phase field", 1, scalars(|c| c.phase.unwrap_or(INTACT))));
    }
    let positions: Vec<[f64; 2]> = corners.iter().map(|c| c.position).collect();
    encode(&positions, Cells::Quadrilaterals(&grid.spans), &columns)
}

fn encode(points: &[[f64; 2]], cells: Cells, columns: &[Column]) -> Vec<u8> {
    let fields = columns.iter().map(|(name, components, values)| Field { name, components: *components, values });
    vtu(&Piece { points, cells, fields: fields.collect() })
}
