//! flipmap: every possible double pendulum at once.
//!
//! Each pixel of a flip-time map is a pendulum released from rest at (θ1, θ2), coloured by the time
//! until its second bob flips over the top. This crate is the program's library; its examples are
//! in the folder `examples`.
//!
//! # A map
//!
//! A [`tiles::Renderer`] turns a [`scene::Scene`] into samples: `examples/map_to_array.rs`.
//!
//! ```
//! use flipmap_engine::choice::EngineRequest;
//! use flipmap_engine::EngineKind;
//! use flipmap_scene::Document;
//! use flipmap_render::tiles::Renderer;
//!
//! let scene = Document::parse("[view]\ncenter = [\"2\", \"1.4\"]\nwidth = \"0.1\"")?.scene();
//! let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
//! let samples = Renderer::new(&request)?.render(&scene.checked()?, [8, 8])?;
//! assert_eq!(samples.len(), 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Its colours are yours (`examples/custom_palette.rs`) or those of [`output::RowPainter`]; two maps
//! are compared sample by sample (`examples/compare_arrays.rs`).
//!
//! # One pendulum
//!
//! The oracle, a Taylor integrator in any number type, is what every engine is judged by:
//! `examples/one_pendulum.rs`.
//!
//! ```
//! use flipmap_pendulum::{Pendulum, Rule, Status, oracle};
//!
//! let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0);
//! let outcome = oracle::outcome(&pendulum, [3.0f64, 3.0], Rule::Second, 30.0);
//! assert_eq!(outcome.status, Status::Flipped);
//! assert!((outcome.time - 1.767_916_558_420_626_6).abs() < 1e-12);
//! ```
//!
//! The equations of motion are generic too: an integrator of your own, an
//! [`engine::cpu::EmbeddedPair`], runs on the processor's SIMD lanes as ours do
//! (`examples/custom_integrator.rs`).
//!
//! # The modules
//!
//! Data flows one way, which a test checks:
//! `physics → question → scene → engine → tiles → output → film → farm → report → lab → app`.
//!
//! | module | contents |
//! |---|---|
//! | [`physics`] | equations of motion, number types, integrators, events, flow patches, the oracle |
//! | [`question`] | what is asked of a pendulum, and the channels of its answer |
//! | [`scene`] | pendulum, question, view, colours, films; from pixels to starts |
//! | [`engine`] | jobs of starts to outcomes: SIMD lanes, compute shaders, deep zoom, checks |
//! | [`tiles`] | which starts are computed next, and the [`tiles::Renderer`] |
//! | [`output`], [`film`], [`farm`] | files, frames, work in shards |
//! | [`report`] | measurements and hard cases |
//! | `lab`, `app` | the live figures and the window, with the feature `window` |
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

#[cfg(feature = "window")]
pub mod app;
#[cfg(feature = "window")]
pub mod lab;
pub mod report;
