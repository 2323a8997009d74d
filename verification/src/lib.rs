//! Cases, checks and records that verify the fisura solver.
pub mod history;
pub mod record;
pub mod scene_file;
