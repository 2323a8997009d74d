//! From the tree of a document to the typed scene: mesh, analysis, solver, boundaries, output.

use std::collections::BTreeMap;
use std::path::Path;

use fisura::scene::{
    Analysis, Contact, Frame, JIntegral, Kinematics, Mass, Output, PhaseFieldInterval, PhaseFieldSolver, Plane, Probe,
    Scene, Shape, SolverSettings, TimeStep, Transfer,
};

use super::accuracy::{accuracy, choose_settings, choose_span};
use super::diagnostic::Problem;
use super::document::Node;
use super::fields::{Item, Problems};
use super::read_body::{bodies, materials};
use super::read_load::boundary;
use super::read_mesh::{degree, mesh};
use super::units::Dimension;

/// Keys of a scene.
pub const SCENE_KEYS: [&str; 10] =
    ["title", "mesh", "analysis", "solver", "material", "body", "contact", "boundary", "start", "output"];

/// Reads the scene that `node` declares: a whole document, or the `[scene]` table of a case file.
///
/// `prefix` is the key path of `node` in its document, empty for a whole document; files that the scene names
/// lie in `folder`. The scene is complete in form; its sense is checked by [`fisura::validate::validate`].
///
/// # Errors
/// Every unknown key, missing key, wrong type, wrong dimension and number out of range.
pub fn read_scene(node: &Node, prefix: &str, folder: &Path) -> Result<Scene, Vec<Problem>> {
    let problems = Problems::in_folder(folder);
    let scene = scene(&Item::new(node, prefix, &problems));
    let found = problems.into_inner();
    match scene {
        Some(scene) if found.is_empty() => Ok(scene),
        _ => Err(found),
    }
}

fn scene(item: &Item<'_>) -> Option<Scene> {
    let fields = item.fields(&SCENE_KEYS)?;
    let title = fields.or("title", String::new(), Item::text);
    let analysis = fields.need("analysis", "a table [analysis] with end_time", analysis);
    let solver = fields.or("solver", (default_solver(), None), solver);
    let mut materials = fields.or("material", BTreeMap::new(), materials);
    let accuracy = solver.as_ref().and_then(|(_, accuracy)| *accuracy);
    let frame = analysis.as_ref().map_or(Frame::Total, |analysis| analysis.frame);
    let degree = degree(item.node).unwrap_or([2; 2]);
    let bodies = fields.or("body", Vec::new(), |item| bodies(item, frame, degree));
    let rule = (bodies.as_deref().unwrap_or_default(), frame, degree);
    let span = accuracy.zip(materials.as_mut()).and_then(|(a, materials)| choose_span(a, materials, rule, item.node));
    let is_idle = accuracy.is_some() && materials.is_some() && span.is_none();
    if let Some(item) = fields.get("solver").filter(|_| is_idle) {
        let message = "an accuracy in a scene without a material that can break: there is nothing to choose";
        item.fail::<()>(message, "remove accuracy, or add [material.NAME.fracture]");
    }
    let mesh = fields.need("mesh", "a table [mesh] with degree, origin, size and cells", |item| mesh(item, span));
    let contact = fields.maybe("contact", |item| {
        let fields = item.fields(&["friction", "fragments", "self_contact", "stiffness"])?;
        let friction = fields.need("friction", "friction = 0.65", number);
        let fragments = fields.or("fragments", false, Item::flag);
        let self_contact = fields.or("self_contact", false, Item::flag);
        let stiffness = fields.or("stiffness", Contact::default().stiffness, number);
        Some(Contact { friction: friction?, fragments: fragments?, self_contact: self_contact?, stiffness: stiffness? })
    });
    let boundaries = fields.or("boundary", Vec::new(), |item| item.each_table(boundary));
    let equilibrium = fields.or("start", false, |item| {
        item.fields(&["equilibrium"])?.need("equilibrium", "equilibrium = true", Item::flag)
    });
    let output = fields.or("output", Output::rows(320), output);
    let (mesh, mut bodies, analysis, materials) = (mesh?, bodies?, analysis?, materials?);
    let (mut solver, _) = solver?;
    if let Some((accuracy, item)) = accuracy.zip(fields.get("solver")) {
        choose_settings(accuracy, &mut solver, (&materials, analysis.frame), item.node);
    }
    if mesh.geometry.is_none() {
        // All of a rectangular mesh is a rectangle.
        for body in bodies.iter_mut().filter(|body| body.shape == Shape::Patch) {
            body.shape = Shape::Rectangle { min: mesh.origin(), max: mesh.end() };
        }
    }
    Some(Scene {
        title: title?,
        mesh,
        analysis,
        solver,
        materials,
        bodies,
        contact: contact?,
        boundaries: boundaries?,
        equilibrium: equilibrium?,
        output: output?,
    })
}

/// A plain number.
pub(super) fn number(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::NONE)
}

/// A length in m.
pub(super) fn length(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::LENGTH)
}

/// A point in m.
pub(super) fn point(item: &Item<'_>) -> Option<[f64; 2]> {
    item.vector(Dimension::LENGTH)
}

/// A time in s.
pub(super) fn time(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::TIME)
}

fn analysis(item: &Item<'_>) -> Option<Analysis> {
    let fields = item.fields(&[
        "plane",
        "thickness",
        "frame",
        "kinematics",
        "end_time",
        "time_step",
        "safety",
        "transfer",
        "mass",
        "gravity",
    ])?;
    let plane = fields.or("plane", Plane::Strain, Item::word);
    let thickness = fields.or("thickness", 1.0, length);
    let frame = fields.or("frame", Frame::Total, Item::word);
    let kinematics = fields.or("kinematics", Kinematics::Small, Item::word);
    let end_time = fields.need("end_time", "end_time = \"80 us\"", time);
    let time_step = fields.or("time_step", TimeStep::Auto, |item| match item.node.as_str() {
        Some("auto") => Some(TimeStep::Auto),
        _ => time(item).map(TimeStep::Fixed),
    });
    let safety = fields.or("safety", 0.8, number);
    let transfer = fields.or("transfer", Transfer::default(), transfer);
    let mass = fields.or("mass", Mass::Lumped, Item::word);
    let gravity = fields.or("gravity", [0.0, 0.0], |item| item.vector(Dimension::ACCELERATION));
    Some(Analysis {
        plane: plane?,
        thickness: thickness?,
        frame: frame?,
        kinematics: kinematics?,
        end_time: end_time?,
        time_step: time_step?,
        safety: safety?,
        transfer: transfer?,
        mass: mass?,
        gravity: gravity?,
    })
}

/// A transfer: its name, or `{ xpic = m }`.
pub fn transfer(item: &Item<'_>) -> Option<Transfer> {
    if item.node.as_table().is_some() {
        let fields = item.fields(&["xpic"])?;
        return fields.need("xpic", "{ xpic = 5 }", |order| order.whole(1, 100)).map(Transfer::Xpic);
    }
    if item.node.as_str() == Some("xpic") {
        return item.fail("xpic needs its order", "write transfer = { xpic = 5 }");
    }
    item.choice(&[("pic", Transfer::Pic), ("flip", Transfer::Flip), ("apic", Transfer::Apic), ("tpic", Transfer::Tpic)])
}

fn default_solver() -> SolverSettings {
    SolverSettings {
        phase_field_tolerance: 2e-6,
        phase_field_solver: PhaseFieldSolver::ConjugateGradients,
        phase_field_interval: PhaseFieldInterval::Steps(1),
    }
}

/// Settings, and the accuracy that others are to be chosen for.
fn solver(item: &Item<'_>) -> Option<(SolverSettings, Option<f64>)> {
    let default = default_solver();
    let fields = item.fields(&["phase_field_tolerance", "phase_field_solver", "phase_field_interval", "accuracy"])?;
    let accuracy = accuracy(&fields);
    let tolerance = fields.or("phase_field_tolerance", default.phase_field_tolerance, number);
    let solver = fields.or("phase_field_solver", default.phase_field_solver, Item::word);
    let interval = fields.or("phase_field_interval", default.phase_field_interval, |item| match item.node.as_str() {
        Some("auto") => Some(PhaseFieldInterval::Automatic),
        Some(_) => item.fail("unknown interval", "write a whole number of steps, or \"auto\""),
        None => item.whole(1, 100).map(PhaseFieldInterval::Steps),
    });
    let settings = SolverSettings {
        phase_field_tolerance: tolerance?,
        phase_field_solver: solver?,
        phase_field_interval: interval?,
    };
    Some((settings, accuracy?))
}

fn output(item: &Item<'_>) -> Option<Output> {
    let fields = item.fields(&["samples", "frames", "bodies", "fragments", "probe", "j_integral"])?;
    let samples = fields.or("samples", 320, |item| item.whole(1, 100_000_000));
    let frames = fields.or("frames", Vec::new(), |item| item.each(time));
    let bodies = fields.or("bodies", false, Item::flag);
    let fragments = fields.or("fragments", false, Item::flag);
    let probes = fields.or("probe", Vec::new(), |item| item.tables()?.iter().map(probe).collect());
    let j_integrals = fields.or("j_integral", Vec::new(), |item| item.tables()?.iter().map(j_integral).collect());
    let (probes, j_integrals) = (probes?, j_integrals?);
    Some(Output { samples: samples?, frames: frames?, bodies: bodies?, fragments: fragments?, probes, j_integrals })
}

fn j_integral(item: &Item<'_>) -> Option<JIntegral> {
    let fields = item.fields(&["name", "radius", "at", "angle"])?;
    let name = fields.maybe("name", Item::words);
    let radius = fields.need("radius", "radius = \"5 mm\", that of its domain", length);
    let at = fields.maybe("at", point);
    let angle = fields.maybe("angle", number);
    Some(JIntegral { name: name?, radius: radius?, at: at?, angle: angle?.map(f64::to_radians) })
}

fn probe(item: &Item<'_>) -> Option<Probe> {
    let fields = item.fields(&["name", "at"])?;
    let name = fields.need("name", "name = \"tip\"", Item::words);
    let at = fields.need("at", "at = [0.05, 0.02] (m), its position at t = 0", point);
    Some(Probe { name: name?, at: at? })
}
