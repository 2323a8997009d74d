//! Masses and loads of the functions of several levels.

use super::super::TotalFrame;
use super::Levels;
use super::regions::Functions;
use crate::linear_algebra::interface::Interface;

impl Levels {
    /// Gives masses and loads to the functions in use.
    pub(super) fn share(&self, frames: &mut [TotalFrame], functions: &[Functions]) {
        let below = |level: usize| self.interface(level, frames, |at| functions[level + 1].known[at]);
        let insertions: Vec<Interface> = (0..self.insertions.len()).map(below).collect();
        let masses = self.truncated(frames, functions, &insertions, |level| &self.masses[level]);
        let of_load = |number: usize| {
            [0, 1].map(|d| self.truncated(frames, functions, &insertions, |level| &self.loads[level][number][d]))
        };
        let loads: Vec<[Vec<Vec<f64>>; 2]> = (0..frames[0].loads.len()).map(of_load).collect();
        for (level, (frame, mass)) in frames.iter_mut().zip(masses).enumerate() {
            frame.mass.set_row_sums(mass);
            for (load, [x, y]) in frame.loads.iter_mut().zip(&loads) {
                let forces = (0..x[level].len()).map(|at| (at, [x[level][at], y[level][at]]));
                load.forces = forces.filter(|(_, force)| *force != [0.0; 2]).collect();
            }
        }
    }

    /// Integrals of the functions in use from those of all functions, by level: a truncated function is what
    /// the finer ones that have values of their own leave of it.
    fn truncated<'a>(
        &self,
        frames: &[TotalFrame],
        functions: &[Functions],
        insertions: &[Interface],
        all: impl Fn(usize) -> &'a Vec<f64>,
    ) -> Vec<Vec<f64>> {
        let mut fields: Vec<Vec<f64>> = (0..frames.len()).map(|level| all(level).clone()).collect();
        let mut less = frames[frames.len() - 1].lattice.patch_grid.zeros(); // what finer ones take of each
        for level in (0..frames.len()).rev() {
            let lattice = &frames[level].lattice;
            let grid = lattice.patch_grid;
            let mut taken = lattice.onto_patch(all(level).clone());
            for at in grid.indices() {
                if !functions[level].whole[at] {
                    taken[at] = less[at];
                }
                let is_own = functions[level].is_own(at);
                fields[level][at] =
                    if is_own { fields[level][at] - fault!("mass-of-both-levels", less[at] => 0.0) } else { 0.0 };
            }
            if let Some(coarser) = level.checked_sub(1) {
                less = frames[coarser].lattice.patch_grid.zeros();
                insertions[coarser].fold(&mut taken, &mut less);
            }
        }
        fields
    }
}
