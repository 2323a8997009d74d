//! Figures of one run: energies, phase field and stress at the frames, and a moving picture.

use std::collections::BTreeSet;

use fisura::output::picture::Picture;
use fisura::scene::Scene;
use fisura_reports::FigureError;
use fisura_reports::animation::{Moment, render_animation};
use fisura_reports::field::{Raster, render_raster};
use fisura_reports::number::pretty;
use fisura_reports::run_report::{energies_svg, phase_name, phase_svg};
use fisura_verification::scene_run::SceneRun;

/// Part of the pixels beyond either end of the colour bar of stress: a crack tip would leave no colour for
/// the rest.
const CLIPPED: f64 = 0.005;

/// Moments of a moving picture, beside the frames of the scene.
const MOMENTS: usize = 40;

/// File name of a figure, and its SVG.
pub type Drawing = (String, Result<String, FigureError>);

/// Adds the moments of a moving picture to the frames of a scene.
pub fn add_moments(scene: &mut Scene) {
    let end = scene.analysis.end_time;
    let frames = &mut scene.output.frames;
    frames.extend((0..=MOMENTS).map(|moment| end * moment as f64 / MOMENTS as f64));
    frames.sort_by(f64::total_cmp);
    frames.dedup_by(|a, b| (*a - *b).abs() < 0.1 * end / MOMENTS as f64);
}

/// Every figure of a run: stills nearest to the times of `stills` (s), and all its frames as a moving picture
/// if that is asked for.
pub fn draw(run: &SceneRun, stills: &[f64], animate: bool) -> Vec<Drawing> {
    let title = &run.summary.title;
    let mut drawings = Vec::new();
    if run.history.rows() > 1 {
        drawings.push(("energies.svg".to_string(), energies_svg(&run.history, title)));
    }
    let stress = StressScale::of(&run.frames);
    for frame in nearest(&run.frames, stills) {
        let name = phase_name(frame.time);
        if let Some(phase) = &frame.phase {
            drawings.push((format!("{name}.svg"), phase_svg(&raster(frame, phase.clone()), frame.time, title)));
        }
        let name = name.replacen("phase", "stress", 1);
        drawings.push((format!("{name}.svg"), stress_svg(frame, &stress, &name, title)));
    }
    if animate {
        drawings.push(animation(run, &stress));
    }
    drawings
}

/// The frame nearest to each time, each once and in order.
fn nearest<'a>(frames: &'a [Picture], times: &[f64]) -> Vec<&'a Picture> {
    let away = |frame: usize, time: f64| (frames[frame].time - time).abs();
    let of_time = |time: &f64| (0..frames.len()).min_by(|a, b| away(*a, *time).total_cmp(&away(*b, *time)));
    let wanted: BTreeSet<usize> = times.iter().filter_map(of_time).collect();
    wanted.into_iter().map(|frame| &frames[frame]).collect()
}

fn animation(run: &SceneRun, stress: &StressScale) -> Drawing {
    let title = &run.summary.title;
    let has_phase = run.frames.iter().all(|frame| frame.phase.is_some());
    let values = |frame: &Picture| match frame.phase.as_ref().filter(|_| has_phase) {
        Some(phase) => phase.clone(),
        None => frame.stress.iter().map(|s| s * stress.factor).collect(),
    };
    let moments: Vec<Moment> = run.frames.iter().map(|frame| (frame.time, raster(frame, values(frame)))).collect();
    let (name, label, range) = match has_phase {
        true => ("phase-animated", "phase field c".to_string(), [0.0, 1.0]),
        false => ("stress-animated", format!("stress σ₁ ({})", stress.unit), stress.range),
    };
    (format!("{name}.svg"), render_animation(name, title, &moments, (&label, range)))
}

fn raster(frame: &Picture, values: Vec<f64>) -> Raster {
    let high = [0, 1].map(|d| frame.origin[d] + frame.pixels[d] as f64 * frame.pixel[d]);
    Raster { pixels: frame.pixels, low: frame.origin, high, values }
}

/// Unit and range of the colour bar, common to all frames of a run.
struct StressScale {
    unit: &'static str,
    factor: f64,
    range: [f64; 2],
}

impl StressScale {
    fn of(frames: &[Picture]) -> Self {
        let mut values: Vec<f64> = frames.iter().flat_map(|f| &f.stress).copied().filter(|v| v.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let quantile = |q: f64| values.get((q * values.len().saturating_sub(1) as f64) as usize).copied();
        let low = quantile(CLIPPED).unwrap_or(0.0).min(0.0);
        let high = quantile(1.0 - CLIPPED).unwrap_or(0.0).max(0.0);
        let size = high.max(-low);
        let units = [("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)];
        let (unit, size_of_unit) = units.into_iter().find(|(_, s)| size >= *s).unwrap_or(("Pa", 1.0));
        let range = if high > low { [low / size_of_unit, high / size_of_unit] } else { [0.0, 1.0] };
        Self { unit, factor: 1.0 / size_of_unit, range }
    }
}

fn stress_svg(frame: &Picture, scale: &StressScale, id: &str, title: &str) -> Result<String, FigureError> {
    let label = format!("stress σ₁ ({})", scale.unit);
    let raster = raster(frame, frame.stress.iter().map(|s| s * scale.factor).collect());
    let title = format!("{title}, largest principal stress at {} µs", pretty(1e6 * frame.time, 4));
    let caption = "The colour bar is common to all frames of the run; at most 0.5 % of the pixels of all frames lie beyond either end.";
    render_raster([id, &title, caption], &raster, (&label, scale.range))
}
