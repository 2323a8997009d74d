//! From the tree of a document to the background mesh: a rectangle, a general NURBS patch, or an annular
//! sector.

use fisura::scene::{Geometry, Mesh, Side};
use fisura::splines::nurbs::{NurbsError, NurbsPatch};

use super::document::Node;
use super::fields::{Fields, Item, Problems};
use super::read::{length, number, point};

/// Largest number of spans in one direction.
const MOST_CELLS: usize = 100_000;
/// Largest number of positions, (p + 1)(q + 1) in every span, at which a patch with a geometry is checked for
/// folds: half a second; and of its spans in one direction.
const MOST_MAPPED_POSITIONS: usize = 2_500_000;
const MOST_MAPPED_IN_A_ROW: usize = 10_000;
/// Excess of a length over whole cells that counts as none.
const ROUND_OFF: f64 = 1e-9;
/// Angle short of a full turn that a ring has to leave open, rad.
const LEAST_OPENING: f64 = 1e-9;
/// Most times that spans near a crack are halved.
const MOST_HALVINGS: usize = 3;
const KEYS: [&str; 11] = [
    "degree",
    "origin",
    "size",
    "cells",
    "knots",
    "long_ends",
    "control_points",
    "weights",
    "subdivide",
    "annulus",
    "refine",
];

/// The `[mesh]` table; a rectangle without cells has cells of at most `longest`, m.
pub(super) fn mesh(item: &Item<'_>, longest: Option<f64>) -> Option<Mesh> {
    let fields = item.fields(&KEYS)?;
    let form = ["control_points", "annulus"].into_iter().find(|key| fields.get(key).is_some());
    let allowed: &[&str] = match form {
        Some("control_points") => &["degree", "knots", "control_points", "weights", "subdivide"],
        Some(_) => &["degree", "cells", "long_ends", "annulus"],
        None => &["degree", "origin", "size", "cells", "knots", "subdivide", "long_ends", "refine"],
    };
    let mut complete = true;
    for key in KEYS.into_iter().filter(|key| !allowed.contains(key)) {
        if let Some(extra) = fields.get(key) {
            let what = form.map_or("a rectangle".to_string(), |form| format!("a mesh with {form}"));
            let remedy = format!("remove it; {what} uses {}", allowed.join(", "));
            complete = extra.fail::<()>(format!("{key} cannot be used with {what}"), remedy).is_some();
        }
    }
    let degree = fields.or("degree", [2; 2], of_degree);
    match (form, complete) {
        (_, false) => None,
        (Some("control_points"), _) => general(&fields, degree),
        (Some(_), _) => fields.get("annulus").and_then(|item| annulus(&item, &fields, degree)),
        (None, _) => rectangle(&fields, degree, longest),
    }
}

/// The degree in the tree of a scene, if it is one; [`mesh`] says what is wrong with it.
pub(super) fn degree(scene: &Node) -> Option<[usize; 2]> {
    of_degree(&Item::new(scene.at("mesh.degree")?, "", &Problems::default()))
}

fn of_degree(item: &Item<'_>) -> Option<[usize; 2]> {
    item.whole_per_direction(1, 4)
}

fn rectangle(fields: &Fields<'_>, degree: [usize; 2], longest: Option<f64>) -> Option<Mesh> {
    let origin = fields.or("origin", [0.0; 2], point);
    let size = fields.need("size", "size = [0.1, 0.04] (m), width and height", size);
    let knots = fields.maybe("knots", |item| item.pair(|direction| direction.each(length)));
    let halvings = fields.or("refine", 0, |item| {
        let like = "levels = 1, how often spans near a crack are halved";
        item.table(|fields| fields.need("levels", like, |item| item.whole(1, MOST_HALVINGS)))
    });
    let coarsening = f64::from(1 << halvings); // of the spans away from cracks
    let by_knots = fields.get("knots").is_some();
    let cells = match (fields.get("cells"), by_knots) {
        (Some(cells), true) => cells.fail("both cells and knots are given", "remove one of the two"),
        (None, false) => match (longest.map(|longest| longest * coarsening), size) {
            (Some(longest), Some(size)) => cells_of(fields, size, longest),
            _ => fields.need("cells", "cells = [100, 40], the spans per direction", |_| None),
        },
        (Some(cells), _) => cells.whole_per_direction(1, MOST_CELLS),
        (None, _) => Some([1, 1]),
    };
    let parts = match fields.get("subdivide").filter(|_| !by_knots) {
        Some(item) => item.fail("subdivide without knots", "give more cells, or the knots to subdivide"),
        None => Some(fields.or("subdivide", 1, |item| item.whole(1, MOST_CELLS))),
    };
    let ends = long_ends(fields);
    let (size, cells, parts) = (size?, cells?, parts?);
    let mut mesh = match knots {
        None => Mesh::uniform(degree, origin, size, cells),
        Some(knots) => graded(fields, degree, origin, size, knots, parts)?,
    };
    mesh.halvings = halvings;
    if ends?.into_iter().all(|side| mesh.lengthen_end(side)) { Some(mesh) } else { too_short(fields) }
}

/// Cells of at most `longest` (m) in a rectangle of a size, m.
fn cells_of(fields: &Fields<'_>, size: [f64; 2], longest: f64) -> Option<[usize; 2]> {
    let cells = size.map(|size| (size / longest * (1.0 - ROUND_OFF)).ceil().max(1.0));
    if cells.iter().all(|cells| *cells <= MOST_CELLS as f64) {
        return Some(cells.map(|cells| cells as usize));
    }
    let message = format!("cells of {longest:.3e} m would be {} x {}", cells[0], cells[1]);
    fields
        .get("size")?
        .fail(message, format!("ask for less accuracy, or give cells: at most {MOST_CELLS} in a direction"))
}

/// Sides at which the last two spans are one.
fn long_ends(fields: &Fields<'_>) -> Option<Vec<Side>> {
    let ends = fields.or("long_ends", Vec::new(), |item| item.each(Item::word::<Side>));
    if (1..ends.len()).any(|number| ends[..number].contains(&ends[number])) {
        return fields.get("long_ends")?.fail("a side is named twice", "name each side once");
    }
    Some(ends)
}

fn too_short<T>(fields: &Fields<'_>) -> Option<T> {
    let remedy = "give more cells, or leave the side out";
    fields.get("long_ends")?.fail("there are too few spans to join two at a side", remedy)
}

fn size(item: &Item<'_>) -> Option<[f64; 2]> {
    item.pair(|entry| {
        let value = length(entry)?;
        if value > 0.0 { Some(value) } else { entry.fail("a size must be positive", "give a positive length") }
    })
}

/// Each knot vector scaled affinely, the first knot to `origin`, the last to `origin + size`, and every span
/// cut into equal parts.
fn graded(
    fields: &Fields<'_>,
    degree: [usize; 2],
    origin: [f64; 2],
    size: [f64; 2],
    knots: [Vec<f64>; 2],
    parts: usize,
) -> Option<Mesh> {
    let item = fields.get("knots")?;
    for d in 0..2 {
        let [Some(first), Some(last)] = [knots[d].first(), knots[d].last()] else {
            return item.fail(format!("no knots in direction {d}"), "give an open knot vector per direction");
        };
        if !(first < last && (last - first).is_finite()) {
            return item.fail("the last knot must be larger than the first", "give increasing knots");
        }
    }
    let spans = knots.each_ref().map(|knots| parts * knots.windows(2).filter(|k| k[0] < k[1]).count());
    if parts > 1 && spans.into_iter().any(|spans| spans > MOST_CELLS) {
        let remedy = format!("give a smaller number: at most {MOST_CELLS} spans in a direction");
        return fields.get("subdivide")?.fail(format!("{} x {} spans", spans[0], spans[1]), remedy);
    }
    let knots = [0, 1].map(|d| {
        let (first, last) = (knots[d][0], knots[d][knots[d].len() - 1]);
        let cut = |k: &[f64]| -> Vec<f64> {
            let parts = if k[0] < k[1] { parts } else { 1 };
            (0..parts).map(|i| k[0] + (k[1] - k[0]) * (i as f64 / parts as f64)).collect()
        };
        let cut = knots[d].windows(2).flat_map(cut).chain([last]);
        cut.map(|k| origin[d] + size[d] * ((k - first) / (last - first))).collect()
    });
    Some(Mesh::of_knots(degree, knots))
}

/// Knots, control points and weights as given, every span cut into `subdivide` equal parts by knot insertion.
fn general(fields: &Fields<'_>, degree: [usize; 2]) -> Option<Mesh> {
    let knots =
        fields.need("knots", "knots = [[0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1]], one vector per direction", |item| {
            item.pair(|direction| direction.each(number))
        });
    let like = "control_points = [[0.0, 0.0], …] (m), first direction fastest";
    let control_points: Option<Vec<[f64; 2]>> = fields.need("control_points", like, |item| item.each(point));
    let weights = fields.maybe("weights", |item| item.each(number));
    let parts = fields.or("subdivide", 1, |item| item.whole(1, MOST_CELLS));
    let (knots, control_points) = (knots?, control_points?);
    let weights = weights.unwrap_or_else(|| vec![1.0; control_points.len()]);
    let mesh = Mesh { degree, knots, geometry: Some(Geometry { control_points, weights }), halvings: 0 };
    match mesh.nurbs()? {
        Ok(patch) if parts > 1 => {
            let spans = patch.spaces().each_ref().map(|space| space.spans().len().saturating_mul(parts));
            few_enough(fields, "subdivide", spans, degree)?;
            refined(fields, "subdivide", patch.subdivide(parts))
        }
        _ => Some(mesh), // validation says what is wrong with a patch
    }
}

/// The sector between two radii: the first direction is radial, the second angular.
fn annulus(item: &Item<'_>, fields: &Fields<'_>, degree: [usize; 2]) -> Option<Mesh> {
    let inner_fields = item.fields(&["center", "inner_radius", "outer_radius", "angles"])?;
    let center = inner_fields.or("center", [0.0; 2], point);
    let inner = inner_fields.need("inner_radius", "inner_radius = 0.1 (m)", length);
    let outer = inner_fields.need("outer_radius", "outer_radius = 0.2 (m)", length);
    let angles = inner_fields.or("angles", [0.0, std::f64::consts::FRAC_PI_2], |item| item.pair(number));
    let cells = fields.need("cells", "cells = [16, 32], the spans along the radius and along the arc", |item| {
        item.whole_per_direction(1, MOST_CELLS)
    });
    if degree[1] < 2 {
        let remedy = "give a degree of at least 2 along the arc, such as degree = [1, 2] or 2";
        return fields.get("degree")?.fail("an arc is a rational curve of degree 2", remedy);
    }
    let ends = long_ends(fields);
    let (inner, outer, cells, ends) = (inner?, outer?, cells?, ends?);
    few_enough(fields, "cells", cells, degree)?;
    if angles[1] - angles[0] >= std::f64::consts::TAU - LEAST_OPENING {
        let message = "a full turn would leave a slit: the ends of the patch touch and are not joined";
        return item.fail(message, "give a sector with symmetry planes at its ends, such as half a turn");
    }
    if inner == 0.0 {
        let message = "an inner radius of zero: a side of the patch would shrink to a point, which has no normal";
        let remedy = "give a small positive inner_radius, or a disk as the body of a rectangular mesh";
        return inner_fields.get("inner_radius")?.fail(message, remedy);
    }
    let sector = match NurbsPatch::annular_sector(inner, outer, angles) {
        Ok(sector) => sector,
        Err(error) => return item.fail(error.to_string(), "give 0 < inner_radius < outer_radius and growing angles"),
    };
    let pieces = sector.spaces()[1].spans().len();
    if !cells[1].is_multiple_of(pieces) {
        let message = format!("{} cells along an arc of {pieces} rational pieces", cells[1]);
        return fields.get("cells")?.fail(message, format!("give a multiple of {pieces}"));
    }
    let joined = [[Side::Left, Side::Right], [Side::Bottom, Side::Top]]
        .map(|sides| sides.map(|side| usize::from(ends.contains(&side))));
    if (0..2).any(|d| cells[d] / [1, pieces][d] <= joined[d][0] + joined[d][1]) {
        return too_short(fields);
    }
    let refine = || {
        let mut patch = sector;
        for d in 0..2 {
            while patch.spaces()[d].degree() < degree[d] {
                patch = patch.elevate(d)?;
            }
            let parts = cells[d] / [1, pieces][d];
            let spans = patch.spaces()[d].spans().iter();
            let mut new: Vec<f64> =
                spans.flat_map(|s| (1..parts).map(move |i| s.left + s.length() * i as f64 / parts as f64)).collect();
            let [first, last] = joined[d];
            new.drain(..first);
            new.truncate(new.len() - last);
            patch = patch.insert_knots(d, &new)?;
        }
        Ok(patch)
    };
    let mut mesh = refined(fields, "annulus", refine())?;
    let points = mesh.geometry.as_mut().map(|geometry| &mut geometry.control_points);
    for point in points.into_iter().flatten() {
        *point = [point[0] + center[0], point[1] + center[1]];
    }
    Some(mesh)
}

fn few_enough(fields: &Fields<'_>, key: &str, [columns, rows]: [usize; 2], degree: [usize; 2]) -> Option<()> {
    let spans = columns.saturating_mul(rows);
    let most = MOST_MAPPED_POSITIONS / ((degree[0] + 1) * (degree[1] + 1));
    if spans <= most && columns.max(rows) <= MOST_MAPPED_IN_A_ROW {
        return Some(());
    }
    let remedy = format!("give fewer: at most {most} spans in all and {MOST_MAPPED_IN_A_ROW} in a direction");
    fields.get(key)?.fail(format!("a general patch of {spans} spans"), remedy)
}

fn refined(fields: &Fields<'_>, key: &str, patch: Result<NurbsPatch, NurbsError>) -> Option<Mesh> {
    match patch {
        Ok(patch) => Some(Mesh::of(&patch)),
        Err(error) => fields.get(key)?.fail(error.to_string(), "correct the patch"),
    }
}
