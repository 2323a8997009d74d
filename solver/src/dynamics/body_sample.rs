//! Bodies that are recorded one by one: where each is, how it moves, and what it exerts on the others.

use crate::scene::Scene;

/// What is recorded of every body at a whole step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodySamples {
    /// The bodies that deform, in the order of the scene.
    pub bodies: Vec<BodySample>,
    /// Forces of contact of every pair of bodies, if the scene declares contact.
    pub forces: Vec<PairForce>,
    /// Smallest gap of boundaries that are near each other, m; negative where they overlap.
    pub smallest_gap: Option<f64>,
}

/// A body at a whole step.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodySample {
    /// Name in columns: see [`column_name`].
    pub name: String,
    /// Mass of the body for the thickness of the scene, kg.
    pub mass: f64,
    /// Present position of the centre of mass, m.
    pub center: [f64; 2],
    /// Velocity of the centre of mass, m/s.
    pub velocity: [f64; 2],
    /// Angular velocity about the centre of mass, `Σ m r × v/Σ m r²`, rad/s: in the updated frame of the
    /// points, half a step back; in the total frame of the control points.
    pub spin: f64,
    /// Kinetic energy of the body for the thickness of the scene, J.
    pub kinetic: f64,
}

/// The force of contact between two bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct PairForce {
    /// Names of the two in columns.
    pub names: [String; 2],
    /// Force on the second, N.
    pub force: [f64; 2],
}

impl BodySamples {
    /// All zero, with the columns that the runs of a scene have.
    pub fn blank(scene: &Scene) -> Self {
        let names = names(scene);
        let deformable = scene.bodies.iter().filter(|body| !body.rigid).count();
        let body = |name: &String| BodySample { name: name.clone(), ..BodySample::default() };
        let force = |pair: [usize; 2]| PairForce { names: pair.map(|i| names[i].clone()), force: [0.0; 2] };
        let forces = scene.contact.iter().flat_map(|_| pairs(deformable, names.len())).map(force);
        Self {
            bodies: names[..deformable].iter().map(body).collect(),
            forces: forces.collect(),
            smallest_gap: scene.contact.as_ref().map(|_| 0.0),
        }
    }

    /// Columns of `history.csv`, in order.
    pub fn named_values(&self) -> Vec<(String, f64)> {
        let mut row = Vec::new();
        for BodySample { name, mass, center, velocity, spin, kinetic } in &self.bodies {
            row.extend([
                (format!("{name}_mass_kg"), *mass),
                (format!("{name}_x_m"), center[0]),
                (format!("{name}_y_m"), center[1]),
                (format!("{name}_velocity_x_m_per_s"), velocity[0]),
                (format!("{name}_velocity_y_m_per_s"), velocity[1]),
                (format!("{name}_spin_rad_per_s"), *spin),
                (format!("{name}_kinetic_j"), *kinetic),
            ]);
        }
        for PairForce { names: [one, other], force } in &self.forces {
            row.push((format!("force_{one}_{other}_x_n"), force[0]));
            row.push((format!("force_{one}_{other}_y_n"), force[1]));
        }
        row.extend(self.smallest_gap.map(|gap| ("smallest_gap_m".to_string(), gap)));
        row
    }
}

/// Names in columns of all bodies, rigid ones last.
pub(crate) fn names(scene: &Scene) -> Vec<String> {
    let of = |rigid: bool| scene.bodies.iter().filter(move |body| body.rigid == rigid);
    of(false).chain(of(true)).map(|body| column_name(&body.name)).collect()
}

/// All pairs of `bodies` bodies, of which only the first `deformable` can be the first of a pair.
pub(crate) fn pairs(deformable: usize, bodies: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..deformable).flat_map(move |a| (a + 1..bodies).map(move |b| [a, b]))
}

/// The name of a body as part of a column: lower-case letters, digits and underscores.
pub fn column_name(body: &str) -> String {
    body.to_lowercase().chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}
