//! Solution verification: what a quantity tends to as the mesh is refined, and how far the finest mesh is
//! from it.
//!
//! For a scene study whose variants differ in the mesh only. With spans h1 < h2 < h3, values f1, f2, f3 and
//! ratios r21 = h2/h1, r32 = h3/h2, a quantity that converges as `f = f0 + C h^p` obeys
//!
//! ```text
//! (f3 - f2)/(f2 - f1) = r21^p (r32^p - 1)/(r21^p - 1)
//! f0  = f1 + (f1 - f2)/(r21^p - 1)                 Richardson
//! GCI = F |(f1 - f2)/f1| / (r21^p - 1)             Roache's grid convergence index
//! ```
//!
//! The order p is found by the fixed-point iteration of Celik et al. (J. Fluids Eng. 130, 078001, 2008), with
//! half the correction per step, so that uneven ratios converge as well. It is sought without their absolute
//! values: a quantity that oscillates or departs has no order here, no limit and no index, but a message.
//!
//! **Safety factor** F: 1.25 with three meshes, 3 with two and an order of theory. Where theory is known and
//! the observed order departs from it by more than a tenth, p is limited to the range from 1/2 to theory and
//! F is 3 (Oberkampf and Roy, Verification and Validation in Scientific Computing, 2010, section 8.6.3);
//! within a tenth, p is that of theory.
//!
//! **Numerical uncertainty** of the value on the finest mesh, for its comparison with a reference: U_num =
//! GCI |f1|. A sequence that has no index still has an uncertainty, three times its range (Eça and Hoekstra,
//! J. Mar. Sci. Technol. 14, 2009).

use fisura::fault;
use fisura::particles::spans::largest_spans;
use fisura::scene::Mesh;

use super::{Measured, Run, expected, held_against, measure};
use crate::case::expand::CaseScene;
use crate::case::{Check, Estimate};
use crate::extremes::spread;
use crate::record::Discretisation;
use crate::reference::Library;

/// Extrapolation by an order below this would go far beyond what was computed.
const LEAST_ORDER: f64 = 0.5;
/// Observed and theoretical order agree within this fraction.
const AGREEMENT: f64 = 0.1;
const ITERATIONS: usize = 500;
/// Where a discretisation error comes from.
const FAMILY: &str = "grid convergence index of the meshes of this case";
/// Uncertainty over the range of a sequence without an order.
const NO_ORDER: f64 = 3.0;

/// Representative span length of a mesh, m.
pub fn span(mesh: &Mesh) -> f64 {
    let [x, y] = largest_spans(mesh);
    (x * y).sqrt()
}

/// Evaluates the measure of `check` on every run and combines the values.
///
/// # Errors
/// If the measure or something it needs does not exist.
pub fn over_meshes(estimate: Estimate, check: &Check, runs: &[Run], library: &Library) -> Result<Measured, String> {
    let mut meshes = Vec::new();
    let mut missing = Vec::new();
    for run in runs {
        match measure(check, run, runs, library)?.value {
            Some(value) => meshes.push((span(&run.scene.mesh), value)),
            None => missing.push(run.name),
        }
    }
    let mut discretisation = None;
    let found = match missing.as_slice() {
        [] if estimate == Estimate::FinestMesh => on_finest_mesh(meshes, check.order).map(|(value, uncertainty)| {
            discretisation = Some(Discretisation { value: uncertainty, from: FAMILY.to_string() });
            value
        }),
        [] => combine(estimate, meshes, check.order),
        names => Err(format!("the measured event did not occur on every mesh: not in {}", names.join(", "))),
    };
    let reference = match estimate {
        Estimate::Richardson | Estimate::FinestMesh => held_against(check, check.scale, library)?,
        _ => expected(check, 1.0),
    };
    let (value, message) = found.map_or_else(|message| (None, Some(message)), |value| (Some(value), None));
    Ok(Measured { value, reference, message, discretisation })
}

/// The value on the finest of the meshes (h, value), in any order, and its numerical uncertainty.
fn on_finest_mesh(mut meshes: Vec<(f64, f64)>, theory: Option<f64>) -> Result<(f64, f64), String> {
    meshes.sort_by(|a, b| a.0.total_cmp(&b.0));
    meshes.truncate(3);
    let &(_, value) = meshes.first().ok_or("there is no mesh")?;
    let range = spread(&meshes.iter().map(|(_, value)| *value).collect::<Vec<_>>());
    let index = combine(Estimate::GridConvergenceIndex, meshes.clone(), theory);
    let uncertainty = index.map_or(NO_ORDER * range, |index| index * value.abs());
    if uncertainty.is_finite() { Ok((value, uncertainty)) } else { Err("a value is not a number".into()) }
}

/// The estimate from pairs (h, value) in any order; the finest three count. The error says why there is none.
fn combine(estimate: Estimate, mut meshes: Vec<(f64, f64)>, theory: Option<f64>) -> Result<f64, String> {
    meshes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let [(h1, f1), (h2, f2), rest @ ..] = meshes.as_slice() else { return Err("there are no two meshes".into()) };
    let ratio = h2 / h1;
    let observed = match rest {
        [] => None,
        [(h3, f3), ..] => Some(order([f2 - f1, f3 - f2], [ratio, h3 / h2]).map_err(|why| {
            let shown = [f3, f2, f1].map(|f| format!("{f:.6e}")).join(", ");
            format!("{why} (from coarse to fine: {shown})")
        })?),
    };
    if estimate == Estimate::ObservedOrder {
        return observed.ok_or_else(|| "two meshes have no observed order".into());
    }
    let (p, safety) = match (observed, theory) {
        (Some(p), Some(theory)) if (p - theory).abs() <= AGREEMENT * theory => (theory, 1.25),
        (Some(p), Some(theory)) => (p.max(LEAST_ORDER).min(theory), 3.0),
        (Some(p), None) if p < LEAST_ORDER => {
            return Err(format!("the observed order {p:.2} is below {LEAST_ORDER}: too far to extrapolate"));
        }
        (Some(p), None) => (p, 1.25),
        (None, Some(theory)) => (theory, 3.0),
        (None, None) => return Err("two meshes need the order of theory".into()),
    };
    let correction = (f1 - f2) / (ratio.powf(p) - 1.0);
    match estimate {
        Estimate::Richardson => Ok(fault!("extrapolation-backwards", f1 + correction => f1 - correction)),
        _ if *f1 == 0.0 => Err("the value is zero, so a relative index is not defined".into()),
        _ => Ok(safety * (correction / f1).abs()),
    }
}

/// The order p from the differences `[f2 - f1, f3 - f2]` and the ratios `[r21, r32]`.
fn order([fine, coarse]: [f64; 2], [r21, r32]: [f64; 2]) -> Result<f64, String> {
    if fine == 0.0 {
        let meshes = if coarse == 0.0 { "any of the meshes" } else { "the finest meshes" };
        return Err(format!("the value does not change between {meshes}, so it has no order"));
    }
    let ratio = coarse / fine;
    if ratio < 0.0 {
        return Err("oscillatory convergence: no order, limit or index".into());
    }
    // the right-hand side of the equation for p grows with p from this value at p = 0
    if ratio.is_nan() || ratio <= (1.0 + 1e-9) * r32.ln() / r21.ln() {
        return Err("no convergence: the difference does not fall from mesh to mesh".into());
    }
    let mut p = ratio.ln() / r21.ln();
    for _ in 0..ITERATIONS {
        let q = ((r21.powf(p) - 1.0) / (r32.powf(p) - 1.0)).ln();
        let next = (ratio.ln() + q) / r21.ln();
        if (next - p).abs() <= 1e-12 * (1.0 + p) {
            return Ok(next);
        }
        p = (0.5 * (p + next)).max(1e-6);
    }
    Err("the iteration for the order does not converge: ratios of the meshes too uneven".into())
}

/// Whether the scenes of a case give a check with `meshes` something to work with: what is wrong, and what
/// would help.
///
/// # Errors
/// If not.
pub fn usable(check: &Check, estimate: Estimate, scenes: &[CaseScene]) -> Result<(), (&'static str, &'static str)> {
    if check.measure.as_deref() == Some("order-in-step") || check.variant.is_some() || check.against.is_some() {
        return Err(("it combines all variants", "remove variant, against, or the measure order-in-step"));
    }
    if check.order.is_some_and(|order| order <= 0.0) {
        return Err(("the order of theory is not positive", "order = 2 with lumped mass"));
    }
    let alike = |pair: &[CaseScene]| {
        let mut scene = pair[1].scene.clone();
        scene.mesh.knots.clone_from(&pair[0].scene.mesh.knots);
        if scene.mesh.geometry.is_some() && pair[0].scene.mesh.geometry.is_some() {
            scene.mesh.geometry.clone_from(&pair[0].scene.mesh.geometry); // refined with the knots
        }
        scene == pair[0].scene && pair[1].energy_factor == pair[0].energy_factor
    };
    if !scenes.windows(2).all(alike) {
        return Err(("variants differ in more than the mesh", "one case per degree, layout and material"));
    }
    let mut spans: Vec<[f64; 2]> = scenes.iter().map(|s| largest_spans(&s.scene.mesh)).collect();
    spans.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let needed = if estimate != Estimate::ObservedOrder && check.order.is_some() { 2 } else { 3 };
    if spans.len() < needed {
        let remedy = if needed == 2 {
            "give scene.mesh.cells two or more values"
        } else {
            "give scene.mesh.cells three or more values; two are enough with order = …, the order of theory, but give no observed order"
        };
        return Err(("there are too few meshes", remedy));
    }
    let uneven = |pair: &[[f64; 2]]| {
        let [x, y] = [0, 1].map(|d| pair[1][d] / pair[0][d]);
        x < 1.0 + 1e-6 || (x / y - 1.0).abs() > 1e-2
    };
    if spans.windows(2).any(uneven) {
        return Err(("meshes are not refined by one factor in both directions", "cells = [[8, 4], [16, 8], [32, 16]]"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
