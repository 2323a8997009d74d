//! The state of a run as bytes, from which the same scene goes on bit by bit.
//!
//! What the scene fixes is built again: patch, lattice, shape functions, masses, loads. What steps change is
//! stored, and what follows from that in the updated frame (order of the points, nodal fields, constraints)
//! is found again. The preconditioner of the phase field is stored, because a lagged one decides the last
//! bits.
//!
//! Every struct lists its fields once, in `exchange`, for both ways through an [`Archive`]. The list takes
//! the struct apart without `..`: a new field does not compile until it is said whether it belongs to the
//! state. The bytes are those of [`postcard`]; who keeps them says which scene they belong to.

use serde::Serialize;
use serde::de::DeserializeOwned;
use thiserror::Error;

/// A state that cannot be stored or taken up.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{0}")]
pub struct StateError(pub String);

impl StateError {
    /// A state that is not one of this scene, and how that is seen.
    pub(crate) fn of_another_scene(what: impl std::fmt::Display) -> Self {
        Self(format!("the state belongs to another scene: {what}"))
    }
}

/// Bytes of a state, on their way out or in.
#[derive(Debug)]
pub(crate) struct Archive<'a>(Way<'a>);

#[derive(Debug)]
enum Way<'a> {
    Out(Vec<u8>),
    In(&'a [u8]),
}

impl<'a> Archive<'a> {
    /// An empty archive, into which a state is written.
    pub(crate) fn writer() -> Self {
        Self(Way::Out(Vec::new()))
    }

    /// An archive over stored bytes, from which a state is read.
    pub(crate) fn reader(bytes: &'a [u8]) -> Self {
        Self(Way::In(bytes))
    }

    /// Whether values are taken from the bytes.
    pub(crate) fn is_reader(&self) -> bool {
        matches!(self.0, Way::In(_))
    }

    /// Stores a value, or replaces it by the stored one.
    ///
    /// # Errors
    /// Bytes that are no such value.
    pub(crate) fn value<T: Serialize + DeserializeOwned>(&mut self, value: &mut T) -> Result<(), StateError> {
        let failed = |error: postcard::Error| StateError(format!("the state is damaged: {error}"));
        match &mut self.0 {
            Way::Out(bytes) => *bytes = postcard::to_extend(value, std::mem::take(bytes)).map_err(failed)?,
            Way::In(bytes) => (*value, *bytes) = postcard::take_from_bytes(bytes).map_err(failed)?,
        }
        Ok(())
    }

    /// [`Self::value`] for a list whose length the scene fixes.
    ///
    /// # Errors
    /// As [`Self::value`], and another length.
    pub(crate) fn list<T: Serialize + DeserializeOwned>(&mut self, values: &mut Vec<T>) -> Result<(), StateError> {
        let expected = values.len();
        self.value(values)?;
        if values.len() == expected {
            return Ok(());
        }
        Err(StateError::of_another_scene(format!("{} values instead of {expected}", values.len())))
    }

    /// What was stored.
    ///
    /// # Errors
    /// If bytes are left that nobody read.
    pub(crate) fn finish(self) -> Result<Vec<u8>, StateError> {
        match self.0 {
            Way::Out(bytes) => Ok(bytes),
            Way::In([]) => Ok(Vec::new()),
            Way::In(rest) => Err(StateError::of_another_scene(format!("{} bytes remain", rest.len()))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_bit_by_bit() {
        let odd = [-0.0, f64::NAN, f64::from_bits(0xfff8_dead_beef_0001), f64::MIN_POSITIVE / 3.0, f64::INFINITY];
        let mut archive = Archive::writer();
        archive.list(&mut odd.to_vec()).unwrap();
        archive.value(&mut Some(3_usize)).unwrap();
        let bytes = archive.finish().unwrap();

        let mut archive = Archive::reader(&bytes);
        let (mut read, mut number) = (vec![0.0_f64; 5], None::<usize>);
        archive.list(&mut read).unwrap();
        archive.value(&mut number).unwrap();
        assert!(read.iter().zip(odd).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert_eq!(number, Some(3));
        archive.finish().unwrap();
    }

    #[test]
    fn other_lengths_cut_bytes_and_bytes_left_over_are_refused() {
        let mut archive = Archive::writer();
        archive.list(&mut vec![1.0, 2.0]).unwrap();
        let bytes = archive.finish().unwrap();
        let read = |bytes: &[u8], length: usize| {
            let mut archive = Archive::reader(bytes);
            archive.list(&mut vec![0.0_f64; length])?;
            archive.finish()
        };
        assert!(read(&bytes, 2).is_ok());
        assert!(read(&bytes, 3).unwrap_err().0.contains("2 values instead of 3"));
        assert!(read(&bytes[..9], 2).unwrap_err().0.contains("damaged"));
        assert!(read(&[&bytes[..], &[0]].concat(), 2).unwrap_err().0.contains("1 bytes remain"));
    }
}
