//! `check SCENE.toml`: what will be modelled and what it will cost.

use std::collections::BTreeMap;
use std::time::Instant;

use fisura::dynamics::time_plan::TimePlan;
use fisura::linear_algebra::extremes::larger;
use fisura::material::elasticity::ElasticModuli;
use fisura::particles::spans::{largest_spans, smallest_span};
use fisura::scene::{Body, Crack, Frame, Material, Plane, Scene};
use fisura::simulation::{Extent, Simulation};
use fisura::validate::expected_size;
use fisura_reports::number::duration;
use fisura_reports::template::filled;
use fisura_verification::scene::SceneFile;
use fisura_verification::scene_run::peak_memory_mb;
use minijinja::value::Serde;
use serde::Serialize;

use crate::cli::{Common, SceneArgs};
use crate::exit::Exit;
use crate::failure::Failure;
use crate::{console, scene_input};

mod growth;
mod long_ends;
mod trial;
mod words;

use growth::Tried;
use long_ends::LongEnds;
use trial::{Trial, spans};
use words::{solves, strength, transfer, words};

/// The findings for people.
const TEXT: &str = include_str!("texts/check.txt");
/// Points or control points up to which a scene is made ready to be checked: seconds, and less than 1 GiB.
const MOST_PREPARED: usize = 1_000_000;
/// Distance in spans by which a slit ends behind the last knot line before its tip, for p = 1 to 4: by the
/// static energy of a plate (`fracture/slit-tip`; p = 4 was measured once, on 80 spans).
const SLIT_ENDS: [f64; 4] = [0.24, 0.53, 0.85, 1.2];
/// Critical step over the time a dilatational wave takes to cross the smallest span, roughly.
const CRITICAL: f64 = 0.5;
/// Wall time after which a run stores its state, s, and how often that is in memory then: as it grows and as
/// it is written.
const BETWEEN_CHECKPOINTS: f64 = 60.0;
const STATES: usize = 3;

/// Arguments of `check`.
#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,
}

/// Validates a scene, prepares it, tries its first steps for a second, and says what it found.
///
/// # Errors
/// A bad scene, or an initial phase field that does not converge. A breakdown within the trial is a warning.
pub fn check(args: &Args, common: &Common) -> Result<Exit, Failure> {
    console::no_files(common, "check");
    let file = scene_input::load(&args.scene, common)?;
    let mut found = match prepared(&file)? {
        Some((simulation, seconds)) => Findings::new(&file.scene, &simulation).tried(&file.scene, simulation, seconds),
        None => Findings::unprepared(&file.scene),
    };
    for warning in &found.warnings {
        console::note(common, &format!("warning: {warning}"));
    }
    found.warnings.splice(0..0, file.warnings.iter().map(ToString::to_string));
    console::show(common, &found, || filled("check.txt", TEXT, Serde(&found)));
    Ok(Exit::Done)
}

/// The scene ready to run and the seconds that took, unless it is too large to be made ready only to be
/// looked at.
fn prepared(file: &SceneFile) -> Result<Option<(Simulation, f64)>, Failure> {
    let size = expected_size(&file.scene);
    if size.points.max(size.control_points) > MOST_PREPARED {
        return Ok(None);
    }
    let start = Instant::now();
    let simulation = Simulation::new(&file.scene).map_err(|breakdown| Failure::of_run(&breakdown, file))?;
    Ok(Some((simulation, start.elapsed().as_secs_f64())))
}

/// What will be modelled and what it will cost.
#[derive(Debug, Serialize)]
struct Findings {
    title: String,
    models: Vec<String>,
    plane: &'static str,
    frame: &'static str,
    /// Of the updated frame, and what it keeps.
    #[serde(skip_serializing_if = "Option::is_none")]
    transfer: Option<String>,
    bodies: Vec<BodyFindings>,
    materials: BTreeMap<String, MaterialFindings>,
    /// How the phase field is solved; absent without fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    phase_field: Option<String>,
    degree: [usize; 2],
    cells: [usize; 2],
    /// How often spans are halved near cracks.
    #[serde(skip_serializing_if = "Option::is_none")]
    halvings: Option<usize>,
    /// Largest span per direction, m.
    span_m: [f64; 2],
    particles: usize,
    control_points: usize,
    end_time_s: f64,
    critical_step_s: Option<f64>,
    /// Absent where it would not pay.
    #[serde(skip_serializing_if = "Option::is_none")]
    long_ends: Option<LongEnds>,
    time_step_s: f64,
    steps: usize,
    samples: usize,
    frames: usize,
    /// Largest memory of the process of a run, 10⁶ bytes.
    memory_mb: f64,
    phase_field_memory_mb: f64,
    /// Absent if no step could be tried.
    estimated_wall_s: Option<f64>,
    /// How time and memory were found.
    estimate: String,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct BodyFindings {
    name: String,
    material: String,
    tractions: usize,
    cracks: usize,
    /// Of each slit: where it is drawn to, m, and by how much it ends before that, m.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    slits: Vec<SlitFindings>,
}

#[derive(Debug, Serialize)]
struct SlitFindings {
    drawn_to_m: [f64; 2],
    ends_before_m: f64,
}

#[derive(Debug, Serialize)]
struct MaterialFindings {
    /// Speed of dilatational waves, m/s.
    wave_speed_m_per_s: f64,
    /// Length scale over the largest span; absent without fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    length_scale_over_span: Option<f64>,
    /// Surface energy and split; absent without fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    fracture: Option<String>,
    /// Largest stress of a uniform bar, Pa, to some percent; absent without fracture.
    #[serde(skip_serializing_if = "Option::is_none")]
    tensile_strength_pa: Option<f64>,
}

impl Findings {
    /// Of a scene too large to be made ready.
    fn unprepared(scene: &Scene) -> Self {
        let size = expected_size(scene);
        let fractures = size.phase_field_bytes > 0;
        let mut models = vec!["momentum".to_string()];
        models.extend(fractures.then(|| "phase field".to_string()));
        models.extend(scene.contact.is_some().then(|| "contact".to_string()));
        let extent = Extent {
            models,
            particles: size.points,
            control_points: size.control_points,
            mechanics_bytes: size.mechanics_bytes,
            phase_field_bytes: size.phase_field_bytes,
        };
        let fastest = materials(scene, 1.0).values().map(|m| m.wave_speed_m_per_s).fold(0.0, larger);
        let critical = CRITICAL * smallest_span(&scene.mesh) / fastest;
        let (plan, warnings) = TimePlan::new(scene, critical);
        let mut found = Self::of(scene, &extent, &plan, &warnings);
        found.memory_mb += peak_memory_mb().unwrap_or(0.0);
        found.estimate =
            "counts, memory and steps from cells and wave speed: too large to be made ready for a look".to_string();
        let Some(tried) = Tried::of(scene) else { return found };
        let (trial, larger) = (&tried.trial, size.points as f64 / tried.points);
        found.estimated_wall_s = Some(larger * trial.step_s() * plan.steps() as f64);
        found.memory_mb = tried.memory_mb(scene, size.points as f64).unwrap_or(found.memory_mb);
        found.phase_field_memory_mb = larger * 1e-6 * tried.extent.phase_field_bytes as f64;
        found.add_output(trial, larger);
        found.estimate = format!(
            "counts and steps from cells and wave speed: too large to be made ready for a look; time and memory from {} \
             steps of a mesh with {} particles",
            trial.steps, tried.extent.particles
        );
        found
    }

    /// Of a scene that is ready.
    fn new(scene: &Scene, simulation: &Simulation) -> Self {
        Self::of(scene, &simulation.extent(), simulation.plan(), simulation.warnings())
    }

    /// With time and memory of a short trial; `seconds` is what making it ready took.
    fn tried(mut self, scene: &Scene, mut simulation: Simulation, seconds: f64) -> Self {
        match Trial::of(scene, &mut simulation) {
            Ok(Some(trial)) => {
                let rows = self.samples as f64 * trial.sample_s + self.frames as f64 * trial.picture_s;
                self.estimated_wall_s = Some(seconds + rows + self.steps as f64 * trial.step_s());
                self.memory_mb = trial.memory_mb.map_or(self.memory_mb, |mb| larger(mb, self.memory_mb));
                self.add_output(&trial, 1.0);
                let (threads, took) = (rayon::current_num_threads(), duration(trial.steps_s));
                let threads = if threads == 1 { "one thread".to_string() } else { format!("{threads} threads") };
                self.estimate = format!("from {} steps that took {took} here, with {threads}", trial.steps);
            }
            Ok(None) => self.estimate = "no step to try".to_string(),
            Err(breakdown) => self.warnings.push(format!("a trial of the first steps breaks down: {breakdown}")),
        }
        self
    }

    /// Memory of what a run keeps to write: pictures, and its state if it lasts; of a scene so many times
    /// larger than that of the trial.
    fn add_output(&mut self, trial: &Trial, larger: f64) {
        self.memory_mb += 1e-6 * (self.frames * trial.picture_bytes) as f64;
        if self.estimated_wall_s.is_some_and(|seconds| seconds > BETWEEN_CHECKPOINTS) {
            self.memory_mb += 1e-6 * larger * (STATES * trial.state_bytes) as f64;
        }
    }

    fn of(scene: &Scene, extent: &Extent, plan: &TimePlan, warnings: &[String]) -> Self {
        let span_m = largest_spans(&scene.mesh);
        let by_points = scene.analysis.frame == Frame::Updated;
        Self {
            title: scene.title.clone(),
            models: extent.models.clone(),
            plane: if scene.analysis.plane == Plane::Strain { "strain" } else { "stress" },
            frame: if scene.analysis.frame == Frame::Total { "total" } else { "updated" },
            transfer: by_points.then(|| transfer(scene.analysis.transfer)),
            bodies: bodies(scene),
            materials: materials(scene, span_m[0].max(span_m[1]) / f64::from(1_u32 << scene.mesh.halvings)),
            phase_field: materials_in_use(scene).any(|(_, m)| m.fracture.is_some()).then(|| solves(&scene.solver)),
            degree: scene.mesh.degree,
            cells: spans(&scene.mesh),
            halvings: Some(scene.mesh.halvings).filter(|halvings| *halvings > 0),
            span_m,
            particles: extent.particles,
            control_points: extent.control_points,
            end_time_s: scene.analysis.end_time,
            critical_step_s: Some(plan.critical).filter(|c| c.is_finite()),
            long_ends: LongEnds::of(scene),
            time_step_s: plan.step,
            steps: plan.steps(),
            samples: plan.samples,
            frames: scene.output.frames.len(),
            memory_mb: 1e-6 * (extent.mechanics_bytes + extent.phase_field_bytes) as f64,
            phase_field_memory_mb: 1e-6 * extent.phase_field_bytes as f64,
            estimated_wall_s: None,
            estimate: String::new(),
            warnings: warnings.to_vec(),
        }
    }
}

fn bodies(scene: &Scene) -> Vec<BodyFindings> {
    let of = |body: &Body| BodyFindings {
        name: body.name.clone(),
        material: body.material.clone(),
        tractions: body.tractions.len(),
        cracks: body.cracks.len(),
        slits: body.cracks.iter().filter(|c| c.is_slit()).filter_map(|crack| slit(scene, body, crack)).collect(),
    };
    scene.bodies.iter().map(of).collect()
}

/// Where the second end of a slit is: functions that it does not part are not copied. `None` on a patch with
/// a geometry, and where the slit leaves the body.
fn slit(scene: &Scene, body: &Body, crack: &Crack) -> Option<SlitFindings> {
    let [from, to] = crack.segments().last()?;
    let along = [to[0] - from[0], to[1] - from[1]];
    if !body.shape.contains([0, 1].map(|d| to[d] + 1e-9 * along[d])) {
        return None;
    }
    let d = usize::from(along[1].abs() > along[0].abs());
    let behind = SLIT_ENDS.get(scene.mesh.degree[d].checked_sub(1)?).filter(|_| scene.mesh.geometry.is_none())?;
    let knots = &scene.mesh.knots[d];
    let inside = |knot: &f64| (knot - to[d]) * along[d] <= 1e-9 * along[d] * along[d];
    let last = knots.iter().copied().filter(inside).min_by(|a, b| (a - to[d]).abs().total_cmp(&(b - to[d]).abs()))?;
    let span = knots.windows(2).filter(|k| k[0] < k[1] && k[0] <= last && last <= k[1]).map(|k| k[1] - k[0]).next()?;
    let length = along[0].hypot(along[1]);
    let ends_before_m = ((to[d] - last).abs() + behind * span) * length / along[d].abs();
    Some(SlitFindings { drawn_to_m: to, ends_before_m })
}

fn materials_in_use(scene: &Scene) -> impl Iterator<Item = (&String, &Material)> {
    scene.materials.iter().filter(|(name, _)| scene.bodies.iter().any(|b| b.material == **name))
}

fn materials(scene: &Scene, span: f64) -> BTreeMap<String, MaterialFindings> {
    let of = |(name, material): (&String, &Material)| {
        let moduli = ElasticModuli::new(material, scene.analysis.plane);
        let findings = MaterialFindings {
            wave_speed_m_per_s: moduli.dilatational_speed(material.density),
            length_scale_over_span: material.fracture.as_ref().map(|f| f.length_scale / span),
            fracture: material.fracture.as_ref().map(words),
            tensile_strength_pa: material.fracture.as_ref().map(|f| strength(material, f, scene.analysis.plane)),
        };
        (name.clone(), findings)
    };
    materials_in_use(scene).map(of).collect()
}
