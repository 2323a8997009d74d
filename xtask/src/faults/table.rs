//! The errors that can be planted, and the cases whose checks should turn red.

/// An error that can be planted, in the solver or where results are judged.
#[derive(Debug, Clone, Copy)]
pub struct Fault {
    /// Name, as at its sites.
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
pub const FAULTS: &[Fault] = &[
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
    fault("broken-points-hold", "broken points hold fragments together", &["contact/parted-bar"]),
    fault("crack-faces-left-out", "fragments have no boundary along the crack", &["contact/cracked-slope"]),
    fault(
        "partition-unbooked",
        "the ledger leaves out what changes where a body falls into fragments",
        &["contact/parted-bar"],
    ),
    fault(
        "joint-force-of-one-slice",
        "the forces of one slice count where two share a control point",
        &["contact/closing-ring"],
    ),
    fault("seam-left-behind", "slices hang together where their seam was at t = 0", &["contact/closing-ring"]),
    fault("normal-not-normalised", "normals of contact are as long as a segment", &["contact/onset"]),
    fault("impulse-one-sided", "body a feels nine tenths of the impulse", &["contact/discs-head-on"]),
    fault(
        "affine-left-behind",
        "velocity gradients keep their order when points are sorted",
        &["energy/spinning-disc"],
    ),
    fault(
        "apic-spread-of-quadratics",
        "APIC takes h²/4 for the spread of the weights whatever they are",
        &["energy/spinning-disc"],
    ),
    fault(
        "band-in-other-units",
        "bounds of a reference band miss the factor to the unit of the check",
        &["stability/judging"],
    ),
    fault(
        "boundary-lags-behind",
        "the boundary of a body moves by nine tenths of its velocity",
        &["contact/impact-equal"],
    ),
    fault("bounds-both-above", "bounds around a reference value lie both above it", &["stability/judging"]),
    fault(
        "checkpoint-without-accelerations",
        "a checkpoint leaves the accelerations out",
        &["stability/repeatability"],
    ),
    fault("closure-at-the-start", "the closure of a run is that of its first row", &["stability/judging"]),
    fault(
        "compression-degraded",
        "the phase field degrades the compressive stress as well",
        &["energy/damage-time-order"],
    ),
    fault("contact-loss-doubled", "the ledger books the loss of contact twice", &["contact/discs-head-on"]),
    fault("contact-pulls", "contact holds bodies together", &["contact/discs-head-on"]),
    fault(
        "curves-compared-by-their-mean",
        "differences from a curve are added up before they are squared",
        &["stability/judging"],
    ),
    fault("deformation-from-the-wrong-side", "F (I + A) in place of (I + A) F", &["energy/transfers-finite"]),
    fault(
        "deformation-left-behind",
        "deformation gradients keep their order when points are sorted",
        &["energy/transfers-finite", "stability/fast-disc"],
    ),
    fault(
        "difference-upwards-only",
        "a difference of two runs counts where it is positive alone",
        &["stability/judging"],
    ),
    fault("drift-upwards-only", "a drift counts where it is upwards alone", &["stability/judging"]),
    fault("driven-side-lags", "a driven side of the updated frame has half its velocity", &["energy/transfers"]),
    fault("driven-side-reversed", "driven sides move the other way", &["stability/broken-band"]),
    fault("events-seen-late", "events of the first half of a run are overlooked", &["rings/collision"]),
    fault("extrapolation-backwards", "Richardson's correction has the wrong sign", &["energy/grid-convergence"]),
    fault(
        "fall-from-the-last-row",
        "a fall is counted from one row to the next, not from the highest",
        &["stability/judging"],
    ),
    fault(
        "fictitious-material-heavy",
        "the material that fills empty spans weighs as much as the body",
        &["energy/updated-frame-fracture"],
    ),
    fault("friction-one-way", "friction acts in one direction along a boundary alone", &["stability/stick-slip"]),
    fault("gap-without-sign", "a boundary that overlaps another counts as apart from it", &["contact/hertz"]),
    fault("gaps-are-overlooked", "the largest of some numbers loses those that are none", &["stability/judging"]),
    fault(
        "gravity-without-mass",
        "gravity acts alike on every control point of the updated frame, whatever its mass",
        &["stability/stick-slip"],
    ),
    fault(
        "greville-a-knot-early",
        "Greville abscissae are means of the knots one before",
        &["patch/spline-basis", "energy/spinning-disc"],
    ),
    fault(
        "half-model-not-doubled",
        "energies of a half model are taken for those of the whole",
        &["patch/half-model-elastic"],
    ),
    fault("impulse-beside-its-place", "impulses of contact lose their torque", &["contact/discs-oblique"]),
    fault(
        "impulse-not-mass-weighted",
        "impulses of contact are spread without regard to mass",
        &["contact/impact-equal"],
    ),
    fault("inserted-knot-halves", "knot insertion takes the middle of two control points", &["patch/nurbs-basis"]),
    fault(
        "inverse-map-transposed",
        "gradients are taken through the transposed inverse of the map",
        &["patch/linear-field-rational"],
    ),
    fault("judge-fails-nothing", "the judge takes everything for a known limit", &["stability/judging"]),
    fault("judge-ignores-lower-bounds", "the judge ignores lower bounds", &["stability/judging"]),
    fault("judge-ignores-upper-bounds", "the judge ignores upper bounds", &["stability/judging"]),
    fault("judge-passes-infinity", "the judge passes infinite values that one bound allows", &["stability/judging"]),
    fault("judge-passes-what-is-missing", "the judge passes what was not measured", &["stability/judging"]),
    fault("judge-takes-any-bounds", "the judge passes bounds that exclude their reference", &["stability/judging"]),
    fault("judge-takes-magnitudes", "the judge takes the magnitude of a value", &["stability/judging"]),
    fault("judge-takes-wide-bounds", "the judge decides by bounds that are too wide", &["stability/judging"]),
    fault("last-verdict-counts", "the verdict of a run is that of its last record", &["stability/judging"]),
    fault(
        "moving-gradient-halved",
        "half the gradient term in the surface energy of moving points",
        &["energy/updated-frame-fracture"],
    ),
    fault("musl-not-smoothed", "MUSL moves its points as FLIP does", &["energy/flip-and-musl"]),
    fault("norm-without-root", "an L2 error is left squared", &["convergence/elastostatics-square"]),
    fault("normal-of-one-body", "the normal of contact is that of one body", &["contact/discs-head-on"]),
    fault("open-gap-counts-as-closed", "bodies stop before they touch", &["contact/onset"]),
    fault("order-with-the-wrong-sign", "an observed order has the wrong sign", &["convergence/elastostatics-square"]),
    fault(
        "phase-motion-unbooked",
        "the ledger misses the energy points gain as they move through the phase field",
        &["energy/updated-frame-fracture"],
    ),
    fault(
        "phase-tolerance-ignored",
        "the phase field is solved to 1e-2 whatever the scene says",
        &["fracture/iterative-against-direct"],
    ),
    fault("quotient-rule-forgotten", "slopes of rational functions miss that of the weight", &["patch/nurbs-basis"]),
    fault("ramp-forgotten", "tractions act at full strength at once", &["energy/grid-convergence"]),
    fault("rigid-body-at-rest", "contact takes rigid bodies to be at rest", &["stability/conveyor"]),
    fault(
        "safety-ignored",
        "the time step is the critical one whatever the safety factor",
        &["energy/damage-time-order"],
    ),
    fault("seed-twice-as-wide", "seeded cracks are twice as wide as the scene says", &["fracture/seeded-crack-half"]),
    fault("shear-energy-once", "the elastic energy counts shear once", &["energy/ramped-traction"]),
    fault("shear-force-one-sided", "shear stress gives a force along x alone in P2G", &["energy/updated-frame"]),
    fault("shear-strain-doubled", "engineering shear in place of tensor shear", &["energy/updated-frame"]),
    fault(
        "side-holds-the-other-component",
        "a condition on x holds y, and the other way round",
        &["fracture/plane-waves"],
    ),
    fault(
        "small-growth-never-assembled",
        "growth of the history field below a tenth of Gc/(4 l0) never reaches the equation",
        &["fracture/homogeneous-bar"],
    ),
    fault("span-not-renewed", "points keep the shape functions of a span they have left", &["stability/flying-crack"]),
    fault(
        "stagger-doubled",
        "the part of the kinetic energy that Verlet does not keep is doubled",
        &["energy/vibration"],
    ),
    fault("tip-of-the-shortest-row", "the crack tip is that of the row that is broken least", &["plate/half-p2-h1"]),
    fault("trace-not-split", "the change of volume drives cracks in compression", &["fracture/compressive-step"]),
    fault("work-of-the-last-force", "the work of a traction is that of its last value", &["energy/ramped-traction"]),
    fault("xpic-a-power-short", "XPIC(m) is XPIC(m − 1)", &["convergence/moving-transfers"]),
    fault("points-move-half-way", "points move half as far as the grid says", &["energy/transfers"]),
    fault(
        "value-of-another-variant",
        "the value of the first variant is held against the bounds of all",
        &["convergence/elastostatics-square"],
    ),
    fault(
        "one-iteration-is-enough",
        "the phase field is taken after one iteration",
        &["fracture/tolerance-at-the-crack"],
    ),
    fault("cut-spans-half-way", "weights of cut spans are halved", &["energy/gauss-quadrature"]),
    fault(
        "spans-miss-the-jacobian",
        "Gauss points of spans have the volume of now for that of t = 0",
        &["energy/gauss-quadrature"],
    ),
    fault("mean-of-the-fit-kept", "points keep the mean error of the fit", &["energy/gauss-quadrature"]),
    fault(
        "gap-force-one-sided",
        "a body feels nine tenths of the force of the gap potential",
        &["contact/impact-equal-gauss"],
    ),
    fault(
        "slip-not-returned",
        "sliding in contact by a potential of the gap goes on loading its spring",
        &["contact/incline-block-gauss"],
    ),
    fault("relaxation-unbooked", "the ledger misses what the relaxation takes", &["energy/gauss-quadrature"]),
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
        let patterns = ["solver", "verification"].map(|part| workspace().join(part).join("src/**/*.rs"));
        let paths = patterns.into_iter().flat_map(|pattern| glob::glob(&pattern.to_string_lossy()).unwrap());
        paths.map(|path| std::fs::read_to_string(path.unwrap()).unwrap())
    }

    /// Names behind `fault!(` in the code of a text, comments left out.
    fn sites(text: &str) -> BTreeSet<String> {
        let code: Vec<&str> = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
        let text = code.join("\n");
        let behind = text.split("fault!(").skip(1).filter_map(|rest| rest.trim_start().strip_prefix('"'));
        behind.filter_map(|rest| rest.split('"').next()).map(str::to_string).collect()
    }

    #[test]
    fn the_table_the_list_and_the_sites_name_the_same_faults() {
        let table: BTreeSet<String> = FAULTS.iter().map(|fault| fault.id.to_string()).collect();
        assert_eq!(table.len(), FAULTS.len(), "a name stands twice");
        let mut found = BTreeSet::new();
        for text in source_files() {
            let example = text.starts_with("//! Planted errors");
            if example {
                let list = text.split("FAULTS: &[&str] =").nth(1).and_then(|rest| rest.split("];").next()).unwrap();
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
