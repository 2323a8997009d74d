//! Checks of initial cracks: they are polylines that lie in their body, and seeds break it. A crack is there
//! only in the material points that its history energy reaches.
//!
//! A history energy H over a narrow band holds `c0 = 1/(1 + S/(4 l0))` at its middle against the gradient of
//! c, with the strength `S = ∫ 4 l0 H/Gc dn` across the band: the solution of (E 8) on a line. On a mesh of
//! spans h the field varies no faster than over h, which is like a longer l0. The strength is summed over the
//! points, in every stretch of the length of a span.

use super::ground::{Findings, Ground, Look, MOST_POSITIONS};
use super::points::{Near, Points};
use crate::linear_algebra::extremes::larger;
use crate::material::degradation::BROKEN;
use crate::material::elasticity::ElasticModuli;
use crate::phase_field::fracture::{SEED_STRENGTH, half_width};
use crate::scene::{Body, Crack, CrackKind, Fracture, Frame, Mass, Material, Scene};
use crate::splines::nurbs::NurbsPatch;

/// Distance from a knot line that counts as none, of the range of a parameter; and places on a straight part
/// of a slit that are looked at, less one.
const ON_KNOT: f64 = 1e-6;

const LOOKS: usize = 8;

/// Relative tolerance of lengths along a crack.
const TOLERANCE: f64 = 1e-6;

/// Strength, of 4 l0 + h, at which c0 is [`BROKEN`] in half of a body that is symmetric about the crack, and
/// 0.095 in a whole one.
const BREAKING: f64 = 0.5 * (1.0 / BROKEN - 1.0);

/// Half width of a seed, in spans across it, from which on it opens freely. A bar that is cut by a seed
/// transmits 0.05 to 0.5 of a wave with half a span, up to 0.04 with one, and up to 0.003 with this (p = 1 to
/// 3, on knots and between them, l0 = 1 to 4 spans).
const OPENING: f64 = 1.5;

/// Distance from a crack up to which points are counted, of l0: they are enough to break it.
const COUNTED: f64 = 0.25;

/// Most halvings of the logarithm of a half width: from the least number to the largest it takes 24.
const HALVINGS: usize = 64;

/// A slit parts the control points of the total frame, which keep their places.
pub(super) fn slit(key: &str, crack: &Crack, scene: &Scene, ground: &Ground<'_>, findings: &mut Findings) {
    let key = format!("{key}.as");
    if ground.patch.as_ref().is_some_and(|patch| !crack.segments().all(|ends| follows_knots(patch, ends))) {
        let message = "a slit between the knot lines of a patch with a geometry acts up to half a span beside its place, and \
                       material between it and a loaded edge may move too far: let it follow knot lines";
        findings.warn(key.clone(), message);
    }
    if scene.analysis.frame == Frame::Updated {
        let remedy = "use frame = \"total\", or cut a notch out of the shape: { difference = { of, minus } }";
        findings.error(key.clone(), "a slit in the updated frame, which is not implemented", remedy);
    }
    if scene.analysis.mass == Mass::Consistent {
        findings.error(key, "a slit with the consistent mass, which is not implemented", "use mass = \"lumped\"");
    }
}

/// Whether a line (m) follows a knot line of a patch. What lies outside is found elsewhere.
fn follows_knots(patch: &NurbsPatch, [from, to]: [[f64; 2]; 2]) -> bool {
    let place = |i: usize| [0, 1].map(|d| from[d] + (to[d] - from[d]) * i as f64 / LOOKS as f64);
    let places = (0..=LOOKS).filter_map(|i| patch.locate(place(i), None).ok());
    let parameters: Vec<[f64; 2]> = places.map(|location| location.parameters).collect();
    (0..2).any(|d| {
        let spans = patch.spaces()[d].spans();
        let near = ON_KNOT * (spans[spans.len() - 1].right - spans[0].left);
        let follows = |knot: f64| parameters.iter().all(|at| (at[d] - knot).abs() < near);
        spans.iter().any(|span| follows(span.left) || follows(span.right))
    })
}

/// A crack that is driven grows by the history field of the total frame.
fn driven(key: &str, speed: f64, material: Option<&Material>, look: &Look<'_>, findings: &mut Findings) {
    let fracture = material.and_then(|material| material.fracture.as_ref());
    let key = format!("{key}.speed");
    if look.frame == Frame::Updated {
        let message = "a crack that is driven is implemented in the total frame";
        findings.error(key.clone(), message, "use frame = \"total\", or leave speed out");
    }
    if let Some(model) = fracture.map(|fracture| fracture.model).filter(|model| model.has_threshold()) {
        let message = format!("a crack that is driven is not implemented with {}", model.word());
        findings.error(key.clone(), message, "use model = \"at2\", or leave speed out");
    }
    let waves = material.map(|material| ElasticModuli::new(material, look.plane).rayleigh_speed(material.density));
    if findings.positive(key.clone(), speed, "speed = \"500 m/s\"")
        && let Some(waves) = waves.filter(|waves| speed > *waves)
    {
        findings.warn(
            key,
            format!("faster than Rayleigh waves ({waves:.4e} m/s): an opening crack takes up no energy at this speed"),
        );
    }
}

pub(super) fn check(key: &str, crack: &Crack, material: Option<&Material>, look: &Look<'_>, findings: &mut Findings) {
    let fracture = material.and_then(|material| material.fracture.as_ref());
    if let CrackKind::Driven(speed) = crack.kind {
        driven(key, speed, material, look, findings);
    }
    if let CrackKind::Seed(Some(half_width)) = crack.kind {
        if let Some(model) = fracture.map(|fracture| fracture.model).filter(|model| model.has_threshold()) {
            let word = model.word();
            let message = format!("a seed of {word} is the bound c = 0 on its line: it has no initial history field");
            findings.error(format!("{key}.half_width"), message, "leave the key out, or use model = \"at2\"");
        }
        let like = "half_width = \"0.125 mm\", or leave it out for l0/2";
        findings.positive(format!("{key}.half_width"), half_width, like);
    }
    // A straight crack is usually written with `from` and `to`.
    let place = |i: usize| match crack.points.len() {
        2 => format!("{key}.{}", ["from", "to"][i]),
        _ => format!("{key}.points.{i}"),
    };
    if crack.points.len() < 2 {
        return findings.error(key, "a crack of one point", "give at least two points");
    }
    if !findings.finite(place(0), &crack.points.concat()) {
        return;
    }
    let mut inside = true;
    for (i, &[x, y]) in crack.points.iter().enumerate() {
        if i > 0 && crack.points[i - 1] == [x, y] {
            return findings.error(place(i), "a crack of zero length", "give two different ends");
        }
        if look.is_outside([x, y]) {
            let message = format!("the end ({x}, {y}) m of the crack lies outside body {:?}", look.body.name);
            findings.error(place(i), message, "give ends inside the body or on its boundary");
            inside = false;
        }
    }
    let finest = fracture.map_or(f64::INFINITY, |f| 0.5 * f.length_scale);
    for (i, [from, to]) in crack.segments().enumerate().filter(|_| inside) {
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let intervals = ((length / finest).ceil() as usize).clamp(2, MOST_POSITIONS - 1);
        if let Some([x, y]) = look.first_outside([from, to], intervals) {
            let message = format!("the crack leaves body {:?} between its ends, at ({x}, {y}) m", look.body.name);
            findings.error(place(i), message, "give one crack for each part that lies inside the body");
        }
    }
}

/// Errors for seeds that leave their cracks whole somewhere, and for seeds that cover their body; `h` is the
/// largest span, m.
pub(super) fn seeds(key: &str, body: &Body, fracture: &Fracture, points: &Points<'_>, h: f64, findings: &mut Findings) {
    let l0 = fracture.length_scale;
    let seeds = || body.cracks.iter().enumerate().filter_map(|(j, crack)| Some((j, crack, half_width(crack, l0)?)));
    let parts = seeds().flat_map(|(j, crack, width)| crack.segments().map(move |ends| (j, ends, width)));
    for (j, ends, width) in parts {
        let Some(near) = points.near(ends, width.min(COUNTED * l0)) else {
            unchecked(format!("{key}.crack.{j}"), findings);
            continue;
        };
        let length = (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1]);
        if let Some(whole) = whole_stretch(&near, length, width, l0) {
            findings.error(
                format!("{key}.crack.{j}.half_width"),
                whole.message(width),
                remedy(&near, length, width, l0, h),
            );
        } else {
            let is_driven = matches!(body.cracks[j].kind, CrackKind::Driven(_));
            bridged(&format!("{key}.crack.{j}"), is_driven, &near, width, findings);
        }
    }
    let spared = |x| seeds().all(|(_, crack, width)| crack.distance(x) >= width);
    if let Some((widest, _, _)) = seeds().max_by(|a, b| a.2.total_cmp(&b.2))
        && !points.any(spared)
    {
        let message =
            format!("the initial history of the cracks covers all of body {:?}: nothing is left whole", body.name);
        let remedy = format!("give a smaller half width; the default is l0/2 = {} m", 0.5 * l0);
        findings.error(format!("{key}.crack.{widest}.half_width"), message, remedy);
    }
}

/// Warns of a seed that is broken but too narrow for the functions of the mesh to open over it.
fn bridged(key: &str, is_driven: bool, near: &[Near], width: f64, findings: &mut Findings) {
    let across = near.iter().map(|point| point.across).fold(0.0, larger);
    if width >= OPENING * across * (1.0 - TOLERANCE) {
        return;
    }
    let (key, remedy) = if is_driven {
        (format!("{key}.speed"), format!("use cells of at most {:.3e} m", width / OPENING))
    } else {
        let wider = format!("give a half_width of at least {:.3e} m", OPENING * across);
        (format!("{key}.half_width"), format!("{wider}, or as = \"slit\" in the total frame"))
    };
    let message = format!(
        "the seed is narrower than {OPENING} spans of {across:.3e} m on either side: functions of the mesh reach across it \
         and hold its faces together, so that it opens too little until it tears; {remedy}"
    );
    findings.warn(key, message);
}

/// Says that it was not checked whether a seed breaks its body.
pub(super) fn unchecked(key: String, findings: &mut Findings) {
    let message = "it was not checked that the seed reaches the material points along its crack: see that the fracture \
                   energy begins at about the toughness times the length of the crack";
    findings.warn(key, message);
}

/// Where a seed leaves a crack whole.
enum Unbroken {
    Everywhere,
    /// Between two places along the crack, m.
    Stretch([f64; 2]),
}

impl Unbroken {
    fn message(&self, width: f64) -> String {
        match self {
            Self::Everywhere => format!("no material point lies within the half width of {width} m: there is no crack"),
            Self::Stretch([from, to]) => format!(
                "the half width of {width} m reaches too few material points to break the body from {from:.3e} m to \
                 {to:.3e} m along the crack"
            ),
        }
    }
}

/// The first stretch of a crack that a seed of half width `width` (m) does not break. Stretches without any
/// point near them do not count.
fn whole_stretch(near: &[Near], length: f64, width: f64, l0: f64) -> Option<Unbroken> {
    let strength = |p: &Near| SEED_STRENGTH * p.area * (1.0 - p.distance / width).max(0.0);
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(near.iter().scan(0.0, |sum, point| {
            *sum += strength(point);
            Some(*sum)
        }))
        .collect();
    let (Some(first), Some(last)) = (near.first(), near.last()) else { return Some(Unbroken::Everywhere) };
    if sums[near.len()] == 0.0 {
        return Some(Unbroken::Everywhere);
    }
    let before = |along: f64| near.partition_point(|point| point.along <= along);
    let is_whole = |[from, to]: [f64; 2], span: f64, points: std::ops::Range<usize>| {
        let needed = BREAKING * (4.0 * l0 + span) * (to - from);
        !points.is_empty() && sums[points.end] - sums[points.start] < needed * (1.0 - TOLERANCE)
    };
    let end_from = (length - last.span).max(0.0);
    let ends = [([0.0, first.span.min(length)], first.span), ([end_from, length], last.span)];
    let mut stretches = ends.into_iter().map(|([from, to], span)| {
        let margin = TOLERANCE * span;
        ([from, to], span, before(from - margin)..before(to + margin))
    });
    let mut between = near.iter().filter(|point| point.along + point.span <= length).map(|point| {
        let ([from, to], margin) = ([point.along, point.along + point.span], TOLERANCE * point.span);
        ([from, to], point.span, before(from + margin)..before(to + margin))
    });
    let mut found = |(ends, span, points)| is_whole(ends, span, points).then_some(Unbroken::Stretch(ends));
    stretches.find_map(&mut found).or_else(|| between.find_map(&mut found))
}

/// The least half width, and the largest cells, that would do; rounded so that the figures in the text do
/// too.
fn remedy(near: &[Near], length: f64, width: f64, l0: f64, h: f64) -> String {
    let breaks = |width: f64, l0: f64| whole_stretch(near, length, width, l0).is_none();
    let widest = near.iter().map(|point| point.distance).fold(width, larger) * 100.0;
    if !breaks(widest, l0) {
        return "use smaller cells, or more particles_per_cell".to_string();
    }
    let (mut least, mut enough) = (width, widest);
    for _ in 0..HALVINGS {
        let middle = least.sqrt() * enough.sqrt(); // their product may be no number
        *(if breaks(middle, l0) { &mut enough } else { &mut least }) = middle;
        if enough <= 1.0001 * least {
            break;
        }
    }
    let wider = format!("give a half_width of at least {:.3e} m", 1.0006 * enough);
    // smaller cells are like a larger width and length scale
    let smaller = (1..150).map(|n| 0.97_f64.powi(n)).find(|part| breaks(width / part, l0 / part));
    smaller.map_or(wider.clone(), |part| format!("{wider}, or cells of at most {:.2e} m", 0.99 * part * h))
}
