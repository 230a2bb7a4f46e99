//! flipmap: every possible double pendulum at once.
//!
//! Each pixel of a flip-time map is a pendulum released from rest at (θ1, θ2), coloured by how
//! long its second bob takes to flip over the top. Data flows one way through the modules:
//! `physics → scene → engine → tiles → output → film → farm → report → app`; a test reads the `use` lines to keep it so.
//!
//! One pendulum, by the gold standard:
//!
//! ```
//! use flipmap::physics::{Pendulum, Rule, Status, oracle};
//!
//! let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0);
//! let outcome = oracle::outcome(&pendulum, [3.0f64, 3.0], Rule::Second, 30.0);
//! assert_eq!(outcome.status, Status::Flipped);
//! assert!((outcome.time - 1.767_916_558_420_626_6).abs() < 1e-12);
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

#[cfg(feature = "window")]
pub mod app;
pub mod engine;
pub mod farm;
pub mod film;
#[cfg(feature = "window")]
pub mod lab;
pub mod output;
pub mod physics;
pub mod report;
pub mod scene;
pub mod tiles;
