//! The built binary on small scenes: exit statuses, streams, files, help.

mod bench;
mod check;
mod compare;
mod figures;
mod help;
mod judge;
mod merge;
mod output;
mod report;
mod resume;
mod run;
mod support;
mod templates;
mod tutorial;
mod verify;
mod vtk;
#[path = "../../../reports/tests/integration/vtu.rs"]
mod vtu;
