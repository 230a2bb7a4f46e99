//! The mathematics of the double pendulum, generic over the number type. This crate uses no files,
//! threads or graphics cards.
//!
//! * [`pendulum`] holds the five numbers and the equations of motion, written once for scalars,
//!   SIMD lanes and the symbols from which the GPU's kernels are printed;
//! * [`phase`] writes the same motion without angles;
//! * [`integrator`] holds the fixed-step methods, [`embedded`] and [`series`] those that choose
//!   their steps, [`control`] their step size control;
//! * [`taylor`] and [`oracle`] are the *gold standard* by which every engine is judged;
//! * [`passes`] lists the passes of the top along an orbit, and returns to the section θ1 = 0;
//! * [`transport`] brings a state to another time;
//! * [`simple`] is the single pendulum, [`separation`] measures how fast two pendulums diverge;
//! * [`flip`] and [`crossing`] find the moment at which a bob passes the top.
//!
//! ```
//! use flipmap_pendulum::{Pendulum, Rule, oracle};
//!
//! let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0);
//! let outcome = oracle::outcome(&pendulum, [2.0f64, 2.0], Rule::Second, 30.0);
//! println!("{:?} after {} units of time", outcome.status, outcome.time);
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod accumulators;
pub mod control;
pub mod crossing;
pub mod embedded;
pub mod extrapolation;
pub mod extremum;
pub mod first_moments;
pub mod flip;
pub mod flow_patch;
pub mod growth;
pub mod integrator;
pub mod opening;
pub mod oracle;
pub mod passes;
pub mod pendulum;
pub mod phase;
pub mod reference;
pub mod separation;
pub mod series;
pub mod simple;
pub mod tangents;
pub mod taylor;
pub mod transport;

pub use accumulators::Accumulators;
pub use flip::{Outcome, Rule, Status};
pub use pendulum::{Launch, Pendulum, State};
