//! What is read from the bodies of the updated frame: energies, momenta, crack tip.

use std::borrow::Cow;

use super::field::DiscreteField;
use super::{UpdatedFrame, views};
use crate::contact::ContactLedger;
use crate::contact::impulse::{ContactForce, Push, Unconverged};
use crate::dynamics::energy::{ContactSample, FractureSample, Sample};
use crate::linear_algebra::control_grid::VectorField;
use crate::material::degradation::BROKEN;
use crate::material::hencky::{Gradient, growth};
use crate::output::inspection::InvertedPoint;
use crate::particles::points::Point;
use crate::phase_field::PhaseFieldCounts;
use crate::phase_field::fracture::{BrokenPoint, CrackTip, crack_tip, most_broken};

impl UpdatedFrame {
    /// Remembers where cracks begin that were not there at the start.
    pub(crate) fn note_crack_start(&mut self) {
        self.fields.iter_mut().for_each(DiscreteField::note_crack_start);
    }

    /// Energies, momenta and crack tip at the present whole step; `dt` is the step in use. Closure is left at
    /// zero.
    pub fn sample(&self, dt: f64) -> Sample {
        let dt = self.fields[0].last_step().unwrap_or(dt);
        let mut accelerations: Vec<_> =
            self.fields.iter().map(|field| Cow::Borrowed(&field.nodes.acceleration)).collect();
        let contact = self.contact.as_ref().map(|contact| {
            let (pushes, ledger) = contact.coming(&views(&self.fields), self.coming_kick(dt));
            for Push { body, at, acceleration } in pushes {
                let pushed = accelerations[body].to_mut();
                (0..2).for_each(|c| pushed[c][at] += acceleration[c]);
            }
            ledger
        });
        let bodies: Vec<Sample> =
            self.fields.iter().zip(&accelerations).map(|(field, a)| field.sample(dt, a)).collect();
        let recorded = self.recorded.as_ref().map(|names| self.sample_bodies(names, &bodies, dt));
        let mut sample = bodies.into_iter().reduce(Sample::with).expect("a scene has a body");
        if let Some(ContactLedger { loss, friction, work }) = contact {
            sample.external_work += work;
            sample.contact = Some(ContactSample { loss, friction });
        }
        Sample { bodies: recorded, fragments: self.fragment_areas(), ..sample.for_thickness(self.thickness) }
    }

    /// Time since the start of the run, s.
    pub fn time(&self) -> f64 {
        self.fields.first().map_or(0.0, |field| field.time)
    }

    /// Forces of contact now; `dt` is the step in use.
    pub fn contact_forces(&self, dt: f64) -> Vec<ContactForce> {
        self.contact
            .as_ref()
            .map_or_else(Vec::new, |contact| contact.forces(&views(&self.fields), self.coming_kick(dt)))
    }

    /// Mass (kg) and momentum (kg m/s) of every field, with the velocities of half a step before.
    pub(crate) fn momenta(&self, _dt: f64) -> Vec<(f64, [f64; 2])> {
        self.fields.iter().map(|field| (field.mass(), field.momentum())).collect()
    }

    /// Whether the impulses of contact of the coming step converge; `dt` is the step in use.
    ///
    /// # Errors
    /// If they do not.
    pub(crate) fn contact_converges(&self, dt: f64) -> Result<(), Unconverged> {
        self.contact.as_ref().map_or(Ok(()), |contact| contact.converges(&views(&self.fields), self.coming_kick(dt)))
    }

    /// Where the boundary of a body was without material first, m, if one ever was.
    pub fn opened_boundary(&self) -> Option<[f64; 2]> {
        self.fields.iter().find_map(|field| field.surface.as_ref()?.opened)
    }

    /// Elastic energy of all bodies for the thickness of the scene, J.
    pub fn elastic_energy(&self) -> f64 {
        self.fields.iter().map(|field| field.elastic_energy()).sum()
    }

    /// External work so far, J.
    pub fn external_work(&self) -> f64 {
        let rigid = self.contact.as_ref().map_or(0.0, |contact| contact.ledger.work) * self.thickness;
        self.fields.iter().map(|field| field.external_work()).sum::<f64>() + rigid
    }

    /// Counters of the phase fields, if there are any.
    pub(crate) fn phase_field_counts(&self) -> Option<PhaseFieldCounts> {
        let counts = self.fields.iter().filter_map(|field| field.fracture.as_ref()).map(|f| f.field.counts);
        counts.reduce(PhaseFieldCounts::plus)
    }

    /// Position (m) of the fastest control point with mass, and its speed (m/s), infinite if it is no number.
    pub fn fastest_control_point(&self) -> ([f64; 2], f64) {
        let fastest = self.fields.iter().map(|field| field.fastest_place());
        fastest.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(([0.0; 2], 0.0), |(square, place)| (place, square.sqrt()))
    }

    /// The point of a body that is turned inside out furthest, if one is; small strains know none.
    pub(crate) fn inverted_point(&self) -> Option<InvertedPoint> {
        self.fields.iter().filter_map(DiscreteField::inverted_point).reduce(InvertedPoint::worse)
    }

    /// Heap memory of mechanics and of the phase fields, without that of boundaries, bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let of_fields = self.fields.iter().map(DiscreteField::bytes);
        of_fields.fold([0; 2], |sum, bytes| [sum[0] + bytes[0], sum[1] + bytes[1]])
    }
}

impl DiscreteField {
    /// Energies, momenta and crack tip of a body a metre thick at the present whole step with the given
    /// accelerations (m/s²); `dt` is the step in use. Closure is left at zero.
    pub(super) fn sample(&self, dt: f64, acceleration: &VectorField) -> Sample {
        let nodes = &self.nodes;
        let mut acceleration = Cow::Borrowed(acceleration);
        let conditions = self.edges.as_ref().map(|edges| {
            let forces = edges.hold(acceleration.to_mut(), self.kick_length(edges.step));
            edges.samples(&forces)
        });
        let half = if self.at_start { 0.0 } else { fault!("half-step-velocity", 0.5 * dt => 0.0) };
        let (mut kinetic, mut stagger, mut momentum, mut angular) = (0.0, 0.0, [0.0; 2], 0.0);
        for at in nodes.grid.indices() {
            let m = nodes.mass[at];
            let a = [0, 1].map(|c| acceleration[c][at]);
            let v = [0, 1].map(|c| nodes.velocity[c][at] + half * a[c]);
            kinetic += 0.5 * m * (v[0] * v[0] + v[1] * v[1]);
            stagger += fault!("stagger-doubled", 0.125 => 0.25) * dt * dt * m * (a[0] * a[0] + a[1] * a[1]);
            momentum = [momentum[0] + m * v[0], momentum[1] + m * v[1]];
            let [x, y] = nodes.position(at);
            angular += m * (x * v[1] - y * v[0]);
        }
        let fracture = self.fracture.as_ref().map(|f| FractureSample {
            energy: f.surface_energy,
            works: f.model.driving_work().map(|name| (name, self.ledger.history_work)).into_iter().collect(),
            crack_tip: self.crack_tip(),
            min_phase: f.least_phase,
            iterations: f.iterations,
        });
        Sample {
            time: self.time,
            kinetic,
            stagger,
            elastic: self.elastic_energy,
            fracture,
            external_work: self.ledger.external_work,
            conditions: conditions.unwrap_or_default(),
            transfer_loss: Some(self.ledger.transfer_loss),
            momentum,
            angular_momentum: angular,
            time_step: dt,
            ..Sample::default()
        }
    }

    /// Tip of the crack: the broken place that is furthest from where the crack begins; `None` without a
    /// crack.
    pub fn crack_tip(&self) -> Option<CrackTip> {
        let phase = self.fracture.as_ref()?.field.control_values();
        let gradient = |position| self.patch.evaluate(phase, position).unwrap_or_default().gradient;
        crack_tip(self.crack_start?, &self.broken_points(), gradient)
    }

    /// Remembers where a crack begins that was not there at the start.
    pub(super) fn note_crack_start(&mut self) {
        if self.crack_start.is_none() {
            self.crack_start = most_broken(&self.broken_points());
        }
    }

    fn broken_points(&self) -> Vec<BrokenPoint> {
        let states = self.fracture.iter().flat_map(|fracture| &fracture.points);
        let broken = self.points.iter().zip(states).filter(|(_, state)| state.phase < BROKEN);
        broken
            .map(|(point, state)| BrokenPoint {
                position: point.position,
                phase: state.phase,
                spacing: point.volume.sqrt(),
            })
            .collect()
    }

    fn inverted_point(&self) -> Option<InvertedPoint> {
        let gradients = self.deformation.as_ref()?.iter().map(growth).zip(&self.points).enumerate();
        let inverted = gradients.filter(|(_, (determinant, _))| *determinant <= 0.0);
        let named =
            inverted.map(|(point, (determinant, at))| InvertedPoint { point, position: at.position, determinant });
        named.reduce(InvertedPoint::worse)
    }

    /// Elastic energy for the thickness of the scene, J.
    pub fn elastic_energy(&self) -> f64 {
        self.elastic_energy * self.thickness
    }

    /// External work so far, J.
    pub fn external_work(&self) -> f64 {
        self.ledger.external_work * self.thickness
    }

    /// Momentum of the points with their velocities half a step back, kg m/s.
    pub fn momentum(&self) -> [f64; 2] {
        let sum = |d: usize| self.points.iter().map(|p| p.volume * p.velocity[d]).sum::<f64>();
        [0, 1].map(|d| self.density * self.thickness * sum(d))
    }

    /// Mass of the points for the thickness of the scene, kg.
    pub fn mass(&self) -> f64 {
        self.density * self.thickness * self.points.iter().map(|p| p.volume).sum::<f64>()
    }

    /// Square of the speed (infinite if it is no number) and position (m) of the fastest control point.
    fn fastest_place(&self) -> (f64, [f64; 2]) {
        let [vx, vy] = &self.nodes.velocity;
        let speed = |at: usize| {
            let speed = vx[at] * vx[at] + vy[at] * vy[at];
            (if speed.is_nan() { f64::INFINITY } else { speed }, at)
        };
        let (speed, at) = self.nodes.grid.indices().map(speed).max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default();
        (speed, self.nodes.position(at))
    }

    /// Time since the start of the run, s.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Length of the last step, s, if there was one.
    fn last_step(&self) -> Option<f64> {
        (!self.at_start).then_some(self.last_step)
    }

    /// Heap memory of mechanics and of the phase field, without that of boundaries, bytes.
    pub fn bytes(&self) -> [usize; 2] {
        let points = self.points.len() * size_of::<Point>() + self.cells.bytes();
        let gradients = self.affine.iter().map(|affine| &affine.gradients).chain(&self.deformation);
        let gradients: usize = gradients.map(|gradients| gradients.len() * size_of::<Gradient>()).sum();
        let nodes = 8 * 21 * self.nodes.grid.len(); // fields of NodalFields and VelocityTransfer
        [points + gradients + nodes, self.fracture.as_ref().map_or(0, |fracture| fracture.bytes())]
    }
}
