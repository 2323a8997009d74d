//! Slits and narrow gaps: material on both sides shares nothing, and everything else stays as it is.

use approx::assert_relative_eq;
use fisura::Simulation;
use fisura::linear_algebra::extremes::larger;
use fisura::scene::*;
use fisura::validate::validate;

use crate::common::{annulus, elastic_scene, patch_scene, rectangle, relative_closure, run};

fn slit(points: &[[f64; 2]]) -> Crack {
    Crack { points: points.to_vec(), kind: CrackKind::Slit }
}

/// A square of 10 mm with a slit, whose upper part is pulled up.
fn pulled(degree: usize, points: &[[f64; 2]]) -> Scene {
    let mut scene = elastic_scene(degree, [0.01; 2], [12; 2]);
    scene.bodies[0].cracks = vec![slit(points)];
    let load = Traction::on(Side::Top, [0.0, 1e6], TimeFactor::ramp(1e-6));
    scene.bodies[0].tractions = vec![load];
    assert!(validate(&scene).is_ok(), "{:?}", validate(&scene));
    scene
}

/// Restricted to one side of a knot line, splines are all splines there: the static state is that of a body
/// that ends at the line.
#[test]
fn a_slit_on_a_knot_line_makes_two_bodies() {
    for degree in [1, 2, 3] {
        let mut whole = pulled(degree, &[[0.0, 0.005], [0.01, 0.005]]);
        whole.bodies[0].tractions[0].time = TimeFactor::default();
        whole.boundaries = vec![Boundary::fixed(Side::Right, [true, true])];
        whole.equilibrium = true;
        let mut upper = whole.clone();
        upper.bodies[0].cracks.clear();
        upper.mesh = Mesh::uniform([degree; 2], [0.0, 0.005], [0.01, 0.005], [12, 6]);
        upper.bodies[0].shape = rectangle([0.0, 0.005], [0.01, 0.01]);
        let [whole, alone] = [whole, upper].map(|scene| Simulation::new(&scene).unwrap().sample());
        assert_relative_eq!(whole.elastic, alone.elastic, max_relative = 1e-9);
    }
}

#[test]
fn a_slit_in_a_body_at_rest_changes_no_mass_and_no_stress_beside_it() {
    // A slit along the load does not disturb a bar in uniform tension without contraction.
    let mut scene = elastic_scene(2, [0.01; 2], [12; 2]);
    scene.materials.get_mut("glass").unwrap().poisson_ratio = 0.0;
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [false, true])];
    let load = Traction::on(Side::Top, [0.0, 1e6], TimeFactor::ramp(1e-6));
    scene.bodies[0].tractions = vec![load];
    let whole = run(&scene).1;
    scene.bodies[0].cracks = vec![slit(&[[0.0047, 0.0], [0.0047, 0.0061]])];
    let (simulation, cut) = run(&scene);
    for (whole, cut) in whole.iter().zip(&cut) {
        assert_relative_eq!(whole.kinetic, cut.kinetic, max_relative = 1e-9, epsilon = 1e-18);
        assert_relative_eq!(whole.elastic, cut.elastic, max_relative = 1e-9, epsilon = 1e-18);
    }
    let grid = &simulation.total_frame().unwrap().lattice;
    assert!(grid.grid.rows > grid.patch_grid.rows, "there are copies");
}

/// The material beyond a gap that is much thinner than the distance of points, of every kind of boundary.
#[test]
fn a_gap_thinner_than_the_distance_of_points_is_not_bridged() {
    let band = |y: f64, slope: f64, width: f64| Shape::Polygon {
        points: [[-0.01, 0.0], [0.02, 0.0], [0.02, width], [-0.01, width]]
            .map(|[x, up]| [x, y + slope * (x - 0.005) + up])
            .to_vec(),
    };
    let ring = Shape::Annulus { center: [0.005, -0.1], inner_radius: 0.105, outer_radius: 0.10502 };
    let square = || Box::new(rectangle([0.0; 2], [0.01; 2]));
    let gaps = [rectangle([-1.0, 0.00503], [1.0, 0.00504]), band(0.00503, 0.0, 1e-5), band(0.00503, 0.3, 1e-5), ring];
    for (number, gap) in gaps.into_iter().enumerate() {
        for degree in [1, 2, 3] {
            let mut scene = pulled(degree, &[[0.0, 0.005], [0.01, 0.005]]);
            let shape = Shape::Difference { of: square(), minus: vec![gap.clone()] };
            scene.bodies[0].shape = shape;
            scene.bodies[0].cracks.clear();
            let ends = [[0.0, 0.01], [0.01, 0.01]];
            let load = Load::Stress([0.0, 1e6]);
            scene.bodies[0].tractions =
                vec![Traction { edge: Edge::Segment(ends), load, time: TimeFactor::ramp(1e-6) }];
            let (simulation, _) = run(&scene);
            let mut most = 0.0;
            simulation.for_each_point(&mut |point| {
                if point.position[1] < 0.0034 {
                    most = larger(most, point.velocity[0].hypot(point.velocity[1]));
                }
            });
            assert_eq!(most, 0.0, "gap {number}, p = {degree}");
        }
    }
}

#[test]
fn a_slit_parts_a_patch_with_a_geometry() {
    for degree in [2, 3] {
        let (sine, cosine) = 0.8_f64.sin_cos();
        let mut scene = patch_scene(&annulus(degree, 12), degree);
        scene.bodies[0].cracks = vec![slit(&[[cosine, sine], [2.0 * cosine, 2.0 * sine]])];
        let warnings = |angle: f64, scene: &mut Scene| {
            let (sine, cosine) = angle.sin_cos();
            scene.bodies[0].cracks[0].points = vec![[cosine, sine], [2.0 * cosine, 2.0 * sine]];
            validate(scene).unwrap().iter().filter(|warning| warning.message.contains("knot lines")).count()
        };
        assert_eq!([std::f64::consts::FRAC_PI_4, 0.8].map(|angle| warnings(angle, &mut scene)), [0, 1]);
        scene.bodies[0].tractions = vec![Traction::on(Side::Top, [1e6, 2e6], TimeFactor::ramp(1e-4))];
        scene.analysis.end_time = 1e-3;
        let (simulation, samples) = run(&scene);
        let mut most = 0.0;
        simulation.for_each_point(&mut |point| {
            if point.position[1] < point.position[0] * 0.8_f64.tan() {
                most = larger(most, point.velocity[0].hypot(point.velocity[1]));
            }
        });
        assert_eq!(most, 0.0, "p = {degree}");
        assert!(samples.last().unwrap().kinetic > 0.0 && relative_closure(&samples) < 1e-9, "p = {degree}");
    }
}

/// A load beside a slit whose side has no point in the span under it goes to the next span of that side.
#[test]
fn a_load_stays_on_its_side_of_a_slit() {
    for degree in [2, 3] {
        let mut scene = pulled(degree, &[[0.0, 0.0005], [0.0095, 0.01]]);
        let ends = [[0.0, 0.01], [0.0094, 0.01]];
        let load = Load::Stress([0.0, 1e6]);
        scene.bodies[0].tractions = vec![Traction { edge: Edge::Segment(ends), load, time: TimeFactor::ramp(1e-6) }];
        let mut most = 0.0;
        run(&scene).0.for_each_point(&mut |point| {
            if point.position[1] < point.position[0] + 0.0004 {
                most = larger(most, point.velocity[0].hypot(point.velocity[1]));
            }
        });
        assert_eq!(most, 0.0, "p = {degree}");
    }
}

#[test]
fn a_slit_is_refused_where_it_is_not_implemented() {
    let keys = |change: fn(&mut Scene)| {
        let mut scene = pulled(2, &[[0.0, 0.0051], [0.004, 0.0051]]);
        change(&mut scene);
        validate(&scene).unwrap_err().into_iter().map(|e| e.key).collect::<Vec<_>>()
    };
    assert_eq!(keys(|s| s.analysis.frame = Frame::Updated), ["body.0.crack.0.as"]);
    assert_eq!(
        keys(|s| s.mesh = Mesh::uniform([1; 2], [0.0; 2], [0.01; 2], [12; 2])),
        ["body.0.shape"],
        "it runs between two knots"
    );
    assert_eq!(keys(|s| s.bodies[0].cracks[0].points.truncate(1)), ["body.0.crack.0"]);
    assert_eq!(keys(|s| s.bodies[0].cracks[0].points.push([0.02, 0.0])), ["body.0.crack.0.points.2"]);
}

/// Elastic energy of a held body under a load on its top, with slits.
fn held(cells: usize, degree: usize, slits: &[[[f64; 2]; 2]]) -> f64 {
    let mut scene = elastic_scene(degree, [1.0; 2], [cells; 2]);
    scene.bodies[0].tractions = vec![Traction::on(Side::Top, [0.3e6, 1e6], TimeFactor::default())];
    scene.bodies[0].cracks = slits.iter().map(|ends| slit(ends)).collect();
    scene.boundaries = vec![Boundary::fixed(Side::Bottom, [true, true])];
    scene.equilibrium = true;
    Simulation::new(&scene).unwrap().sample().elastic
}

/// Slits from a loaded corner or edge, across each other, close to each other and to a held side: no material
/// is left without neighbours, wherever the points of the spans lie.
#[test]
fn material_beside_a_slit_keeps_its_neighbours() {
    let places: [&[[[f64; 2]; 2]]; 5] = [
        &[[[0.0, 1.0], [0.3, 0.7]]],
        &[[[0.312, 1.0], [0.306, 0.6]]],
        &[[[0.487, 0.595], [0.284, 0.216]], [[0.369, 0.355], [0.685, 0.833]]],
        &[[[0.3, 0.5], [0.7, 0.55]], [[0.45, 0.3], [0.5, 0.8]]],
        &[[[0.0, 0.01], [0.5, 0.01]]],
    ];
    for degree in [2, 3] {
        let whole = held(20, degree, &[]);
        for slits in places {
            let [coarse, middle, fine] = [17, 20, 30].map(|cells| held(cells, degree, slits));
            // a slit acts up to half a span beside its tip, and beside a held side that is much of its effect
            for energy in [coarse, middle] {
                assert!((energy / fine - 1.0).abs() < 0.25, "{slits:?}, p = {degree}: {coarse} {middle} {fine}");
            }
            assert!(fine > 1.005 * whole, "{slits:?}, p = {degree}: {fine} for {whole} without a slit");
        }
    }
}

#[test]
fn a_slit_that_parts_nothing_is_told() {
    let told = |from: f64, to: f64| {
        let scene = pulled(2, &[[from, 0.005], [to, 0.005]]);
        let warnings = Simulation::new(&scene).unwrap().warnings().to_vec();
        warnings.iter().any(|warning| warning.contains("has no effect"))
    };
    assert!(told(0.0045, 0.0055) && !told(0.004, 0.006) && !told(0.002, 0.008) && !told(0.0, 0.002));
}
