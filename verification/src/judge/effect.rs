//! What an error does to the curves of a result, held against the uncertainty by which they are judged.
//!
//! A planted error moves a curve from y₀ to y. With E = |y − r| and the triangle inequality, a sound
//! result (E₀ ≤ U_val) that is moved by more than 2 U_val cannot be accepted any more, and one that is
//! moved by less than U_val may not be told from a sound one. *Visible* is what moves a curve by more than
//! U_val. Events count where the spacing lets the judge decide on them.

use super::events;
use super::family::LENGTH_SCALE;
use super::table::Curve;
use super::verdict::{Comparison, Outcome};
use super::{BALANCE, Judged, QUANTITIES, TIP_X, TIP_Y, curves};
use crate::extremes::larger;
use crate::reference::ReferenceCurve;

/// The effect of an error on one thing that is judged.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Quantity and phase, or event.
    pub what: String,
    /// Unit of the figures below; `1` for relative ones.
    pub unit: String,
    /// Distance from the sound result, in the norm of the comparison; absent where a curve ends early or an
    /// event does not happen any more.
    pub size: Option<f64>,
    /// Validation uncertainty of the sound result.
    pub u_val: f64,
}

impl Effect {
    /// The effect over the uncertainty.
    pub fn ratio(&self) -> f64 {
        self.size.map_or(f64::INFINITY, |size| size / self.u_val)
    }

    /// Whether it can be told from the uncertainty.
    pub fn is_visible(&self) -> bool {
        self.ratio() > 1.0
    }
}

/// The largest effect over its uncertainty, of all that decides in the sound result; `None` if nothing does.
pub fn largest(sound: &Judged, other: &Judged) -> Option<Effect> {
    let mut found = Vec::new();
    for quantity in 0..TIP_Y {
        let (Some(curve), Some(reference)) = (&sound.curves[quantity], &sound.references[quantity]) else { continue };
        for comparison in &sound.verdict.quantities[quantity].comparisons {
            let Some((window, u_val)) = comparison.window_s.zip(decides(comparison)) else { continue };
            let moved = other.curves[quantity].as_ref();
            found.push(Effect {
                what: format!("{}, {}", QUANTITIES[quantity].words, comparison.name),
                unit: comparison.unit.clone(),
                size: moved.and_then(|moved| distance(curve, moved, reference, window, quantity != TIP_X)),
                u_val,
            });
        }
    }
    let spacing = sound.verdict.spacing_m.map_or(0.0, |h| h / LENGTH_SCALE);
    for event in sound.verdict.events.iter().filter(|event| events::decides_at(&event.name, spacing)) {
        let Some((value, u_val)) = event.value.zip(decides(event)) else { continue };
        let moved = other.verdict.events.iter().find(|e| e.name == event.name).and_then(|e| e.value);
        let (what, unit) = (event.name.clone(), event.unit.clone());
        found.push(Effect { what, unit, size: moved.map(|moved| (moved - value).abs()), u_val });
    }
    if let Some((balance, moved)) = sound.verdict.balance.as_ref().zip(other.verdict.balance.as_ref()) {
        let size = Some((moved.open - balance.open).abs());
        found.push(Effect { what: "balance of energies".into(), unit: "1".into(), size, u_val: BALANCE });
    }
    found.into_iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
}

/// The uncertainty of a comparison that passes; others decide nothing.
fn decides(comparison: &Comparison) -> Option<f64> {
    comparison.u_val.filter(|_| comparison.outcome == Outcome::Pass)
}

/// Rms of y − y₀ at the times of the reference in a window, over that of the reference if it is relative.
fn distance(
    sound: &Curve,
    moved: &Curve,
    reference: &ReferenceCurve,
    [from, to]: [f64; 2],
    relative: bool,
) -> Option<f64> {
    let slack = 1e-9 * to;
    let rows = reference.x.iter().zip(&reference.y).filter(|(t, _)| (from - slack..=to + slack).contains(*t));
    let (mut square, mut scale, mut count) = (0.0, 0.0, 0.0);
    for (t, r) in rows {
        let Some(y) = curves::at(sound, *t) else { continue };
        let y = curves::at(moved, *t)? - y;
        (square, scale, count) = (square + y * y, scale + r * r, count + 1.0);
    }
    let size = (square / if relative { scale } else { count }).sqrt();
    size.is_finite().then(|| larger(size, 0.0))
}
