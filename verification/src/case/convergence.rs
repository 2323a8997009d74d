//! The `[convergence]` table of a case file: which exact solution is solved for, on which meshes, how.
//!
//! ```toml
//! study = "convergence"
//!
//! [convergence]
//! problem = "elastostatics"     # an exact solution, or "projection"
//! patch = "annulus"             # "square", "graded", "bent", "annulus", "weighted", "random"
//! degrees = [2, 3]
//! cells = [4, 8, 16, 32]        # spans per direction
//! ```
//!
//! `frame = "updated"` lets the points of a finite motion cross the spans of a fixed mesh;
//! `transfers = ["flip", "apic"]` then gives a curve for each, and so does `offsets = [0.0, 0.5]`, by
//! which the mesh is shifted against the body.

use fisura::scene::{Frame, Layout, Mass, Plane, Transfer};

use schemars::JsonSchema;
use serde::Deserialize;

use super::value::{Duration, Filled, Number, Positive, TransferName, Whole, Word};
use crate::scene::fields::{Item, Words};

/// A family of patches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum PatchFamily {
    /// The rectangle [0, 1] × [0, 0.8] m with equal spans.
    #[default]
    Square,
    /// The same with spans of random lengths, drawn once on the coarsest mesh.
    Graded,
    /// A polynomial patch with curved sides.
    Bent,
    /// The quarter annulus between the radii 1 and 2 m.
    Annulus,
    /// The polynomial patch's control points with weights from 1/2 to 2, drawn once on its one span.
    Weighted,
    /// The rectangle with random weights, inner control points and knots, drawn once on the coarsest mesh.
    Random,
    /// A strip of equal spans along [0, 1] m, one span high, with two points across: for waves along x.
    Strip,
    /// The square [0, 1]² m with equal spans.
    UnitSquare,
    /// A rectangle around the block [0, 1]² m and its way of (0.675, 0.36) m, with equal spans of which
    /// `cells` are 1 m.
    Block,
    /// The ring between the radii 0.75 and 1.25 m in the square [−1.4, 1.4]² m with equal spans that it
    /// cuts.
    Ring,
    /// The square [0, 2]² m with equal spans, without the disc of radius 1 m about the origin, which cuts
    /// them.
    Holed,
    /// The disc of radius 1 m about the origin in the square [−1.1, 1.1]² m with equal spans that it cuts.
    Disc,
}

/// How the problem is loaded.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Loading {
    /// Body force and traction: measures the method.
    #[default]
    Strong,
    /// Exact stress and inertia through the code's own sums: verifies the code, blind to the quadrature.
    Weak,
}

/// What becomes finer from level to level: the mesh or the time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Refine {
    /// The mesh, with time steps in proportion to a power of the span length; (p + 1)/2 if none is given.
    Mesh(Option<f64>),
    /// The time step on the finest mesh, in these fractions of its critical one.
    TimeStep,
}

/// A convergence study.
#[derive(Debug, Clone, PartialEq)]
pub struct ConvergenceSetup {
    /// Name of the exact solution that is solved for, or `projection`.
    pub problem: String,
    /// Plane state, strain or stress.
    pub plane: Plane,
    /// Frame: the updated one has finite kinematics.
    pub frame: Frame,
    /// Transfers of the updated frame, a curve each.
    pub transfers: Vec<Transfer>,
    /// Offsets of the mesh against a body that cuts it, in spans, a curve each; 0.37 of it in y.
    pub offsets: Vec<f64>,
    /// Family of patches from which the meshes are made.
    pub patch: PatchFamily,
    /// Degrees of the splines, a curve each.
    pub degrees: Vec<usize>,
    /// Spans per direction, level by level.
    pub cells: Vec<usize>,
    /// Layout of the points.
    pub layout: Layout,
    /// Points per span and direction, one per degree; p + 1 if absent.
    pub points: Option<Vec<usize>>,
    /// Kind of mass matrix, lumped or consistent.
    pub mass: Mass,
    /// How the problem is loaded.
    pub loading: Loading,
    /// Whether the levels differ in the mesh or in the time step.
    pub refine: Refine,
    /// Time step on the coarsest mesh over its critical one; the fractions tried, where the time step is
    /// refined.
    pub safety: Vec<f64>,
    /// End of the simulated time, s, if not that of the problem.
    pub end_time: Option<f64>,
}

impl ConvergenceSetup {
    /// Points per span and direction for the n-th degree.
    pub fn points(&self, n: usize) -> usize {
        self.points.as_ref().map_or(self.degrees[n] + 1, |points| points[n])
    }
}

/// As it stands in the file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct ConvergenceTable {
    /// The exact solution: `problem = "elastostatics"`.
    problem: String,
    /// Plane strain or plane stress.
    #[serde(default = "first::<Plane>")]
    plane: Word<Plane>,
    /// The updated frame has finite kinematics, and points that cross spans.
    #[serde(default = "first::<Frame>")]
    frame: Word<Frame>,
    /// Transfers of the updated frame, a curve each: `transfers = ["flip", "apic"]`.
    transfers: Option<Filled<TransferName>>,
    /// Offsets of the mesh against the body, in spans, a curve each: `offsets = [0.0, 0.5]`.
    offsets: Option<Filled<Number>>,
    /// The family of meshes.
    #[serde(default)]
    patch: PatchFamily,
    /// Degrees of the splines, `degrees = [2, 3]` if absent.
    degrees: Option<Filled<Whole<1, 4>>>,
    /// Spans per direction, level by level, `cells = [4, 8, 16, 32]` if absent.
    cells: Option<Filled<Whole<1, 4096>>>,
    /// Layout of the points.
    #[serde(default = "first::<Layout>")]
    layout: Word<Layout>,
    /// Points per span and direction, one number for each degree; p + 1 if absent.
    points: Option<Vec<Whole<1, 16>>>,
    /// Mass matrix.
    #[serde(default = "consistent")]
    mass: Word<Mass>,
    /// How the problem is loaded.
    #[serde(default)]
    loading: Loading,
    /// What is refined.
    #[serde(default)]
    refine: Refined,
    /// Power of the span length to which the time step is proportional; (p + 1)/2 if absent.
    step_power: Option<Number>,
    /// Time steps over the critical one: `safety = [0.4]`.
    safety: Option<Filled<Positive>>,
    /// End of the simulated time, if not that of the problem.
    end_time: Option<Duration>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
enum Refined {
    #[default]
    Mesh,
    TimeStep,
}

/// The first of the words of a type.
fn first<T: Words>() -> Word<T> {
    Word(T::WORDS[0].1)
}

fn consistent() -> Word<Mass> {
    Word(Mass::Consistent)
}

/// The study of a table; `item` is the table.
pub(super) fn setup(table: ConvergenceTable, item: &Item<'_>) -> Option<ConvergenceSetup> {
    let degrees = table.degrees.map_or(vec![2, 3], |all| all.0.iter().map(|degree| degree.0).collect());
    let points: Option<Vec<usize>> = table.points.map(|points| points.iter().map(|n| n.0).collect());
    if let Some(points) = &points
        && points.len() != degrees.len()
    {
        let message = format!("{} numbers of points for {} degrees", points.len(), degrees.len());
        return item.at("points")?.fail(message, "give one number of points per span and direction for each degree");
    }
    if table.frame.0 == Frame::Total && table.transfers.is_some() {
        let remedy = "leave transfers out, or give frame = \"updated\"";
        return item.at("transfers")?.fail("the total frame has no transfers", remedy);
    }
    let transfers = table.transfers.map(|all| all.0.iter().map(|transfer| transfer.0).collect());
    Some(ConvergenceSetup {
        problem: table.problem,
        plane: table.plane.0,
        frame: table.frame.0,
        transfers: transfers.unwrap_or(vec![Transfer::default()]),
        offsets: table.offsets.map_or(vec![0.0], |all| all.0.iter().map(|offset| offset.0).collect()),
        patch: table.patch,
        degrees,
        cells: table.cells.map_or(vec![4, 8, 16, 32], |all| all.0.iter().map(|cells| cells.0).collect()),
        layout: table.layout.0,
        points,
        mass: table.mass.0,
        loading: table.loading,
        refine: match table.refine {
            Refined::Mesh => Refine::Mesh(table.step_power.map(|power| power.0)),
            Refined::TimeStep => Refine::TimeStep,
        },
        safety: table.safety.map_or(vec![0.4], |all| all.0.iter().map(|safety| safety.0).collect()),
        end_time: table.end_time.map(|end| end.0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::document::Document;
    use crate::scene::fields::Problems;
    use crate::scene::typed;

    /// What is wrong with a table that is sound but for these lines: keys, messages and remedies.
    fn problems(lines: &str) -> Vec<(String, String, String)> {
        let document = Document::parse("trial.toml", &format!("problem = \"vortex\"\n{lines}\n")).unwrap();
        let problems = Problems::default();
        let item = Item::new(&document.root, "convergence", &problems);
        let setup = typed::read(&item).and_then(|table| setup(table, &item));
        let found = problems.into_inner();
        assert_eq!(setup.is_none(), !found.is_empty(), "{lines}");
        found.into_iter().map(|p| (p.key, p.message, p.remedy)).collect()
    }

    #[test]
    fn what_is_sound_is_read() {
        for lines in ["", "frame = \"updated\"\ntransfers = [\"flip\"]", "safety = [0.4]\nend_time = \"1 s\""] {
            assert_eq!(problems(lines), vec![], "{lines}");
        }
    }

    #[test]
    fn what_cannot_be_run_is_refused_by_key_with_a_remedy() {
        for (key, lines) in [
            ("degrees", "degrees = []"),
            ("degrees.1", "degrees = [2, 0]"),
            ("cells", "cells = []"),
            ("cells.0", "cells = [0, 4]"),
            ("points", "points = [3]"),
            ("safety", "safety = []"),
            ("safety.0", "safety = [0.0]"),
            ("safety.1", "safety = [0.4, -0.2]"),
            ("end_time", "end_time = \"0 s\""),
            ("end_time", "end_time = -1.0"),
            ("transfers", "transfers = [\"flip\"]"),
            ("transfers", "frame = \"updated\"\ntransfers = []"),
        ] {
            let found = problems(lines);
            assert_eq!(found.len(), 1, "{lines}: {found:?}");
            assert_eq!(found[0].0, format!("convergence.{key}"), "{lines}: {found:?}");
            assert!(found[0].2.contains("give"), "{found:?}");
        }
    }
}
