//! Cases, checks and records that verify the fisura solver.

pub mod bench;
pub mod case;
pub mod convergence;
pub mod dense;
pub mod exact;
pub mod expand;
pub mod figures;
pub mod foreign;
pub mod history;
pub mod judge;
pub mod measure;
pub mod output;
pub mod patches;
pub mod plain_scene;
pub mod random;
pub mod record;
pub mod reference;
pub mod rings;
pub mod scene_file;
pub mod scene_run;
pub mod study;
pub mod suite;
pub mod watch;

pub use fisura::linear_algebra::extremes;
