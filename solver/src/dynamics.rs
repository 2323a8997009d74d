//! Explicit dynamics (E 14–18): the step in the total and in the updated frame, mass, loads, prescribed
//! sides, the critical step and the energy ledger.
//!
//! Symbols: u, v, a on the control points (m, m/s, m/s²), m lumped or consistent mass (kg/m), dt the time
//! step (s). Calls every module but [`simulation`](crate::simulation) and [`validate`](crate::validate).

pub mod body_sample;
pub(crate) mod constraints;
pub mod critical_step;
pub(crate) mod edge_moments;
pub mod energy;
pub mod failure;
pub mod forcing;
pub mod loads;
pub(crate) mod mass;
pub mod projection;
pub mod statics;
pub(crate) mod surface;
pub mod time_plan;
pub mod total_frame;
pub mod updated_frame;
