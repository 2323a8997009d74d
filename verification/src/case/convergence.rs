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
//! which the mesh is shifted against the body. `quadrature = "gauss"` integrates by spans.

use fisura::scene::{Frame, Layout, Mass, Plane, Quadrature, Transfer};

use crate::scene::fields::Item;
use crate::scene::read::transfer;
use crate::scene::units::Dimension;

/// A family of patches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PatchFamily {
    /// The rectangle [0, 1] × [0, 0.8] m with equal spans.
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
}

/// How the problem is loaded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loading {
    /// Body force and traction: measures the method.
    Strong,
    /// Exact stress and inertia through the code's own sums: verifies the code, blind to the quadrature.
    Weak,
}

/// What is refined.
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
    /// Exact solution.
    pub problem: String,
    /// Plane state.
    pub plane: Plane,
    /// Frame: the updated one has finite kinematics.
    pub frame: Frame,
    /// Transfers of the updated frame, a curve each.
    pub transfers: Vec<Transfer>,
    /// Quadrature of the updated frame.
    pub quadrature: Quadrature,
    /// Offsets of the mesh against a body that cuts it, in spans, a curve each; 0.37 of it in y.
    pub offsets: Vec<f64>,
    /// Meshes.
    pub patch: PatchFamily,
    /// Degrees.
    pub degrees: Vec<usize>,
    /// Spans per direction, level by level.
    pub cells: Vec<usize>,
    /// Layout of the points.
    pub layout: Layout,
    /// Points per span and direction, one per degree; p + 1 if absent.
    pub points: Option<Vec<usize>>,
    /// Mass matrix.
    pub mass: Mass,
    /// Loads.
    pub loading: Loading,
    /// Mesh or time step.
    pub refine: Refine,
    /// Time step on the coarsest mesh over its critical one; the fractions tried, where the time step is
    /// refined.
    pub safety: Vec<f64>,
    /// End of the simulated time, s, if not that of the problem.
    pub end_time: Option<f64>,
}

impl ConvergenceSetup {
    /// Whether the mass matrix is lumped: where spans integrate it never is.
    pub fn lumps_mass(&self) -> bool {
        self.mass == Mass::Lumped && self.quadrature == Quadrature::Points
    }

    /// Points per span and direction for the n-th degree.
    pub fn points(&self, n: usize) -> usize {
        self.points.as_ref().map_or(self.degrees[n] + 1, |points| points[n])
    }
}

/// Keys of `[convergence]`.
pub const KEYS: [&str; 17] = [
    "problem",
    "plane",
    "frame",
    "transfers",
    "quadrature",
    "offsets",
    "patch",
    "degrees",
    "cells",
    "layout",
    "points",
    "mass",
    "loading",
    "refine",
    "step_power",
    "safety",
    "end_time",
];

/// Names of the families of patches.
pub const PATCHES: [(&str, PatchFamily); 10] = [
    ("square", PatchFamily::Square),
    ("graded", PatchFamily::Graded),
    ("bent", PatchFamily::Bent),
    ("annulus", PatchFamily::Annulus),
    ("weighted", PatchFamily::Weighted),
    ("random", PatchFamily::Random),
    ("strip", PatchFamily::Strip),
    ("unit-square", PatchFamily::UnitSquare),
    ("block", PatchFamily::Block),
    ("ring", PatchFamily::Ring),
];

pub(super) fn read(item: &Item<'_>) -> Option<ConvergenceSetup> {
    let fields = item.fields(&KEYS)?;
    let problem = fields.need("problem", "problem = \"elastostatics\"", Item::text);
    let planes = [("strain", Plane::Strain), ("stress", Plane::Stress)];
    let plane = fields.or("plane", Plane::Strain, |i| i.choice(&planes));
    let frame = fields.or("frame", Frame::Total, |i| i.choice(&[("total", Frame::Total), ("updated", Frame::Updated)]));
    let transfers = fields.maybe("transfers", |i| filled(i, "[\"flip\", \"apic\"]", transfer));
    let quadratures = [("points", Quadrature::Points), ("gauss", Quadrature::Gauss)];
    let quadrature = fields.or("quadrature", Quadrature::Points, |i| i.choice(&quadratures));
    let offsets = fields.or("offsets", vec![0.0], |i| filled(i, "[0.0, 0.5]", |n| n.quantity(Dimension::NONE)));
    let patch = fields.or("patch", PatchFamily::Square, |i| i.choice(&PATCHES));
    let degrees = fields.need("degrees", "degrees = [2, 3]", |i| filled(i, "[2, 3]", |n| n.whole(1, 4)));
    let cells = fields.need("cells", "cells = [4, 8, 16, 32]", |i| filled(i, "[4, 8, 16, 32]", |n| n.whole(1, 4096)));
    let layouts = [("gauss", Layout::Gauss), ("uniform", Layout::Uniform), ("maclaurin", Layout::Maclaurin)];
    let layout = fields.or("layout", Layout::Gauss, |i| i.choice(&layouts));
    let points = fields.maybe("points", |i| i.each(|n| n.whole(1, 16)));
    let masses = [("consistent", Mass::Consistent), ("lumped", Mass::Lumped)];
    let mass = fields.or("mass", Mass::Consistent, |i| i.choice(&masses));
    let loadings = [("strong", Loading::Strong), ("weak", Loading::Weak)];
    let loading = fields.or("loading", Loading::Strong, |i| i.choice(&loadings));
    let step_power = fields.maybe("step_power", |i| i.quantity(Dimension::NONE));
    let refine = fields.or("refine", true, |i| i.choice(&[("mesh", true), ("time-step", false)]));
    let safety = fields.or("safety", vec![0.4], |i| filled(i, "[0.4]", |n| n.positive(Dimension::NONE)));
    let end_time = fields.maybe("end_time", |i| i.positive(Dimension::TIME));
    let (degrees, points) = (degrees?, points?);
    if let Some(points) = &points
        && points.len() != degrees.len()
    {
        let message = format!("{} numbers of points for {} degrees", points.len(), degrees.len());
        return fields.get("points")?.fail(message, "give one number of points per span and direction for each degree");
    }
    let (frame, transfers) = (frame?, transfers?);
    if frame == Frame::Total && transfers.is_some() {
        let remedy = "leave transfers out, or give frame = \"updated\"";
        return fields.get("transfers")?.fail("the total frame has no transfers", remedy);
    }
    let step_power = step_power?;
    Some(ConvergenceSetup {
        problem: problem?,
        plane: plane?,
        frame,
        transfers: transfers.unwrap_or(vec![Transfer::Flip]),
        quadrature: quadrature?,
        offsets: offsets?,
        patch: patch?,
        degrees,
        cells: cells?,
        layout: layout?,
        points,
        mass: mass?,
        loading: loading?,
        refine: if refine? { Refine::Mesh(step_power) } else { Refine::TimeStep },
        safety: safety?,
        end_time: end_time?,
    })
}

/// A list with at least one entry.
fn filled<'a, T>(item: &Item<'a>, like: &str, read: impl Fn(&Item<'a>) -> Option<T>) -> Option<Vec<T>> {
    let entries = item.each(read)?;
    if entries.is_empty() {
        return item.fail("the list is empty", format!("give at least one entry, such as {like}"));
    }
    Some(entries)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::document::Document;
    use crate::scene::fields::Problems;

    /// What is wrong with a table that is sound but for these lines: keys, messages and remedies.
    fn problems(lines: &str) -> Vec<(String, String, String)> {
        let sound = [("problem", "\"vortex\""), ("degrees", "[2]"), ("cells", "[4, 8]")];
        let given = |key: &str| lines.lines().any(|line| line.starts_with(key));
        let rest: String =
            sound.iter().filter(|(key, _)| !given(key)).map(|(key, value)| format!("{key} = {value}\n")).collect();
        let document = Document::parse("trial.toml", &format!("{rest}{lines}\n")).unwrap();
        let problems = Problems::default();
        let setup = read(&Item::new(&document.root, "convergence", &problems));
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
            ("points", "points = [3, 4]"),
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
