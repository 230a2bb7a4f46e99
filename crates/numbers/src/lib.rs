//! Number types over which the integrators of the double pendulum are generic. Nothing in this
//! crate depends on a pendulum.
//!
//! * [`Real`] and [`Angle`] are the traits that equations of motion need, [`Scalar`] the one that
//!   code with branches needs;
//! * [`Dd`] is a pair of `f64`, [`Fixed`] a fixed-point number of any length, [`Decimal`] a number
//!   exactly as it was typed;
//! * [`dual`] and [`jet`] carry derivatives, of first and of higher order;
//! * [`polynomial`] and [`sign_changes`] find roots over one step;
//! * [`number_text`] writes numbers for people.
//!
//! ```
//! use flipmap_numbers::Dd;
//!
//! let third = Dd::new(1.0) / Dd::new(3.0);
//! let error = third * Dd::new(3.0) - Dd::new(1.0);
//! assert!(error.hi.abs() < 1e-31);
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod dd;
mod decimal;
pub mod dual;
pub mod fixed;
pub mod frame;
pub mod jet;
mod jet_product;
pub mod number_text;
pub mod polynomial;
pub mod real;
pub mod sign_changes;
pub mod trig;

pub use dd::Dd;
pub use decimal::Decimal;
pub use fixed::{Exact, Fixed};
pub use real::{Angle, Real, Scalar};
