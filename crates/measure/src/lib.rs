//! Measures scenes: how large the areas of a map are, how rough its edges, how long pendulums last.
//!
//! A [`Survey`] computes checked answers at scattered starts, close pairs, small boxes and pictures of a
//! scene, and hands class numbers and times to the estimators of `flipmap_estimate`, which know no
//! pendulum. Every number of its [`Findings`] has a 95 % interval, which answers that nobody is sure of
//! widen.
//!
//! * [`Statistic`] names what can be measured, [`SurveyOrder`] says what is;
//! * [`Survey`] computes what is missing, part by part; a [`SurveyFolder`] keeps finished parts and the
//!   results in files.
//!
//! ```
//! use flipmap_engine::EngineKind;
//! use flipmap_engine::choice::EngineRequest;
//! use flipmap_measure::{Statistic, Survey, SurveyOrder};
//! use flipmap_render::tiles::Renderer;
//! use flipmap_scene::Document;
//!
//! let scene = Document::parse("[question]\nbudget = 2.0")?.scene().checked()?;
//! let order = SurveyOrder { of: vec![Statistic::Areas], samples: 2000, ..SurveyOrder::of(scene) };
//! let kind = Some(EngineKind::Cpu);
//! let mut renderer = Renderer::new(&EngineRequest { kind, verify: true, ..Default::default() })?;
//! let mut survey = Survey::new(order)?;
//! survey.run(&mut renderer, &|_, _| true)?;
//! let areas = survey.findings().areas.ok_or("it was ordered")?;
//! let (name, share) = &areas.classes[2];
//! assert!(name == "forbidden" && (share.value - 0.30643564).abs() < 1e-7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

mod basins;
mod curves;
mod findings;
mod folder;
mod forbidden;
mod order;
mod page;
mod plots;
mod sampling;
mod survey;
mod table;

pub use findings::{
    Areas, Edges, Findings, GrowthFindings, Missing, SectionShare, SurvivalFindings,
};
pub use folder::SurveyFolder;
pub use order::{MeasureError, Statistic, SurveyOrder};
pub use survey::Survey;
pub use table::table;
