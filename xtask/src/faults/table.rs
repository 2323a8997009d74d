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
    fault("jacobian-missing", "weights of points omit the determinant of the map", &["patch/constant-stress-curved"]),
    fault("rational-weights-ignored", "NURBS weights are set to 1", &["patch/linear-field-rational"]),
    fault(
        "knot-span-off-by-one",
        "a position is searched in the next span",
        &["patch/constant-stress-gauss", "convergence/elastostatics-square"],
    ),
    fault("volumes-off-by-a-layer", "points have the volumes of the next layer", &["patch/constant-stress-gauss"]),
    fault("traction-on-wrong-edge", "tractions act on the bottom", &["patch/constant-stress-gauss"]),
    fault(
        "shear-halved",
        "mu instead of 2 mu in the shear stress",
        &["patch/constant-stress-gauss", "convergence/elastostatics-square"],
    ),
    fault(
        "plane-stress-lambda",
        "plane stress uses Lamé's constant of plane strain",
        &["fracture/homogeneous-bar-residual", "convergence/kirsch-plane-stress"],
    ),
    fault("mass-lumped", "lumped mass instead of the consistent mass", &["manufactured/bar-eigenfrequencies"]),
    fault("held-side-let-go", "prescribed components accelerate", &["fracture/plane-waves"]),
    fault(
        "whole-kick",
        "the second half of the kick uses the whole step",
        &["energy/vibration", "energy/free-vibration"],
    ),
    fault("gravity-upwards", "gravity has the wrong sign in the forces", &["energy/ramped-traction"]),
    fault("driven-work-left-out", "the ledger omits the work of driven sides", &["energy/ramped-traction"]),
    fault("thickness-forgotten", "energies assume a thickness of one metre", &["stability/units"]),
    fault("half-step-velocity", "velocities at half steps replace those at whole steps", &["energy/transfers"]),
    fault("loss-forgotten", "the ledger omits the energy loss of imposed velocities", &["energy/updated-frame"]),
    fault("transfer-keeps-less", "points keep 0.999 of their velocity with FLIP", &["patch/rigid-translation"]),
    fault("affine-transposed", "points transfer the transpose of their velocity gradient", &["energy/spinning-disc"]),
    fault("hencky-without-half", "Hencky strain lacks its factor 1/2", &["stability/split", "convergence/hencky-wave"]),
    fault("critical-step-too-long", "2.2 instead of 2 over the highest frequency", &["stability/critical-step"]),
    fault(
        "step-of-the-total-frame",
        "the updated frame takes the step of the total frame, 2/ω_max",
        &["stability/critical-step"],
    ),
    fault("length-scale-doubled", "l0 is twice the value in the scene", &["fracture/homogeneous-bar"]),
    fault(
        "one-minus-k-missing",
        "the phase-field equation omits the factor 1 − k",
        &["fracture/homogeneous-bar-residual"],
    ),
    fault("degradation-linear", "the factor c instead of c² degrades the stress", &["fracture/homogeneous-bar"]),
    fault("phase-load-without-volumes", "the phase-field load omits volumes", &["fracture/homogeneous-bar"]),
    fault("phase-gradient-halved", "2 l0² instead of 4 l0² in the equation", &["fracture/seeded-crack-half"]),
    fault("surface-energy-doubled", "Gc/(2 l0) instead of Gc/(4 l0) in the energy", &["fracture/seeded-crack-half"]),
    fault("split-swapped", "principal strains are swapped in the split", &["stability/split"]),
    fault(
        "history-forgets",
        "the history field decreases with the tensile energy",
        &["stability/unloading", "energy/updated-frame-fracture"],
    ),
    fault("history-work-halved", "the ledger counts half the history work", &["energy/damage-time-order"]),
    fault("history-left-behind", "the history field is not sorted with the points", &["stability/flying-crack"]),
    fault("friction-twice", "the limit of friction is doubled", &["contact/incline-polygon"]),
    fault("broken-points-hold", "broken points connect fragments", &["contact/parted-bar"]),
    fault("crack-faces-left-out", "fragments have no boundary along the crack", &["contact/cracked-slope"]),
    fault(
        "partition-unbooked",
        "the ledger omits the energy change when a body breaks into fragments",
        &["contact/parted-bar"],
    ),
    fault(
        "joint-force-of-one-slice",
        "of two slices that share a control point, only one adds its force",
        &["contact/closing-ring"],
    ),
    fault("seam-left-behind", "slices are connected at their seam of t = 0", &["contact/closing-ring"]),
    fault("normal-not-normalised", "contact normals have the length of a segment", &["contact/onset"]),
    fault("impulse-one-sided", "body a receives nine tenths of the impulse", &["contact/discs-head-on"]),
    fault("affine-left-behind", "velocity gradients are not sorted with the points", &["energy/spinning-disc"]),
    fault("apic-spread-of-quadratics", "APIC uses h²/4 for the spread of all weights", &["energy/spinning-disc"]),
    fault(
        "band-in-other-units",
        "bounds of a reference band are not converted to the unit of the check",
        &["stability/judging"],
    ),
    fault(
        "boundary-lags-behind",
        "the boundary of a body moves at nine tenths of its velocity",
        &["contact/impact-equal"],
    ),
    fault("bounds-both-above", "both bounds around a reference value lie above it", &["stability/judging"]),
    fault("checkpoint-without-accelerations", "a checkpoint omits the accelerations", &["stability/repeatability"]),
    fault("closure-at-the-start", "the closure of a run is that of its first row", &["stability/judging"]),
    fault(
        "compression-degraded",
        "the phase field also degrades the compressive stress",
        &["energy/damage-time-order"],
    ),
    fault("contact-loss-doubled", "the ledger counts the contact loss twice", &["contact/discs-head-on"]),
    fault("contact-pulls", "contact transmits tension between bodies", &["contact/discs-head-on"]),
    fault(
        "curves-compared-by-their-mean",
        "differences from a curve are summed before they are squared",
        &["stability/judging"],
    ),
    fault("deformation-from-the-wrong-side", "F (I + A) instead of (I + A) F", &["energy/transfers-finite"]),
    fault(
        "deformation-left-behind",
        "deformation gradients are not sorted with the points",
        &["energy/transfers-finite", "stability/fast-disc"],
    ),
    fault("difference-upwards-only", "only positive differences of two runs count", &["stability/judging"]),
    fault("drift-upwards-only", "only an upward drift counts", &["stability/judging"]),
    fault("driven-side-lags", "a driven side of the updated frame has half its velocity", &["energy/transfers"]),
    fault("driven-side-reversed", "driven sides move in the opposite direction", &["stability/broken-band"]),
    fault("events-seen-late", "events of the first half of a run are ignored", &["rings/collision"]),
    fault("extrapolation-backwards", "Richardson's correction has the wrong sign", &["energy/grid-convergence"]),
    fault(
        "fall-from-the-last-row",
        "a fall is measured from the previous row, not from the maximum",
        &["stability/judging"],
    ),
    fault(
        "fictitious-material-heavy",
        "the material that fills empty spans has the density of the body",
        &["energy/updated-frame-fracture"],
    ),
    fault("friction-one-way", "friction acts in only one direction along a boundary", &["stability/stick-slip"]),
    fault("gap-without-sign", "overlapping boundaries count as separated", &["contact/hertz"]),
    fault("gaps-are-overlooked", "the maximum of several numbers ignores NaN", &["stability/judging"]),
    fault(
        "gravity-without-mass",
        "gravity on control points of the updated frame ignores their mass",
        &["stability/stick-slip"],
    ),
    fault(
        "greville-a-knot-early",
        "Greville abscissae are means of knots shifted by one",
        &["patch/spline-basis", "energy/spinning-disc"],
    ),
    fault("half-model-not-doubled", "energies of a half model are not doubled", &["patch/half-model-elastic"]),
    fault("impulse-beside-its-place", "contact impulses lose their torque", &["contact/discs-oblique"]),
    fault(
        "impulse-not-mass-weighted",
        "contact impulses are distributed without mass weights",
        &["contact/impact-equal"],
    ),
    fault("inserted-knot-halves", "knot insertion uses the midpoint of two control points", &["patch/nurbs-basis"]),
    fault(
        "inverse-map-transposed",
        "gradients use the transposed inverse of the map",
        &["patch/linear-field-rational"],
    ),
    fault("judge-fails-nothing", "the judge reports every value as a known limit", &["stability/judging"]),
    fault("judge-ignores-lower-bounds", "the judge ignores lower bounds", &["stability/judging"]),
    fault("judge-ignores-upper-bounds", "the judge ignores upper bounds", &["stability/judging"]),
    fault("judge-passes-infinity", "the judge passes infinite values that one bound allows", &["stability/judging"]),
    fault("judge-passes-what-is-missing", "the judge passes values that were not measured", &["stability/judging"]),
    fault("judge-takes-any-bounds", "the judge passes bounds that exclude their reference", &["stability/judging"]),
    fault("judge-takes-magnitudes", "the judge uses the magnitude of a value", &["stability/judging"]),
    fault("judge-takes-wide-bounds", "the judge decides by bounds that are too wide", &["stability/judging"]),
    fault("last-verdict-counts", "the verdict of a run is that of its last record", &["stability/judging"]),
    fault(
        "moving-gradient-halved",
        "the gradient term in the surface energy of moving points is halved",
        &["energy/updated-frame-fracture"],
    ),
    fault("norm-without-root", "an L2 error lacks its square root", &["convergence/elastostatics-square"]),
    fault("normal-of-one-body", "the contact normal is that of one body", &["contact/discs-head-on"]),
    fault("open-gap-counts-as-closed", "bodies stop before they touch", &["contact/onset"]),
    fault("order-with-the-wrong-sign", "an observed order has the wrong sign", &["convergence/elastostatics-square"]),
    fault(
        "phase-motion-unbooked",
        "the ledger omits the energy that points gain as they move through the phase field",
        &["energy/updated-frame-fracture"],
    ),
    fault(
        "phase-field-carried-too-far",
        "between solves the phase field falls twice as fast as between the last two",
        &["energy/phase-field-interval"],
    ),
    fault(
        "phase-lag-work-left-out",
        "the ledger omits the work of the phase field between its solves",
        &["energy/phase-field-interval"],
    ),
    fault(
        "phase-tolerance-ignored",
        "the phase field is solved to 1e-2 for any tolerance of the scene",
        &["fracture/iterative-against-direct"],
    ),
    fault(
        "quotient-rule-forgotten",
        "derivatives of rational functions omit that of the weight",
        &["patch/nurbs-basis"],
    ),
    fault("ramp-forgotten", "loads and velocities have their full value from t = 0", &["energy/grid-convergence"]),
    fault("load-without-end", "a course does not end at its `until`", &["energy/driven-bar"]),
    fault("smooth-course-linear", "a smooth course rises linearly", &["energy/driven-bar"]),
    fault("table-of-steps", "a table is not interpolated", &["energy/driven-bar"]),
    fault("displacement-lags", "a prescribed displacement comes three steps late", &["energy/driven-bar"]),
    fault("reaction-without-inertia", "reactions omit the inertia of what is driven", &["energy/driven-bar"]),
    fault("part-of-a-side-is-all-of-it", "a condition on a part holds the whole side", &["energy/driven-bar"]),
    fault("pressure-outwards", "a pressure pulls", &["convergence/lame"]),
    fault(
        "static-start-short",
        "a static start takes 99 % of every step",
        &["convergence/lame", "energy/static-start"],
    ),
    fault("slit-bridged", "shape functions reach across slits", &["patch/slits"]),
    fault("slit-without-ties", "copies of whole functions do not move with them", &["patch/slits"]),
    fault("copies-lose-their-share", "forces and masses of copies are lost", &["patch/slits"]),
    fault("rigid-body-at-rest", "contact treats rigid bodies as at rest", &["stability/conveyor"]),
    fault("safety-ignored", "the time step ignores the safety factor", &["energy/damage-time-order"]),
    fault("seed-twice-as-wide", "seeded cracks have twice the width in the scene", &["fracture/seeded-crack-half"]),
    fault("shear-energy-once", "the elastic energy counts shear once", &["energy/ramped-traction"]),
    fault("shear-force-one-sided", "shear stress gives only a force along x in P2G", &["energy/updated-frame"]),
    fault("shear-strain-doubled", "engineering shear instead of tensor shear", &["energy/updated-frame"]),
    fault("side-holds-the-other-component", "conditions on x and y are swapped", &["fracture/plane-waves"]),
    fault(
        "small-growth-never-assembled",
        "the equation ignores growth of the history field below a tenth of Gc/(4 l0)",
        &["fracture/homogeneous-bar"],
    ),
    fault("span-not-renewed", "points use the shape functions of their previous span", &["stability/flying-crack"]),
    fault(
        "stagger-doubled",
        "the part of the kinetic energy that Verlet does not conserve is doubled",
        &["energy/vibration"],
    ),
    fault(
        "tip-from-the-end-of-the-seed",
        "the crack tip is the point furthest from the end of the seed",
        &["plate/half-p2-h1"],
    ),
    fault("trace-not-split", "volumetric compression drives cracks", &["fracture/compressive-step"]),
    fault("work-of-the-last-force", "the work of a traction uses its last value", &["energy/ramped-traction"]),
    fault("xpic-a-power-short", "XPIC(m) is XPIC(m − 1)", &["convergence/moving-transfers"]),
    fault("points-move-half-way", "points move half the displacement of the grid", &["energy/transfers"]),
    fault(
        "value-of-another-variant",
        "the value of the first variant is compared with the bounds of all variants",
        &["convergence/elastostatics-square"],
    ),
    fault(
        "one-iteration-is-enough",
        "the phase-field solve stops after one iteration",
        &["fracture/tolerance-at-the-crack"],
    ),
    fault("cut-spans-half-way", "weights of cut spans are halved", &["energy/gauss-quadrature"]),
    fault(
        "spans-miss-the-jacobian",
        "Gauss points of spans use the current volume instead of that of t = 0",
        &["energy/gauss-quadrature"],
    ),
    fault("mean-of-the-fit-kept", "points retain the mean error of the fit", &["energy/gauss-quadrature"]),
    fault(
        "gap-force-one-sided",
        "a body receives nine tenths of the force of the gap potential",
        &["contact/impact-equal-gauss"],
    ),
    fault(
        "slip-not-returned",
        "with the gap potential, sliding contact continues to load its spring",
        &["contact/incline-block-gauss"],
    ),
    fault("relaxation-unbooked", "the ledger omits the energy removed by the relaxation", &["energy/gauss-quadrature"]),
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
