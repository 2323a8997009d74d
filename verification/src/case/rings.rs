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

use crate::case::geometry::Geometry;
use crate::scene::fields::Item;
use crate::scene::units::Dimension;

/// Most geometries of a sweep.
const MOST_GEOMETRIES: usize = 10_000;

pub(super) fn read(item: &Item<'_>) -> Option<Vec<Geometry>> {
    let fields = item.fields(&["outer_radius", "inner_over_outer", "length_scale", "points"])?;
    let list = |key: &str, like: &str, dimension: Dimension| {
        fields.need(key, like, |i| i.each(|entry| entry.positive(dimension)))
    };
    let outer = list("outer_radius", "outer_radius = [\"50 mm\"]", Dimension::LENGTH);
    let ratio = list("inner_over_outer", "inner_over_outer = [0.6]", Dimension::NONE);
    let scale = list("length_scale", "length_scale = [\"1 mm\"]", Dimension::LENGTH);
    let points = fields.need("points", "points = [2]", |i| i.each(|n| n.whole(1, 8)));
    let (outer, ratio, scale, points) = (outer?, ratio?, scale?, points?);
    if let Some(ratio) = ratio.iter().find(|ratio| **ratio >= 1.0) {
        let message = format!("an inner radius of {ratio} times the outer one");
        return fields.get("inner_over_outer")?.fail(message, "give ratios below 1");
    }
    let all = [outer.len(), ratio.len(), scale.len(), points.len()].into_iter().fold(1, usize::saturating_mul);
    if all > MOST_GEOMETRIES {
        return item.fail(format!("{all} geometries"), format!("give lists with at most {MOST_GEOMETRIES} in all"));
    }
    let mut geometries = Vec::new();
    for &outer in &outer {
        for &ratio in &ratio {
            for &length_scale in &scale {
                let of = |&points: &usize| Geometry { outer, inner: ratio * outer, length_scale, points };
                geometries.extend(points.iter().map(of));
            }
        }
    }
    Some(geometries)
}
