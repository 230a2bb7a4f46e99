//! Pictures, films and traces: which samples are computed, in what order, and into which files.
//!
//! * [`tiles`] chooses the starts to compute next; its [`Renderer`](tiles::Renderer) turns a scene
//!   into [`Samples`](tiles::Samples), its [`Explorer`](tiles::explorer::Explorer) serves a window;
//! * [`output`] writes PNG, EXR, NumPy and tiled pictures, each either complete or absent; its
//!   [`PictureRecipe`](output::PictureRecipe) is the only way in which a picture is made, its
//!   [`Trace`](output::Trace) follows a single pendulum;
//! * [`film`] paints the frames between keys and feeds an encoder; its
//!   [`FilmRecipe`](film::FilmRecipe) is the only way in which a film is made;
//! * [`Denoiser`] calms the grain of unresolved chaos, in all of these and in a window;
//! * [`farm`] splits stills and films into shards, and joins them.
//!
//! A [`Watch`] takes the progress of long computations and can stop them.
//!
//! ```
//! use flipmap_engine::EngineKind;
//! use flipmap_engine::choice::EngineRequest;
//! use flipmap_render::tiles::Renderer;
//! use flipmap_scene::Document;
//!
//! let scene = Document::parse("[question]\nbudget = 3.0")?.scene();
//! let request = EngineRequest { kind: Some(EngineKind::Cpu), ..EngineRequest::default() };
//! let samples = Renderer::new(&request)?.render(&scene.checked()?, [8, 8])?;
//! println!("{:?} in the corner", samples.get(0).status);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod denoise;
pub mod farm;
pub mod film;
pub mod output;
pub mod tiles;
mod watch;

pub use denoise::Denoiser;
pub use watch::Watch;
