//! flipmap: every possible double pendulum at once.
//!
//! Each pixel of a flip-time map is a pendulum released from rest at (θ1, θ2), coloured by the time
//! until its second bob flips over the top. This crate re-exports the names that your own programs
//! need from the crates that do the work. The folder `examples` shows how to use them.
//!
//! # A map
//!
//! A [`Renderer`] turns a [`Scene`] into samples: `examples/map_to_array.rs`.
//!
//! ```
//! use flipmap::{Document, EngineKind, EngineRequest, Renderer};
//!
//! let scene = Document::parse("[view]\ncenter = [\"2\", \"1.4\"]\nwidth = \"0.1\"")?.scene();
//! let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
//! let samples = Renderer::new(&request)?.render(&scene.checked()?, [8, 8])?;
//! assert_eq!(samples.len(), 64);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Colour the samples yourself (`examples/custom_palette.rs`), or let a [`PictureRecipe`] colour
//! and write them. `examples/compare_arrays.rs` compares two maps sample by sample.
//!
//! # One pendulum
//!
//! Every engine is judged by the [`oracle`], a Taylor integrator for any number type:
//! `examples/one_pendulum.rs`.
//!
//! ```
//! use flipmap::{Pendulum, Rule, Status, oracle};
//!
//! let pendulum = Pendulum::points([1.0, 1.0], [1.0, 1.0], 1.0);
//! let outcome = oracle::outcome(&pendulum, [3.0f64, 3.0], Rule::Second, 30.0);
//! assert_eq!(outcome.status, Status::Answered);
//! assert!((outcome.time - 1.767_916_558_420_626_6).abs() < 1e-12);
//! ```
//!
//! The equations of motion are generic too: an integrator of your own, an
//! [`EmbeddedPair`](flipmap_pendulum::embedded::EmbeddedPair), runs on the processor's SIMD lanes as ours
//! do (`examples/custom_integrator.rs`).
//!
//! # The crates
//!
//! Data flows one way, and a crate can use only those to its left:
//! `numbers → pendulum → scene → engine → render → report`, `render → lab, screen → window`,
//! `estimate → measure ← render`.
//!
//! | crate | contents |
//! |---|---|
//! | [`flipmap_numbers`] | number types, exact decimals, derivatives, roots of polynomials |
//! | [`flipmap_pendulum`] | equations of motion, integrators, events, flow patches, the oracle |
//! | [`flipmap_scene`] | pendulum, question, view, colours, keys of films; pixels as starts |
//! | [`flipmap_engine`] | outcomes of starts: SIMD lanes, compute shaders, deep zoom, checks |
//! | [`flipmap_render`] | order of samples, pictures, films, traces, work in shards |
//! | [`flipmap_report`] | speed against error, hard cases |
//! | [`flipmap_estimate`], [`flipmap_measure`] | estimators with intervals, and surveys of scenes |
//! | `flipmap_screen` | the camera, the drawn map, the flights of single pendulums |
//! | `flipmap_lab`, `flipmap_window` | the live figures and the window, with the feature `window` |
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub use flipmap_engine::choice::{ChoiceError, EngineRequest, IntegrationSetting};
pub use flipmap_engine::run_settings::RunSpec;
pub use flipmap_engine::{Accuracy, EngineError, EngineKind, Trust};
pub use flipmap_numbers::{Dd, Scalar};
pub use flipmap_pendulum::{Outcome, Pendulum, Rule, Status, oracle};
pub use flipmap_render::Watch;
pub use flipmap_render::output::{NpyWriter, PictureRecipe, Trace, TraceError, named_document};
pub use flipmap_render::tiles::{Renderer, Samples};
pub use flipmap_scene::question::Channel;
pub use flipmap_scene::{BuiltIn, Document, PictureTable, RunTable, Scene, Setting};
