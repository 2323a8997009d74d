//! The homogeneous state of AT2, AT1 and a cohesive crack against their closed forms.
//!
//! A body under uniform uniaxial strain e has psi+ = M e²/2 everywhere, with M = lam + 2 mu; rankine is
//! driven by H = (M e)²/(2 E). The phase field is constant and the stress `c² M e`. With AT2 `c = 1/(1 + 4 l0
//! H/Gc)`: the stress peaks at `H = Gc/(12 l0)`, where c = 3/4. With AT1 the body is elastic up to `H = 3
//! Gc/(32 l0)`, where the stress peaks, and c is that over H beyond. With a cohesive crack the stress peaks
//! at `H = ft²/(2 E)`, and beyond c is the root of `4 l0 H/Gc g'(c)/2 = 2/π c`. Constants are in the space
//! and the same sums stand on both sides, so the discrete solution is exact for every degree and layout. The
//! displacement is imposed on the control points; strain, split, history and degraded stress are those of the
//! solver's own sweeps, and the stress is the reaction on the right side over its height. The closed form
//! takes its numbers from the scene, not from the solver. (The reaction of equally spaced points is exact for
//! p up to 2 only; see the patch test.)

use std::f64::consts::FRAC_2_PI;

use fisura::linear_algebra::conjugate_gradients::SolveFailure;
use fisura::linear_algebra::lane::Lane;
use fisura::material::degradation::FractureModel;
use fisura::material::elasticity::ElasticModuli;
use fisura::material::split::driving_energy;
use fisura::particles::lattice::Lattice;
use fisura::phase_field::fracture::LatticeFracture;
use fisura::scene::{CrackModel, Fracture, Kinematics, Material, Plane, Scene, Side, Split};
use fisura::splines::patch::Patch;
use fisura::splines::patch::control_points_on;
use fisura::transfer::finite::Elastic;
use fisura::transfer::sweep::StripForces;

use super::charts::curve;
use super::{Case, CaseScene, Findings, StudyError, exact, other};
use crate::exact::cohesive::CohesiveLaw;
use crate::extremes::{larger, largest, smaller};
use crate::output::history::Table;
use crate::record::{Axis, CurveStyle, Figure, FigureBody};

/// Strains looked at, over the strain at the peak.
const STRAINS: usize = 40;
const FURTHEST: f64 = 4.0;

pub(super) fn study(case: &Case, scenes: &[CaseScene], findings: &mut Findings) -> Result<(), StudyError> {
    let stem = format!("{}-{}", case.suite, case.name);
    let mut tables = Vec::new();
    for scene in scenes {
        let strain = "H = Gc/(12 l0), with AT1 3 Gc/(32 l0), with a cohesive crack ft^2/(2 E)";
        let quantities = [
            ("phase field, largest error", None),
            ("stress, largest error over the peak stress", None),
            ("strain at the peak over closed form", exact(1.0, strain)),
            ("tensile over compressive strength, largest difference from closed form", None),
            ("stress at the peak over closed form", exact(1.0, "9/16 of M times that strain with AT2, else all")),
        ];
        findings.measure(&scene.name, quantities, || {
            let (table, error) = loading(scene)?;
            let stress = largest(table.columns[1].iter().zip(&table.columns[2]).map(|(a, b)| (a - b).abs()));
            let (peak_strain, peak_stress) = peak(&table);
            tables.push((stem.clone(), table));
            Ok([error, stress, peak_strain, strengths(&scene.scene)?, peak_stress])
        })?;
    }
    findings.figures.push(figure(case, &stem));
    findings.series.extend(tables.into_iter().take(1));
    Ok(())
}

/// Strain, stress, and both against closed forms; and the largest error of c at a control point.
fn loading(case_scene: &CaseScene) -> Result<(Table, f64), StudyError> {
    let scene = &case_scene.scene;
    let body = &scene.bodies[0];
    let (material, fracture) = constants(scene)?;
    let model = FractureModel::of(material).ok_or_else(brittle)?;
    let moduli = ElasticModuli::new(material, scene.analysis.plane);
    let modulus = uniaxial_modulus(material, scene.analysis.plane);
    let drive = match fracture.split {
        Split::Rankine => modulus * modulus / material.young_modulus,
        _ => modulus,
    };
    let unit = fracture.critical_energy_release_rate / fracture.length_scale; // J/m³
    let (at_peak, part) = match fracture.model {
        CrackModel::At2 => (unit / 12.0, 9.0 / 16.0),
        CrackModel::At1 => (3.0 * unit / 32.0, 1.0),
        CrackModel::PfCzm { tensile_strength, .. } => {
            (0.5 * tensile_strength * tensile_strength / material.young_modulus, 1.0)
        }
    };
    let peak_strain = (2.0 * at_peak / drive).sqrt();
    let peak_stress = part * modulus * peak_strain;
    let patch = Patch::new(&scene.mesh);
    let lattice = Lattice::new(&patch, body);
    let (low, high) = body.shape.bounding_box();
    let cracking = LatticeFracture::new(&patch, &lattice, body, model, None, &scene.solver).map_err(unsolved)?;
    let mut points = Points {
        lattice: &lattice,
        moduli,
        fracture: cracking,
        forces: StripForces::new(&lattice),
        greville: patch.spaces[0].greville(),
        height: high[1] - low[1],
    };
    let mut table = Table::new(&["strain_over_peak", "stress_over_peak", "closed_form"]);
    let mut worst = 0.0_f64;
    for step in 0..=STRAINS {
        let strain = FURTHEST * peak_strain * step as f64 / STRAINS as f64;
        let (phase, stress) = points.strained_by(strain)?;
        let exact = closed_form(material, fracture, 0.5 * drive * strain * strain);
        worst = phase.into_iter().map(|c| (c - exact).abs()).fold(worst, larger);
        let k = fracture.residual_stiffness;
        let whole = match CohesiveLaw::of(material) {
            Some(law) => law.degradation(exact)[0],
            None => exact * exact,
        };
        let degraded = (1.0 - k) * whole + k;
        table.push(&[strain / peak_strain, stress / peak_stress, degraded * modulus * strain / peak_stress]);
    }
    Ok((table, worst))
}

/// `c = 1/(1 + 4 l0 (1 − k) H/Gc)`, or with AT1 `3 Gc/(32 l0 (1 − k) H)` and at most 1; with a cohesive crack
/// the largest root below 1, by bisection from there on.
fn closed_form(material: &Material, fracture: &Fracture, energy: f64) -> f64 {
    let Fracture { critical_energy_release_rate, length_scale, residual_stiffness, .. } = fracture;
    let reaction = 4.0 * length_scale * (1.0 - residual_stiffness) * energy / critical_energy_release_rate;
    match fracture.model {
        CrackModel::At2 => 1.0 / (1.0 + reaction),
        CrackModel::At1 => smaller(1.0, 0.375 / reaction),
        CrackModel::PfCzm { .. } => {
            let Some(law) = CohesiveLaw::of(material) else { return f64::NAN };
            let rises = |c: f64| 0.5 * reaction * law.degradation(c)[1] > FRAC_2_PI * c;
            let (mut low, mut high) = (0.0, 1.0);
            while rises(1.0) && high - low > 1e-15 {
                let middle = 0.5 * (low + high);
                if rises(middle) { high = middle } else { low = middle }
            }
            high
        }
    }
}

/// Tensile over compressive strength in uniaxial stress, as its difference from the closed form of the split:
/// the root of what drives in compression over what drives in tension.
fn strengths(scene: &Scene) -> Result<f64, StudyError> {
    let (material, fracture) = constants(scene)?;
    let nu = material.poisson_ratio;
    // Strains over s/E under a stress s; energies over s²/(2 E): of all, and of a change of volume e, K e²/2.
    let ([along, across], lame, whole, volume) = match scene.analysis.plane {
        Plane::Strain => (
            [1.0 - nu * nu, -nu * (1.0 + nu)],
            nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            1.0 - nu * nu,
            (1.0 + nu) * (1.0 + nu) * (1.0 - 2.0 * nu) / 3.0,
        ),
        Plane::Stress => ([1.0, -nu], nu / (1.0 - nu * nu), 1.0, (1.0 - 2.0 * nu) / 3.0),
    };
    let (shear, trace) = (1.0 / (1.0 + nu), along + across);
    let [compressive, tensile] = match fracture.split {
        Split::Spectral => [shear * across * across, lame * trace * trace + shear * along * along],
        Split::VolumetricDeviatoric => [whole - volume, whole],
        Split::StarConvex(gamma) => [whole - (1.0 + gamma) * volume, whole],
        Split::Rankine => [0.0, 1.0],
        Split::None => [whole, whole],
    };
    let moduli = ElasticModuli::new(material, scene.analysis.plane);
    let drive = |sign: f64| {
        let strain = [along, across, 0.0].map(|e| Lane::splat(sign * e));
        driving_energy(&moduli, fracture.split, strain)[0]
    };
    Ok(((drive(-1.0) / drive(1.0)).sqrt() - (compressive / tensile).sqrt()).abs())
}

fn brittle() -> StudyError {
    other("the material has no fracture")
}

fn constants(scene: &Scene) -> Result<(&Material, &Fracture), StudyError> {
    let material = &scene.materials[&scene.bodies[0].material];
    Ok((material, material.fracture.as_ref().ok_or_else(brittle)?))
}

/// Stress over strain in uniaxial strain, Pa: `E (1 − nu)/((1 + nu)(1 − 2 nu))`, and `E/(1 − nu²)` in plane
/// stress.
fn uniaxial_modulus(material: &Material, plane: Plane) -> f64 {
    let (young, nu) = (material.young_modulus, material.poisson_ratio);
    match plane {
        Plane::Strain => young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)),
        Plane::Stress => young / (1.0 - nu * nu),
    }
}

/// The material points of the body and their phase field: the solver's own kernels, driven by a displacement.
struct Points<'a> {
    lattice: &'a Lattice,
    moduli: ElasticModuli,
    fracture: LatticeFracture,
    forces: StripForces,
    /// Control values of x, m.
    greville: Vec<f64>,
    /// Height of the body, m.
    height: f64,
}

impl Points<'_> {
    /// Control values of c, and the mean stress on the right side (Pa), under the uniaxial strain.
    fn strained_by(&mut self, strain: f64) -> Result<(Vec<f64>, f64), StudyError> {
        let Self { lattice, moduli, fracture, forces, .. } = self;
        let grid = lattice.grid;
        let mut displacement = [grid.zeros(), grid.zeros()];
        for at in grid.indices() {
            displacement[0][at] = strain * self.greville[grid.column_of(at)];
        }
        let body = Elastic { lattice, moduli: *moduli, kinematics: Kinematics::Small };
        fracture.update_history(body, 0.0, &displacement, forces);
        let solved = fracture.field.solve(lattice, &fracture.history);
        solved.map_err(unsolved)?;
        fracture.degraded_forces(body, &displacement, forces);
        let mut nodal = [grid.zeros(), grid.zeros()];
        forces.assemble(grid.stride, &mut nodal);
        let force: f64 = control_points_on(Side::Right, grid).into_iter().map(|at| nodal[0][at]).sum();
        let phase = grid.indices().map(|at| fracture.field.control_values()[at]).collect();
        Ok((phase, force / self.height))
    }
}

fn unsolved(failure: SolveFailure) -> StudyError {
    other(format!("the phase-field solve {failure}"))
}

/// Strain and stress of the highest row over the closed forms; rows include the peak itself.
fn peak(table: &Table) -> (f64, f64) {
    let stress = &table.columns[1];
    let top = (0..stress.len()).max_by(|&a, &b| stress[a].total_cmp(&stress[b])).unwrap_or(0);
    (table.columns[0][top], stress[top])
}

fn figure(case: &Case, stem: &str) -> Figure {
    let columns = |column| ["strain_over_peak", column];
    let axes = ["strain / strain at the peak", "stress / peak stress"].map(Axis::linear);
    let curves = vec![
        curve("closed form", stem, columns("closed_form"), CurveStyle::Reference),
        curve("material points", stem, columns("stress_over_peak"), CurveStyle::Markers),
    ];
    let caption = "Stress over its closed-form peak against strain over its closed-form peak.";
    let words = [stem, "Homogeneous bar in uniaxial strain", caption];
    Figure::new(&case.suite, words, FigureBody::chart(axes, curves, Vec::new()))
}
