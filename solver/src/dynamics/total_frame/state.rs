//! The state of a body in the total frame.

use super::TotalFrame;
use crate::checkpoint::{Archive, StateError};
use crate::phase_field::fracture::LatticeFracture;

impl TotalFrame {
    /// Stores or takes up what steps change.
    ///
    /// # Errors
    /// Bytes of another scene, and loads that only the program knows.
    pub(crate) fn exchange(&mut self, archive: &mut Archive) -> Result<(), StateError> {
        let Self {
            patch: _,
            grid: _,
            counts_fragments: _,
            lattice: _,
            moduli: _,
            kinematics: _,
            shape: _,
            thickness: _,
            gravity: _,
            loads,
            forced,
            constraints: _,
            edges,
            boundary: _,
            mass: _,
            in_use: _,
            displacement,
            velocity,
            acceleration,
            internal,
            strip_forces: _,
            fracture,
            probes: _,
            domains: _,
            density: _,
            crack_start,
            elastic_energy,
            ledger,
            time,
            time_step: _,
            reactions,
            judged_stiffening,
        } = self;
        if forced.is_some() {
            return Err(StateError("loads that only the program knows cannot be stored".to_string()));
        }
        let stored = fault!("checkpoint-without-accelerations", 4 => 3);
        for field in [&mut *displacement, velocity, internal, acceleration].into_iter().take(stored) {
            field.iter_mut().try_for_each(|component| archive.list(component))?;
        }
        loads.iter_mut().for_each(|load| load.follow(displacement));
        if let Some(LatticeFracture {
            model: _,
            history,
            phase,
            excess,
            lag_work,
            field,
            iterations,
            intact_energy: _,
            relative: _,
            driven: _,
        }) = fracture
        {
            [history, phase, excess].into_iter().try_for_each(|values| archive.list(values))?;
            field.exchange(archive)?;
            lag_work.as_mut().map_or(Ok(()), |work| work.exchange(archive))?;
            archive.value(iterations)?;
        }
        [elastic_energy, time, judged_stiffening].into_iter().try_for_each(|value| archive.value(value))?;
        archive.value(crack_start)?;
        reactions.exchange(archive)?;
        edges.as_mut().map_or(Ok(()), |edges| edges.exchange(archive))?;
        archive.value(ledger)
    }
}
