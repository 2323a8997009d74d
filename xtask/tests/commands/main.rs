//! The built binary on small scenes: exit statuses, streams, files, help.

mod check;
mod help;
mod report;
mod resume;
mod run;
mod support;
mod verify;
