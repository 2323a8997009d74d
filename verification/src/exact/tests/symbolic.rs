//! Every quantity of every solution against the tables that `reference-data/derivations/` computes
//! symbolically.

use std::collections::BTreeMap;
use std::path::Path;

use fisura::scene::Plane;

use crate::exact::{ExactSolution, all};
use crate::extremes::larger;

/// Largest difference allowed, relative to the largest entry of the same kind in the table (and to 1e-3 at
/// least).
const TOLERANCE: f64 = 1e-12;

type Row = BTreeMap<String, String>;

fn table(name: &str) -> Vec<Row> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../reference-data/derivations");
    let mut reader = csv::Reader::from_path(folder.join(format!("{name}.csv"))).expect(name);
    reader.deserialize().collect::<Result<_, _>>().expect(name)
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("a number in column {column}"))
}

/// The quantities of a solution, in groups of one kind, with the names of their columns.
fn quantities(solution: &dyn ExactSolution, at: [f64; 2], time: f64) -> Vec<Vec<(&'static str, f64)>> {
    let pair = |names: [&'static str; 2], values: [f64; 2]| names.into_iter().zip(values).collect::<Vec<_>>();
    let tensor = |names: [&'static str; 4], values: [[f64; 2]; 2]| {
        names.into_iter().zip(values.into_iter().flatten()).collect::<Vec<_>>()
    };
    let mut groups = vec![
        pair(["u", "v"], solution.displacement(at, time)),
        tensor(["u_x", "u_y", "v_x", "v_y"], solution.displacement_gradient(at, time)),
        pair(["u_t", "v_t"], solution.velocity(at, time)),
        pair(["u_tt", "v_tt"], solution.acceleration(at, time)),
        tensor(["p_xx", "p_xy", "p_yx", "p_yy"], solution.stress(at, time)),
        pair(["b_x", "b_y"], solution.body_force(at, time)),
    ];
    if let Some(phase) = solution.phase() {
        groups.push(vec![("c", phase.value(at, time))]);
        groups.push(pair(["c_x", "c_y"], phase.gradient(at, time)));
        groups.push(vec![("history", phase.history(at, time))]);
        groups.push(vec![("source", phase.source(at, time))]);
    }
    groups
}

#[test]
fn solutions_agree_with_their_symbolic_derivations() {
    for solution in all() {
        let name = solution.name;
        let rows = table(name);
        assert!(rows.len() >= 12, "{name}");
        for row in &rows {
            let plane = match row["plane"].as_str() {
                "strain" => Plane::Strain,
                "stress" => Plane::Stress,
                other => panic!("{name}: plane state {other}"),
            };
            let solution = (solution.fields)(plane);
            let (at, time) = ([number(row, "x"), number(row, "y")], number(row, "t"));
            for group in quantities(solution.as_ref(), at, time) {
                let entries = group.iter().flat_map(|(column, _)| rows.iter().map(|r| number(r, column).abs()));
                let scale = entries.fold(1e-3, larger);
                for (column, value) in group {
                    let difference = (value - number(row, column)).abs() / scale;
                    assert!(
                        difference <= TOLERANCE,
                        "{name} {plane:?} {at:?} {time}: {column} is off by {difference:e}"
                    );
                }
            }
        }
    }
}
