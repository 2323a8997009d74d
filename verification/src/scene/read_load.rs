//! From the tree of a document to loads, and to conditions on edges.

use fisura::scene::time::TimeFactor;
use fisura::scene::{Boundary, Edge, EdgeCondition, Hold, Load, Motion, Prescribed, Traction};

use super::fields::{Fields, Item};
use super::read::{length, number, point, time};
use super::read_function::{factor, stress_field};
use super::units::Dimension;

/// One `[[boundary]]`.
pub(super) fn boundary(item: &Item<'_>) -> Option<Boundary> {
    item.table(|fields| {
        let side = fields.need("side", "side = \"left\"", Item::word);
        let part = match (fields.get("from"), fields.get("to")) {
            (None, None) => Some(None),
            (Some(from), Some(to)) => length(&from).zip(length(&to)).map(|(from, to)| Some([from, to])),
            (Some(_), None) => item.missing("to", "to = \"25 mm\", the other end of the part"),
            (None, Some(_)) => item.missing("from", "from = 0.0, the other end of the part"),
        };
        let components = fields.need("fix", "fix = [\"x\"], the fixed components", |item| {
            item.each(|component| component.choice(&[("x", 0), ("y", 1)]))
        });
        let (name, prescribed) = (fields.maybe("name", Item::words), prescribed(fields));
        let components = components?;
        let fix = [0, 1].map(|d| components.contains(&d));
        Some(Boundary { name, side: side?, part: part?, fix, prescribed: prescribed? })
    })
}

/// Reads a table `[[body.condition]]`.
pub(super) fn edge_condition(item: &Item<'_>) -> Option<EdgeCondition> {
    item.table(|fields| {
        let (name, edge) = (fields.maybe("name", Item::words), edge(fields));
        let hold = fields.need("fix", "fix = [\"x\"], the fixed components, or fix = [\"normal\"]", hold);
        let prescribed = prescribed(fields);
        Some(EdgeCondition { name, edge: edge?, hold: hold?, prescribed: prescribed? })
    })
}

fn hold(item: &Item<'_>) -> Option<Hold> {
    let components = item.each(|component| component.choice(&[("x", Some(0)), ("y", Some(1)), ("normal", None)]))?;
    match components.as_slice() {
        [None] => Some(Hold::Normal),
        given if given.contains(&None) => {
            item.fail("the normal beside other components", "give fix = [\"normal\"], or fix = [\"x\", \"y\"]")
        }
        given => Some(Hold::Components([0, 1].map(|d| given.contains(&Some(d))))),
    }
}

/// Reads a traction: the edge, the stress or pressure on it, and how that changes with time.
pub(super) fn traction(item: &Item<'_>) -> Option<Traction> {
    item.table(|fields| {
        let edge = edge(fields);
        let load = fields.one_of(&["stress", "pressure", "stress_field"]).and_then(|given| match given {
            None => fields.need("stress", "stress = [0.0, \"1 MPa\"], or pressure = \"1 MPa\"", |_| None),
            Some(("stress", vector)) => vector.vector(Dimension::STRESS).map(Load::Stress),
            Some(("pressure", pressure)) => pressure.quantity(Dimension::STRESS).map(Load::Pressure),
            Some((_, field)) => stress_field(&field).map(Load::Field),
        });
        let time = match (fields.get("ramp"), fields.get("time")) {
            (Some(_), Some(time)) => time.fail("both ramp and time are given", "write time = { ramp = \"1 us\" }"),
            (Some(ramp), None) => time(&ramp).map(TimeFactor::ramp), // the short form
            (None, _) => Some(fields.or("time", TimeFactor::default(), factor)),
        };
        Some(Traction { edge: edge?, load: load?, time: time? })
    })
}

/// Where a load or a condition acts: one of edge, segment and arc.
fn edge(fields: &Fields<'_>) -> Option<Edge> {
    match fields.one_of(&["edge", "segment", "arc"])? {
        None => fields.need("edge", "edge = \"top\", or segment = [[x0, y0], [x1, y1]], or arc = { … }", |_| None),
        Some(("edge", side)) => side.word().map(Edge::Side),
        Some(("segment", ends)) => ends.pair(point).map(Edge::Segment),
        Some((_, item)) => arc(&item),
    }
}

/// An arc: angles in degrees, anticlockwise; the whole circle if they are left out.
fn arc(item: &Item<'_>) -> Option<Edge> {
    item.table(|fields| {
        let center = fields.need("center", "center = [0.0, 0.0] (m)", point);
        let radius = fields.need("radius", "radius = 0.1 (m)", length);
        let angles = fields.or("angles", [0.0, 360.0], |item| item.pair(number)).map(f64::to_radians);
        Some(Edge::Arc { center: center?, radius: radius?, angles })
    })
}

/// What a condition prescribes, and when: at rest if nothing is given.
fn prescribed(fields: &Fields<'_>) -> Option<Prescribed> {
    let time = fields.or("time", TimeFactor::default(), factor);
    let motion = match fields.one_of(&["velocity", "displacement"])? {
        None => Some(Motion::Velocity([0.0; 2])),
        Some(("velocity", velocity)) => velocity.vector(Dimension::VELOCITY).map(Motion::Velocity),
        Some((_, displacement)) => displacement.vector(Dimension::LENGTH).map(Motion::Displacement),
    };
    Some(Prescribed { motion: motion?, time })
}
