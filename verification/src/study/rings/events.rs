//! Events of a collision, watched sample by sample on the line of centres.

use fisura::Simulation;
use fisura::dynamics::energy::Sample;
use fisura::fault;
use fisura::material::degradation::BROKEN;
use fisura::output::inspection::PointState;
use fisura::scene::{Scene, Shape};

use crate::extremes::smaller;
use crate::output::history::Table;
use crate::study::yes;

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
    thickness: f64,
    /// What is watched, row by row.
    pub table: Table,
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
            thickness: scene.analysis.thickness,
            table: Table { names: names.map(String::from).to_vec(), columns: vec![Vec::new(); names.len()] },
        })
    }

    /// Adds the present state of a run to the rows of every ring.
    pub fn look(rings: &mut [Self], simulation: &Simulation, sample: &Sample) {
        let mut seen: Vec<Seen> = rings.iter().map(Seen::of).collect();
        simulation.for_each_point(&mut |point| {
            let ring = rings.iter().zip(&mut seen).find(|(ring, _)| ring.body == point.body);
            ring.into_iter().for_each(|(ring, seen)| seen.take(ring, &point));
        });
        let asymmetry = |value: fn(&Seen) -> f64| match seen.as_slice() {
            [left, right] => asymmetry(value(left), value(right)),
            _ => 0.0,
        };
        let apart = [asymmetry(|seen| seen.elastic), asymmetry(|seen| seen.damage)];
        let force = simulation.contact_forces().iter().map(|f| f.force[0]).sum::<f64>();
        for (ring, seen) in rings.iter_mut().zip(&seen) {
            ring.push(seen, force * ring.thickness, apart, sample);
        }
    }

    fn push(&mut self, seen: &Seen, force: f64, [elastic, damage]: [f64; 2], sample: &Sample) {
        if self.table.rows() == 0 {
            let own: Vec<String> = sample.named_values().iter().map(|(name, _)| name.to_string()).collect();
            self.table.names.extend(own);
            self.table.columns.resize(self.table.names.len(), Vec::new());
        }
        let is_broken = |phase: &f64| *phase < BROKEN;
        let part = |wall: &[f64]| wall.iter().filter(|phase| is_broken(phase)).count() as f64 / wall.len() as f64;
        let [front, rear] = &seen.walls;
        let aside = if seen.broken > 0.0 { seen.aside / seen.broken } else { 0.0 };
        let begun = [front, rear].map(|wall| yes(wall.first().is_some_and(is_broken)));
        let mut row = vec![part(front), part(rear), begun[0], begun[1], force, elastic, damage, aside];
        row.extend(sample.named_values().iter().map(|(_, value)| value));
        self.table.push(&row);
    }

    /// Intervals of a wall, from the inner edge to where the outer one counts as reached.
    fn intervals(&self) -> usize {
        let [inner, outer] = self.radii;
        ((outer - self.depth - inner) / self.interval).floor().max(1.0) as usize
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

/// What is seen of a ring at one time.
struct Seen {
    /// Smallest phase field of the points in every interval from the inner edge outwards on the line of
    /// centres, of the wall towards the contact and of that at the rear.
    walls: [Vec<f64>; 2],
    /// Elastic energy, J/m.
    elastic: f64,
    /// Integral of (1 − c)², m².
    damage: f64,
    /// Area of the broken points, and of those aside the line of centres, m².
    broken: f64,
    aside: f64,
}

impl Seen {
    fn of(ring: &Watch) -> Self {
        let walls = [(); 2].map(|()| vec![f64::INFINITY; ring.intervals()]);
        Self { walls, elastic: 0.0, damage: 0.0, broken: 0.0, aside: 0.0 }
    }

    fn take(&mut self, ring: &Watch, point: &PointState) {
        let ([xx, yy, xy], [a, b, c]) = (point.stress, point.strain);
        let phase = point.fracture.map_or(1.0, |fracture| fracture.phase);
        self.elastic += 0.5 * point.area * (xx * a + yy * b + 2.0 * xy * c);
        self.damage += point.area * (1.0 - phase) * (1.0 - phase);
        let [x, y] = [0, 1].map(|d| point.present[d] - point.displacement[d] - ring.center[d]);
        if y.abs() <= ring.strip {
            let wall = usize::from(ring.side * x < 0.0);
            let at = (x.abs() - ring.radii[0]) / ring.interval;
            if at >= 0.0
                && let Some(least) = self.walls[wall].get_mut(at as usize)
            {
                *least = smaller(*least, phase);
            }
        }
        if phase < BROKEN {
            self.broken += point.area;
            self.aside += if y.abs() > ASIDE * ring.depth { point.area } else { 0.0 };
        }
    }
}

/// Difference of a value between both rings over their mean.
fn asymmetry(a: f64, b: f64) -> f64 {
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
            thickness: 1.0,
            table,
        };
        assert_eq!(watch.events(), [Some(1.0), Some(2.0), Some(2.0), None, Some(3.0), Some(2.0)]);
    }
}
