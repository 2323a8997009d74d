//! From the tree of a document to the typed scene: mesh, analysis, solver, boundaries, output.

use std::collections::BTreeMap;
use std::path::Path;

use fisura::scene::{
    Analysis, Contact, Frame, JIntegral, Kinematics, Mass, Output, PhaseFieldInterval, PhaseFieldSolver, Plane, Probe,
    Scene, Shape, SolverSettings, TimeFactor, TimeStep, Transfer,
};

use super::accuracy::{accuracy, choose_settings, choose_span};
use super::diagnostic::Problem;
use super::document::Node;
use super::fields::{Fields, Item, Problems};
use super::read_body::{bodies, materials};
use super::read_function::factor;
use super::read_load::boundary;
use super::read_mesh::{degree, mesh};
use super::units::Dimension;

/// Keys that a scene may have at its top level.
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
    if let Some(claim) = item.at("claim") {
        return claim.fail("a case, not a scene", "run it with `cargo xtask verify --case NAME`");
    }
    let fields = item.fields(&SCENE_KEYS)?;
    let title = fields.or("title", String::new(), Item::text);
    let analysis = fields.need("analysis", "a table [analysis] with end_time", analysis);
    let (mut solver, accuracy) = fields.or("solver", (default_solver(), None), solver);
    let mut materials = fields.or("material", BTreeMap::new(), materials);
    let frame = analysis.as_ref().map_or(Frame::Total, |analysis| analysis.frame);
    let degree = degree(item.node).unwrap_or([2; 2]);
    let named = fields.get("material").and_then(|item| item.node.as_table());
    let only = named.filter(|named| named.len() == 1).and_then(|named| named.keys().next().cloned());
    let mut bodies = fields.or("body", Vec::new(), |item| bodies(item, only.as_deref(), frame, degree));
    let rule = (&bodies[..], frame, degree);
    let span = accuracy.and_then(|accuracy| choose_span(accuracy, &mut materials, rule, item.node));
    let is_read = !materials.is_empty() || fields.get("material").is_none();
    let is_idle = accuracy.is_some() && is_read && span.is_none();
    if let Some(item) = fields.get("solver").filter(|_| is_idle) {
        let message = "an accuracy in a scene without a material that can break: there is nothing to choose";
        item.fail::<()>(message, "remove accuracy, or add [material.NAME.fracture]");
    }
    let mesh = fields.need("mesh", "a table [mesh] with size and cells", |item| mesh(item, span));
    let contact = fields.maybe("contact", |item| {
        item.table(|fields| {
            let friction = fields.need("friction", "friction = 0.65", number);
            Some(Contact {
                fragments: fields.or("fragments", false, Item::flag),
                self_contact: fields.or("self_contact", false, Item::flag),
                stiffness: fields.maybe("stiffness", number),
                friction: friction?,
            })
        })
    });
    let boundaries = fields.or("boundary", Vec::new(), |item| item.each_table(boundary));
    let equilibrium = fields
        .or("start", false, |item| item.table(|fields| fields.need("equilibrium", "equilibrium = true", Item::flag)));
    let output = fields.or("output", Output::rows(320), output);
    let (mesh, analysis) = (mesh?, analysis?);
    if let Some((accuracy, item)) = accuracy.zip(fields.get("solver")) {
        choose_settings(accuracy, &mut solver, (&materials, analysis.frame), item.node);
    }
    if mesh.geometry.is_none() {
        // All of a rectangular mesh is a rectangle.
        for body in bodies.iter_mut().filter(|body| body.shape == Shape::Patch) {
            body.shape = Shape::Rectangle { min: mesh.origin(), max: mesh.end() };
        }
    }
    Some(Scene { title, mesh, analysis, solver, materials, bodies, contact, boundaries, equilibrium, output })
}

/// Reads a number without a unit.
pub(super) fn number(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::NONE)
}

/// Reads a length; the result is in m.
pub(super) fn length(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::LENGTH)
}

/// Reads a point `[x, y]`; the result is in m.
pub(super) fn point(item: &Item<'_>) -> Option<[f64; 2]> {
    item.vector(Dimension::LENGTH)
}

/// Reads a time; the result is in s.
pub(super) fn time(item: &Item<'_>) -> Option<f64> {
    item.quantity(Dimension::TIME)
}

fn analysis(item: &Item<'_>) -> Option<Analysis> {
    item.table(|fields| {
        let end_time = fields.need("end_time", "end_time = \"80 us\"", time);
        Some(Analysis {
            plane: fields.or("plane", Plane::Strain, Item::word),
            thickness: fields.or("thickness", 1.0, length),
            frame: fields.or("frame", Frame::Total, Item::word),
            kinematics: fields.or("kinematics", Kinematics::Small, Item::word),
            time_step: fields.or("time_step", TimeStep::Auto, |item| match item.node.as_str() {
                Some("auto") => Some(TimeStep::Auto),
                _ => time(item).map(TimeStep::Fixed),
            }),
            safety: fields.or("safety", 0.8, number),
            transfer: fields.or("transfer", Transfer::default(), transfer),
            mass: fields.or("mass", Mass::Lumped, Item::word),
            gravity: fields.or("gravity", [0.0, 0.0], |item| item.vector(Dimension::ACCELERATION)),
            gravity_time: fields.or("gravity_time", TimeFactor::default(), factor),
            end_time: end_time?,
        })
    })
}

/// A transfer: its name, or `{ xpic = m }`.
pub fn transfer(item: &Item<'_>) -> Option<Transfer> {
    if item.node.as_table().is_some() {
        let order = |fields: &Fields<'_>| fields.need("xpic", "{ xpic = 5 }", |order| order.whole(1, 100));
        return item.table(order).map(Transfer::Xpic);
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
    let interval = |item: &Item<'_>| match item.node.as_str() {
        Some("auto") => Some(PhaseFieldInterval::Automatic),
        Some(_) => item.fail("unknown interval", "write a whole number of steps, or \"auto\""),
        None => item.whole(1, 100).map(PhaseFieldInterval::Steps),
    };
    item.table(|fields| {
        let settings = SolverSettings {
            phase_field_tolerance: fields.or("phase_field_tolerance", default.phase_field_tolerance, number),
            phase_field_solver: fields.or("phase_field_solver", default.phase_field_solver, Item::word),
            phase_field_interval: fields.or("phase_field_interval", default.phase_field_interval, interval),
        };
        Some((settings, accuracy(fields)))
    })
}

fn output(item: &Item<'_>) -> Option<Output> {
    item.table(|fields| {
        Some(Output {
            samples: fields.or("samples", 320, |item| item.whole(1, 100_000_000)),
            frames: fields.or("frames", Vec::new(), |item| item.each(time)),
            bodies: fields.or("bodies", false, Item::flag),
            fragments: fields.or("fragments", false, Item::flag),
            probes: fields.or("probe", Vec::new(), |item| item.each_table(probe)),
            j_integrals: fields.or("j_integral", Vec::new(), |item| item.each_table(j_integral)),
        })
    })
}

fn j_integral(item: &Item<'_>) -> Option<JIntegral> {
    item.table(|fields| {
        let radius = fields.need("radius", "radius = \"5 mm\", that of its domain", length);
        Some(JIntegral {
            name: fields.maybe("name", Item::words),
            at: fields.maybe("at", point),
            angle: fields.maybe("angle", number).map(f64::to_radians),
            radius: radius?,
        })
    })
}

fn probe(item: &Item<'_>) -> Option<Probe> {
    item.table(|fields| {
        let name = fields.need("name", "name = \"tip\"", Item::words);
        let at = fields.need("at", "at = [0.05, 0.02] (m), its position at t = 0", point);
        Some(Probe { name: name?, at: at? })
    })
}
