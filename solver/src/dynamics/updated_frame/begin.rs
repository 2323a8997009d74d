//! How a body of the updated frame begins: from a scene, or from a stored state, which is what the points and
//! surfaces carry. Order and nodal fields follow from it.

use std::sync::Arc;

use super::affine::{AffineVelocities, Fit};
use super::field::DiscreteField;
use super::grid::NodalFields;
use super::held_edges::HeldEdges;
use super::held_sides::{self, HeldSide};
use super::loads::SurfaceLoad;
use super::losses::TransferLosses;
use super::pointwise_fracture::PointwiseFracture;
use super::velocity_transfer::VelocityTransfer;
use super::{UpdatedFrame, fragments, views};
use crate::checkpoint::{Archive, StateError};
use crate::contact::Surface;
use crate::contact::gap_potential::boundary_stiffness;
use crate::dynamics::energy::Ledger;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::{Balance, Gravity, LostTraction};
use crate::material::degradation::FractureModel;
use crate::material::elasticity::ElasticModuli;
use crate::particles::lattice::build::moving_points;
use crate::particles::points::{Cells, OutsidePatch, Point};
use crate::phase_field::fracture::crack_start;
use crate::scene::{Body, Boundary, Kinematics, Material, Plane, Scene, Transfer};
use crate::splines::patch::Patch;

impl DiscreteField {
    /// The body of `scene` at t = 0 with its initial velocities and accelerations.
    ///
    /// # Errors
    /// If the body holds no material point, a part of a traction would be lost, the initial phase field does
    /// not converge, or a point is not on the patch.
    pub fn new(scene: &Scene, body: &Body, whole: &Arc<Patch>) -> Result<Self, Failure> {
        let mut field = Self::at_rest(scene, body, whole)?;
        let center = center_of_mass(field.points.iter());
        let begin = |x: [f64; 2]| {
            let relative = body.relative_velocity([x[0] - center[0], x[1] - center[1]]);
            [body.velocity[0] + relative[0], body.velocity[1] + relative[1]]
        };
        field.points.iter_mut().for_each(|point| point.velocity = begin(point.position));
        field.take_affine_velocities(begin);
        field.crack_and_stress()?;
        field.begin_ledger();
        field.points_to_grid();
        field.attach_first()?;
        field.respond();
        for (traction, load) in field.loads.iter().enumerate() {
            if let Some(place) = load.undefined() {
                return Err(Failure::LostTraction { body: 0, traction, lost: LostTraction::NotFinite(place) });
            }
            let balance = Balance::of_edge(body, &body.tractions[traction].edge);
            let shares = load.shares(&field.patch, &field.nodes);
            balance.check(shares).map_err(|lost| Failure::LostTraction { body: 0, traction, lost })?;
        }
        Ok(field)
    }

    /// Finds the first spans for the surface points of loads and conditions.
    fn attach_first(&mut self) -> Result<(), Failure> {
        for (traction, load) in self.loads.iter_mut().enumerate() {
            let bare =
                |OutsidePatch(place)| Failure::LostTraction { body: 0, traction, lost: LostTraction::Bare(place) };
            load.attach(&self.patch, &self.nodes, self.density).map_err(bare)?;
        }
        self.attach_loads()
    }

    /// Sorted points at rest, on nodal fields of zeros.
    fn at_rest(scene: &Scene, body: &Body, whole: &Arc<Patch>) -> Result<Self, Failure> {
        let (material, analysis) = (&scene.materials[&body.material], &scene.analysis);
        let place = |(position, size)| Point::at_rest(position, size);
        let mut points: Vec<Point> = moving_points(whole, body).into_iter().map(place).collect();
        if points.is_empty() {
            return Err(Failure::NoPoints(0));
        }
        let spans = fragments::spans_around(whole, &points)?;
        let (patch, origin) = (whole.part(&spans), fragments::origin(whole, &spans));
        let mut cells = Cells::default();
        cells.sort(&patch, &mut points)?;
        let crack = |model| PointwiseFracture::new(&patch, body, model, &scene.solver, &points);
        let fixed = |boundary: &&Boundary| held_sides::is_fixed(boundary);
        let (fixed, moving): (Vec<_>, Vec<_>) = scene.boundaries.iter().partition(fixed);
        let side = |&boundary| HeldSide::with_material(whole, body, boundary);
        let sides: Vec<_> = fixed.iter().filter_map(side).collect();
        let nodes = NodalFields::new(&patch, held_sides::constraints(whole, &patch, origin, &sides));
        let moving = moving.into_iter().map(|boundary| held_sides::as_edge(whole, boundary));
        let edges = HeldEdges::new(whole, body, body.conditions.iter().cloned().chain(moving));
        let loads = body.tractions.iter().map(|t| SurfaceLoad::new(whole, body, t)).collect();
        let moduli = ElasticModuli::new(material, analysis.plane);
        let finite = analysis.kinematics == Kinematics::Finite;
        let of_boundary = |stiffness| boundary_stiffness(stiffness, &moduli, material.density, whole.shortest_span());
        Ok(Self {
            fracture: FractureModel::of(material).map(crack),
            nodes,
            velocity_transfer: VelocityTransfer::new(patch.control_grid(), analysis.transfer),
            affine: fit(analysis.transfer).map(|fit| AffineVelocities::new(fit, &patch, points.len())),
            deformation: finite.then(|| vec![[[0.0; 2]; 2]; points.len()]),
            loads,
            forcing: None,
            surface: scene.contact.is_some().then(|| Surface::new(&scene.mesh, body)),
            moduli,
            thickening: thickening(material, analysis.plane),
            density: material.density,
            boundary_stiffness: scene.contact.as_ref().and_then(|contact| contact.stiffness).map(of_boundary),
            thickness: analysis.thickness,
            gravity: Gravity::new(analysis),
            crack_start: crack_start(body),
            elastic_energy: 0.0,
            stress_work: 0.0,
            ledger: Ledger::default(),
            losses: TransferLosses::default(),
            time: 0.0,
            at_start: true,
            last_step: 0.0,
            travelled: 0.0,
            whole: Arc::clone(whole),
            sides,
            edges,
            patch,
            origin,
            points,
            cells,
        })
    }

    fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let mut spans = self.covered_spans();
        archive.value(&mut spans)?;
        if archive.is_reader() {
            let inside =
                (0..2).all(|d| spans[d].start < spans[d].end && spans[d].end <= self.whole.spaces[d].spans().len());
            if !inside {
                return Err(StateError::of_another_scene("a body lies outside the mesh"));
            }
            self.occupy(&spans);
        }
        self.exchange_points(archive)?;
        if archive.is_reader() {
            self.rebuild().map_err(StateError::of_another_scene)?;
        }
        self.exchange_sums(archive)
    }

    /// What points and surfaces carry.
    fn exchange_points(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { sides, edges, points, affine, deformation, loads, forcing, surface, fracture, .. } = self;
        if forcing.is_some() {
            return Err(StateError("loads that only the program knows cannot be stored".to_string()));
        }
        archive.value(&mut self.time)?;
        archive.value(&mut self.at_start)?;
        archive.value(&mut self.last_step)?;
        archive.value(&mut self.crack_start)?;
        archive.list(points)?;
        affine.iter_mut().try_for_each(|affine| archive.list(&mut affine.gradients))?;
        deformation.iter_mut().try_for_each(|gradients| archive.list(gradients))?;
        loads.iter_mut().try_for_each(|load| load.exchange(archive))?;
        sides.iter_mut().try_for_each(|side| side.exchange(archive))?;
        edges.iter_mut().try_for_each(|edges| edges.exchange(archive))?;
        surface.iter_mut().try_for_each(|surface| surface.exchange(archive))?;
        fracture.iter_mut().try_for_each(|fracture| fracture.exchange(archive))
    }

    /// Order of the points, spans of the surface points, nodal fields.
    fn rebuild(&mut self) -> Result<(), Failure> {
        // They are sorted already: the order of all else stays.
        self.cells.sort(&self.patch, &mut self.points)?;
        self.hold_sides();
        self.rebuild_grid()
    }

    fn exchange_sums(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self { elastic_energy, stress_work, ledger, losses, travelled, .. } = self;
        [elastic_energy, stress_work, travelled].into_iter().try_for_each(|sum| archive.value(sum))?;
        archive.value(ledger)?;
        archive.value(losses)
    }
}

/// Where the points take their velocity gradients from, if the transfer carries them.
fn fit(transfer: Transfer) -> Option<Fit> {
    match transfer {
        Transfer::Apic => Some(Fit::Weighted),
        Transfer::Tpic => Some(Fit::Taylor),
        Transfer::Flip | Transfer::Pic | Transfer::Xpic(_) => None,
    }
}

/// Logarithmic change of volume over that of area.
fn thickening(material: &Material, plane: Plane) -> f64 {
    match plane {
        Plane::Strain => 1.0,
        Plane::Stress => (1.0 - 2.0 * material.poisson_ratio) / (1.0 - material.poisson_ratio),
    }
}

/// Present centre of mass of points of equal density, m.
pub(super) fn center_of_mass<'a>(points: impl Iterator<Item = &'a Point> + Clone) -> [f64; 2] {
    let volume: f64 = points.clone().map(|p| p.volume).sum();
    [0, 1].map(|d| points.clone().map(|p| p.volume * p.position[d]).sum::<f64>() / volume)
}

impl UpdatedFrame {
    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        self.exchange_fragments(archive)?;
        let Self { patch: _, fields, bodies: _, contact, fragments: _, thickness: _, recorded: _ } = self;
        fields.iter_mut().try_for_each(|field| field.exchange(archive))?;
        if let Some(contact) = contact {
            contact.exchange(archive)?;
            if archive.is_reader() && fields[0].time() > 0.0 {
                contact.move_rigid(fields[0].time());
                contact.find(&views(fields)).map_err(StateError::of_another_scene)?;
            }
        }
        Ok(())
    }
}
