//! Free vibration of a bar over many periods: what velocity Verlet conserves and what only oscillates.
//!
//! The bar stands between rollers (nu = 0) and starts from its first mode at full speed. The staggered energy
//! `½ vᵀ M v − dt²/8 aᵀ M a + U` is constant; at whole steps the energy `½ vᵀ M v + U` oscillates by
//! `(ω dt)²/4` from peak to peak, and does not drift. Drift is the difference of the means over the first and
//! the second half of the run, both with a window that suppresses the oscillation itself.

use fisura::dynamics::total_frame::TotalFrame;
use fisura::scene::{Mass, Mesh};

use super::{Case, CaseScene, Findings, StudyError, other, projected, theory};
use crate::extremes::spread;
use crate::scene::plain::PlainScene;

const SPANS: usize = 16;
const PERIODS: f64 = 100.0;
/// Time step over the critical one.
const SAFETY: f64 = 0.2;

pub(super) fn study(_case: &Case, _scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    for degree in 1..=3 {
        for (mass, word) in [(Mass::Consistent, "consistent"), (Mass::Lumped, "lumped")] {
            let quantities = [
                ("energy at whole steps, oscillation over (omega dt)^2", theory(0.25, "velocity Verlet")),
                ("energy at whole steps, relative drift", None),
                ("staggered energy, relative spread", None),
            ];
            findings.measure(&format!("p={degree}, {word} mass"), quantities, || vibrate(degree, mass))?;
        }
    }
    Ok(())
}

/// Oscillation and drift of the energy at whole steps, and spread of the staggered one.
fn vibrate(degree: usize, mass: Mass) -> Result<[f64; 3], StudyError> {
    let height = 2.0 / SPANS as f64;
    let mesh = Mesh::uniform([degree; 2], [0.0; 2], [1.0, height], [SPANS, 2]);
    let scene = PlainScene::unit_bar(mesh, mass).scene();
    let broken = || other("no phase field is expected");
    let mut frame = TotalFrame::new(&scene).map_err(|_| broken())?;
    let velocity = projected(&frame, |[x, _]| [(std::f64::consts::PI * x).sin(), 0.0])?;
    let still = [frame.lattice.grid.zeros(), frame.lattice.grid.zeros()];
    frame.start_with(still, velocity).map_err(|_| broken())?;
    let dt = SAFETY * frame.critical_step();
    let phase = std::f64::consts::PI * dt;
    let steps = (PERIODS * std::f64::consts::TAU / phase).ceil() as usize;
    let (mut whole, mut staggered) = (vec![], vec![]);
    for _ in 0..steps {
        crate::watch::check()?;
        frame.step(dt).map_err(|_| broken())?;
        let sample = frame.sample(dt);
        whole.push(sample.kinetic + sample.elastic);
        staggered.push(sample.kinetic - sample.stagger + sample.elastic);
    }
    Ok([relative_spread(&whole) / (phase * phase), drift(&whole), relative_spread(&staggered)])
}

/// Largest minus smallest, over the first.
fn relative_spread(values: &[f64]) -> f64 {
    spread(values) / values[0]
}

/// Mean with a Blackman–Harris window, whose side lobes lie 92 dB below its main one.
fn windowed_mean(values: &[f64]) -> f64 {
    let weight = |i: usize| {
        let t = std::f64::consts::TAU * (i as f64 + 0.5) / values.len() as f64;
        0.35875 - 0.48829 * t.cos() + 0.14128 * (2.0 * t).cos() - 0.01168 * (3.0 * t).cos()
    };
    let (sum, total) = values.iter().enumerate().fold((0.0, 0.0), |(s, w), (i, e)| (s + weight(i) * e, w + weight(i)));
    sum / total
}

/// Difference of the means of both halves, over the first.
fn drift(energies: &[f64]) -> f64 {
    let (first, second) = energies.split_at(energies.len() / 2);
    let [first, second] = [first, second].map(windowed_mean);
    (second - first).abs() / first
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_hides_the_oscillation_and_shows_the_drift() {
        let energy = |growth: f64| move |i: i32| 1.0 + 1e-3 * (0.3 * f64::from(i)).cos() + growth * f64::from(i);
        let found = |growth| drift(&(0..5000).map(energy(growth)).collect::<Vec<_>>());
        assert!(found(0.0) < 1e-9);
        approx::assert_relative_eq!(found(1e-8), 2500.0 * 1e-8, max_relative = 1e-3);
    }
}
