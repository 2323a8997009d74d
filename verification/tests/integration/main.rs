//! The tests of the harness from outside: one program, which is linked once.

mod case_files;
mod citation;
mod documents;
mod endings;
mod patch_scenes;
mod scene_files;
mod suites;
mod support;
mod units;
mod verdicts;
