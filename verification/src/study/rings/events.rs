//! Events of a collision, watched sample by sample on the line of centres.

use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::dynamics::updated_frame::field::DiscreteField;
use fisura::fault;
use fisura::material::degradation::BROKEN;
use fisura::scene::{Scene, Shape};

use crate::extremes::smaller;
use crate::output::history::Table;

/// Part of the final fracture energy at which it counts as levelled off.
const LEVEL: f64 = 0.97;

/// Distance from the line of centres beyond which broken material lies aside, over twice the length scale.
const ASIDE: f64 = 3.0;

/// Names of the events, in the order of the paper.
pub const EVENTS: [&str; 6] = [
    "cracks at the inner edge towards the contact",
    "contact zone reached",
    "cracks at the rear",
    "rear wall cracked through",
    "fracture energy levels off",
    "contact ends",
];

/// The wall of the first ring on the line of centres, on the side of the contact or at the rear.
#[derive(Debug, Clone, Default)]
struct Wall {
    /// Smallest phase field of the points in every interval from the inner edge outwards.
    phases: Vec<f64>,
}

/// A ring of a run that is being watched.
#[derive(Debug)]
pub struct Watch {
    /// Number of the body, and the side on which it meets the other: 1 towards larger x.
    body: usize,
    side: f64,
    center: [f64; 2],
    radii: [f64; 2],
    interval: f64,
    /// Half width of the strip around the line of centres, m.
    strip: f64,
    /// Depth under the outer edge that counts as reached by the crack, m.
    depth: f64,
    /// What is watched, row by row.
    pub table: Table,
}

impl Wall {
    /// Whether the crack has begun at the inner edge.
    fn begun(&self) -> bool {
        self.phases.first().is_some_and(|c| *c < BROKEN)
    }

    /// Part of the intervals that are broken.
    fn broken(&self) -> f64 {
        self.phases.iter().filter(|c| **c < BROKEN).count() as f64 / self.phases.len() as f64
    }
}

/// Radii of the first body: an annulus, or what is left of one. Its centre, inner and outer radius, m.
pub fn annulus(shape: &Shape) -> Option<([f64; 2], [f64; 2])> {
    match shape {
        Shape::Annulus { center, inner_radius, outer_radius } => Some((*center, [*inner_radius, *outer_radius])),
        Shape::Difference { of, .. } => annulus(of),
        _ => None,
    }
}

impl Watch {
    /// Watch over a body of a scene, the first of which is hit on its right and the second on its left;
    /// `None` if it is no brittle ring.
    pub fn new(scene: &Scene, number: usize) -> Option<Self> {
        let body = &scene.bodies[number];
        let (center, radii) = annulus(&body.shape)?;
        let fracture = scene.materials[&body.material].fracture.as_ref()?;
        let spans = scene.mesh.knots[0].windows(2).map(|k| k[1] - k[0]).filter(|h| *h > 0.0);
        let spacing = spans.fold(f64::INFINITY, smaller) / body.particles_per_cell[0] as f64;
        let names = [
            "front_broken",
            "rear_broken",
            "front_begun",
            "rear_begun",
            "force_n",
            "elastic_asymmetry",
            "fracture_asymmetry",
            "broken_aside",
        ];
        Some(Self {
            body: number,
            side: if number == 0 { 1.0 } else { -1.0 },
            center,
            radii,
            interval: 2.0 * spacing,
            strip: 1.01 * spacing,
            depth: 2.0 * fracture.length_scale,
            table: Table { names: names.map(String::from).to_vec(), columns: vec![Vec::new(); names.len()] },
        })
    }

    /// Adds the present state of a run to the watched rows.
    pub fn look(&mut self, simulation: &Simulation, sample: &Sample) {
        if self.table.rows() == 0 {
            let own: Vec<String> = sample.named_values().iter().map(|(name, _)| name.to_string()).collect();
            self.table.names.extend(own);
            self.table.columns.resize(self.table.names.len(), Vec::new());
        }
        let [front, rear] = [self.side, -self.side].map(|side| self.wall(simulation, side));
        let frame = simulation.updated_frame().expect("rings move in the updated frame");
        let forces = frame.contact_forces(sample.time_step);
        let force = forces.iter().map(|f| f.force[0]).sum::<f64>() * frame.thickness();
        let yes = |holds: bool| f64::from(u8::from(holds));
        let mut row = vec![
            front.broken(),
            rear.broken(),
            yes(front.begun()),
            yes(rear.begun()),
            force,
            asymmetry(simulation, |field| field.elastic_energy()),
            asymmetry(simulation, |field| field.fracture.as_ref().map_or(0.0, |f| f.surface_energy)),
            self.aside(simulation),
        ];
        row.extend(sample.named_values().iter().map(|(_, value)| value));
        self.table.push(&row);
    }

    fn wall(&self, simulation: &Simulation, side: f64) -> Wall {
        let field = &simulation.updated_frame().expect("rings move in the updated frame").fields()[self.body];
        let Some(cracking) = &field.fracture else { return Wall::default() };
        let [inner, outer] = self.radii;
        let reach = outer - self.depth - inner;
        let count = (reach / self.interval).floor().max(1.0) as usize;
        let mut phases = vec![f64::INFINITY; count];
        for (point, cracked) in field.points().iter().zip(&cracking.points) {
            let [x, y] = [0, 1].map(|d| point.reference()[d] - self.center[d]);
            let at = (side * x - inner) / self.interval;
            if y.abs() <= self.strip && at >= 0.0 && (at as usize) < count {
                phases[at as usize] = smaller(phases[at as usize], cracked.phase);
            }
        }
        Wall { phases }
    }

    /// Part of the broken material that lies further than a few length scales from the line of centres: zero
    /// if the ring splits along the diameter alone.
    fn aside(&self, simulation: &Simulation) -> f64 {
        let field = &simulation.updated_frame().expect("rings move in the updated frame").fields()[self.body];
        let cracked = field.fracture.iter().flat_map(|cracking| cracking.points.iter());
        let broken = field.points().iter().zip(cracked).filter(|(_, cracked)| cracked.phase < BROKEN);
        let (mut all, mut aside) = (0.0, 0.0);
        for (point, _) in broken {
            all += point.volume;
            if (point.reference()[1] - self.center[1]).abs() > ASIDE * self.depth {
                aside += point.volume;
            }
        }
        if all > 0.0 { aside / all } else { 0.0 }
    }

    /// Times (s) of [`EVENTS`]; none of those that did not come.
    pub fn events(&self) -> [Option<f64>; 6] {
        let column = |name: &str| self.table.column(name).unwrap_or_default();
        let time = column("time_s");
        let rows = fault!("events-seen-late", 0..time.len() => time.len() / 2..time.len());
        let first = |holds: &dyn Fn(usize) -> bool| rows.clone().find(|&i| holds(i)).map(|i| time[i]);
        let reaches = |name: &str, level: f64| first(&|i| column(name)[i] >= level);
        let fracture = column("fracture_j");
        let end = fracture.last().copied().unwrap_or(f64::NAN);
        let touching = column("force_n").iter().rposition(|force| *force != 0.0);
        let ended = touching.filter(|&i| i + 1 < time.len()).map(|i| time[i]);
        [
            reaches("front_begun", 1.0),
            reaches("front_broken", 1.0),
            reaches("rear_begun", 1.0),
            reaches("rear_broken", 1.0),
            first(&|i| fracture[i] >= LEVEL * end),
            ended,
        ]
    }
}

/// Difference of an energy between both rings over their mean; zero if there is one ring.
fn asymmetry(simulation: &Simulation, energy: impl Fn(&DiscreteField) -> f64) -> f64 {
    let fields = simulation.updated_frame().map_or(&[][..], |frame| frame.fields());
    let [a, b] = fields else { return 0.0 };
    let [a, b] = [energy(a), energy(b)];
    if a + b == 0.0 { 0.0 } else { 2.0 * (a - b) / (a + b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_the_first_rows_that_show_them() {
        let names = ["front_broken", "rear_broken", "front_begun", "rear_begun", "force_n", "time_s", "fracture_j"];
        let mut table = Table::new(&names);
        for row in [
            [0.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0],
            [0.5, 0.0, 1.0, 0.0, 5.0, 1.0, 1.0],
            [1.0, 0.0, 1.0, 1.0, 5.0, 2.0, 2.0],
            [1.0, 0.9, 1.0, 1.0, 0.0, 3.0, 3.0],
            [1.0, 0.9, 1.0, 1.0, 0.0, 4.0, 3.0],
        ] {
            table.push(&row);
        }
        let watch = Watch {
            body: 0,
            side: 1.0,
            center: [0.0; 2],
            radii: [1.0, 2.0],
            interval: 0.1,
            strip: 0.1,
            depth: 0.1,
            table,
        };
        assert_eq!(watch.events(), [Some(1.0), Some(2.0), Some(2.0), None, Some(3.0), Some(2.0)]);
    }
}
