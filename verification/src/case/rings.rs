//! The `[rings]` table of a case file: geometries of two rings, all combinations of its lists.
//!
//! ```toml
//! study = "rings-sweep"
//!
//! [rings]
//! outer_radius = ["50 mm", "60 mm"]
//! inner_over_outer = [0.6, 0.7]
//! length_scale = ["1 mm"]
//! points = [2]                  # per span and direction
//! ```

use schemars::JsonSchema;
use serde::Deserialize;

use super::value::{Length, Positive, Whole};
use crate::case::geometry::Geometry;
use crate::scene::fields::Item;

/// Most geometries of a sweep.
const MOST_GEOMETRIES: usize = 10_000;

/// As it stands in the file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(super) struct RingsTable {
    /// Outer radii: `outer_radius = ["50 mm"]`.
    outer_radius: Vec<Length>,
    /// Ratios of the inner to the outer radius: `inner_over_outer = [0.6]`.
    inner_over_outer: Vec<Positive>,
    /// Length scales l0 of the phase field: `length_scale = ["1 mm"]`.
    length_scale: Vec<Length>,
    /// Points per span and direction: `points = [2]`.
    points: Vec<Whole<1, 8>>,
}

/// All combinations of the lists; `item` is the table.
pub(super) fn geometries(table: &RingsTable, item: &Item<'_>) -> Option<Vec<Geometry>> {
    let RingsTable { outer_radius, inner_over_outer, length_scale, points } = table;
    if let Some(ratio) = inner_over_outer.iter().find(|ratio| ratio.0 >= 1.0) {
        let message = format!("an inner radius of {} times the outer one", ratio.0);
        return item.at("inner_over_outer")?.fail(message, "give ratios below 1");
    }
    let all = [outer_radius.len(), inner_over_outer.len(), length_scale.len(), points.len()];
    let all = all.into_iter().fold(1, usize::saturating_mul);
    if all > MOST_GEOMETRIES {
        return item.fail(format!("{all} geometries"), format!("give lists with at most {MOST_GEOMETRIES} in all"));
    }
    let mut geometries = Vec::new();
    for Length(outer) in outer_radius {
        for Positive(ratio) in inner_over_outer {
            for Length(length_scale) in length_scale {
                let of = |points: &Whole<1, 8>| Geometry {
                    outer: *outer,
                    inner: ratio * outer,
                    length_scale: *length_scale,
                    points: points.0,
                };
                geometries.extend(points.iter().map(of));
            }
        }
    }
    Some(geometries)
}
