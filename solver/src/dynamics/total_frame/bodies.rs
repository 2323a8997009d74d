//! The bodies of a scene in the total frame, and their contact.
//!
//! Each has a field of its own, on the spans of the mesh that it reaches into at t = 0, and moves wherever
//! its displacement takes it. Between its internal forces and its acceleration come the forces of contact.

use super::TotalFrame;
use super::boundary::arcs_at_rest;
use super::levels::Levels;
use crate::checkpoint::{Archive, StateError};
use crate::contact::ContactLedger;
use crate::contact::gap_potential::thin_parts::ThinParts;
use crate::contact::gap_potential::{GapForce, GapPotential};
use crate::contact::impulse::ContactForce;
use crate::contact::rigid::{RigidMotion, RigidOutline};
use crate::dynamics::body_sample::{BodySample, BodySamples, PairForce, names, pairs};
use crate::dynamics::energy::{ContactSample, Sample};
use crate::dynamics::failure::Failure;
use crate::linear_algebra::extremes::smaller;
use crate::material::hencky::Distortion;
use crate::output::inspection::{InvertedPoint, PointState};
use crate::output::picture::Raster;
use crate::output::span_grid::SpanGrid;
use crate::phase_field::PhaseFieldCounts;
use crate::scene::{Body, Crack, Scene};
use crate::splines::patch::Patch;
use crate::splines::spline::ROUND_OFF;

/// Bodies in the total frame.
#[derive(Debug)]
pub struct TotalBodies {
    /// Bodies that deform, in the order of the scene; or the levels of one body on a refined mesh.
    pub(crate) bodies: Vec<TotalFrame>,
    pub(crate) contact: Option<GapPotential>,
    /// If they are the levels of one body on a mesh that is refined.
    levels: Option<Levels>,
    /// The mesh of the scene.
    pub(crate) patch: Patch,
    thickness: f64,
    /// Names of all bodies in columns, rigid ones last, if they are recorded one by one.
    recorded: Option<Vec<String>>,
}

impl TotalBodies {
    /// The bodies of `scene` at t = 0 with their initial accelerations.
    ///
    /// # Errors
    /// As [`TotalFrame::new`]; if there is no material at a part of a boundary that may meet others.
    pub fn new(scene: &Scene) -> Result<Self, Failure> {
        let numbered = scene.bodies.iter().enumerate();
        let deformable: Vec<(usize, &Body)> = numbered.filter(|(_, body)| !body.rigid).collect();
        let mut levels = None;
        let bodies = match (&scene.contact, deformable.as_slice()) {
            (None, [_]) if scene.mesh.halvings > 0 => {
                let (frames, of_frames) = Levels::new(scene)?;
                levels = Some(of_frames);
                frames
            }
            (None, [_]) => vec![TotalFrame::new(scene)?],
            _ => {
                let first = deformable.first().map_or(0, |(number, _)| *number);
                let of = |&(number, body): &(usize, &Body)| {
                    of_body(scene, body, number == first).map_err(|failure| failure.of_body(number))
                };
                deformable.iter().map(of).collect::<Result<_, _>>()?
            }
        };
        let patch = Patch::new(&scene.mesh);
        let contact = scene.contact.as_ref().map(|contact| {
            let span = patch.shortest_span();
            let rigid = |body: &Body| {
                let motion = RigidMotion::new(&scene.mesh, body);
                let arcs = arcs_at_rest(&body.shape, &scene.mesh, span);
                (ThinParts::new(&arcs, span, |position| body.shape.contains(position)), RigidOutline::new(arcs, motion))
            };
            let (thin_rigid, rigid): (Vec<_>, _) = scene.bodies.iter().filter(|body| body.rigid).map(rigid).unzip();
            let thin = bodies.iter().filter_map(TotalFrame::thin_parts).chain(thin_rigid).collect();
            let own = bodies.iter().filter(|_| contact.self_contact).filter_map(TotalFrame::own_pairs).collect();
            GapPotential::new(span, contact.friction, rigid, thin, own)
        });
        let recorded = scene.output.bodies.then(|| names(scene));
        let mut all = Self { bodies, contact, levels, patch, thickness: scene.analysis.thickness, recorded };
        all.meet(0.0)?; // bodies may overlap a little
        Ok(all)
    }

    /// One time step of `dt` seconds; phase fields that are `sampled` after it are solved for.
    ///
    /// # Errors
    /// If a phase field cannot be solved for, or a boundary is deep in another body.
    pub(crate) fn step(&mut self, dt: f64, sampled: bool) -> Result<(), Failure> {
        let fractures = self.bodies.iter_mut().filter_map(|body| body.fracture.as_mut());
        fractures.filter(|_| sampled).for_each(|fracture| fracture.field.expect_solve());
        if let Some(levels) = &mut self.levels {
            return levels.step(&mut self.bodies, dt);
        }
        for body in &mut self.bodies {
            body.find_internal_forces(dt)?;
        }
        self.meet(dt)?;
        self.bodies.iter_mut().for_each(|body| body.find_motion(dt));
        Ok(())
    }

    /// Forces of contact at the present positions, `dt` seconds after they were found last.
    fn meet(&mut self, dt: f64) -> Result<(), Failure> {
        let Self { bodies, contact: Some(contact), .. } = self else { return Ok(()) };
        let outlines = bodies.iter().filter_map(TotalFrame::outline).collect();
        contact.find(outlines, bodies[0].time(), dt)?;
        for pair in &contact.forces {
            for (side, body) in pair.bodies.into_iter().enumerate() {
                if let Some(body) = bodies.get_mut(body) {
                    body.push(pair, side);
                }
            }
        }
        Ok(())
    }

    /// Warnings of slits that part no function of the mesh.
    pub(crate) fn idle_slits(&self, scene: &Scene) -> Vec<String> {
        let coarser = if self.levels.is_some() { self.bodies.len() - 1 } else { 0 }; // these have no slits
        let bodies = scene.bodies.iter().filter(|body| !body.rigid).zip(&self.bodies[coarser..]);
        let slits = bodies.flat_map(|(body, frame)| body.slits().map(move |slit| (frame, slit)));
        let idle = slits.filter(|(frame, slit)| !frame.lattice.is_parted_by(&frame.patch, slit));
        let words = |(frame, slit): (&TotalFrame, &Crack)| {
            let [[x0, y0], [x1, y1]] = [slit.points[0], slit.points[slit.points.len() - 1]];
            let functions = 1 + frame.lattice.degree[0].max(frame.lattice.degree[1]);
            format!(
                "the slit from ({x0}, {y0}) to ({x1}, {y1}) m has no effect: functions of the mesh reach over up to \
                 {functions} cells, and it parts none of them; use smaller cells, or make it longer"
            )
        };
        idle.map(words).collect()
    }

    /// Makes ready for steps of `dt` seconds.
    pub(crate) fn prepare(&mut self, dt: f64) {
        match &self.levels {
            None => self.bodies.iter_mut().for_each(|body| body.prepare(dt)),
            Some(levels) => levels.prepare(&mut self.bodies, dt),
        }
    }

    /// Critical time step, s; infinite if nothing can move.
    pub(crate) fn critical_step(&self) -> f64 {
        if let Some(levels) = &self.levels {
            return levels.critical_step;
        }
        let steps = self.bodies.iter().map(TotalFrame::critical_step);
        steps.fold(f64::INFINITY, |least, step| if step >= least { least } else { step }) // NaN stays
    }

    /// The critical step where a body has become stiffer: see [`TotalFrame::retake_critical_step`].
    pub(crate) fn retake_critical_step(&mut self, dt: f64, undeformed: f64) -> Option<f64> {
        let steps = self.bodies.iter_mut().filter_map(|body| body.retake_critical_step(dt, undeformed));
        steps.reduce(smaller)
    }

    /// Remembers where cracks begin that were not there at the start.
    pub(crate) fn note_crack_start(&mut self) {
        self.bodies.iter_mut().for_each(TotalFrame::note_crack_start);
    }

    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at
    /// zero.
    pub(crate) fn sample(&self, dt: f64) -> Sample {
        let samples: Vec<Sample> = self.bodies.iter().map(|body| body.sample(dt)).collect();
        if let Some(levels) = &self.levels {
            return levels.sample(&self.bodies, samples);
        }
        let recorded = self.recorded.as_ref().map(|names| self.sample_bodies(names, &samples));
        let mut sample = samples.into_iter().reduce(Sample::with).expect("a scene has a body");
        if let Some(ContactLedger { loss, friction, work }) = self.contact.as_ref().map(GapPotential::ledger) {
            let [loss, friction, work] = [loss, friction, work].map(|energy| energy * self.thickness);
            sample.external_work += work;
            sample.contact = Some(ContactSample { loss, friction });
        }
        Sample { bodies: recorded, ..sample }
    }

    fn sample_bodies(&self, names: &[String], samples: &[Sample]) -> BodySamples {
        let of = |((body, sample), name): ((&TotalFrame, &Sample), &String)| sample_body(body, sample, name);
        let bodies: Vec<BodySample> = self.bodies.iter().zip(samples).zip(names).map(of).collect();
        let Some(contact) = &self.contact else { return BodySamples { bodies, ..BodySamples::default() } };
        let forces = self.contact_forces(0.0);
        let force = |pair: [usize; 2]| {
            let of_pair = forces.iter().filter(|force| force.bodies == pair);
            let sum = of_pair.fold([0.0; 2], |sum, force| [0, 1].map(|d| sum[d] + force.force[d]));
            PairForce { names: pair.map(|i| names[i].clone()), force: sum.map(|f| f * self.thickness) }
        };
        let forces = pairs(bodies.len(), names.len()).map(force).collect();
        let smallest_gap = Some(contact.forces.iter().map(GapForce::gap).fold(0.0, smaller));
        BodySamples { bodies, forces, smallest_gap }
    }

    /// Forces of contact now; they do not depend on the step.
    pub(crate) fn contact_forces(&self, _dt: f64) -> Vec<ContactForce> {
        self.contact.as_ref().map_or_else(Vec::new, GapPotential::contact_forces)
    }

    /// Mass (kg) and momentum (kg m/s) of every body, with the velocities of half a step of `dt` seconds
    /// before.
    pub(crate) fn momenta(&self, dt: f64) -> Vec<(f64, [f64; 2])> {
        self.bodies.iter().map(|body| body.mass_and_momentum(if body.time() > 0.0 { 0.5 * dt } else { 0.0 })).collect()
    }

    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        for (number, body) in self.bodies.iter().enumerate() {
            let body_number = if self.levels.is_some() { 0 } else { number };
            body.for_each_point_state(&mut |state| f(PointState { body: body_number, ..state }));
        }
    }

    /// The spans with points; their corners move with the bodies.
    pub(crate) fn span_grid(&self) -> SpanGrid {
        let mut grid = SpanGrid::default();
        let number = |number| if self.levels.is_some() { 0 } else { number };
        self.bodies.iter().enumerate().for_each(|(index, body)| body.add_spans(number(index), &mut grid));
        grid
    }

    /// Phase field, if there is one, and largest principal stress (Pa) on a raster; NaN where there is no
    /// body. A body that meets no others is drawn where it was at t = 0.
    pub(crate) fn paint(&self, raster: &Raster) -> (Option<Vec<f64>>, Vec<f64>) {
        match (self.bodies.as_slice(), &self.levels, &self.contact) {
            (bodies, Some(levels), _) => return levels.on_finest(bodies).paint(raster),
            ([body], None, None) => return body.paint(raster),
            _ => {}
        }
        let blank = vec![[f64::NAN; 2]; raster.pixels[0] * raster.pixels[1]];
        let values = self.bodies.iter().fold(blank, |mut values, body| {
            body.paint_moved(raster, &mut values);
            values
        });
        let brittle = self.bodies.iter().any(|body| body.fracture.is_some());
        (brittle.then(|| values.iter().map(|v| v[0]).collect()), values.iter().map(|v| v[1]).collect())
    }

    /// Position (m) of the fastest control point, and its speed (m/s), infinite if it is no number.
    pub(crate) fn fastest_control_point(&self) -> ([f64; 2], f64) {
        let fastest = self.bodies.iter().map(TotalFrame::fastest_control_point);
        fastest.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or_default()
    }

    /// Where material is distorted too far for small strains: see [`TotalFrame::distorted_beyond`].
    pub(crate) fn distorted_beyond(&self, limit: f64) -> Option<([f64; 2], Distortion)> {
        let turned = self.bodies.iter().filter_map(|body| body.distorted_beyond(limit));
        turned.max_by(|a, b| a.1.size().total_cmp(&b.1.size()))
    }

    /// The point that is turned inside out furthest, if one is.
    pub(crate) fn inverted_point(&self) -> Option<InvertedPoint> {
        self.bodies.iter().filter_map(TotalFrame::inverted_point).reduce(InvertedPoint::worse)
    }

    /// Elastic energy of all bodies for the thickness of the scene, J.
    pub(crate) fn elastic_energy(&self) -> f64 {
        self.bodies.iter().map(TotalFrame::elastic_energy).sum()
    }

    /// External work so far, J.
    pub(crate) fn external_work(&self) -> f64 {
        let by_rigid_bodies = self.contact.as_ref().map_or(0.0, |contact| contact.ledger().work * self.thickness);
        self.bodies.iter().map(TotalFrame::external_work).sum::<f64>() + by_rigid_bodies
    }

    /// Counters of the phase fields, if there are any.
    pub(crate) fn phase_field_counts(&self) -> Option<PhaseFieldCounts> {
        let counts = self.bodies.iter().filter_map(|body| body.fracture.as_ref()).map(|f| f.field.counts);
        counts.reduce(PhaseFieldCounts::plus)
    }

    /// Heap memory of mechanics and of the phase fields, without that of boundaries, bytes.
    pub(crate) fn bytes(&self) -> [usize; 2] {
        let of_bodies = self.bodies.iter().map(TotalFrame::bytes);
        of_bodies.fold([0; 2], |sum, bytes| [sum[0] + bytes[0], sum[1] + bytes[1]])
    }

    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.levels.iter_mut().try_for_each(|levels| levels.exchange(archive, &mut self.bodies))?;
        self.bodies.iter_mut().try_for_each(|body| body.exchange(archive))?;
        if let Some(contact) = &mut self.contact {
            contact.exchange(archive)?;
            if archive.is_reader() {
                let outlines = self.bodies.iter().filter_map(TotalFrame::outline).collect();
                contact.find(outlines, self.bodies[0].time(), 0.0).map_err(StateError::of_another_scene)?;
            }
        }
        Ok(())
    }
}

/// A body of a scene with several, or with contact, on the spans that it reaches into. The first one has the
/// J-integrals.
fn of_body(scene: &Scene, body: &Body, is_first: bool) -> Result<TotalFrame, Failure> {
    let mesh = scene.mesh.around(&body.shape);
    let (low, high) = body.shape.bounding_box();
    let boundaries = scene.boundaries.iter().filter(|boundary| {
        let along = boundary.side.along();
        let meets = boundary.part.is_none_or(|[from, to]| from < high[along] && low[along] < to);
        meets && scene.mesh.is_reached(boundary.side, &body.shape)
    });
    let mut output = scene.output.clone();
    output.probes.retain(|probe| body.shape.contains_within(probe.at, ROUND_OFF));
    output.j_integrals.retain(|_| is_first);
    let boundaries = boundaries.cloned().collect();
    let alone = Scene { bodies: vec![body.clone()], boundaries, mesh, output, ..scene.clone() };
    let mut frame = TotalFrame::new(&alone)?;
    if let Some(contact) = &scene.contact {
        frame.expect_contact(body, &alone.mesh, contact)?;
    }
    Ok(frame)
}

/// What is recorded of a body, by its control points.
fn sample_body(body: &TotalFrame, sample: &Sample, name: &str) -> BodySample {
    let masses = &body.mass.row_sums;
    let sum = |value: &dyn Fn(usize) -> f64| -> f64 {
        masses.iter().enumerate().filter(|(_, mass)| **mass > 0.0).map(|(at, mass)| mass * value(at)).sum()
    };
    let mass = sum(&|_| 1.0);
    let (at_rest, displacement, velocity) = (body.control_positions(), &body.displacement, &body.velocity);
    let position = |d: usize, at: usize| at_rest[d][at] + displacement[d][at];
    let center = [0, 1].map(|d| sum(&|at| position(d, at)) / mass);
    let mean = [0, 1].map(|d| sum(&|at| velocity[d][at]) / mass);
    let arm = |at: usize| [0, 1].map(|d| position(d, at) - center[d]);
    let moment = sum(&|at| arm(at)[0] * (velocity[1][at] - mean[1]) - arm(at)[1] * (velocity[0][at] - mean[0]));
    let inertia = sum(&|at| arm(at).iter().map(|x| x * x).sum());
    let mass = mass * body.thickness;
    BodySample { name: name.to_string(), mass, center, velocity: mean, spin: moment / inertia, kinetic: sample.kinetic }
}
