//! What is solved for each exact solution, and the loads it needs.

use std::fmt;
use std::sync::Arc;

use fisura::forcing::{Forcing, VolumeLoad};
use fisura::scene::{Plane, Side};

use crate::case::convergence::{Loading, PatchFamily};
use crate::exact::{self, ExactSolution};

/// Which equation is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Least-squares projection of the displacement.
    Projection,
    /// Equilibrium.
    Static,
    /// The phase-field equation with a given history energy.
    PhaseField,
    /// Equations of motion, and the phase field where the solution has one.
    Dynamic,
}

/// A problem of a convergence study.
#[derive(Clone)]
pub(super) struct Problem {
    pub kind: Kind,
    pub solution: Arc<dyn ExactSolution>,
    /// Sides on which components are prescribed.
    pub held: Vec<(Side, [bool; 2])>,
    /// End of the simulated time, s.
    pub end_time: f64,
}

/// The problem of a name on a family of patches; an error message otherwise.
///
/// A wave stands between rollers on a rectangle; on any other patch its exact traction acts on all sides.
pub(super) fn find(name: &str, plane: Plane, family: PatchFamily) -> Result<Problem, String> {
    use Side::{Bottom, Left, Right, Top};
    let rollers = match family {
        PatchFamily::Square | PatchFamily::Graded | PatchFamily::Random => {
            vec![(Left, [true, false]), (Right, [true, false]), (Bottom, [false, true]), (Top, [false, true])]
        }
        PatchFamily::Bent | PatchFamily::Annulus | PatchFamily::Weighted => vec![],
    };
    let (kind, held, end_time) = match name {
        "projection" => (Kind::Projection, vec![], 0.0),
        "elastostatics" => (Kind::Static, vec![(Left, [true; 2])], 0.0),
        "kirsch" => (Kind::Static, vec![(Bottom, [false, true]), (Top, [true, false])], 0.0),
        "phase-field" | "phase-field-zero-flux" => (Kind::PhaseField, vec![], 0.0),
        "standing-wave" | "finite-wave" => (Kind::Dynamic, rollers, 0.6),
        "coupled" => (Kind::Dynamic, vec![], 0.5),
        _ => {
            let known = "projection, elastostatics, kirsch, phase-field, phase-field-zero-flux, standing-wave, \
                         finite-wave, coupled";
            return Err(format!("no convergence study solves for {name:?}; known: {known}"));
        }
    };
    let source = if name == "projection" { "elastostatics" } else { name };
    let solution = exact::find(source, plane).ok_or_else(|| format!("no exact solution {source:?}"))?;
    Ok(Problem { kind, solution: solution.into(), held, end_time })
}

/// The loads that make an exact solution one of the discrete problem.
pub(super) struct Manufactured {
    pub solution: Arc<dyn ExactSolution>,
    pub loading: Loading,
    /// `4 l0²` (m²), where there is a phase field.
    pub diffusion: f64,
}

impl fmt::Debug for Manufactured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Manufactured({:?})", self.loading)
    }
}

impl Forcing for Manufactured {
    fn volume(&self, position: [f64; 2], time: f64) -> VolumeLoad {
        match self.loading {
            Loading::Strong => VolumeLoad { force: self.solution.body_force(position, time), ..VolumeLoad::default() },
            Loading::Weak => {
                let density = self.solution.material().density;
                let force = self.solution.acceleration(position, time).map(|a| density * a);
                VolumeLoad { force, stress: self.solution.stress(position, time) }
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
