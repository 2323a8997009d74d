//! From the tree of a document to the typed scene: materials, bodies, shapes, tractions, cracks.

use std::collections::BTreeMap;

use fisura::scene::time::TimeFactor;
use fisura::scene::{
    Anisotropy, Body, Crack, CrackKind, CrackModel, Fracture, Frame, Layout, Material, RandomToughness, Shape,
    Softening, Split,
};

use super::document::join;
use super::fields::{Fields, Item};
use super::read::{length, number, point};
use super::read_file::outline;
use super::read_function::factor;
use super::read_load::{edge_condition, traction};
use super::units::Dimension;

/// `[material.NAME]` tables by name.
pub(super) fn materials(item: &Item<'_>) -> Option<BTreeMap<String, Material>> {
    let Some(table) = item.node.as_table() else {
        return item.fail(format!("expected a table, found {}", item.node.kind()), "write [material.NAME]");
    };
    let names: Vec<&str> = table.keys().map(String::as_str).collect();
    let fields = item.fields(&names)?;
    let mut complete = true;
    let mut materials = BTreeMap::new();
    for name in names {
        let Some(entry) = fields.get(name) else { continue };
        if join("", name) != name {
            let remedy = "name materials with letters, digits, - and _";
            complete &= entry.fail::<()>(format!("{name:?} cannot be a material name"), remedy).is_some();
        }
        match material(&entry) {
            Some(material) => drop(materials.insert(name.to_string(), material)),
            None => complete = false,
        }
    }
    complete.then_some(materials)
}

fn material(item: &Item<'_>) -> Option<Material> {
    if item.node.as_table().is_none() {
        return item.fail("expected a table of material constants", "name the material: [material.NAME]");
    }
    item.table(|fields| {
        let modulus = fields.need("young_modulus", "young_modulus = \"32 GPa\"", |i| i.quantity(Dimension::STRESS));
        let poisson = fields.need("poisson_ratio", "poisson_ratio = 0.2", number);
        let density = fields.need("density", "density = \"2450 kg/m^3\"", |i| i.quantity(Dimension::DENSITY));
        let fracture = fields.maybe("fracture", fracture);
        Some(Material { young_modulus: modulus?, poisson_ratio: poisson?, density: density?, fracture })
    })
}

fn fracture(item: &Item<'_>) -> Option<Fracture> {
    item.table(|fields| {
        let model = model(fields);
        let rate = fields.need("critical_energy_release_rate", "critical_energy_release_rate = \"3 J/m^2\"", |item| {
            item.quantity(Dimension::ENERGY_PER_AREA)
        });
        let scale = fields.need("length_scale", "length_scale = \"0.25 mm\"", length);
        Some(Fracture {
            residual_stiffness: fields.or("residual_stiffness", 0.0, number),
            split: fields.or("split", Split::Spectral, split),
            anisotropy: fields.maybe("anisotropy", anisotropy),
            random: fields.maybe("random", random),
            mesh_toughness: fields.or("mesh_toughness", false, Item::flag),
            model: model?,
            critical_energy_release_rate: rate?,
            length_scale: scale?,
        })
    })
}

/// The model, and what belongs to a cohesive crack.
fn model(fields: &Fields<'_>) -> Option<CrackModel> {
    let plain = |model: CrackModel| (model.word(), Some(model));
    let words = [plain(CrackModel::At2), plain(CrackModel::At1), ("pf-czm", None)];
    let [strength, softening] = ["tensile_strength", "softening"].map(|key| fields.get(key));
    let Some(model) = fields.or("model", Some(CrackModel::At2), |item| item.choice(&words)) else {
        let read = |item: &Item<'_>| item.quantity(Dimension::STRESS);
        let strength = fields.need("tensile_strength", "tensile_strength = \"3 MPa\"", read);
        let softening = fields.or("softening", Softening::Linear, Item::word);
        return Some(CrackModel::PfCzm { tensile_strength: strength?, softening });
    };
    if let Some(given) = strength.or(softening) {
        return given.fail(format!("{} has no such key", model.word()), "remove it, or use model = \"pf-czm\"");
    }
    Some(model)
}

/// A word, or `{ star-convex = GAMMA }`.
fn split(item: &Item<'_>) -> Option<Split> {
    if item.node.as_table().is_none() {
        return item.word();
    }
    item.table(|fields| fields.need("star-convex", "split = { star-convex = 3.0 }", number).map(Split::StarConvex))
}

/// `{ tensor = [[1.0, 0.0], [0.0, 4.0]], angle = 30 }`, the angle in degrees.
fn anisotropy(item: &Item<'_>) -> Option<Anisotropy> {
    let row = |row: &Item<'_>| row.vector(Dimension::NONE);
    item.table(|fields| {
        let tensor = fields.need("tensor", "tensor = [[1.0, 0.0], [0.0, 4.0]]", |item| item.pair(row));
        Some(Anisotropy { angle: fields.or("angle", 0.0, number).to_radians(), tensor: tensor? })
    })
}

/// `{ field = "toughness", distribution = "weibull", modulus = 2.0, correlation = "1 mm", seed = 1 }`.
fn random(item: &Item<'_>) -> Option<RandomToughness> {
    item.table(|fields| {
        let word =
            |key: &str, only: &str| fields.need(key, &format!("{key} = \"{only}\""), |item| item.choice(&[(only, ())]));
        let (field, distribution) = (word("field", "toughness"), word("distribution", "weibull"));
        let modulus = fields.need("modulus", "modulus = 2.0", number);
        let correlation = fields.need("correlation", "correlation = \"1 mm\"", length);
        let seed = fields.or("seed", 1, |item| item.whole(0, 1 << 32)) as u64;
        field.and(distribution)?;
        Some(RandomToughness { modulus: modulus?, correlation: correlation?, seed })
    })
}

/// `[[body]]` tables in order, on a mesh of the given degrees.
pub(super) fn bodies(item: &Item<'_>, only: Option<&str>, frame: Frame, degree: [usize; 2]) -> Option<Vec<Body>> {
    item.each_table(|item| body(item, only, default_points(frame, degree), default_layout(frame)))
}

/// Where points keep their places in the spans, fewer than the degree leave modes nearly without stiffness.
fn default_points(frame: Frame, degree: [usize; 2]) -> [usize; 2] {
    match frame {
        Frame::Total => degree.map(|p| p.max(2)),
        Frame::Updated => [2, 2],
    }
}

/// Points that move through the mesh lose Gauss's places in the spans, and equal distances serve them better.
fn default_layout(frame: Frame) -> Layout {
    match frame {
        Frame::Total => Layout::Gauss,
        Frame::Updated => Layout::Uniform,
    }
}

/// `only` is the name of the only material, if there is one.
fn body(item: &Item<'_>, only: Option<&str>, default_points: [usize; 2], default_layout: Layout) -> Option<Body> {
    item.table(|fields| {
        let material = match only {
            Some(only) => Some(fields.or("material", only.to_string(), Item::text)),
            None => fields.need("material", "the name of a [material.NAME] table", Item::text),
        };
        let rates = |item: &Item<'_>| item.pair(|row| row.vector(Dimension::RATE));
        Some(Body {
            particles_per_cell: fields.or("particles_per_cell", default_points, |item| item.whole_per_direction(1, 16)),
            layout: fields.or("layout", default_layout, Item::word),
            velocity: fields.or("velocity", [0.0, 0.0], |item| item.vector(Dimension::VELOCITY)),
            angular_velocity: fields.or("angular_velocity", 0.0, |item| item.quantity(Dimension::RATE)),
            velocity_gradient: fields.or("velocity_gradient", [[0.0; 2]; 2], rates),
            rigid: fields.or("rigid", false, Item::flag),
            time: fields.or("time", TimeFactor::default(), factor),
            tractions: fields.or("traction", Vec::new(), |item| item.each_table(traction)),
            conditions: fields.or("condition", Vec::new(), |item| item.each_table(edge_condition)),
            cracks: fields.or("crack", Vec::new(), |item| item.each_table(crack)),
            shape: fields.or("shape", Shape::Patch, shape),
            name: fields.or("name", "body".to_string(), Item::text),
            material: material?,
        })
    })
}

const SHAPES: [&str; 7] = ["rectangle", "disk", "annulus", "polygon", "file", "union", "difference"];

fn shape(item: &Item<'_>) -> Option<Shape> {
    if item.node.as_str() == Some("patch") {
        return Some(Shape::Patch);
    }
    let fields = item.fields(&SHAPES)?;
    let given: Vec<Item<'_>> = SHAPES.iter().filter_map(|kind| fields.get(kind)).collect();
    let [inner] = given.as_slice() else {
        let message = format!("expected one shape, found {}", given.len());
        let remedy = "give one of rectangle, disk, annulus, polygon, file, union, difference; or shape = \"patch\"";
        return item.fail(message, remedy);
    };
    match inner.path.rsplit('.').next()? {
        "file" => outline(inner),
        "union" => inner.each(shape).map(Shape::Union),
        kind => inner.table(|fields| of_kind(kind, fields)),
    }
}

/// A shape whose table has numbers, or other shapes.
fn of_kind(kind: &str, fields: &Fields<'_>) -> Option<Shape> {
    match kind {
        "rectangle" => {
            let min = fields.need("min", "min = [0.0, 0.0] (m), the lower left corner", point);
            let max = fields.need("max", "max = [0.1, 0.04] (m), the upper right corner", point);
            Some(Shape::Rectangle { min: min?, max: max? })
        }
        "disk" => {
            let (center, radius) = (center(fields), fields.need("radius", "radius = 0.1 (m)", length));
            Some(Shape::Disk { center: center?, radius: radius? })
        }
        "annulus" => {
            let center = center(fields);
            let inner_radius = fields.need("inner_radius", "inner_radius = 0.1 (m)", length);
            let outer_radius = fields.need("outer_radius", "outer_radius = 0.2 (m)", length);
            Some(Shape::Annulus { center: center?, inner_radius: inner_radius?, outer_radius: outer_radius? })
        }
        "polygon" => {
            let like = "points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] (m)";
            fields.need("points", like, |item| item.each(point)).map(|points| Shape::Polygon { points })
        }
        _ => {
            let of = fields.need("of", "of = { rectangle = { ... } }, the shape cut from", shape);
            let minus = fields.need("minus", "minus = [{ disk = { ... } }], the shapes cut out", |i| i.each(cut_out));
            Some(Shape::Difference { of: Box::new(of?), minus: minus?.concat() })
        }
    }
}

/// Shapes that are cut out: any, or a notch.
fn cut_out(item: &Item<'_>) -> Option<Vec<Shape>> {
    match (item.at("notch"), item.at("union")) {
        (Some(given), _) => item.fields(&["notch"]).and_then(|_| notch(&given)),
        (None, Some(given)) => item.fields(&["union"]).and_then(|_| given.each(cut_out)).map(|shapes| shapes.concat()),
        (None, None) => shape(item).map(|shape| vec![shape]),
    }
}

/// A notch along a line: a strip, which a round tip ends with a disk about the second end.
fn notch(item: &Item<'_>) -> Option<Vec<Shape>> {
    let (from, to, width, round) = item.table(|fields| {
        let from = fields.need("from", "from = [0.0, 0.02] (m), its mouth", point);
        let to = fields.need("to", "to = [0.05, 0.02] (m), its tip", point);
        let width = fields.need("width", "width = \"1 mm\"", |item| item.positive(Dimension::LENGTH));
        let round = fields.or("tip", false, |item| item.choice(&[("square", false), ("round", true)]));
        Some((from?, to?, width?, round))
    })?;
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    if length == 0.0 {
        return item.fail("a notch of zero length", "give two different ends");
    }
    let [x, y] = along.map(|component| 0.5 * width * component / length);
    let corners =
        [[from[0] + y, from[1] - x], [to[0] + y, to[1] - x], [to[0] - y, to[1] + x], [from[0] - y, from[1] + x]];
    let strip = Shape::Polygon { points: corners.to_vec() };
    let tip = round.then_some(Shape::Disk { center: to, radius: 0.5 * width });
    Some(std::iter::once(strip).chain(tip).collect())
}

fn center(fields: &Fields<'_>) -> Option<[f64; 2]> {
    fields.need("center", "center = [0.0, 0.0] (m)", point)
}

fn crack(item: &Item<'_>) -> Option<Crack> {
    item.table(|fields| {
        let ends = [("from", "from = [0.0, 0.02] (m), the first end"), ("to", "to = [0.05, 0.02] (m), the second end")];
        let points = match (fields.get("points"), ends.iter().find_map(|(key, _)| fields.get(key))) {
            (Some(_), Some(end)) => end.fail("both points and an end are given", "remove one of the two"),
            (Some(points), None) => points.each(point),
            (None, _) => {
                let [from, to] = ends.map(|(key, like)| fields.need(key, like, point));
                from.zip(to).map(|(from, to)| vec![from, to])
            }
        };
        let is_slit = fields.or("as", false, |item| item.choice(&[("seed", false), ("slit", true)]));
        let half_width = fields.maybe("half_width", length);
        let speed = fields.maybe("speed", |item| item.quantity(Dimension::VELOCITY));
        let refused = |key: &str, message: &str, remedy: &str| fields.get(key)?.fail(message, remedy);
        let kind = match (is_slit, half_width, speed) {
            (false, half_width, None) => Some(CrackKind::Seed(half_width)),
            (true, None, None) => Some(CrackKind::Slit),
            (false, None, Some(speed)) => Some(CrackKind::Driven(speed)),
            (true, None, Some(_)) => refused("speed", "a slit does not grow", "remove it, or use as = \"seed\""),
            (true, Some(_), _) => refused("half_width", "a slit has no half width", "remove it, or use as = \"seed\""),
            (false, Some(_), Some(_)) => {
                refused("half_width", "a crack that is driven has the half width l0/2", "remove it")
            }
        };
        Some(Crack { points: points?, kind: kind? })
    })
}
