//! A cut that ends flush with a side of its body opens that side: bodies pass through its mouth.

use crate::common::{body, elastic_scene, rectangle};
use fisura::Simulation;
use fisura::scene::*;
use fisura::validate::validate;

/// A specimen with a notch from its left side, and a rigid block through the mouth of that with air around
/// it.
fn block_in_a_notch(specimen: Shape) -> Scene {
    let mut scene = elastic_scene(2, [1.0; 2], [1; 2]);
    scene.mesh = Mesh::uniform([2, 2], [-0.03, -0.005], [0.24, 0.21], [48, 42]);
    scene.analysis.frame = Frame::Updated;
    scene.contact = Some(Contact::default());
    let block = rectangle([-0.02, 0.092], [0.025, 0.108]);
    scene.bodies = vec![body(specimen, [2; 2]), Body { name: "block".into(), rigid: true, ..body(block, [2; 2]) }];
    scene
}

fn cut_from(left: f64) -> Shape {
    let minus = vec![rectangle([left, 0.09], [0.08, 0.11])];
    Shape::Difference { of: Box::new(rectangle([0.0; 2], [0.2, 0.2])), minus }
}

#[test]
fn a_block_in_the_mouth_of_a_cut_overlaps_nothing_and_no_material_is_missed_there() {
    for left in [0.0, -0.01] {
        let scene = block_in_a_notch(cut_from(left));
        assert_eq!(validate(&scene), Ok(vec![]), "from {left}");
        let mut simulation = Simulation::new(&scene).unwrap();
        simulation.step().unwrap();
        assert_eq!(simulation.warnings(), [""; 0], "from {left}");
    }
    let mut scene = block_in_a_notch(cut_from(0.0));
    scene.bodies[1].shape = rectangle([-0.02, 0.085], [0.025, 0.108]);
    let errors = validate(&scene).unwrap_err();
    assert!(errors.iter().any(|error| error.message.contains("overlaps")), "{errors:?}");
}
