//! Bytes of matrices and factors that solves have read. What is counted where the reading is done cannot be
//! forgotten by those who call it: one more pass over a matrix shows, however often a clock is looked at.

use std::sync::atomic::{AtomicU64, Ordering};

/// A number that grows; the same for any number of threads.
#[derive(Debug, Default)]
pub struct Counter(AtomicU64);

impl Counter {
    /// Adds to it.
    pub fn add(&self, bytes: usize) {
        self.0.fetch_add(bytes as u64, Ordering::Relaxed);
    }

    /// What it has come to.
    pub fn get(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Clone for Counter {
    fn clone(&self) -> Self {
        Self(AtomicU64::new(self.get()))
    }
}
