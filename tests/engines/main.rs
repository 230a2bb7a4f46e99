//! Engines, their checks and their pictures, judged by the gold standard.

#[macro_use]
#[path = "../common/adapter.rs"]
mod adapter;
mod agreement;
#[path = "../common/mod.rs"]
mod common;
mod enemy;
mod expansions;
mod goldens;
mod gpu;
mod hard;
mod oracle;
mod packing;
mod rewritten;
mod trust;
