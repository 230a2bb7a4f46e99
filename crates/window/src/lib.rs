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
pub mod captions;
mod central;
pub mod colour_cycle;
pub mod commands;
pub mod compute_service;
pub mod descent;
pub mod dialog;
mod effects;
pub mod egui_host;
pub mod energy_curve;
pub mod export;
mod favourites;
mod film;
pub mod film_draft;
pub mod film_run;
pub mod flight;
pub mod folders;
pub mod gesture;
pub mod history;
pub mod hover;
mod incoming;
pub mod integration;
mod laboratory;
pub mod map;
pub mod meter;
pub mod model;
mod movement;
mod news_pace;
pub mod notices;
mod outlook;
pub mod overlay;
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
pub mod stats;
pub mod swing;
mod thumbs;
pub mod time_left;
pub mod view_samples;
pub mod wake;
pub mod window;
