//! Questions other than the flip, and planes other than the angles at rest, judged by the gold
//! standard.

#[path = "../common/mod.rs"]
mod common;
mod deep;
mod deep_planes;
mod flips;
mod orbits;
mod speeds;
mod states;
mod truth;
