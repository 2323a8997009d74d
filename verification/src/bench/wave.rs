//! Work and precision: what an error costs on one problem with an exact solution.
//!
//! The standing wave of [`crate::exact::standing_wave`] on rollers, small enough (a millionth of the
//! amplitude there) that the updated frame solves the same linear problem. It needs no loads, so that steps
//! cost what steps of a scene cost. Only steps are timed. Explicit steps of 0.8 of the critical one with the
//! lumped mass; with the consistent mass steps in proportion to h^((p + 1)/2), so that time and space are of
//! the same order. The error is that of the displacement at the end, relative, in L2 (in the updated frame:
//! at the points, weighted with their volumes).

use fisura::dynamics::energy;
use fisura::dynamics::total_frame::TotalFrame;
use fisura::dynamics::updated_frame::UpdatedFrame;
use fisura::scene::{Frame, Layout, Mass, Mesh, Plane, Scene, Transfer};
use rayon::prelude::*;

use super::record::{AnswerError, BenchRecord, Sample};
use super::timing::{Contestant, Stopwatch, pool, round_robin};
use super::{BenchError, Settings};
use crate::exact::ExactSolution;
use crate::exact::motion::Derived;
use crate::exact::standing_wave::{SIZE, StandingWave};
use crate::scene::plain::{PlainScene, ROLLERS};
use crate::study::convergence::errors::ErrorPoints;
use crate::study::convergence::moving::displace;
use crate::study::projected;

/// Factor on the exact solution.
const AMPLITUDE: f64 = 1e-6;
/// End of the simulated time, s.
const END: f64 = 0.6;
/// Spans per direction of the coarsest mesh with the consistent mass.
const COARSEST: usize = 8;
/// Fraction of the critical step.
const SAFETY: f64 = 0.8;
/// Closure of the ledger over its largest term that counts as round-off after some thousand steps.
const CLOSURE: f64 = 1e-9;

/// One way to solve the problem.
#[derive(Debug, Clone, Copy)]
struct Way {
    frame: Frame,
    transfer: Transfer,
    mass: Mass,
    layout: Layout,
    degree: usize,
}

/// Times every way on every mesh.
///
/// # Errors
/// If a run breaks down.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let contestants = pool(settings.threads)?.install(|| {
        let meshes: Vec<(Way, usize)> = ways().flat_map(|way| way.meshes(settings.quick)).collect();
        meshes.into_par_iter().map(|(way, n)| Wave::new(way, n, COARSEST)).collect::<Result<Vec<_>, _>>()
    })?;
    pool(1)?.install(|| {
        let contestants = contestants.iter().map(Wave::contestant).collect();
        round_robin(contestants, settings.rounds(), settings.budget())
    })
}

fn ways() -> impl Iterator<Item = Way> {
    let total = [Mass::Lumped, Mass::Consistent].into_iter().flat_map(|mass| {
        let layouts = [Layout::Gauss, Layout::Uniform].into_iter();
        layouts.flat_map(move |layout| {
            (1..=4).map(move |degree| Way { frame: Frame::Total, transfer: Transfer::Flip, mass, layout, degree })
        })
    });
    let updated = [Transfer::Flip, Transfer::Apic].into_iter().flat_map(|transfer| {
        let (mass, layout) = (Mass::Lumped, Layout::Gauss);
        [2, 3].into_iter().map(move |degree| Way { frame: Frame::Updated, transfer, mass, layout, degree })
    });
    total.chain(updated)
}

impl Way {
    /// With the numbers of spans per direction. Order 2 needs finer meshes for the same error than order p +
    /// 1.
    fn meshes(self, quick: bool) -> impl Iterator<Item = (Self, usize)> {
        let first = if self.mass == Mass::Lumped { 2 * COARSEST } else { COARSEST };
        (0..if quick { 3 } else { 4 }).map(move |level| (self, first << level))
    }

    /// Figure it belongs to.
    fn group(self) -> &'static str {
        match (self.frame, self.mass) {
            (Frame::Updated, _) => "updated frame",
            (Frame::Total, Mass::Lumped) => "lumped mass",
            (Frame::Total, Mass::Consistent) => "consistent mass",
        }
    }

    fn label(self) -> String {
        let kind = match (self.frame, self.layout) {
            (Frame::Updated, _) => format!("{:?}", self.transfer).to_uppercase(),
            (Frame::Total, layout) => format!("{layout:?}").to_lowercase(),
        };
        format!("p = {}, {kind}", self.degree)
    }

    fn scene(self, cells: usize) -> Scene {
        let plain = PlainScene {
            mesh: Mesh::uniform([self.degree; 2], [0.0; 2], SIZE, [cells; 2]),
            material: solution().material(),
            plane: Plane::Strain,
            mass: self.mass,
            layout: self.layout,
            points: self.degree + 1,
            held: ROLLERS.to_vec(),
        };
        let mut scene = plain.scene();
        (scene.analysis.frame, scene.analysis.transfer) = (self.frame, self.transfer);
        scene
    }
}

fn solution() -> Derived<StandingWave> {
    Derived { motion: StandingWave, plane: Plane::Strain }
}

/// The body at t = 0 in one of the two frames; in the total one with the points at which its error is taken.
enum Body {
    Total(Box<TotalFrame>, Box<ErrorPoints>),
    Updated(Box<UpdatedFrame>),
}

/// One way on one mesh, ready to run.
struct Wave {
    way: Way,
    cells: usize,
    solution: Derived<StandingWave>,
    body: Body,
    steps: usize,
    particles: usize,
    bytes: usize,
}

impl Wave {
    fn new(way: Way, cells: usize, coarsest: usize) -> Result<Self, BenchError> {
        let solution = solution();
        let scene = way.scene(cells);
        let start = |x: [f64; 2]| solution.displacement(x, 0.0).map(|u| AMPLITUDE * u);
        let velocity = |x: [f64; 2]| solution.velocity(x, 0.0).map(|v| AMPLITUDE * v);
        let broken = || BenchError::other("the wave cannot be started");
        let (body, critical, particles, bytes) = match way.frame {
            Frame::Total => {
                let mut frame = TotalFrame::new(&scene).map_err(|_| broken())?;
                let (displacement, velocity) = (projected(&frame, start)?, projected(&frame, velocity)?);
                frame.start_with(displacement, velocity).map_err(|_| broken())?;
                let points = ErrorPoints::new(&frame.patch, &scene.bodies[0]);
                let (critical, particles) = (frame.critical_step(), frame.lattice.count());
                let bytes = frame.bytes()[0];
                (Body::Total(Box::new(frame), Box::new(points)), critical, particles, bytes)
            }
            Frame::Updated => {
                let mut frame = UpdatedFrame::new(&scene).map_err(|_| broken())?;
                frame.set_initial_velocity(velocity);
                displace(&mut frame, &scene.bodies[0], start)?;
                let (critical, particles) = (frame.critical_step(), frame.fields[0].points.len());
                let bytes = frame.bytes()[0];
                (Body::Updated(Box::new(frame)), critical, particles, bytes)
            }
        };
        let step = match way.mass {
            Mass::Lumped => SAFETY * critical,
            Mass::Consistent => {
                let coarsest_step = TotalFrame::new(&way.scene(coarsest)).map_err(|_| broken())?.critical_step();
                let power = 0.5 * (way.degree + 1) as f64;
                (SAFETY * coarsest_step * (coarsest as f64 / cells as f64).powf(power)).min(SAFETY * critical)
            }
        };
        Ok(Self { way, cells, solution, body, steps: (END / step).ceil() as usize, particles, bytes })
    }

    fn contestant(&self) -> Contestant<'_> {
        let Way { degree, layout, mass, transfer, .. } = self.way;
        let (group, label) = (self.way.group(), self.way.label());
        let slug = |text: &str| text.replace(" = ", "").replace(", ", "-").replace(' ', "-").to_lowercase();
        let id = format!("work-precision/{}/{}/h{}", slug(group), slug(&label), self.cells);
        let work = (self.particles * self.steps) as f64;
        let mut record = BenchRecord::new(id, label, work, "particle-step")
            .with("group", group)
            .with("degree", degree)
            .with("cells", self.cells)
            .with("layout", format!("{layout:?}").to_lowercase())
            .with("mass", format!("{mass:?}").to_lowercase())
            .with("steps", self.steps)
            .with("particles", self.particles);
        if self.way.frame == Frame::Updated {
            record = record.with("transfer", format!("{transfer:?}").to_lowercase());
        }
        record.memory_bytes = self.bytes as u64;
        Contestant { record, run: Box::new(|record| self.run(record)) }
    }

    /// Runs to the end; error and closure go into the record.
    fn run(&self, record: &mut BenchRecord) -> Result<Sample, BenchError> {
        let dt = END / self.steps as f64;
        let (timed, error, closure) = match &self.body {
            Body::Total(frame, points) => {
                let (timed, end, closure) = self.march(frame, |f| f.step(dt).is_ok(), |f| f.sample(dt), &record.id)?;
                (timed, self.error_of_field(points, &end.displacement), closure)
            }
            Body::Updated(frame) => {
                let (timed, end, closure) = self.march(frame, |f| f.step(dt).is_ok(), |f| f.sample(dt), &record.id)?;
                (timed, self.error_at_points(&end), closure)
            }
        };
        record.verify_at_most("closure of the ledger over its largest term", closure.abs(), CLOSURE);
        record.error = Some(AnswerError::relative("displacement error in L2", error, "exact solution"));
        Ok(timed)
    }

    /// Steps a copy of a body to the end: what the steps took, the body, and the closure of its ledger over
    /// the largest term.
    fn march<B: Clone>(
        &self,
        body: &B,
        step: impl Fn(&mut B) -> bool,
        energies: impl Fn(&B) -> energy::Sample,
        id: &str,
    ) -> Result<(Sample, B, f64), BenchError> {
        let mut body = body.clone();
        let initial = energies(&body).stored();
        let watch = Stopwatch::start();
        if !(0..self.steps).all(|_| step(&mut body)) {
            return Err(BenchError::other(format!("{id} breaks down")));
        }
        let timed = watch.read();
        let mut end = energies(&body);
        end.close(initial);
        let closure = end.closure / end.largest_term();
        Ok((timed, body, closure))
    }

    fn error_of_field(&self, points: &ErrorPoints, field: &[Vec<f64>; 2]) -> f64 {
        let exact = |x| (self.solution.displacement(x, END).map(|u| AMPLITUDE * u), [[0.0; 2]; 2]);
        points.vector_squares(field, exact).l2()
    }

    fn error_at_points(&self, frame: &UpdatedFrame) -> f64 {
        let (mut error, mut size) = (0.0, 0.0);
        for point in &frame.fields[0].points {
            let exact = self.solution.displacement(point.reference(), END);
            for d in 0..2 {
                let exact = AMPLITUDE * exact[d];
                error += point.volume * (point.displacement[d] - exact).powi(2);
                size += point.volume * exact * exact;
            }
        }
        f64::sqrt(error / size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(way: Way) -> Vec<f64> {
        let run = |cells| {
            let wave = Wave::new(way, cells, 4).unwrap();
            let Contestant { mut record, mut run } = wave.contestant();
            run(&mut record).unwrap();
            assert!(record.verified, "{}: {}", record.id, record.answer);
            record.error.unwrap().value
        };
        [8, 16].map(run).to_vec()
    }

    #[test]
    fn every_kind_of_way_closes_its_ledger_and_converges() {
        let total =
            |mass, degree| Way { frame: Frame::Total, transfer: Transfer::Flip, mass, layout: Layout::Gauss, degree };
        let updated = |transfer| Way { frame: Frame::Updated, transfer, ..total(Mass::Lumped, 2) };
        // Points that cross spans have larger errors on such meshes, and are of order 2 as the lumped mass
        // is.
        for (way, least, largest) in [
            (total(Mass::Lumped, 2), 3.0, 0.2),
            (total(Mass::Consistent, 3), 12.0, 0.2),
            (updated(Transfer::Flip), 2.0, 0.5),
            (updated(Transfer::Apic), 2.0, 0.5),
        ] {
            let found = errors(way);
            assert!(found[0] / found[1] > least && found[1] < largest, "{way:?}: {found:?}");
        }
    }
}
