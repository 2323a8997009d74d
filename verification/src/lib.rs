//! Cases, checks and records that verify the fisura solver.
pub mod history;
pub mod record;
pub mod reference;
pub mod scene_file;
