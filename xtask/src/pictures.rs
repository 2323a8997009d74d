//! Figures of one run: energies, and phase field and stress at the frames.

use fisura::output::picture::Picture;
use fisura_reports::FigureError;
use fisura_reports::field::{Raster, render_field};
use fisura_reports::number::pretty;
use fisura_reports::run_report::{energies_svg, phase_name, phase_svg};
use fisura_verification::output::history::Table;
use fisura_verification::record::{Figure, FigureBody};
use fisura_verification::scene_run::SceneRun;

/// Part of the pixels beyond either end of the colour bar of stress: a crack tip would leave no colour for
/// the rest.
const CLIPPED: f64 = 0.005;

/// File name and SVG of every figure of a run.
pub fn draw(run: &SceneRun) -> Vec<(String, Result<String, FigureError>)> {
    let title = &run.summary.title;
    let mut drawings = Vec::new();
    if run.history.rows() > 1 {
        drawings.push(("energies.svg".to_string(), energies_svg(&run.history, title)));
    }
    let stress = StressScale::of(&run.frames);
    for frame in &run.frames {
        let name = phase_name(frame.time);
        if let Some(phase) = &frame.phase {
            drawings.push((format!("{name}.svg"), phase_svg(&table(frame, phase), frame.time, title)));
        }
        let name = name.replacen("phase", "stress", 1);
        drawings.push((format!("{name}.svg"), stress_svg(frame, &stress, &name, title)));
    }
    drawings
}

/// A field of a picture in the form of a series file.
fn table(picture: &Picture, values: &[f64]) -> Table {
    let mut table = Table::new(&["x_m", "y_m", "value"]);
    for (index, value) in values.iter().enumerate() {
        let [x, y] = picture.center(index);
        table.push(&[x, y, *value]);
    }
    table
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
    let high = [0, 1].map(|d| frame.origin[d] + frame.pixels[d] as f64 * frame.pixel[d]);
    let values = frame.stress.iter().map(|s| s * scale.factor).collect();
    let raster = Raster { pixels: frame.pixels, low: frame.origin, high, values };
    let body =
        FigureBody::Field { series: String::new(), pixels: raster.pixels, label: label.clone(), range: scale.range };
    let figure = Figure {
        id: id.to_string(),
        suite: String::new(),
        title: format!("{title}, largest principal stress at {} µs", pretty(1e6 * frame.time, 4)),
        caption: "The colour bar is common to all frames of the run; at most 0.5 % of the pixels of all frames lie beyond either end."
            .to_string(),
        deviations: Vec::new(),
        body,
    };
    render_field(&figure, &raster, &label, scale.range)
}
