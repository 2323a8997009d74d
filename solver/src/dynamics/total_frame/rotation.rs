//! How far material has turned, which small strains do not follow.

use super::TotalFrame;
use crate::linear_algebra::extremes::larger;
use crate::linear_algebra::lane::Lane;
use crate::material::degradation::BROKEN;
use crate::material::hencky::rotation;
use crate::scene::Kinematics;
use crate::transfer::kernels::LargestRotation;
use crate::transfer::point_kernel::Fields;
use crate::transfer::sweep::sweep;

impl TotalFrame {
    /// Where material that is not broken has turned most (m, at t = 0) and by which angle, if that is beyond
    /// a limit, rad; `None` with finite strains.
    pub(crate) fn turned_beyond(&self, limit: f64) -> Option<([f64; 2], f64)> {
        if self.kinematics == Kinematics::Finite || self.largest_tangent() <= limit.tan() {
            return None;
        }
        let mut most: Option<([f64; 2], f64)> = None;
        self.lattice.for_each_point(|batch, lane, position, _| {
            let functions = self.lattice.functions_at(&self.patch, batch, lane);
            let gradient = self.displacement.each_ref().map(|u| functions.interpolate(u).gradient);
            let broken = self.fracture.as_ref().is_some_and(|fracture| fracture.phase[batch][lane] < BROKEN);
            let angle = rotation(&gradient).abs();
            if !broken && angle > most.map_or(limit, |(_, most)| most) {
                most = Some((position, angle));
            }
        });
        most
    }

    /// Tangent of the largest angle.
    fn largest_tangent(&self) -> f64 {
        let lattice = &self.lattice;
        let phase = self.fracture.as_ref().map_or(&[][..], |fracture| &fracture.phase);
        let mut phases = phase.chunks(lattice.strip_batches());
        let mut kernel = |_| LargestRotation { phase: phases.next().unwrap_or_default(), tangent: Lane::ZERO };
        let mut kernels: Vec<_> = (0..lattice.strips()).map(&mut kernel).collect();
        let fields = Fields { displacement: [&self.displacement[0], &self.displacement[1]], phase: &[] };
        sweep(lattice, fields, &mut kernels, None);
        kernels.iter().flat_map(|kernel| kernel.tangent.0).fold(0.0, larger)
    }
}
