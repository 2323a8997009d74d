//! The tests of the reports from outside: one program, which is linked once.

mod bench;
mod browser;
mod convergence;
mod dashboards;
mod fixture;
mod foreign;
mod forms;
mod gallery;
mod render;
mod support;
mod vtk;
mod vtu;
