//! Points on the sides of general patches: lengths, outward normals, and sums that close.

use crate::common::{annulus, bent_patch, body, random_patch};
use fisura::particles::lattice::Lattice;
use fisura::scene::*;
use fisura::splines::nurbs::NurbsPatch;
use fisura::splines::patch::Patch;
use fisura::splines::quadrature::Rule;

/// Σ n L = 0 and Σ x·n L = 2 area around a patch; the area is that of the lattice. `tolerance` is relative.
fn check_surface(name: &str, nurbs: &NurbsPatch, points: usize, tolerance: f64) -> f64 {
    let patch = Patch::new(&Mesh::of(nurbs));
    let mut area = 0.0;
    Lattice::new(&patch, &body(Shape::Patch, [points; 2])).for_each_point(|_, _, _, weight| area += weight);
    let rule = Rule::new(Layout::Gauss, points);
    let (mut closed, mut twice, mut length) = ([0.0; 2], 0.0, 0.0);
    for side in [Side::Left, Side::Right, Side::Bottom, Side::Top] {
        for (n, point) in patch.boundary(side, &rule).into_iter().enumerate() {
            let ([x, y], [nx, ny]) = (point.functions.position, point.normal);
            assert!((nx.hypot(ny) - 1.0).abs() <= 1e-14, "{name}: a unit normal");
            assert!((point.functions.values.iter().map(|f| f.1).sum::<f64>() - 1.0).abs() <= 1e-13);
            closed = [closed[0] + nx * point.length, closed[1] + ny * point.length];
            twice += (x * nx + y * ny) * point.length;
            length += point.length;
            // A little inwards lies on the patch, as much outwards does not.
            let moved = |step: f64| nurbs.locate([x + step * nx, y + step * ny], None).is_ok();
            assert!(
                n % 97 > 0 || (moved(-1e-7) && !moved(1e-7)),
                "{name}: the normal at ({x}, {y}) on the {side:?} side"
            );
        }
    }
    assert!(closed[0].hypot(closed[1]) <= tolerance * length, "{name}: not closed by {closed:?}");
    assert!((twice / (2.0 * area) - 1.0).abs() <= tolerance, "{name}: {twice} is not twice {area}");
    area
}

/// Sums over the sides close where the points integrate the sides exactly: on polynomial patches, and on
/// rational ones with more points than round-off needs.
#[test]
fn surfaces_are_closed() {
    for degree in 2..=4 {
        check_surface("bent", &bent_patch(degree, 3), degree + 1, 1e-13);
        let area = check_surface("annulus", &annulus(degree, 3), 12, 1e-13);
        approx::assert_relative_eq!(area, 0.75 * std::f64::consts::PI, max_relative = 1e-13);
        let random = random_patch([degree; 2], [4, 3], 400 + degree as u64).subdivide(16).unwrap();
        check_surface("random weights", &random, 16, 1e-12);
    }
}

#[test]
fn arcs_have_their_length_and_point_away_from_the_centre() {
    let patch = Patch::new(&Mesh::of(&annulus(2, 4)));
    let rule = Rule::new(Layout::Gauss, 10);
    for (side, radius, outwards) in [(Side::Left, 1.0, -1.0), (Side::Right, 2.0, 1.0)] {
        let points = patch.boundary(side, &rule);
        let length: f64 = points.iter().map(|p| p.length).sum();
        approx::assert_relative_eq!(length, radius * std::f64::consts::FRAC_PI_2, max_relative = 1e-13);
        for p in points {
            for d in 0..2 {
                assert!((p.normal[d] - outwards * p.functions.position[d] / radius).abs() <= 1e-13, "{side:?}");
            }
        }
    }
}
