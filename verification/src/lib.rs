//! Cases, checks and records that verify the fisura solver.
//!
//! Modules, lowest first: each calls those above it in this table, and none below.
//!
//! | module | what |
//! |---|---|
//! | [`output`] | folders that commands write to, tables, fingerprints, files of others |
//! | [`watch`] | progress, interrupts and panics of a case |
//! | [`record`] | results: records, verdicts, figures |
//! | `arithmetic` | formulas in text |
//! | [`scene`] | scene files, units, what is wrong with a file and where |
//! | [`mod@reference`] | reference data and their uncertainty |
//! | [`case`] | case files: claims, checks, variants and study axes |
//! | [`exact`] | exact solutions, each in a file of its own |
//! | [`measure`] | what is measured of a run |
//! | [`scene_run`] | a scene run to its end |
//! | [`study`] | studies that need more than a scene and its measures |
//! | [`suite`] | cases chosen, prepared, run, judged, stored, merged |
//! | [`mod@bench`] | speed against error |
//! | [`judge`] | results of other codes, held against the benchmarks |

mod arithmetic;
pub mod bench;
pub mod case;
pub mod exact;
pub mod judge;
pub mod measure;
pub mod output;
pub mod record;
pub mod reference;
pub mod scene;
pub mod scene_run;
pub mod study;
pub mod suite;
pub mod watch;

pub use fisura::linear_algebra::extremes;
