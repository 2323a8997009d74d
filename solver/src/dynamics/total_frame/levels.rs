//! Local refinement that follows the crack: truncated hierarchical splines (Giannelli, Jüttler and Speleers
//! 2012) of several levels.
//!
//! Every level is a frame of its own over the whole mesh, whose spans are half as long as those of the level
//! before, and has points in a part of it only: the coarsest where nothing is refined, the finest next to the
//! crack. A function of a level has a value of its own if its support lies where that level has points or
//! finer ones do, and not wholly where finer ones do. The values of the other functions that reach into the
//! points of a level are those of the coarser one by knot insertion, `u_f = R u_c`; what acts on them acts on
//! the coarser one, `f_c += Rᵀ f_f`. So the functions sum to one, and the lumped mass is positive.
//!
//! What is refined stays so. Tiles of spans are refined where c falls below 0.75, and around
//! (`levels/regions.rs`). The phase field of a model with a threshold is on the finest level alone, and 1
//! elsewhere. Tiles are then refined where c is below 1, and where the energy nears the threshold.
//!
//! Fields are copied, so that they do not change and momentum is kept. The change of the energies, which
//! comes from the lumped mass, the new points and c there, is a term of the ledger. The critical step is
//! that of the finest level over the whole mesh: the functions in use are combinations of its own, and the
//! lumped mass is convex.

mod regions;
mod shares;

use super::{AT_WHOLE_STEP, BETWEEN_STEPS, TotalFrame};
use crate::checkpoint::{Archive, StateError};
use crate::dynamics::constraints::Constraints;
use crate::dynamics::energy::Sample;
use crate::dynamics::failure::Failure;
use crate::dynamics::loads::NodalLoad;
use crate::linear_algebra::active_columns::ActiveColumns;
use crate::linear_algebra::conjugate_gradients::SolveFailure;
use crate::linear_algebra::control_grid::VectorField;
use crate::linear_algebra::interface::{Interface, fold_all, spread_all};
use crate::particles::lattice::STRIP_ROWS;
use crate::phase_field::fracture::LatticeFracture;
use crate::phase_field::levels::{OnLevel, PhaseFieldLevels};
use crate::scene::{Crack, CrackKind, Scene};
use crate::splines::insertion::knot_insertion;
use crate::splines::spline::SplineSpace;
use crate::transfer::sweep::StripForces;
use regions::{Functions, ROWS, Regions, copy_fields, copy_points};

/// Steps from one look at the phase field to the next: a crack is a third of a span further at most. Where
/// the energy nears a threshold is seen in every step, since a wave is faster.
const LOOK: usize = 8;
/// Where every level has points, and how the levels hang together.
#[derive(Debug)]
pub(super) struct Levels {
    regions: Regions,
    /// Knot insertion in x and y, from each level to the next.
    insertions: Vec<[Insertion; 2]>,
    /// What lies between each level and the next.
    interfaces: Vec<Interface>,
    functions: Vec<Functions>,
    /// Control points of each level with values of their own.
    own: Vec<ActiveColumns>,
    /// Mass (kg/m) and loads (N/m) of the functions of each level where all have points.
    masses: Vec<Vec<f64>>,
    loads: Vec<Vec<VectorField>>,
    /// Conditions on the functions of each level.
    constraints: Vec<Constraints>,
    /// Right-hand sides of the phase field by the points of each level.
    phase_loads: Vec<Vec<f64>>,
    /// Critical step of the finest level, s.
    pub critical_step: f64,
    /// Steps since the phase field was looked at.
    since: usize,
    /// What refinement added to the energies, J/m.
    added: f64,
}

/// For each function of a level in a direction, those of the coarser one that determine it.
type Insertion = Vec<Vec<(usize, f64)>>;

impl Levels {
    /// The levels of a scene, from coarse to fine, at t = 0.
    ///
    /// # Errors
    /// As [`TotalFrame::new`].
    pub(super) fn new(scene: &Scene) -> Result<(Vec<TotalFrame>, Self), Failure> {
        let finest = scene.mesh.halvings;
        let mut frames = Vec::new();
        let mut mesh = scene.mesh.clone();
        for level in 0..=finest {
            let mut of_level = Scene { mesh: mesh.clone(), ..scene.clone() };
            if level < finest {
                of_level.bodies[0].cracks.retain(|crack| !crack.is_slit()); // they lie in the finest level
            }
            let strip_rows = if level < finest { ROWS } else { STRIP_ROWS };
            let mut frame = TotalFrame::in_strips(&of_level, strip_rows)?;
            if level < finest
                && let Some(fracture) = frame.fracture.as_mut().filter(|fracture| fracture.has_threshold())
            {
                fracture.field.rest();
            }
            frames.push(frame);
            mesh = mesh.halved();
        }
        let insertion = |pair: &[TotalFrame]| {
            let middles = |space: &SplineSpace| -> Vec<f64> {
                space.spans().iter().map(|span| 0.5 * (span.left + span.right)).collect()
            };
            pair[0].patch.spaces.each_ref().map(|space| knot_insertion(space, &middles(space)))
        };
        let dense = |frame: &TotalFrame| {
            let field = |load: &NodalLoad| {
                let mut field = [frame.grid.zeros(), frame.grid.zeros()];
                load.forces.iter().for_each(|(at, force)| (0..2).for_each(|d| field[d][*at] = force[d]));
                field
            };
            frame.loads.iter().map(field).collect::<Vec<_>>()
        };
        let phase_load =
            |frame: &TotalFrame| frame.fracture.as_ref().map_or_else(Vec::new, |fracture| fracture.field.load.clone());
        let mut levels = Self {
            regions: Regions::new(&frames),
            insertions: frames.windows(2).map(insertion).collect(),
            interfaces: Vec::new(),
            functions: Vec::new(),
            own: frames.iter().map(|frame| ActiveColumns::all(frame.lattice.patch_grid)).collect(),
            masses: frames.iter().map(|frame| frame.mass.row_sums.clone()).collect(),
            loads: frames.iter().map(dense).collect(),
            constraints: frames.iter().map(|frame| frame.constraints.clone()).collect(),
            phase_loads: frames.iter().map(phase_load).collect(),
            critical_step: frames[finest].critical_step(),
            since: 0,
            added: 0.0,
        };
        let seeded = |crack: &&Crack| matches!(crack.kind, CrackKind::Seed(_)); // these have a phase field
        let others: Vec<&Crack> = scene.bodies[0].cracks.iter().filter(|crack| !seeded(crack)).collect();
        levels.regions.mark_along(&others, &frames);
        levels.regions.mark_cracks(&frames);
        levels.regions.mark_driven(&frames);
        levels.functions = levels.regions.functions(&frames);
        levels.take_regions(&mut frames);
        levels.on_fields(&mut frames, |frame| &mut frame.displacement, spread_all);
        levels.on_fields(&mut frames, |frame| &mut frame.velocity, spread_all);
        levels.phase_fields(&mut frames).map(|mut fields| fields.initialise()).transpose()?;
        for frame in &mut frames {
            frame.begin_forces();
        }
        levels.accelerate(&mut frames, AT_WHOLE_STEP);
        Ok((frames, levels))
    }

    /// Refines where the crack has come.
    ///
    /// # Errors
    /// If the phase field cannot be solved for.
    fn follow(&mut self, frames: &mut [TotalFrame]) -> Result<(), SolveFailure> {
        self.since = (self.since + 1) % LOOK;
        let before = self.regions.clone();
        let of_cracks = self.since == 0 && self.regions.mark_cracks(frames);
        let is_driven = self.regions.mark_driven(frames);
        if !of_cracks && !is_driven {
            return Ok(());
        }
        let stored = |frames: &[TotalFrame]| frames.iter().map(TotalFrame::stored_energies).collect::<Vec<_>>();
        let energies = stored(frames);
        let functions = std::mem::replace(&mut self.functions, self.regions.functions(frames));
        for level in 0..self.insertions.len() {
            let (now, was) = (&self.functions[level + 1], &functions[level + 1]);
            let new = self.interface(level, frames, |at| now.known[at] && !was.known[at]);
            let (coarse, fine) = frames.split_at_mut(level + 1);
            copy_fields(&new, &coarse[level], &mut fine[0]);
            copy_points(level, [&before, &self.regions], &coarse[level], &mut fine[0]);
        }
        self.take_regions(frames);
        frames.iter_mut().for_each(TotalFrame::update_history);
        self.phase_fields(frames).map(|mut fields| fields.solve_anew()).transpose()?;
        for (frame, energies) in frames.iter_mut().zip(&energies) {
            frame.refresh(energies[1]);
        }
        self.accelerate(frames, AT_WHOLE_STEP);
        let sum = |energies: &[[f64; 2]]| energies.iter().flatten().sum::<f64>();
        self.added += sum(&stored(frames)) - sum(&energies);
        Ok(())
    }

    /// One time step of `dt` seconds.
    ///
    /// # Errors
    /// If the phase field cannot be solved for.
    pub(super) fn step(&mut self, frames: &mut [TotalFrame], dt: f64) -> Result<(), Failure> {
        self.follow(frames)?;
        let mut fields = frames.iter_mut().filter_map(|frame| frame.fracture.as_mut());
        if fields.any(|fracture| fracture.field.is_due()) {
            let fields = frames.iter_mut().filter_map(|frame| frame.fracture.as_mut());
            fields.for_each(|fracture| fracture.field.expect_solve());
        }
        frames.iter_mut().for_each(|frame| frame.find_strains(dt));
        self.advance_phase_fields(frames)?;
        frames.iter_mut().for_each(TotalFrame::internal_forces);
        self.accelerate(frames, BETWEEN_STEPS);
        frames.iter_mut().for_each(|frame| frame.find_velocities(dt));
        Ok(())
    }

    /// Makes ready for steps of `dt` seconds.
    pub(super) fn prepare(&self, frames: &mut [TotalFrame], dt: f64) {
        frames.iter_mut().for_each(|frame| frame.expect_steps(dt));
        self.accelerate(frames, AT_WHOLE_STEP);
    }

    /// The sample of the body, from those of its levels.
    pub(super) fn sample(&self, frames: &[TotalFrame], samples: Vec<Sample>) -> Sample {
        let probe = |number: usize| {
            let place = frames[0].probes[number].functions.position;
            let level = (0..frames.len()).rev().find(|&level| {
                let location = frames[level].patch.locate(place);
                location.is_some_and(|location| self.regions.holds(level, location.span))
            });
            samples[level.unwrap_or(0)].probes[number].clone()
        };
        let probes = (0..frames[0].probes.len()).map(probe).collect();
        let sample = samples.into_iter().reduce(Sample::with).expect("there is a level");
        Sample { probes, refinement: Some(self.added * frames[0].thickness), ..sample }
    }

    /// The body on the finest level, with the fields of all.
    pub(super) fn on_finest(&self, frames: &[TotalFrame]) -> TotalFrame {
        let mut frames = frames.to_vec();
        for level in 0..self.insertions.len() {
            let others = self.interface(level, &frames, |at| !self.functions[level + 1].known[at]);
            let (coarse, fine) = frames.split_at_mut(level + 1);
            copy_fields(&others, &coarse[level], &mut fine[0]);
        }
        frames.pop().expect("there is a level")
    }

    /// Phase fields of all levels at the end of a step.
    ///
    /// # Errors
    /// If they cannot be solved for.
    fn advance_phase_fields(&mut self, frames: &mut [TotalFrame]) -> Result<(), SolveFailure> {
        let Some(mut fields) = self.phase_fields(frames) else {
            let finest = frames.last_mut().and_then(|frame| Some((&frame.lattice, frame.fracture.as_mut()?)));
            return finest.map_or(Ok(()), |(lattice, fracture)| fracture.advance_phase_field(lattice));
        };
        let found = fields.advance()?;
        if let (Some(found), Some(fracture)) = (found, &mut frames[0].fracture) {
            fracture.iterations = found.iterations;
        }
        Ok(())
    }

    /// Accelerations of all levels at the present forces; the velocity at hand is so much of a step before.
    fn accelerate(&self, frames: &mut [TotalFrame], part: f64) {
        frames.iter_mut().for_each(TotalFrame::external_minus_internal);
        self.on_fields(frames, |frame| &mut frame.acceleration, fold_all);
        frames.iter_mut().for_each(|frame| frame.divide_by_mass(part));
        self.on_fields(frames, |frame| &mut frame.acceleration, spread_all);
    }

    /// Spreads or folds a field of all levels.
    fn on_fields(
        &self,
        frames: &mut [TotalFrame],
        field: fn(&mut TotalFrame) -> &mut VectorField,
        f: fn(&[Interface], &mut [&mut [f64]]),
    ) {
        for d in 0..2 {
            let mut fields: Vec<_> = frames.iter_mut().map(|frame| &mut field(frame)[d][..]).collect();
            f(&self.interfaces, &mut fields);
        }
    }

    /// The phase fields, which are solved for together. One with a threshold is on the finest level alone: it
    /// is 1 elsewhere.
    fn phase_fields<'a>(&'a mut self, frames: &'a mut [TotalFrame]) -> Option<PhaseFieldLevels<'a>> {
        let levels = frames.iter_mut().zip(&self.own).zip(&mut self.phase_loads).map(|((frame, own), load)| {
            let TotalFrame { lattice, fracture, .. } = frame;
            let LatticeFracture { field, history, relative, .. } =
                fracture.as_mut().filter(|fracture| !fracture.has_threshold())?;
            Some(OnLevel { field, lattice, history, own, load, relative: relative.as_deref() })
        });
        Some(PhaseFieldLevels { levels: levels.collect::<Option<_>>()?, interfaces: &self.interfaces })
    }

    /// Gives every level the points that it has now, and takes what was added by others from the systems of
    /// the phase field.
    fn move_points(&mut self, frames: &mut [TotalFrame]) {
        for level in 0..frames.len() {
            let lattice = &frames[level].lattice;
            let now = self.regions.occupied(level, lattice);
            let places = (0..now.len()).map(|tile| (tile / lattice.tiles.len(), tile % lattice.tiles.len()));
            let before: Vec<bool> = places.map(|(strip, tile)| lattice.is_occupied(strip, tile)).collect();
            for (sign, from, to) in [(-1.0, &before, &now), (1.0, &now, &before)] {
                let moved: Vec<bool> = from.iter().zip(to).map(|(from, to)| *from && !to).collect();
                if moved.contains(&true) {
                    let moved = frames[level].lattice.on_tiles(&moved);
                    if let Some(mut fields) = self.phase_fields(frames) {
                        fields.levels[level].add_points(&moved, sign);
                    }
                }
            }
            frames[level].lattice.occupy(&now);
        }
    }

    /// Takes points away and back, and what follows from it: interfaces, masses, loads and the systems of the
    /// phase field.
    fn take_regions(&mut self, frames: &mut [TotalFrame]) {
        self.move_points(frames);
        let functions = std::mem::take(&mut self.functions);
        let levels = 0..self.insertions.len();
        let between = |level: usize| self.interface(level, frames, |at| functions[level + 1].is_between(at));
        self.interfaces = levels.map(between).collect();
        let own = |(frame, functions): (&TotalFrame, &Functions)| {
            let grid = frame.lattice.patch_grid;
            ActiveColumns::exactly(grid, grid.indices().filter(|&at| functions.is_own(at)))
        };
        self.own = frames.iter().zip(&functions).map(own).collect();
        self.share(frames, &functions);
        let levels = frames.iter_mut().zip(&functions).zip(&self.constraints);
        for ((frame, functions), constraints) in levels {
            let (grid, all) = (frame.lattice.patch_grid, frame.grid);
            let is_copy = |at: usize| all.row_of(at) >= grid.rows;
            frame.constraints = constraints.among(|at| is_copy(at) || functions.is_own(at));
            let in_use = |at: usize| is_copy(at) || functions.is_in_use(at);
            frame.in_use = ActiveColumns::exactly(all, all.indices().filter(|&at| in_use(at)));
            frame.strip_forces = StripForces::new(&frame.lattice);
            [&mut frame.internal, &mut frame.acceleration].into_iter().flatten().for_each(|field| field.fill(0.0));
            let in_use = ActiveColumns::exactly(grid, grid.indices().filter(|&at| in_use(at)));
            frame.fracture.iter_mut().for_each(|fracture| fracture.field.restrict(in_use.clone()));
            for at in grid.indices().filter(|&at| functions.covered[at]) {
                frame.velocity.iter_mut().for_each(|component| component[at] = 0.0);
            }
        }
        if let (Some(fracture), Some(functions)) =
            (frames.last_mut().and_then(|f| f.fracture.as_mut()), functions.last())
        {
            fracture.field.allow((0..functions.whole.len()).map(|at| functions.is_own(at)).collect());
        }
        self.functions = functions;
        if let Some(mut fields) = self.phase_fields(frames) {
            fields.renew();
        }
    }

    /// Knot insertion from a level to some functions of the next.
    fn interface(&self, level: usize, frames: &[TotalFrame], takes: impl Fn(usize) -> bool) -> Interface {
        let [coarse, fine] = [level, level + 1].map(|level| frames[level].lattice.patch_grid);
        let [x, y] = &self.insertions[level];
        let row = |at: usize| {
            let (columns, rows) = (&x[fine.column_of(at)], &y[fine.row_of(at)]);
            let of_row = |&(j, w): &(usize, f64)| columns.iter().map(move |&(i, v)| (coarse.index(i, j), w * v));
            (at, rows.iter().flat_map(of_row).collect())
        };
        Interface::new(fine.indices().filter(|&at| takes(at)).map(row))
    }

    /// Stores or takes up which tiles are refined, before the levels themselves.
    ///
    /// # Errors
    /// Bytes of another scene.
    pub(super) fn exchange(&mut self, archive: &mut Archive, frames: &mut [TotalFrame]) -> Result<(), StateError> {
        self.regions.refined.iter_mut().try_for_each(|refined| archive.value(refined))?;
        archive.value(&mut self.since)?;
        archive.value(&mut self.added)?;
        if archive.is_reader() {
            self.functions = self.regions.functions(frames);
            self.take_regions(frames);
        }
        self.phase_loads.iter_mut().try_for_each(|load| archive.list(load))?;
        if archive.is_reader()
            && let Some(mut fields) = self.phase_fields(frames)
        {
            fields.renew();
        }
        Ok(())
    }
}
