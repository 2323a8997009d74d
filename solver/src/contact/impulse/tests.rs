//! Impulses at constraints that share few control points.

mod three_fields;

use super::*;
use crate::contact::constraint::BoundaryFunctions;

/// A constraint of body 0 on the left with a rigid body, which pushes it along the normal.
fn constraint(normal: [f64; 2], x: f64) -> ContactConstraint {
    let (bodies, square, on_a) = ([0, 1], [0, 0], BoundaryFunctions::default());
    ContactConstraint { gap: 0.0, pressing: None, bodies, square, position: [x, 0.5], normal, on_a, on_b: None }
}

/// A constraint, its nodes with their weights, and the velocity of a rigid body.
type Described = (ContactConstraint, Vec<(usize, f64)>, [f64; 2]);

/// A problem of nodes of unit mass at rest.
fn problem<'a>(nodes: usize, constraints: &'a [Described]) -> Problem<'a> {
    let [before, free, after] = [[0.0; 2]; 3];
    let node = |at| Node { body: 0, at, mobility: [1.0; 2], before, free, after };
    let nodes: Vec<Node> = (0..nodes).map(node).collect();
    let acting = |(constraint, weights, rigid): &'a Described| {
        let weights = weights.iter().map(|&(node, weight)| (node, -weight)).collect();
        let impulse = Impulse::default();
        let mut acting = Acting { constraint, weights, rigid: *rigid, round_off: 0.0, answers: [0.0; 2], impulse };
        acting.find_answers(&nodes);
        acting
    };
    let constraints = constraints.iter().map(acting).collect();
    Problem { nodes, constraints, unconverged: None }
}

/// Two walls that close on one control point: no impulses keep both out.
#[test]
fn impulses_that_cannot_converge_are_said_to_be_unconverged() {
    for friction in [0.0, 0.3] {
        let walls = [
            (constraint([1.0, 0.0], 0.25), vec![(0, 1.0)], [-1.0, 0.0]),
            (constraint([-1.0, 0.0], 0.75), vec![(0, 1.0)], [1.0, 0.0]),
        ];
        let mut problem = problem(1, &walls);
        problem.converge(friction, 1.0);
        let found = problem.unconverged.expect("no solution");
        assert!(found.residual > ACCEPTED && found.iterations == MOST_ITERATIONS && found.place[1] == 0.5, "{found:?}");
    }
    let broken = [(constraint([1.0, 0.0], 0.25), vec![(0, 1.0)], [f64::NAN, 0.0])];
    let mut problem = problem(1, &broken);
    problem.converge(0.3, 1.0);
    assert!(problem.unconverged.expect("no number").residual.is_nan());
}

/// A wall against a row of control points, at as many places between them: neighbours differ in how it falls
/// on them, and iterations take as many as the square of the row to find out. The equations say at once.
#[test]
fn touches_as_many_as_control_points_converge() {
    let count = 60;
    for friction in [0.0, 0.3] {
        let between = |i: usize| {
            let push = [-1.0 - 0.01 * (i as f64).sin(), 0.2];
            (constraint([1.0, 0.0], i as f64), vec![(i, 0.5), ((i + 1) % (count + 1), 0.5)], push)
        };
        let constraints: Vec<_> = (0..count).map(between).collect();
        let mut slow = problem(count + 1, &constraints);
        assert!(
            !slow.iterations(friction, 1.0).has_converged(CONVERGED),
            "the iterations alone converge: the test is empty"
        );
        let mut problem = problem(count + 1, &constraints);
        problem.converge(friction, 1.0);
        assert_eq!(problem.unconverged, None);
        for acting in &problem.constraints {
            let [approach, slide] = acting.relative(&problem.nodes, |node| node.after);
            let Impulse { normal, tangent } = acting.impulse;
            assert!(normal >= 0.0 && approach > -1e-9 && normal * approach.abs() < 1e-9, "{normal} and {approach}");
            assert!(
                tangent.abs() <= friction * normal * (1.0 + 1e-12) && tangent * slide <= 1e-9,
                "{tangent} and {slide}"
            );
        }
    }
}
