//! One step of a body whose spans integrate, and what is read from it.

use std::borrow::Cow;

use super::OnPatch;
use crate::contact::gap_potential::GapForce;
use crate::contact::gap_potential::arc::Outline;
use crate::dynamics::energy::Sample;
use crate::dynamics::failure::Failure;
use crate::dynamics::updated_frame::field::DiscreteField;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::vectors::dot;

impl DiscreteField {
    /// One time step of `dt` seconds but for its last solve, which contact comes before (see [the
    /// module](super)).
    ///
    /// # Errors
    /// If a point leaves the patch, a solve does not converge, or the body is turned inside out.
    pub(in super::super) fn step_with_spans(&mut self, dt: f64) -> Result<(), Failure> {
        self.relax_velocities(dt).map_err(Failure::Spans)?; // v_p(n−1/2) towards the velocity of the grid
        let before = self.body_forces();
        let kick = self.kick_length(dt);
        self.book_change_of_step(dt, Self::half_square_of_accelerations);
        self.kick_points(kick, &before); // v_p(n+1/2) = v_p(n−1/2) + dt [a(x_p) − s + b_p]
        self.book_work(0.5 * dt, &before); // dt/2 Σ m b(n) · v(n+1/2)
        self.drift_points(dt); // x_p(n+1) = x_p(n) + dt v_p(n+1/2)
        self.time += dt;
        self.at_start = false;
        self.last_step = dt;
        let after = self.renewed(before); // b_p(n+1)
        self.book_work(0.5 * dt, &after); // dt/2 Σ m b(n+1) · v(n+1/2)
        self.sort()?;
        self.find_forces_of_spans() // D, F, sigma at x(n+1); contact adds its forces, and then M a = f
    }

    /// Displacement, forces and accelerations at the present positions, without contact.
    pub(in super::super) fn respond_with_spans(&mut self) -> Result<(), Failure> {
        self.find_forces_of_spans()?;
        self.accelerate_with_spans()
    }

    /// Displacement and forces of the stresses at the present positions.
    fn find_forces_of_spans(&mut self) -> Result<(), Failure> {
        let Self { patch, cells, points, spans, .. } = self;
        if let Some(spans) = spans {
            self.elastic_energy = spans.find_forces(OnPatch { patch, cells, points })?;
        }
        Ok(())
    }

    /// Accelerations of the points by all forces, where spans integrate.
    pub(in super::super) fn accelerate_with_spans(&mut self) -> Result<(), Failure> {
        let Self { patch, cells, points, spans, .. } = self;
        spans.as_mut().map_or(Ok(()), |spans| spans.accelerate(OnPatch { patch, cells, points }))
    }

    /// The boundary of a body whose spans integrate, if it may meet others.
    pub(in super::super) fn outline(&self) -> Option<Outline> {
        self.spans.as_ref()?.outline()
    }

    /// Takes the force of a pair on this body, which is its `side`.
    pub(in super::super) fn push(&mut self, pair: &GapForce, side: usize) {
        let Self { patch, spans, .. } = self;
        if let Some(spans) = spans {
            spans.push(patch, pair, side);
        }
    }

    /// Once in the time a wave takes through half a span, velocities are relaxed by that part of it.
    fn relax_velocities(&mut self, dt: f64) -> Result<(), SolveFailure> {
        let Self { patch, cells, points, spans: Some(spans), moduli, density, .. } = self else { return Ok(()) };
        let courant = dt * moduli.dilatational_speed(*density) / patch.shortest_span();
        let every = (0.5 / courant).round().max(1.0) as usize;
        if spans.since_relaxation >= every {
            let beta = (every as f64 * courant).min(1.0);
            let loss = spans.relax(patch, cells, points, beta)?;
            spans.since_relaxation = 0;
            self.losses.relaxation += fault!("relaxation-unbooked", loss => 0.0);
            self.ledger.transfer_loss = self.losses.sum();
        }
        if let Some(spans) = &mut self.spans {
            spans.since_relaxation += 1;
        }
        Ok(())
    }

    /// Force per mass on each point at the present time, m/s²: that of half a step ago without a load that
    /// changes.
    fn renewed(&mut self, before: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        let Some(forcing) = &mut self.forcing else { return before };
        forcing.renew(&self.points, self.time);
        self.body_forces()
    }

    /// Force per mass on each point, m/s².
    fn body_forces(&self) -> Vec<[f64; 2]> {
        let of_load = |at: usize| self.forcing.as_ref().map_or([0.0; 2], |forcing| forcing.force(at));
        let per_mass = |at: usize| {
            let force = of_load(at);
            [0, 1].map(|c| self.gravity[c] + force[c] / self.density)
        };
        (0..self.points.len()).map(per_mass).collect()
    }

    fn kick_points(&mut self, dt: f64, forces: &[[f64; 2]]) {
        let Self { points, spans: Some(spans), .. } = self else { return };
        for ((point, a), b) in points.iter_mut().zip(&spans.point_acceleration).zip(forces) {
            (0..2).for_each(|c| point.velocity[c] += dt * (a[c] + b[c]));
        }
    }

    fn drift_points(&mut self, dt: f64) {
        let mut fastest = 0.0;
        for point in &mut self.points {
            for c in 0..2 {
                let moved = dt * point.velocity[c];
                point.displacement[c] += moved;
                point.position[c] += moved;
                fastest = larger(fastest, moved.abs());
            }
        }
        self.travelled += std::f64::consts::SQRT_2 * fastest;
    }

    fn book_work(&mut self, dt: f64, forces: &[[f64; 2]]) {
        let power: f64 = self
            .points
            .iter()
            .zip(forces)
            .map(|(point, b)| point.volume * (b[0] * point.velocity[0] + b[1] * point.velocity[1]))
            .sum();
        self.ledger.external_work += dt * self.density * power;
    }

    /// Control values of the velocity, m/s: where spans integrate, those that fit the points.
    pub(in super::super) fn grid_velocity(&self) -> Cow<'_, VectorField> {
        let Self { patch, cells, points, nodes, .. } = self;
        let fitted = self.spans.as_ref().map(|spans| spans.fitted_velocity(OnPatch { patch, cells, points }));
        fitted.map_or(Cow::Borrowed(&nodes.velocity), Cow::Owned)
    }

    /// Acceleration of each point, m/s², where spans integrate.
    pub fn point_accelerations(&self) -> Option<Vec<[f64; 2]>> {
        let spans = self.spans.as_ref()?;
        let sum = |(a, b): (&[f64; 2], [f64; 2])| [a[0] + b[0], a[1] + b[1]];
        Some(spans.point_acceleration.iter().zip(self.body_forces()).map(sum).collect())
    }

    /// `1/2 Σ m_p a_p²`, N²/kg.
    fn half_square_of_accelerations(&self) -> f64 {
        let accelerations = self.point_accelerations().unwrap_or_default();
        let squares = self.points.iter().zip(accelerations).map(|(point, a)| point.volume * dot(a, a));
        0.5 * self.density * squares.sum::<f64>()
    }

    /// Energies and momenta of the points at the present whole step; `dt` is the step in use.
    pub(in super::super) fn sample_points(&self, dt: f64) -> Option<Sample> {
        let accelerations = self.point_accelerations()?;
        let half = if self.at_start { 0.0 } else { 0.5 * dt };
        let mut sample = Sample {
            time: self.time,
            elastic: self.elastic_energy,
            external_work: self.ledger.external_work,
            transfer_loss: Some(self.ledger.transfer_loss),
            time_step: dt,
            ..Sample::default()
        };
        for (point, a) in self.points.iter().zip(&accelerations) {
            let m = self.density * point.volume;
            let v = [0, 1].map(|c| point.velocity[c] + half * a[c]);
            sample.kinetic += 0.5 * m * (v[0] * v[0] + v[1] * v[1]);
            sample.stagger += 0.125 * dt * dt * m * (a[0] * a[0] + a[1] * a[1]);
            (0..2).for_each(|c| sample.momentum[c] += m * v[c]);
            sample.angular_momentum += m * (point.position[0] * v[1] - point.position[1] * v[0]);
        }
        Some(sample)
    }
}
