//! The errors that can be planted, and the cases whose checks should turn red.

/// An error that can be planted in the solver.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    /// Name, as at its site in the solver.
    pub id: &'static str,
    /// What is wrong.
    pub what: &'static str,
    /// Cases of the quick tier it is run on.
    pub cases: &'static [&'static str],
}

const fn fault(id: &'static str, what: &'static str, cases: &'static [&'static str]) -> Fault {
    Fault { id, what, cases }
}

/// All of them.
pub const FAULTS: [Fault; 34] = [
    fault("gradient-sign", "gradients of shape functions have the wrong sign", &["patch/spline-basis"]),
    fault("jacobian-missing", "weights of points miss the determinant of the map", &["patch/constant-stress-curved"]),
    fault("rational-weights-ignored", "NURBS weights are taken for 1", &["patch/linear-field-rational"]),
    fault(
        "knot-span-off-by-one",
        "a position is looked for in the next span",
        &["patch/constant-stress-gauss", "convergence/elastostatics-square"],
    ),
    fault("volumes-off-by-a-layer", "points have the volumes of the next layer", &["patch/constant-stress-gauss"]),
    fault("traction-on-wrong-edge", "tractions act on the bottom", &["patch/constant-stress-gauss"]),
    fault(
        "shear-halved",
        "mu in place of 2 mu in the shear stress",
        &["patch/constant-stress-gauss", "convergence/elastostatics-square"],
    ),
    fault(
        "plane-stress-lambda",
        "Lamé's constant of plane strain in plane stress",
        &["fracture/homogeneous-bar-residual", "convergence/kirsch-plane-stress"],
    ),
    fault("mass-lumped", "lumped mass in place of the consistent one", &["manufactured/bar-eigenfrequencies"]),
    fault("held-side-let-go", "prescribed components accelerate", &["fracture/plane-waves"]),
    fault("whole-kick", "the second half of the kick is a whole one", &["energy/vibration", "energy/free-vibration"]),
    fault("gravity-upwards", "gravity has the wrong sign in the forces", &["energy/ramped-traction"]),
    fault("driven-work-left-out", "the ledger misses the work of driven sides", &["energy/ramped-traction"]),
    fault("thickness-forgotten", "energies are those of a body a metre thick", &["stability/units"]),
    fault("half-step-velocity", "the velocity at half a step is taken for that at whole ones", &["energy/transfers"]),
    fault("loss-forgotten", "the ledger misses what imposed velocities cost", &["energy/updated-frame"]),
    fault("transfer-keeps-less", "points keep 0.999 of their velocity with FLIP", &["patch/rigid-translation"]),
    fault("affine-transposed", "points give the transpose of their velocity gradient", &["energy/spinning-disc"]),
    fault("hencky-without-half", "Hencky strain misses its 1/2", &["stability/split", "convergence/hencky-wave"]),
    fault("critical-step-too-long", "2.2 in place of 2 over the highest frequency", &["stability/critical-step"]),
    fault("stable-fraction-of-musl", "every transfer has the step of MUSL", &["stability/critical-step"]),
    fault("length-scale-doubled", "l0 is twice what the scene says", &["fracture/homogeneous-bar"]),
    fault(
        "one-minus-k-missing",
        "1 − k is left out of the phase-field equation",
        &["fracture/homogeneous-bar-residual"],
    ),
    fault("degradation-linear", "c in place of c² degrades the stress", &["fracture/homogeneous-bar"]),
    fault("phase-load-without-volumes", "the phase-field load misses volumes", &["fracture/homogeneous-bar"]),
    fault("phase-gradient-halved", "2 l0² in place of 4 l0² in the equation", &["fracture/seeded-crack-half"]),
    fault("surface-energy-doubled", "Gc/(2 l0) in place of Gc/(4 l0) in the energy", &["fracture/seeded-crack-half"]),
    fault("split-swapped", "principal strains are swapped in the split", &["stability/split"]),
    fault(
        "history-forgets",
        "the history field follows the tensile energy down",
        &["stability/unloading", "energy/updated-frame-fracture"],
    ),
    fault("history-work-halved", "the ledger books half the history work", &["energy/damage-time-order"]),
    fault(
        "history-left-behind",
        "the history field keeps its order when points are sorted",
        &["stability/flying-crack"],
    ),
    fault("friction-twice", "friction up to twice the coefficient", &["contact/incline-polygon"]),
    fault("normal-not-normalised", "normals of contact are as long as a segment", &["contact/onset"]),
    fault("impulse-one-sided", "body a feels nine tenths of the impulse", &["contact/discs-head-on"]),
];

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;
    use std::path::{Path, PathBuf};

    use super::*;

    fn workspace() -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
    }

    fn source_files() -> impl Iterator<Item = String> {
        let pattern = workspace().join("solver/src/**/*.rs");
        let paths = glob::glob(&pattern.to_string_lossy()).unwrap();
        paths.map(|path| std::fs::read_to_string(path.unwrap()).unwrap())
    }

    /// Names behind `fault!(` in a text.
    fn sites(text: &str) -> BTreeSet<String> {
        let behind = text.split("fault!(").skip(1).filter_map(|rest| rest.trim_start().strip_prefix('"'));
        behind.filter_map(|rest| rest.split('"').next()).map(str::to_string).collect()
    }

    #[test]
    fn the_table_the_list_of_the_solver_and_the_sites_name_the_same_faults() {
        let table: BTreeSet<String> = FAULTS.iter().map(|fault| fault.id.to_string()).collect();
        assert_eq!(table.len(), FAULTS.len(), "a name stands twice");
        let mut found = BTreeSet::new();
        for text in source_files() {
            let example = text.starts_with("//! Planted errors");
            if example {
                let list = text.split("FAULTS: [&str;").nth(1).and_then(|rest| rest.split("];").next()).unwrap();
                let listed: BTreeSet<String> = list.split('"').skip(1).step_by(2).map(str::to_string).collect();
                assert_eq!(listed, table);
            } else {
                found.extend(sites(&text));
            }
        }
        assert_eq!(found, table);
    }

    #[test]
    fn every_fault_names_cases_of_the_quick_tier() {
        for fault in FAULTS {
            assert!(!fault.cases.is_empty(), "{}", fault.id);
            for case in fault.cases {
                let path = workspace().join("verification/cases").join(case).with_extension("toml");
                let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {case}: {e}", fault.id));
                assert!(text.contains("tier = \"quick\""), "{case} is not of the quick tier");
            }
        }
    }
}
