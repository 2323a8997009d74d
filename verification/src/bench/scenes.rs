//! Only what a scene declares is modelled: time and memory of scenes that differ in their physics, in both
//! frames; and half of a symmetric plate against the whole.
//!
//! Blocks of equal numbers of points, p = 2 with 2 × 2 points per span, one thread.

use fisura::Simulation;
use fisura::scene::{
    Body, Contact, CrackModel, Frame, Mesh, Scene, Shape, Side, Softening, Split, TimeFactor, Traction,
};

use super::block::{MARGIN, SPAN, cracked_scene, elastic_scene};
use super::plate_scene;
use super::record::BenchRecord;
use super::timing::{Contestant, pool, round_robin, time_steps};
use super::{BenchError, Settings, advance};

/// Degree of the blocks.
const DEGREE: usize = 2;
/// Number of time steps in a sample.
const STEPS: usize = 10;
/// The ledger of a cracking body closes to this fraction of the largest energy, as the suites ask.
const CLOSURE: f64 = 1e-3;

/// Cracks beside that of the scene "fracture", which is AT2 with the spectral split.
const MODELS: [(&str, CrackModel, Split); 7] = [
    ("fracture, no split", CrackModel::At2, Split::None),
    ("fracture, volumetric-deviatoric split", CrackModel::At2, Split::VolumetricDeviatoric),
    ("fracture, star-convex split", CrackModel::At2, Split::StarConvex(1.0)),
    ("fracture, AT1", CrackModel::At1, Split::Spectral),
    ("fracture, AT1, Rankine", CrackModel::At1, Split::Rankine),
    ("fracture, PF-CZM", COHESIVE, Split::Spectral),
    ("fracture, PF-CZM, Rankine", COHESIVE, Split::Rankine),
];
/// Cohesive crack: in the material of the block `a1 = 2 E Gc/(π l0 ft²)` is 4.35.
const COHESIVE: CrackModel = CrackModel::PfCzm { tensile_strength: 7.5e6, softening: Softening::Linear };

/// What must have happened in a scene for its time to count.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Happens {
    /// Nothing is solved for the phase field, if there is one, and nothing meets.
    Motion,
    /// The phase field is solved for, and its start is accepted every time.
    NothingGrows,
    /// Its solves, one or more in a step, take iterations.
    CrackGrows,
    /// Two bodies, and no force of contact.
    Apart,
    /// Two bodies meet, and forces of contact act between them.
    Contact,
}

/// Times the scenes.
///
/// # Errors
/// If a scene cannot be run.
pub fn family(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let cells = if settings.quick { 64 } else { 192 };
    pool(1)?.install(|| {
        let mut contestants = Vec::new();
        for frame in [Frame::Total, Frame::Updated] {
            for (name, scene, happens) in scenes(cells, frame) {
                contestants.push(contestant(settings, name, frame, &scene, happens)?);
            }
        }
        let mut records = round_robin(contestants, settings.rounds(), settings.budget())?;
        records.extend(halves(settings)?);
        Ok(records)
    })
}

fn scenes(cells: usize, frame: Frame) -> Vec<(&'static str, Scene, Happens)> {
    let margin = if frame == Frame::Updated { MARGIN } else { 0 };
    let elastic = elastic_scene(DEGREE, 2, cells, margin);
    let frozen = cracked_scene(DEGREE, 2, cells, margin);
    let mut fracture = frozen.clone();
    let pulled = |side, stress| Traction::on(side, [0.0, stress], TimeFactor::default());
    fracture.bodies[0].tractions = vec![pulled(Side::Top, 4e6), pulled(Side::Bottom, -4e6)];
    let mut scenes = vec![
        ("elastic", elastic, Happens::Motion),
        ("elastic with a frozen crack", frozen, Happens::NothingGrows),
        ("fracture", fracture.clone(), Happens::CrackGrows),
    ];
    if frame == Frame::Total {
        let mut intact = fracture.clone();
        (intact.bodies[0].tractions, intact.bodies[0].cracks) = Default::default();
        let cracks = intact.materials.values_mut().filter_map(|material| material.fracture.as_mut());
        cracks.for_each(|fracture| fracture.model = CrackModel::At1);
        scenes.push(("AT1 that does not crack", intact, Happens::Motion));
        scenes.extend(MODELS.map(|(name, model, split)| {
            let mut scene = fracture.clone();
            let cracks = scene.materials.values_mut().filter_map(|material| material.fracture.as_mut());
            cracks.for_each(|fracture| (fracture.model, fracture.split) = (model, split));
            (name, scene, Happens::CrackGrows)
        }));
    }
    if frame == Frame::Updated {
        let contact = Some(Contact { friction: 0.3, ..Contact::default() });
        scenes.push(("two bodies, no contact declared", pair(cells, 2.0, None), Happens::Motion));
        scenes.push(("two bodies apart, contact declared", pair(cells, 4.0, contact.clone()), Happens::Apart));
        scenes.push(("two bodies in contact", pair(cells, 0.0, contact), Happens::Contact));
    }
    for (_, scene, _) in &mut scenes {
        scene.analysis.frame = frame;
    }
    scenes
}

/// Two halves of the elastic block, `gap` spans apart, that move towards each other.
pub fn pair(cells: usize, gap: f64, contact: Option<Contact>) -> Scene {
    let mut scene = elastic_scene(DEGREE, 2, cells, MARGIN);
    let (edge, half) = (SPAN * MARGIN as f64, SPAN * (cells / 2) as f64);
    let (width, height) = (2.0 * half + SPAN * gap.ceil(), SPAN * cells as f64);
    let spans = [cells + gap.ceil() as usize + 2 * MARGIN, cells + 2 * MARGIN];
    scene.mesh = Mesh::uniform([DEGREE; 2], [-edge; 2], [width + 2.0 * edge, height + 2.0 * edge], spans);
    let body = |name: &str, left: f64, velocity: f64| Body {
        name: name.into(),
        shape: Shape::Rectangle { min: [left, 0.0], max: [left + half, height] },
        velocity: [velocity, 0.0],
        angular_velocity: 0.0,
        ..scene.bodies[0].clone()
    };
    scene.bodies = vec![body("left", 0.0, 1.0), body("right", half + SPAN * gap, -1.0)];
    scene.contact = contact;
    scene
}

fn contestant(
    settings: &Settings,
    name: &str,
    frame: Frame,
    scene: &Scene,
    happens: Happens,
) -> Result<Contestant<'static>, BenchError> {
    let mut simulation = Simulation::new(scene)?;
    let run_up = match (happens, settings.quick) {
        (Happens::CrackGrows, true) => 60,
        (Happens::CrackGrows, false) => 200,
        _ => 5,
    };
    advance(&mut simulation, run_up)?;
    let extent = simulation.extent();
    // Fictitious material makes pivots vanish, and a factor whose diagonal was raised for them judges a start
    // only by an iteration.
    let (word, to_judge) = if frame == Frame::Total { ("total", 0) } else { ("updated", STEPS) };
    let id = format!("scenes/{word}/{}", name.replace([',', ' '], "-").replace("--", "-"));
    let record = BenchRecord::of_steps(id, name, &extent, STEPS).with("frame", word).with("models", extent.models);
    let run = move |record: &mut BenchRecord| {
        let before = simulation.phase_field_counts();
        let sample = time_steps(&mut simulation, STEPS)?;
        let counts = simulation.phase_field_counts();
        let [solves, iterations] = [counts.solves - before.solves, counts.iterations - before.iterations];
        let forces = simulation.updated_frame().map_or(0, |f| f.contact_forces(simulation.plan().step).len());
        let found = simulation.sample();
        let closure = found.closure.abs() / found.largest_term().max(f64::MIN_POSITIVE);
        let holds = match happens {
            Happens::Motion => solves == 0 && forces == 0,
            Happens::NothingGrows => solves == STEPS && iterations <= to_judge,
            Happens::CrackGrows => solves >= STEPS && iterations >= STEPS,
            Happens::Apart => solves == 0 && forces == 0,
            Happens::Contact => forces > 0,
        };
        let answer = format!(
            "{solves} solves with {iterations} iterations in {STEPS} steps, {forces} forces of contact, ledger closed to {closure:.0e}"
        );
        record.verify(holds && closure <= CLOSURE, answer);
        Ok(sample)
    };
    Ok(Contestant { record, run: Box::new(run) })
}

/// Half of the plate and all of it at h = l0, from the start; the energies of both must agree.
fn halves(settings: &Settings) -> Result<Vec<BenchRecord>, BenchError> {
    let half = plate_scene::half(settings, 2, 1.0)?;
    let whole = settings.case("plate/half-against-full-p2-h1", &[])?.scenes()?;
    let whole = whole.into_iter().find(|s| s.energy_factor == 1.0);
    let whole = whole.ok_or_else(|| BenchError::other("the case half-against-full-p2-h1 has no whole plate"))?;
    let mut contestants = Vec::new();
    let mut kinetic = Vec::new();
    for (name, case) in [("half of the plate", half), ("the whole plate", whole)] {
        let mut simulation = Simulation::new(&case.scene)?;
        advance(&mut simulation, 100)?;
        kinetic.push(case.energy_factor * simulation.sample().kinetic);
        let extent = simulation.extent();
        let id = format!("scenes/total/{}", name.replace(' ', "-"));
        let record =
            BenchRecord::of_steps(id, name, &extent, STEPS).with("frame", "total").with("models", extent.models);
        let run = move |_: &mut BenchRecord| time_steps(&mut simulation, STEPS);
        contestants.push(Contestant { record, run: Box::new(run) });
    }
    let difference = (kinetic[0] / kinetic[1] - 1.0).abs();
    for contestant in &mut contestants {
        contestant.record.verify_at_most("difference of the kinetic energies after 100 steps", difference, 1e-2);
    }
    round_robin(contestants, settings.rounds(), settings.budget())
}
