//! flipmap: every possible double pendulum at once.
pub mod engine;
pub mod output;
pub mod physics;
pub mod scene;
pub mod tiles;
