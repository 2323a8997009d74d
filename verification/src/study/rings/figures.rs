//! Figures 5b and 6 of the paper: fracture energy against time with the events marked, and phase-field
//! pictures.

use super::{PAPER, Watched};
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::record::{Curve, Figure, FigureBody, Region};
use crate::study::Findings;
use crate::study::rings::events::{EVENTS, annulus};
use crate::study::scene::{length_scale, microseconds, raster, series_stem};

/// Adds the figures of a scene.
pub fn add(findings: &mut Findings, case: &Case, case_scene: &CaseScene, watched: &Watched) {
    let stem = series_stem(case, &case_scene.name);
    let caption = caption(case_scene, watched);
    let figure = |name: &str, title: &str, body: FigureBody| Figure {
        deviations: case.deviations.clone(),
        ..Figure::new(&case.suite, [&format!("{}-{name}", case.name), title, &caption], body)
    };
    let series = format!("series/{stem}.csv");
    let curve = |column: &str| Curve::energy(&series, column, case_scene.energy_factor);
    let body = FigureBody::over_time("fracture energy (J)", vec![curve("fracture_j")], events());
    let title = "Fracture energy of both rings, events of the paper marked";
    findings.figures.push(figure("fracture-energy", title, body));
    let energies = ["fracture_j", "kinetic_j", "elastic_j", "contact_loss_j", "closure_j"];
    let body = FigureBody::over_time("energy (J)", energies.map(curve).to_vec(), Vec::new());
    findings.figures.push(figure("ledger", "Energy ledger of both rings", body));
    for picture in &watched.pictures {
        let Some(phase) = &picture.phase else { continue };
        let time = microseconds(picture.time);
        let name = format!("{stem}-phase-{time}us");
        findings.series.push((name.clone(), raster(picture, phase)));
        let (name, title) = (format!("series/{name}.csv"), format!("Phase field at {time:.0} µs"));
        let body = FigureBody::phase_field(name, picture.pixels);
        findings.figures.push(figure(&format!("phase-{time:.0}us"), &title, body));
    }
}

fn caption(CaseScene { scene, .. }: &CaseScene, watched: &Watched) -> String {
    let radii = annulus(&scene.bodies[0].shape)
        .map_or(String::new(), |(_, [inner, outer])| format!("radii {:.0} and {:.0} mm, ", 1e3 * inner, 1e3 * outer));
    let l0 = length_scale(scene).unwrap_or(f64::NAN);
    format!(
        "Geometry assumed: {radii}l0 = {} mm. p = {}, h = {:.3} mm, {} points, {} steps of {:.3e} s.",
        (1e6 * l0).round() / 1e3,
        scene.mesh.degree[0],
        1e3 * fisura::particles::spans::largest_spans(&scene.mesh)[0],
        watched.particles,
        watched.steps,
        watched.step
    )
}

/// Lines at the times of the paper.
fn events() -> Vec<Region> {
    let region = |(name, time): (&&str, Option<f64>)| {
        let time = 1e6 * time?;
        Some(Region { label: (*name).to_string(), x: Some([time - 0.5, time + 0.5]), y: None })
    };
    EVENTS.iter().zip(PAPER).filter_map(region).collect()
}
