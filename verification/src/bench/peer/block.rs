//! The block of a peer, and what its answer is held against.
//!
//! A free elastic square flies over a few spans and swings in a mode that leaves its edges free (Lamé's, with
//! the shear wave speed c_s):
//!
//! ```text
//! v = drift + A cos(ωt) [cos(πx/L) sin(πy/L), −sin(πx/L) cos(πy/L)],    ω = √2 π c_s/L
//! ```
//!
//! After three eighths of a period the displacement stands at 0.7 of its largest and the velocity has turned
//! to −0.7 of its first value: neither a program that leaves the points where they are nor one that lets them
//! fly on is near. Differences are taken over the swing alone, in whose measure the flight is long.

use std::f64::consts::{PI, SQRT_2, TAU};

use fisura::Simulation;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::material::elasticity::ElasticModuli;
use fisura::particles::points::Point;
use fisura::scene::{Plane, Scene};
use serde_json::json;

use super::super::BenchError;
use super::super::block::{DENSITY, SPAN, moving_scene};
use crate::extremes::larger;
use crate::output::OutputFolder;
use crate::output::history::Table;

/// Degree of the splines, and points per span and direction.
const DEGREE: usize = 2;
const POINTS: usize = 2;
/// Spans that the block flies over, and room around it.
const FLIGHT: [f64; 2] = [3.0, 2.0];
const MARGIN: usize = 8;
/// Part of a period that is run.
const PERIODS: f64 = 0.375;
/// Amplitude of the velocity over the shear wave speed: strains of 1e-3.
const AMPLITUDE: f64 = 2e-3;
/// Relative difference of volumes that is allowed: some keep those of the start, some let them follow the
/// strain.
const VOLUME: f64 = 0.01;
/// Columns of both files.
const COLUMNS: [&str; 5] = ["x", "y", "volume", "vx", "vy"];

/// The block, before and after our steps.
pub struct PeerBlock {
    scene: Scene,
    /// The block at t = 0, before any step.
    pub start: UpdatedFrame,
    /// Time step of all runs of the block, s.
    pub step: f64,
    /// Numbers of steps of the shorter and the longer run.
    pub steps: [usize; 2],
    drift: [f64; 2],
    before: Vec<Point>,
    after: Vec<Point>,
}

impl PeerBlock {
    /// A block of `cells` × `cells` spans.
    ///
    /// # Errors
    /// If it cannot be started, or a step cannot be taken.
    pub fn new(cells: usize) -> Result<Self, BenchError> {
        let mut scene = moving_scene(DEGREE, POINTS, cells, MARGIN);
        scene.bodies[0].angular_velocity = 0.0;
        Self::of(scene, cells)
    }

    fn of(scene: Scene, cells: usize) -> Result<Self, BenchError> {
        let moduli = ElasticModuli::new(&scene.materials[&scene.bodies[0].material], Plane::Strain);
        let (length, speed) = (cells as f64 * SPAN, (moduli.mu / DENSITY).sqrt());
        let end = PERIODS * TAU / (SQRT_2 * PI * speed / length);
        let step = Simulation::new(&scene)?.plan().step;
        let long = (end / step).ceil() as usize;
        let drift = FLIGHT.map(|spans| spans * SPAN / end);
        let broken = |_| BenchError::other("the block of the peer cannot be started");
        let mut start = UpdatedFrame::new(&scene).map_err(broken)?;
        start.set_initial_velocity(|[x, y]| {
            let [(sx, cx), (sy, cy)] = [x, y].map(|x| (x * PI / length).sin_cos());
            let amplitude = AMPLITUDE * speed;
            [drift[0] + amplitude * cx * sy, drift[1] - amplitude * sx * cy]
        });
        let before = start.fields[0].points.to_vec();
        let mut block = Self { scene, start, step, steps: [long / 10, long], drift, before, after: Vec::new() };
        let mut frame = block.start.clone();
        block.advance(&mut frame, long)?;
        block.after = block.in_first_order(&frame.fields[0].points);
        if block.after.len() < block.before.len() {
            return Err(BenchError::other("points of the block of the peer are not found again"));
        }
        Ok(block)
    }

    /// Number of material points.
    pub fn points(&self) -> usize {
        self.before.len()
    }

    /// Takes steps.
    ///
    /// # Errors
    /// If one cannot be taken.
    pub fn advance(&self, frame: &mut UpdatedFrame, steps: usize) -> Result<(), BenchError> {
        let broken = |_| BenchError::other("a step of the block of the peer cannot be taken");
        (0..steps).try_for_each(|_| frame.step(self.step)).map_err(broken)
    }

    /// Points in the order of [`Self::before`]: steps sort them by the spans they are in.
    fn in_first_order(&self, points: &[Point]) -> Vec<Point> {
        let key = |place: [f64; 2]| place.map(|x| (x * POINTS as f64 / SPAN).floor() as i64);
        let places: std::collections::HashMap<_, _> = points.iter().map(|p| (key(p.reference()), *p)).collect();
        self.before.iter().filter_map(|p| places.get(&key(p.position)).copied()).collect()
    }

    /// Our own answer, as a peer would leave it.
    pub fn answer(&self) -> Table {
        table(&self.after)
    }

    /// Writes what the peer reads into a folder below `out`.
    ///
    /// # Errors
    /// If the files cannot be written.
    pub fn write(&self, out: &OutputFolder, folder: &str, steps: usize) -> Result<(), BenchError> {
        out.write_table(&format!("{folder}/particles.csv"), &table(&self.before))?;
        let material = &self.scene.materials[&self.scene.bodies[0].material];
        let block = json!({
            "young_modulus": material.young_modulus,
            "poisson_ratio": material.poisson_ratio,
            "density": DENSITY,
            "plane": "strain",
            "thickness": 1.0,
            "degree": DEGREE,
            "span": SPAN,
            "grid_origin": self.scene.mesh.origin(),
            "grid_end": self.scene.mesh.end(),
            "time_step": self.step,
            "steps": steps,
            "transfer": "flip",
        });
        Ok(out.write(&format!("{folder}/block.json"), format!("{block:#}\n"))?)
    }

    /// The larger of the relative differences of positions and velocities from ours: root mean squares over
    /// those of the swing.
    ///
    /// # Errors
    /// An answer of another form, with other rows, or with points elsewhere.
    pub fn difference(&self, answer: &Table) -> Result<f64, String> {
        let column = |name: &str| answer.column(name).ok_or_else(|| format!("result.csv has no column {name}"));
        let [x, y, volume, vx, vy] = COLUMNS.map(column);
        let (x, y, volume, vx, vy) = (x?, y?, volume?, vx?, vy?);
        if answer.rows() != self.after.len() {
            return Err(format!("result.csv has {} rows, particles.csv has {}", answer.rows(), self.after.len()));
        }
        let time = self.steps[1] as f64 * self.step;
        let square = |a: [f64; 2]| a[0] * a[0] + a[1] * a[1];
        let (mut apart, mut swing) = ([0.0; 2], [0.0; 2]);
        for (row, (first, last)) in self.before.iter().zip(&self.after).enumerate() {
            let off = [x[row] - last.position[0], y[row] - last.position[1]];
            let far = square(off).sqrt();
            if far.is_nan() || far > SPAN {
                let [there, here] = [[x[row], y[row]], last.position].map(|[x, y]| format!("({x:.6e}, {y:.6e}) m"));
                let asked = "check that the block moves and that the rows are in the order of particles.csv";
                return Err(format!("row {} lies at {there}, in fisura at {here}: {asked}", row + 1));
            }
            let ratio = volume[row] / last.volume;
            if ratio.is_nan() || (ratio - 1.0).abs() > VOLUME {
                let [there, here] = [volume[row], last.volume];
                return Err(format!("row {} has the volume {there:.6e} m², in fisura {here:.6e} m²", row + 1));
            }
            apart[0] += square(off);
            apart[1] += square([vx[row] - last.velocity[0], vy[row] - last.velocity[1]]);
            swing[0] += square([0, 1].map(|d| last.displacement[d] - self.drift[d] * time));
            swing[1] += square([0, 1].map(|d| first.velocity[d] - self.drift[d]));
        }
        Ok(larger((apart[0] / swing[0]).sqrt(), (apart[1] / swing[1]).sqrt()))
    }
}

fn table(points: &[Point]) -> Table {
    let row = |p: &Point| [p.position[0], p.position[1], p.volume, p.velocity[0], p.velocity[1]];
    Table::of_rows(&COLUMNS, points.iter().map(row))
}

#[cfg(test)]
mod tests {
    use fisura::scene::Transfer;

    use super::super::SAME;
    use super::*;

    fn changed(table: &Table, change: impl Fn(&mut Table)) -> Table {
        let mut other = table.clone();
        change(&mut other);
        other
    }

    #[test]
    fn other_transfers_give_the_answer_and_programs_that_do_not_compute_are_far_from_it() {
        let block = PeerBlock::new(32).unwrap();
        assert_eq!((block.after.len(), block.difference(&block.answer())), (4 * 32 * 32, Ok(0.0)));
        for transfer in [Transfer::Apic, Transfer::Tpic] {
            let mut scene = block.scene.clone();
            scene.analysis.transfer = transfer;
            let difference = block.difference(&PeerBlock::of(scene, 32).unwrap().answer()).unwrap();
            assert!(difference > 0.0 && difference < SAME, "{transfer:?}: {difference}");
        }
        let time = block.steps[1] as f64 * block.step;
        let flying = changed(&table(&block.before), |table| {
            for (position, velocity) in [(0, 3), (1, 4)] {
                let way: Vec<f64> = table.columns[velocity].iter().map(|v| v * time).collect();
                table.columns[position].iter_mut().zip(way).for_each(|(x, way)| *x += way);
            }
        });
        assert!(block.difference(&flying).unwrap() > 30.0 * SAME);
        let swinging = changed(&block.answer(), |table| table.columns[3].iter_mut().for_each(|v| *v *= -1.0));
        assert!(block.difference(&swinging).unwrap() > 100.0 * SAME);
    }

    #[test]
    fn a_copy_of_the_start_other_orders_and_other_rows_are_named() {
        let block = PeerBlock::new(16).unwrap();
        let answer = block.answer();
        let refused = |table: &Table| block.difference(table).unwrap_err();
        let copy = refused(&table(&block.before));
        assert!(copy.contains("row 1 lies at") && copy.contains("that the block moves"), "{copy}");
        let reversed = changed(&answer, |table| table.columns.iter_mut().for_each(|column| column.reverse()));
        assert!(refused(&reversed).contains("in the order of particles.csv"));
        let short = changed(&answer, |table| table.columns.iter_mut().for_each(|column| column.truncate(7)));
        assert!(refused(&short).contains("7 rows, particles.csv has 1024"));
        let heavy = changed(&answer, |table| table.columns[2][3] *= 1.1);
        assert!(refused(&heavy).contains("row 4 has the volume"));
        let lost = changed(&answer, |table| table.columns[0][5] = f64::NAN);
        assert!(refused(&lost).contains("row 6"));
        let unnamed = changed(&answer, |table| table.names[4] = "v_y".into());
        assert!(refused(&unnamed).contains("no column vy"));
        let gap = changed(&answer, |table| table.columns[4][5] = f64::NAN);
        assert!(block.difference(&gap).unwrap().is_nan());
    }
}
