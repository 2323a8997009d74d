//! Memory of a scene that is too large to be prepared: measured with a coarser one, and carried on by what is
//! counted of both and of one that is coarser still.

use fisura::Scene;
use fisura::simulation::{Extent, Simulation};
use fisura::validate::expected_size;
use fisura_verification::scene_run::peak_memory_mb;

use super::trial::{Trial, coarser};

/// Most spans of the coarser scene.
const COARSER: usize = 200_000;

/// A coarser scene that was tried.
pub(super) struct Tried {
    /// Points, as expected of the scene.
    pub points: f64,
    /// What its steps took.
    pub trial: Trial,
    /// Numbers of points and heap memory of the coarser scene.
    pub extent: Extent,
    /// Memory of this process before and its peak, 10⁶ bytes; none where the system does not tell.
    peaks_mb: Option<[f64; 2]>,
}

impl Tried {
    /// None of a patch that cannot be made coarser.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let program_mb = peak_memory_mb();
        let coarse = coarser(scene, COARSER)?;
        let mut simulation = Simulation::new(&coarse).ok()?;
        let trial = Trial::of(&coarse, &mut simulation).ok()??;
        let (points, extent) = (expected_size(&coarse).points as f64, simulation.extent());
        let peaks_mb = program_mb.zip(trial.memory_mb).map(|(program, peak)| [program, peak]);
        Some(Self { points, trial, extent, peaks_mb })
    }

    /// Largest memory of a run of the scene with so many points, 10⁶ bytes.
    pub(super) fn memory_mb(&self, scene: &Scene, points: f64) -> Option<f64> {
        let small = coarser(scene, COARSER / 4)?;
        let (few, extent) = (expected_size(&small).points as f64, Simulation::new(&small).ok()?.extent());
        let [program, peak] = self.peaks_mb?;
        let growth = growth([[few, bytes(&extent)], [self.points, bytes(&self.extent)]], points);
        Some(program + growth * (peak - program))
    }
}

fn bytes(extent: &Extent) -> f64 {
    (extent.mechanics_bytes + extent.phase_field_bytes) as f64
}

/// Bytes of so many points over those of the larger of two scenes, given points and bytes of both: a part
/// grows with the points, a part, such as that of boundaries, with their root.
fn growth([[few, small], [many, large]]: [[f64; 2]; 2], points: f64) -> f64 {
    let [s, m, l] = [few, many, points].map(f64::sqrt);
    let slope = (large / m - small / s) / (m - s);
    if few < many && slope > 0.0 { (slope * l * l + (large / m - slope * m) * l) / large } else { points / many }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_and_their_boundaries_grow_at_their_own_rates() {
        let bytes = |points: f64| 100.0 * points + 5e4 * points.sqrt();
        let found = growth([1e5, 4e5].map(|n| [n, bytes(n)]), 4e6);
        assert!((found / (bytes(4e6) / bytes(4e5)) - 1.0).abs() < 1e-12, "{found}");
        assert_eq!(growth([[1e5, 1e7], [1e5, 1e7]], 4e5), 4.0);
    }
}
