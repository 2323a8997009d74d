//! What is solved for each exact solution, and the loads it needs.

use std::fmt;
use std::sync::Arc;

use fisura::dynamics::forcing::{Forcing, VolumeLoad};
use fisura::scene::{Frame, Kinematics, Side};

use crate::case::convergence::{ConvergenceSetup, Loading, PatchFamily};
use crate::exact::{self, Equation, ExactSolution, Held};
use crate::scene::plain::ROLLERS;

/// Name of the problem that projects the displacement of elastostatics.
const PROJECTION: &str = "projection";

/// A problem of a convergence study.
#[derive(Clone)]
pub(super) struct Problem {
    pub equation: Equation,
    pub solution: Arc<dyn ExactSolution>,
    /// Sides on which components are prescribed.
    pub held: Vec<(Side, [bool; 2])>,
    /// End of the simulated time, s.
    pub end_time: f64,
    /// Small strains, or the Hencky law.
    pub kinematics: Kinematics,
}

/// The problem of a setup; an error message if no study solves it in that frame.
///
/// Small kinematics in the total frame are `P = E (F − 1)` in a bar, at any amplitude. A wave stands
/// between rollers on a rectangle; on a curved patch its exact traction acts on all sides.
pub(super) fn find(setup: &ConvergenceSetup) -> Result<Problem, String> {
    let name = setup.problem.as_str();
    let projected = (name == PROJECTION && setup.frame == Frame::Total).then_some("elastostatics");
    let found = exact::find(projected.unwrap_or(name)).filter(|solution| solution.frames.contains(&setup.frame));
    let Some(solution) = found else {
        let solved =
            exact::all().filter(|solution| solution.frames.contains(&setup.frame)).map(|solution| solution.name);
        let known: Vec<&str> = solved.chain((setup.frame == Frame::Total).then_some(PROJECTION)).collect();
        return Err(format!("no convergence study solves for {name:?} in this frame; known: {}", known.join(", ")));
    };
    use PatchFamily::{Annulus, Bent, Disc, Holed, Weighted};
    let curved = matches!(setup.patch, Bent | Annulus | Weighted | Holed | Disc);
    let held = match solution.held {
        _ if projected.is_some() => &[],
        Held::Sides(sides) => sides,
        Held::Axes if setup.patch == Holed => &[(Side::Bottom, [false, true]), (Side::Left, [true, false])],
        Held::Axes => &[(Side::Bottom, [false, true]), (Side::Top, [true, false])],
        Held::Rollers if curved => &[],
        Held::Rollers => &ROLLERS[..],
    };
    Ok(Problem {
        equation: if projected.is_some() { Equation::Projection } else { solution.equation },
        solution: (solution.fields)(setup.plane).into(),
        held: held.to_vec(),
        end_time: solution.end_time,
        kinematics: solution.kinematics,
    })
}

/// The loads that make an exact solution one of the discrete problem.
pub(super) struct Manufactured {
    pub solution: Arc<dyn ExactSolution>,
    pub loading: Loading,
    /// Coefficient of the gradient term (m²), where there is a phase field.
    pub diffusion: f64,
    /// Whether gradients are those at the moved points, on which Kirchhoff's stress works.
    pub moved: bool,
}

impl fmt::Debug for Manufactured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Manufactured({:?})", self.loading)
    }
}

impl Forcing for Manufactured {
    fn acts_inside(&self) -> bool {
        self.loading == Loading::Weak || !self.solution.is_force_free()
    }

    fn volume(&self, position: [f64; 2], time: f64) -> VolumeLoad {
        match self.loading {
            Loading::Strong => VolumeLoad { force: self.solution.body_force(position, time), ..VolumeLoad::default() },
            Loading::Weak => {
                let density = self.solution.material().density;
                let force = self.solution.acceleration(position, time).map(|a| density * a);
                let stress = self.solution.stress(position, time);
                if !self.moved {
                    return VolumeLoad { force, stress };
                }
                let gradient = self.solution.displacement_gradient(position, time);
                VolumeLoad { force, stress: kirchhoff(stress, gradient) }
            }
        }
    }

    fn traction(&self, position: [f64; 2], normal: [f64; 2], time: f64) -> [f64; 2] {
        match self.loading {
            Loading::Strong => {
                let stress = self.solution.stress(position, time);
                [0, 1].map(|i| stress[i][0] * normal[0] + stress[i][1] * normal[1])
            }
            Loading::Weak => [0.0; 2],
        }
    }

    fn phase_source(&self, position: [f64; 2], time: f64) -> f64 {
        self.solution.phase().map_or(1.0, |phase| phase.source(position, time))
    }

    fn phase_flux(&self, position: [f64; 2], normal: [f64; 2], time: f64) -> f64 {
        let gradient = self.solution.phase().map_or([0.0; 2], |phase| phase.gradient(position, time));
        self.diffusion * (gradient[0] * normal[0] + gradient[1] * normal[1])
    }
}

/// Kirchhoff's stress `P Fᵀ` from that of Piola–Kirchhoff and the displacement gradient.
fn kirchhoff(stress: [[f64; 2]; 2], gradient: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    [0, 1].map(|i| [0, 1].map(|j| stress[i][j] + stress[i][0] * gradient[j][0] + stress[i][1] * gradient[j][1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kirchhoff_stress_is_symmetric_and_piola_without_strain() {
        let stress = [[2.0, 0.5], [0.5, -1.0]];
        assert_eq!(kirchhoff(stress, [[0.0; 2]; 2]), stress);
        let vortex = (exact::find("vortex").unwrap().fields)(fisura::scene::Plane::Strain);
        let (x, t) = ([0.7, 0.6], 0.4);
        let tau = kirchhoff(vortex.stress(x, t), vortex.displacement_gradient(x, t));
        assert!(tau[0][1].abs() > 1e-3 && (tau[0][1] - tau[1][0]).abs() < 1e-14);
    }
}
