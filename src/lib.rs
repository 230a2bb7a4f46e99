//! flipmap: every possible double pendulum at once.
pub mod physics;
