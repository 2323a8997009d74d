//! What is wrong with a scene, or probably not meant.

use thiserror::Error;

/// One thing wrong with a scene, found before anything runs.
#[derive(Debug, Clone, PartialEq, Error)]
#[error("{key}: {message}")]
pub struct SceneError {
    /// Path of the key, as in the scene file: `material.glass.poisson_ratio`, `body.0.crack.0.from`.
    pub key: String,
    /// Description of what is wrong, for people.
    pub message: String,
    /// What would be right.
    pub remedy: String,
}

/// Something in a scene that is legal but probably not meant.
#[derive(Debug, Clone, PartialEq)]
pub struct SceneWarning {
    /// Path of the key in the scene file, as in [`SceneError::key`].
    pub key: String,
    /// What is suspicious, and what to do about it.
    pub message: String,
}
