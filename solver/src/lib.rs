//! Dynamic brittle fracture in the plane by the material point method on a NURBS background mesh.
//!
//! `fisura` moves bodies made of material points through time with an explicit scheme, lets them crack by a
//! phase field driven by the tensile part of their elastic energy, and accounts for every joule on the way.
//! It follows Estrada (2024), *Material point method applied to dynamic brittle fracture analysis using
//! phase-field*, Mecánica Computacional XLI, 537–546; (E n) is equation n of that paper. This crate is the
//! physics alone: it reads and writes no files and looks at no clock. What it gives are numbers: samples,
//! states of points, and [`output::picture`], fields on a raster that others draw.
//!
//! A [`Scene`] is plain data. [`validate::validate`] says what is wrong with one, by key; [`Simulation::new`]
//! makes one ready to run; [`Simulation::step`] takes a step and [`Simulation::sample`] reads the energies.
//! What a scene does not declare is not modelled: an elastic body holds no phase field and solves for none.
//!
//! # The time step
//!
//! In the total frame, where shape functions are evaluated at the reference positions once
//! ([`dynamics::total_frame::TotalFrame::step`]):
//!
//! ```text
//! ┌─ given u, v, a on the control points, H at the points, c on the control points, all at n ────────┐
//! │ predict      v ← v + dt/2 a,   u ← u + dt v             velocity Verlet: beta = 0, gamma = 1/2   │
//! │ history      e = sym grad u at the points,   H ← max(H, psi+(e))           E 4–5, 10, 15–16      │
//! │ phase field  K(H) c = Σ V N                                                E 11–12, 19–24        │
//! │ stress       sigma = g(c) dpsi+/de + dpsi−/de at the points                E 6–7                 │
//! │ forces       f_int = Σ V sigma grad N,   f_ext = Σ l t N + m g             E 17–18               │
//! │ accelerate   a = (f_ext − f_int) / m, zero where velocity is prescribed    E 14                  │
//! │ correct      v ← v + dt/2 a                                                                      │
//! └─ u, v, a, H, c at n + 1 ─────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! History and phase field are there only with a [`scene::Fracture`]. With beta = 0 the strain at n + 1 does
//! not depend on the acceleration at n + 1, so the staggered iteration of the paper is converged after one
//! pass. In the updated frame the points carry the velocity and the grid is rebuilt at every step: see
//! [`dynamics::updated_frame`]. The step is a fraction of the critical one of the operator itself
//! ([`dynamics::critical_step`]).
//!
//! # From the paper to the code
//!
//! Each module calls only those that stand before it in this table. All may call `checkpoint`, the state of
//! a run as bytes, and `faults`, the planted errors `fault!("name", right => wrong)` of the tests.
//!
//! | module | equations | what |
//! |---|---|---|
//! | [`linear_algebra`] | – | values side by side, matrices, conjugate gradients, factors |
//! | [`scene`] | – | what a scene declares, shapes |
//! | [`splines`] | E 13 | spline spaces, NURBS, the patch they span, quadrature |
//! | [`material`] | E 4–7 | elastic energy, its split, degradation, finite strain |
//! | [`particles`] | – | material points: layouts, tiles of spans, points that move |
//! | [`transfer`] | E 3, 6, 10, 15–18 | sweeps of the total frame over points, and what they compute |
//! | [`phase_field`] | E 9–12, 19–24 | history energy, the equation, its matrix, seeded cracks |
//! | [`contact`] | – | boundaries, frictional impulses, a potential of the gap, rigid bodies, crack faces |
//! | [`output`] | – | pictures, states of points, spans that hold material |
//! | [`dynamics`] | E 14–18 | the step in both frames, mass, loads, critical step, energy ledger |
//! | [`validate`] | – | what is wrong with a scene |
//! | [`simulation`] | – | the run: steps, samples, checkpoints, breakdowns |
//!
//! FLIP, XPIC and the other transfers of velocities are in [`dynamics::updated_frame`], as are
//! fragments of bodies that are cracked through.
//!
//! Where the paper prints a slip, the module that uses the equation says so.
//!
//! # Units
//!
//! SI throughout: m, s, kg, N, J, Pa. Inside, masses, forces and energies are per metre of thickness; a
//! [`Sample`](dynamics::energy::Sample) is for the thickness of the scene. The phase field c is 1 where
//! intact and 0 where broken, and the length scale l0 is Borden's, half the l of the form
//! `(Gc/2)(d²/l + l |grad d|²)`.
//!
//! # The same bits
//!
//! Sums are cut by data, strip by strip and chunk by chunk, and added in a fixed order: a run gives the same
//! bits for any number of threads.
//!
//! # Not modelled
//!
//! Three dimensions, plasticity, rate effects and heat. [`validate::validate`] refuses what a scene can ask
//! for and does not exist: general patches, slits, probes and static starts in the updated frame; the
//! consistent mass there or where a body cuts spans; contact of a body with itself there; fragments with
//! tractions, and with fields of their own in the total frame.
//!
//! # Example
//!
//! A clamped strip of glass is pulled at its free end. It is elastic, so the energies add up to round-off:
//!
//! ```
//! use fisura::scene::*;
//! use fisura::{Scene, Simulation};
//!
//! let glass = Material { young_modulus: 32e9, poisson_ratio: 0.2, density: 2450.0, fracture: None };
//! let strip = Body {
//!     tractions: vec![Traction::on(Side::Right, [1e6, 0.0], TimeFactor::ramp(1e-6))],
//!     ..Body::at_rest("strip", "glass", Shape::Rectangle { min: [0.0, 0.0], max: [8e-3, 2e-3] })
//! };
//! let scene = Scene {
//!     title: "a strip under tension".into(),
//!     mesh: Mesh::uniform([2, 2], [0.0, 0.0], [8e-3, 2e-3], [32, 8]),
//!     analysis: Analysis {
//!         plane: Plane::Stress,
//!         thickness: 1e-3,
//!         frame: Frame::Total,
//!         kinematics: Kinematics::Small,
//!         end_time: 4e-6,
//!         time_step: TimeStep::Auto,
//!         safety: 0.8,
//!         transfer: Transfer::default(),
//!         mass: Mass::Lumped,
//!         gravity: [0.0, 0.0],
//!         gravity_time: TimeFactor::default(),
//!     },
//!     solver: SolverSettings {
//!         phase_field_tolerance: 1e-8,
//!         phase_field_solver: PhaseFieldSolver::ConjugateGradients,
//!         phase_field_interval: PhaseFieldInterval::Steps(1),
//!     },
//!     materials: [("glass".to_string(), glass)].into(),
//!     bodies: vec![strip],
//!     contact: None,
//!     boundaries: vec![Boundary::driven(Side::Left, [true, true], [0.0, 0.0])],
//!     equilibrium: false,
//!     output: Output::rows(10),
//! };
//!
//! assert_eq!(fisura::validate::validate(&scene), Ok(vec![]));
//! let mut simulation = Simulation::new(&scene)?;
//! while !simulation.finished() {
//!     let sample = simulation.advance_to_next_sample()?;
//!     assert!(sample.elastic > 0.0 && sample.kinetic > 0.0);
//!     assert!(sample.closure.abs() <= 1e-12 * sample.largest_term());
//! }
//! # Ok::<(), fisura::simulation::breakdown::Breakdown>(())
//! ```

#![deny(unsafe_code)]
#![warn(unreachable_pub)]
#![allow(rustdoc::private_intra_doc_links)] // headers of modules also lead to what is not public

#[macro_use]
pub mod faults;

pub(crate) mod checkpoint;
pub mod contact;
pub mod dynamics;
pub mod linear_algebra;
pub mod material;
pub mod output;
pub mod particles;
pub mod phase_field;
pub mod scene;
pub mod simulation;
pub mod splines;
pub mod transfer;
pub mod validate;

pub use scene::Scene;
pub use simulation::Simulation;

#[cfg(test)]
extern crate self as fisura;
#[cfg(test)]
#[allow(dead_code, unreachable_pub, reason = "shared with the tests from outside")]
#[path = "../tests/integration/common/mod.rs"]
mod example;
