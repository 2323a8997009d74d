//! How far material is distorted, which small strains do not follow.

use super::TotalFrame;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::BROKEN;
use crate::material::hencky::Distortion;
use crate::scene::Kinematics;
use crate::transfer::kernels::LargestDistortion;
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::sweep;

impl TotalFrame {
    /// Where material that is not broken is distorted most (m, at t = 0) and how, if that is beyond a limit;
    /// `None` with finite strains.
    pub(crate) fn distorted_beyond(&self, limit: f64) -> Option<([f64; 2], Distortion)> {
        if self.kinematics == Kinematics::Finite || self.largest_distortion() <= limit {
            return None;
        }
        let mut most: Option<([f64; 2], Distortion)> = None;
        self.lattice.for_each_point(|batch, lane, position, _| {
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let gradient = self.displacement.each_ref().map(|u| functions.interpolate(u).gradient);
            let broken = self.fracture.as_ref().is_some_and(|fracture| fracture.phase[batch][lane] < BROKEN);
            let found = Distortion::of(&gradient, self.fracture.is_none());
            if !broken && found.size() > most.map_or(limit, |(_, most)| most.size()) {
                most = Some((position, found));
            }
        });
        most
    }

    /// An upper bound: the tangent of the largest angle, or the largest strain of a body that cannot break.
    fn largest_distortion(&self) -> f64 {
        let lattice = &self.lattice;
        let phase = self.fracture.as_ref().map_or(&[][..], |fracture| &fracture.phase);
        let mut phases = phase.chunks(lattice.strip_batches());
        let mut kernel = |_| LargestDistortion { phase: phases.next().unwrap_or_default(), size: Lane::ZERO };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(&mut kernel).collect();
        let fields = Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase: &[] };
        sweep(lattice, fields, &mut kernels, None);
        kernels.iter().flat_map(|kernel| kernel.size.0).fold(0.0, larger)
    }
}

#[cfg(test)]
mod tests {
    use crate::Simulation;
    use crate::example::pulled_plate;
    use crate::scene::{Crack, CrackKind};

    /// What fills up a batch of points, or lies beside a slit, is no material.
    #[test]
    fn only_material_is_distorted() {
        let mut scene = pulled_plate(1e6);
        scene.bodies[0].cracks = vec![Crack { points: vec![[0.0, 0.0025], [0.004, 0.0025]], kind: CrackKind::Slit }];
        let mut simulation = Simulation::new(&scene).unwrap();
        for _ in 0..60 {
            simulation.step().unwrap();
        }
        let frame = simulation.total_frame().unwrap();
        let (_, most) = frame.distorted_beyond(0.0).unwrap();
        let ratio = frame.largest_distortion() / most.size();
        assert!((ratio - 1.0).abs() <= 1e-3, "{ratio}");
    }
}
