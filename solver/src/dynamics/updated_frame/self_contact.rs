//! Contact of a body with itself: its parts have control points of their own where they meet, and the same
//! ones where their material hangs together.
//!
//! The body is cut into slices ([`slicing`]), each a discrete field with points, loads and boundary of its
//! own. At the seam between two slices the points next to the other one are marked, and the marks move with
//! them. A control point in whose support a mark lies is one for both slices: mass, momentum and forces are
//! added up there,
//!
//! ```text
//! m_I = Σ_s m_I^s,     m_I w_I = Σ_s m_I^s w_I^s,     f_I = Σ_s f_I^s,
//! ```
//!
//! which is the sum over the points of the whole body in another order. So nothing changes until the body
//! meets something. All others are of a slice alone: where slices come near each other there, the
//! splines of one do not see the other, and they meet as bodies do ([`crate::contact`]).
//!
//! Of the slices that share a control point the first one has mass and forces, so that sums over all fields
//! count it once; the others have copies of its velocity and acceleration.

mod joint_stiffness;
pub(super) mod slice;
mod slicing;

use std::collections::{BTreeMap, BTreeSet};

use super::field::DiscreteField;
use super::held_sides::HeldSide;
use super::pieces::{Pieces, spacing};
use super::velocity_transfer::stable_fraction;
use crate::dynamics::critical_step::highest_frequency;
use crate::dynamics::failure::Failure;
use joint_stiffness::JointStiffness;
use slice::Slice;
use slicing::Slicing;

impl DiscreteField {
    /// Its slices, if it is of several; `first` is the number of the first of their fields, and `body` that
    /// of the body.
    pub(super) fn slices(&self, body: usize, first: usize) -> Result<Option<Vec<Self>>, Failure> {
        let Some(surface) = &self.surface else { return Ok(None) };
        let slicing = Slicing::new(&self.points, surface, self.patch.shortest_span());
        let of = &slicing.of;
        let pieces = Pieces::given(&self.points, of);
        if pieces.count() < 2 {
            return Ok(None);
        }
        let mut marks = vec![BTreeSet::new(); pieces.count() as usize];
        for [a, b] in slicing.seams.iter().flat_map(|&[a, b]| [[a, b], [b, a]]) {
            marks[of[a] as usize].insert((a, of[b] as usize));
        }
        let slice = |(piece, marks): (u32, BTreeSet<(usize, usize)>)| {
            let mut part = self.piece(&pieces, piece)?;
            let belongs = |place| slicing.at(place).unwrap_or_else(|| pieces.at(place)) == piece;
            part.loads.iter_mut().for_each(|load| load.keep(belongs));
            part.sides.iter_mut().for_each(HeldSide::forget_material);
            part.hold_sides();
            part.surface = Some(surface.part(body, spacing(&self.points), belongs));
            part.points_to_grid();
            part.attach_loads()?;
            let seam = marks.into_iter().map(|(at, other)| (self.points[at].position, first + other)).collect();
            part.slice = Some(Box::new(Slice { seam, ..Slice::default() }));
            Ok(part)
        };
        (0..).zip(marks).map(slice).collect::<Result<Vec<_>, _>>().map(Some)
    }

    /// Number of the first control column and row of the whole patch in whose support each mark lies, and of
    /// the field on the other side.
    fn marked(&self) -> impl Iterator<Item = ([usize; 2], usize)> + '_ {
        let seam = self.slice.iter().flat_map(|slice| &slice.seam);
        seam.filter_map(|&(place, other)| {
            let first = |d: usize| self.whole.spaces[d].first_function(place[d]);
            Some(([first(0)?, first(1)?], other))
        })
    }

    /// Number in the nodal fields of a control point of the whole patch, if they cover it.
    fn number_of(&self, control_point: [usize; 2]) -> Option<usize> {
        let grid = self.nodes.grid;
        let [column, row] = [0, 1].map(|d| control_point[d].checked_sub(self.origin[d]));
        Some(grid.index(column.filter(|c| *c < grid.columns)?, row.filter(|r| *r < grid.rows)?))
    }
}

/// One step of `dt` seconds of slices, and of the other bodies.
///
/// # Errors
/// If a point leaves the patch.
pub(super) fn step(fields: &mut [DiscreteField], dt: f64) -> Result<(), Failure> {
    share(fields); // the accelerations of contact
    let ends = fields.iter_mut().map(|field| field.advance(dt)).collect::<Result<Vec<_>, _>>()?;
    join(fields);
    fields.iter_mut().zip(&ends).for_each(|(field, end_of_step)| field.respond_and_book(dt, end_of_step));
    share(fields);
    Ok(())
}

/// Accelerations of all fields where no step leads to them.
pub(super) fn find_accelerations(fields: &mut [DiscreteField]) {
    for field in &mut *fields {
        field.points_to_grid();
        field.add_external_forces();
    }
    join(fields);
    fields.iter_mut().for_each(DiscreteField::accelerate_freely);
    share(fields);
}

/// Critical time step of all fields, s.
pub(super) fn critical_step(fields: &[DiscreteField]) -> f64 {
    let stable = stable_fraction();
    stable / highest_frequency(&mut JointStiffness::new(fields, copies(fields)))
}

/// Adds up what the slices have at control points that are one, and leaves it to the first of them.
fn join(fields: &mut [DiscreteField]) {
    let groups = groups(fields);
    for group in &groups {
        let parts = group.iter().map(|&(field, at)| fields[field].nodes.take(at));
        if let Some(sum) = parts.reduce(|a, b| a.plus(&b)) {
            let (field, at) = group[0];
            fields[field].nodes.give(at, &sum);
        }
    }
    for field in &mut *fields {
        if let Some(slice) = &mut field.slice {
            slice.copies.clear();
            slice.mass.clone_from(&field.nodes.mass);
            slice.inverse_mass.clone_from(&field.nodes.inverse_mass);
        }
    }
    for group in &groups {
        let original = group[0];
        let nodes = &fields[original.0].nodes;
        let (mass, inverse_mass) = (nodes.mass[original.1], nodes.inverse_mass[original.1]);
        for &(field, at) in &group[1..] {
            if let Some(slice) = &mut fields[field].slice {
                slice.copies.insert(at, original);
                (slice.mass[at], slice.inverse_mass[at]) = (mass, inverse_mass);
            }
        }
    }
}

/// Gives copies of control points the velocities and the acceleration of the original.
fn share(fields: &mut [DiscreteField]) {
    for [(field, at), (of, original)] in copies(fields) {
        let motion = fields[of].nodes.motion(original);
        fields[field].nodes.set_motion(at, motion);
    }
}

/// Numbers of a field and of a copy in it, and those of the original.
fn copies(fields: &[DiscreteField]) -> Vec<[(usize, usize); 2]> {
    let of_field = |(number, field): (usize, &DiscreteField)| {
        let copies = field.slice.iter().flat_map(|slice| &slice.copies);
        copies.map(|(&at, &original)| [(number, at), original]).collect::<Vec<_>>()
    };
    fields.iter().enumerate().flat_map(of_field).collect()
}

/// Control points that are one: numbers of fields, and in their nodal fields.
fn groups(fields: &[DiscreteField]) -> Vec<Vec<(usize, usize)>> {
    let marked = fields.iter().enumerate().flat_map(|(at, field)| field.marked().map(move |mark| (at, mark)));
    let spans: BTreeSet<_> = marked.map(|(at, (first, other))| (first, at.min(other), at.max(other))).collect();
    let [columns, rows] = [0, 1].map(|d| fields[0].whole.spaces[d].degree() + 1);
    let mut joined: BTreeMap<[usize; 2], Vec<BTreeSet<usize>>> = BTreeMap::new();
    for ([column, row], a, b) in spans {
        for (k, l) in (0..columns).flat_map(|k| (0..rows).map(move |l| (k, l))) {
            unite(joined.entry([column + k, row + l]).or_default(), [a, b]);
        }
    }
    let group = |(control_point, set): ([usize; 2], BTreeSet<usize>)| -> Vec<(usize, usize)> {
        set.into_iter().filter_map(|at| Some((at, fields[at].number_of(control_point)?))).collect()
    };
    let sets = joined.into_iter().flat_map(|(at, sets)| sets.into_iter().map(move |set| (at, set)));
    sets.map(group).filter(|group| group.len() > 1).collect()
}

/// Makes the sets that two numbers are in one.
fn unite(sets: &mut Vec<BTreeSet<usize>>, pair: [usize; 2]) {
    let meets = |set: &BTreeSet<usize>| pair.iter().any(|at| set.contains(at));
    let (met, others): (Vec<_>, Vec<_>) = std::mem::take(sets).into_iter().partition(meets);
    *sets = others;
    sets.push(met.into_iter().flatten().chain(pair).collect());
}
