//! A block that slides on a level plane until friction has stopped it, and then has to stay. The plane may
//! move: the way of the block is the one it makes on it.
//!
//! Coulomb friction mu stops a block of speed V after `T = V/(mu g)` and the distance `V²/(2 mu g)`.

use fisura::scene::Scene;

use super::super::contact::{center, chart, curve, run};
use super::exact;
use crate::case::Case;
use crate::case::expand::CaseScene;
use crate::extremes::{larger, largest};
use crate::output::history::Table;
use crate::record::CurveStyle;
use crate::study::scene::series_stem;
use crate::study::{Findings, StudyError};

pub(in super::super) fn offers(_case: &Case, scenes: &[CaseScene]) -> crate::study::Offered {
    let held = &["distance of sliding over the closed form", "creep after it has stopped over the distance"];
    let bare = &["largest way back in a step over the distance"];
    Ok(crate::study::Offers::of_scenes(scenes, held, bare))
}

pub(in super::super) fn study(case: &Case, scenes: &[CaseScene]) -> Result<Findings, StudyError> {
    let mut findings = Findings::default();
    let mut curves = Vec::new();
    for CaseScene { name, scene, .. } in scenes {
        let slide = Slide::of(scene)?;
        let table = slide.run(scene)?;
        let (times, places) = (&table.columns[0], &table.columns[1]);
        let last = places.last().copied().unwrap_or(f64::NAN);
        let source = exact(1.0, "V²/(2 mu g)");
        findings.add(name, "distance of sliding over the closed form", last / slide.distance(), source);
        let rested = times.iter().zip(places).filter(|(time, _)| **time >= 1.2 * slide.duration());
        let creep = rested.map(|(_, place)| (place - last).abs());
        findings.add(
            name,
            "creep after it has stopped over the distance",
            largest(creep) / slide.distance(),
            exact(0.0, "it sticks"),
        );
        let backwards = places.windows(2).map(|pair| pair[0] - pair[1]).fold(0.0, larger);
        findings.add(name, "largest way back in a step over the distance", backwards / slide.distance(), None);
        let stem = series_stem(case, name);
        for (label, column, style) in
            [("points", "place_m", CurveStyle::Line), ("closed form", "closed_form_m", CurveStyle::Reference)]
        {
            curves.push(curve(&format!("{name}, {label}"), &stem, ["time_s", column], style));
        }
        findings.series.push((stem, table));
    }
    let axes = ["time (s)", "way of the centre of mass (m)"];
    findings.figures.push(chart(case, "way", "A block slides and stops", "", axes, curves));
    Ok(findings)
}

struct Slide {
    /// Velocity of the floor along it, m/s; what follows is relative to it.
    floor: f64,
    speed: f64,
    /// mu g, m/s².
    deceleration: f64,
}

impl Slide {
    fn of(scene: &Scene) -> Result<Self, StudyError> {
        let friction = scene.contact.as_ref().ok_or_else(|| StudyError::Other("there is no contact".into()))?.friction;
        let floor = scene.bodies.iter().find(|body| body.rigid).map_or(0.0, |body| body.velocity[0]);
        Ok(Self {
            floor,
            speed: scene.bodies[0].velocity[0] - floor,
            deceleration: -friction * scene.analysis.gravity[1],
        })
    }

    fn duration(&self) -> f64 {
        self.speed / self.deceleration
    }

    fn distance(&self) -> f64 {
        0.5 * self.speed * self.duration()
    }

    /// Time, way of the centre of mass, and that of the closed form.
    fn run(&self, scene: &Scene) -> Result<Table, StudyError> {
        let mut table = Table::new(&["time_s", "place_m", "closed_form_m"]);
        let mut start = None;
        run(scene, &mut |simulation, frame| {
            let place = center(&frame.fields()[0])[0];
            let time = simulation.steps() as f64 * simulation.plan().step;
            let way = place - *start.get_or_insert(place) - self.floor * time;
            let sliding = time.min(self.duration());
            let exact = self.speed * sliding - 0.5 * self.deceleration * sliding * sliding;
            table.push(&[time, way, exact]);
        })?;
        Ok(table)
    }
}
