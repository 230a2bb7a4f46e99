//! The window, in which the user wanders through the map without ever waiting for it.
//!
//! Everything the user does becomes an `Action`; actions change the plain state; drawing only reads
//! it. Panels are functions `(&mut Ui, &State) → Actions`, so that they can be shown and rendered
//! without a window. Slow work runs on threads of its own and wakes the window when there is
//! something to show.

pub mod action;
mod answerable;
mod answers;
mod auto_budget;
pub mod camera;
pub mod canvas;
pub(crate) mod captions;
mod central;
pub mod colour_cycle;
pub(crate) mod commands;
pub(crate) mod compute_service;
pub(crate) mod descent;
pub(crate) mod dialog;
mod effects;
pub(crate) mod egui_host;
pub(crate) mod energy_curve;
pub mod export;
mod favourites;
mod film;
pub mod film_draft;
pub mod film_run;
pub(crate) mod flight;
pub mod folders;
pub(crate) mod gesture;
pub(crate) mod history;
pub mod hover;
mod incoming;
pub(crate) mod integration;
mod laboratory;
pub(crate) mod map;
pub(crate) mod meter;
pub mod model;
mod movement;
mod news_pace;
pub(crate) mod notices;
mod outlook;
pub(crate) mod overlay;
pub mod panels;
mod pin_paths;
pub mod pin_start;
pub mod pins;
pub mod places;
pub mod reach;
mod resize;
pub mod settings;
mod side_panel;
mod spread;
pub mod state;
pub(crate) mod stats;
pub(crate) mod swing;
mod thumbs;
pub(crate) mod time_left;
pub(crate) mod view_samples;
pub(crate) mod wake;
pub mod window;
