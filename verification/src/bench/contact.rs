//! What an error of a collision costs: two equal bars and two equal discs, head-on, elastic, without
//! friction.
//!
//! The bars exchange their velocities in the time `2 L/c` (Goldsmith, Impact, 1960, section 2.1): the errors
//! are those of the rebound velocity, of the contact time, and the energy that is lost in all. Discs leave
//! with some vibration, so that only the lost energy has an exact value there.
//!
//! The errors come from a run that looks at every step; what is timed is the same run without looking.

use fisura::Simulation;
use fisura::material::elasticity::ElasticModuli;
use fisura::scene::{Frame, Kinematics, Mesh, Scene, Shape, Transfer};

use super::record::{AnswerError, BenchRecord};
use super::timing::{Contestant, pool, round_robin, time_steps};
use super::{BenchError, Settings};
use crate::extremes::largest;
use crate::study::contact::{run, sample_is_due};

/// Closure of the ledger over the energy at t = 0: in the total frame an error of the time step.
const CLOSURE: f64 = 2e-2;
/// Height of the bars over their length.
const HEIGHT: f64 = 0.125;
/// Spans to the left of the first bar.
const MARGIN: f64 = 7.0;

/// Spans of the mesh over those of a radius of the discs.
const SPANS_PER_RADIUS: usize = 5;
/// Fewest spans of the mesh on which discs in the total frame are run.
const FEWEST: usize = 20;

/// A degree, and a transfer of the updated frame; none in the total frame.
#[derive(Debug, Clone, Copy)]
struct Way(usize, Option<Transfer>);

/// The ways on their meshes.
fn ways(meshes: impl Fn(Way) -> Vec<usize>) -> impl Iterator<Item = (Way, usize)> {
    let transfers = [Some(Transfer::Flip), Some(Transfer::Apic), None].into_iter();
    let ways = transfers.flat_map(|transfer| [2, 3].map(|degree| Way(degree, transfer)));
    ways.flat_map(move |way| meshes(way).into_iter().map(move |mesh| (way, mesh)))
}

impl Way {
    fn word(self) -> String {
        self.1.map_or("total".into(), |transfer| format!("{transfer:?}"))
    }

    fn label(self) -> String {
        match self.1 {
            Some(_) => format!("p = {}, {}", self.0, self.word().to_uppercase()),
            None => format!("p = {}, total frame", self.0),
        }
    }

    fn apply(self, scene: &mut Scene) {
        let points = match self.1 {
            Some(transfer) => {
                scene.analysis.transfer = transfer;
                self.0
            }
            None => {
                scene.analysis.kinematics = Kinematics::Finite;
                scene.analysis.frame = Frame::Total;
                self.0 + 1
            }
        };
        scene.bodies.iter_mut().for_each(|body| body.particles_per_cell = [points; 2]);
    }
}

/// Times collisions of bars and of discs.
///
/// # Errors
/// If a case is missing, or a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    pool(1)?.install(|| {
        let mut contestants = Vec::new();
        let mut found = Vec::new();
        for (kind, way, spans, scene, wave) in bars(settings)?.into_iter().chain(discs(settings)?) {
            found.push((watched(&scene)?, wave));
            contestants.push(contestant(&format!("contact/{kind}/{}/{spans}", id_of(way)), way, spans, scene)?);
        }
        let records = round_robin(contestants, settings.rounds(), settings.budget())?;
        Ok(records.iter().zip(&found).flat_map(|(record, errors)| with_errors(record, errors)).collect())
    })
}

/// What collides, way, spans per length or radius, scene, speed of waves in bars.
type Collision = (&'static str, Way, usize, Scene, Option<f64>);

/// Errors by the last part of an id, of bars with the speed `wave` of their waves.
fn errors(found: &Watched, wave: Option<f64>) -> Vec<(&'static str, AnswerError)> {
    let off = |found: f64, exact: f64| (found / exact - 1.0).abs();
    let exchange = "equal bars exchange their velocities in 2 L/c";
    let of_bars = wave.map(|wave| {
        [
            ("rebound", AnswerError::relative("error of the rebound velocity", off(found.rebound, 1.0), exchange)),
            ("duration", AnswerError::relative("error of the contact time", off(found.duration, 2.0 / wave), exchange)),
        ]
    });
    let loss = AnswerError::relative("energy lost over that at t = 0", found.loss.abs(), "an elastic impact");
    of_bars.into_iter().flatten().chain([("loss", loss)]).collect()
}

/// The same samples once for every error.
fn with_errors(record: &BenchRecord, (found, wave): &(Watched, Option<f64>)) -> Vec<BenchRecord> {
    let of = |(name, error): (&str, AnswerError)| {
        let mut record = record.clone();
        record.id = format!("{}/{name}", record.id);
        record.error = Some(error);
        record.verify_at_most("closure of the ledger over the energy at t = 0", found.closure.abs(), CLOSURE);
        record
    };
    errors(found, *wave).into_iter().map(of).collect()
}

fn contestant(id: &str, way: Way, spans: usize, scene: Scene) -> Result<Contestant<'static>, BenchError> {
    let prepared = Simulation::new(&scene)?;
    let (extent, steps) = (prepared.extent(), prepared.plan().steps());
    let record = BenchRecord::of_steps(id, way.label(), &extent, steps).with("degree", way.0).with("spans", spans);
    let run = move |_: &mut BenchRecord| time_steps(&mut Simulation::new(&scene)?, steps);
    Ok(Contestant { record, run: Box::new(run) })
}

fn bars(settings: &Settings) -> Result<Vec<Collision>, BenchError> {
    let base = settings.scene("contact/impact-equal", &[])?.scene;
    let material = &base.materials[&base.bodies[0].material];
    let wave = ElasticModuli::new(material, base.analysis.plane).dilatational_speed(material.density);
    let all: &[usize] = if settings.quick { &[8, 16, 32] } else { &[16, 32, 64, 128] };
    let all = |way: Way| if way.1.is_none() { &all[..all.len() - 1] } else { all };
    let runs = ways(|way| all(way).to_vec());
    Ok(runs.map(|(way, spans)| ("bars", way, spans, bars_of(&base, way, spans), Some(wave))).collect())
}

fn id_of(way: Way) -> String {
    format!("p{}-{}", way.0, way.word().to_lowercase())
}

/// Two bars of unit length, one span apart, on a mesh of square spans.
fn bars_of(base: &Scene, way: Way, spans: usize) -> Scene {
    let mut scene = base.clone();
    let h = 1.0 / spans as f64;
    let cells = [2 * spans + 2 * MARGIN as usize + 1, (HEIGHT * spans as f64).round() as usize];
    scene.mesh = Mesh::uniform([way.0; 2], [0.0; 2], cells.map(|n| n as f64 * h), cells);
    let (left, middle) = (MARGIN * h, (MARGIN + 1.0) * h + 1.0);
    for (body, x) in scene.bodies.iter_mut().zip([left, middle]) {
        body.shape = Shape::Rectangle { min: [x, 0.0], max: [x + 1.0, HEIGHT] };
    }
    let speed = scene.bodies[0].velocity[0];
    scene.analysis.end_time = h / speed + 4.0;
    way.apply(&mut scene);
    scene
}

fn discs(settings: &Settings) -> Result<Vec<Collision>, BenchError> {
    let base = settings.scene("contact/discs-head-on", &[])?.scene;
    let all: &[usize] = if settings.quick { &[10, 20] } else { &[20, 40, 80] };
    let fits = |way: Way, n: usize| way.1.is_some() || n >= FEWEST;
    let runs = ways(|way| all.iter().copied().filter(|&n| fits(way, n)).collect());
    Ok(runs.map(|(way, cells)| ("discs", way, cells / SPANS_PER_RADIUS, discs_of(&base, way, cells), None)).collect())
}

fn discs_of(base: &Scene, way: Way, cells: usize) -> Scene {
    let mut scene = base.clone();
    scene.mesh = Mesh::uniform([way.0; 2], scene.mesh.origin(), [1.0; 2], [cells; 2]);
    way.apply(&mut scene);
    scene
}

/// What a collision gave.
struct Watched {
    /// Velocity of separation over that of approach.
    rebound: f64,
    /// Contact time by the momentum of the first body: that between a tenth and nine tenths of its change,
    /// over 0.8, s.
    duration: f64,
    /// Energy lost in all, over that at t = 0.
    loss: f64,
    /// Closure of the ledger over the energy at t = 0.
    closure: f64,
}

/// Looks at a collision along x of two bodies.
fn watched(scene: &Scene) -> Result<Watched, BenchError> {
    let (mut energies, mut momenta) = (Vec::new(), Vec::new());
    let mut velocities = Vec::new();
    run(scene, &mut |simulation| {
        let bodies = simulation.momenta();
        let velocity = |body: usize| bodies[body].1[0] / bodies[body].0;
        momenta.push([simulation.time(), bodies[0].1[0]]);
        velocities.push(velocity(1) - velocity(0));
        if sample_is_due(simulation) {
            let sample = simulation.sample();
            energies.push([sample.stored(), sample.closure.abs()]);
        }
    })?;
    let (Some([initial, _]), Some([end, _])) = (energies.first(), energies.last()) else {
        return Err(BenchError::other("a collision without samples"));
    };
    let closure = largest(energies.iter().map(|e| e[1])) / initial;
    let rebound = -velocities[velocities.len() - 1] / velocities[0];
    Ok(Watched { rebound, duration: passage(&momenta) / 0.8, loss: 1.0 - end / initial, closure })
}

/// Time between a tenth and nine tenths of the change of a quantity; rows are time and value.
fn passage(rows: &[[f64; 2]]) -> f64 {
    let (first, last) = (rows[0][1], rows[rows.len() - 1][1]);
    let part = |row: &[f64; 2]| (row[1] - first) / (last - first);
    let time = |level: f64| {
        let pair = rows.windows(2).find(|pair| part(&pair[0]) < level && part(&pair[1]) >= level);
        pair.map_or(f64::NAN, |pair| {
            let [a, b] = [part(&pair[0]), part(&pair[1])];
            pair[0][0] + (level - a) / (b - a) * (pair[1][0] - pair[0][0])
        })
    };
    time(0.9) - time(0.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_passage_of_a_ramp_is_four_fifths_of_it() {
        let rows: Vec<[f64; 2]> = (0..=20).map(f64::from).map(|t| [t, 3.0 - (t - 5.0).clamp(0.0, 10.0)]).collect();
        assert!((passage(&rows) - 8.0).abs() < 1e-12);
    }
}
