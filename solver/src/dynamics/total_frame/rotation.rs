//! How far material is distorted, which small strains do not follow.

use super::TotalFrame;
use crate::linear_algebra::lane::LANES;
use crate::material::degradation::BROKEN;
use crate::material::hencky::{Distortion, Gradient};
use crate::phase_field::fracture::LatticeFracture;
use crate::scene::Kinematics;
use crate::transfer::directional::gradients;

impl TotalFrame {
    /// Where material that is not broken is distorted most (m, at t = 0) and how, if that is beyond a limit;
    /// `None` with finite strains.
    pub(crate) fn distorted_beyond(&self, limit: f64) -> Option<([f64; 2], Distortion)> {
        if self.kinematics == Kinematics::Finite {
            return None;
        }
        let mut most: Option<([f64; 2], Distortion)> = None;
        self.for_each_gradient(self.fracture.as_ref(), |batch, lane, gradient| {
            let found = Distortion::of(&gradient, self.fracture.is_none());
            if found.size() > most.map_or(limit, |(_, most)| most.size()) {
                most = Some((self.lattice.position(batch, lane), found));
            }
        });
        most
    }

    /// Calls `f` with the batch and the lane of every point that is not broken, and its displacement
    /// gradient; without `breaking` all count.
    pub(super) fn for_each_gradient(
        &self,
        breaking: Option<&LatticeFracture>,
        mut f: impl FnMut(usize, usize, Gradient),
    ) {
        let gradients = gradients(&self.lattice, &self.displacement);
        for (batch, [xx, xy, yx, yy]) in gradients.iter().enumerate().take(self.lattice.batches()) {
            let weight = self.lattice.weights_of(batch);
            let is_broken = |lane: usize| breaking.is_some_and(|fracture| fracture.phase[batch][lane] < BROKEN);
            for lane in (0..LANES).filter(|&lane| weight[lane] > 0.0 && !is_broken(lane)) {
                f(batch, lane, [[xx[lane], xy[lane]], [yx[lane], yy[lane]]]);
            }
        }
    }
}
