//! The points of a body in the total frame, one by one, for looking at a run that broke down.

use super::TotalFrame;
use crate::inspection::{PointFracture, PointState};
use crate::lane::Lane;
use crate::split::split;

impl TotalFrame {
    /// Calls `f` with the state of every point.
    pub(crate) fn for_each_point_state(&self, f: &mut dyn FnMut(PointState)) {
        let mut point = 0;
        self.lattice.for_each_point(|batch, lane, position, _| {
            let [x, y] = self.displacement.each_ref().map(|u| self.patch.evaluate(u, position).unwrap_or_default());
            let (strain, _) = self.strain([x.gradient, y.gradient]);
            let lanes = strain.map(Lane::splat);
            let fracture = self.fracture.as_ref();
            let stress = match fracture {
                None => self.moduli.stress(lanes).map(|s| s[0]),
                Some(fracture) => {
                    let state = split(&self.moduli, fracture.model.split, lanes);
                    let g = fracture.model.degradation(Lane::splat(fracture.phase[batch][lane]))[0];
                    [0, 1, 2].map(|i| state.stress_minus[i][0] + g * state.stress_plus[i][0])
                }
            };
            let fracture =
                fracture.map(|f| PointFracture { history: f.history[batch][lane], phase: f.phase[batch][lane] });
            f(PointState { body: 0, point, position, strain, stress, fracture });
            point += 1;
        });
    }
}
