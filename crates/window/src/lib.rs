//! The window, in which the user wanders through the map without ever waiting for it.
//!
//! Everything the user does becomes an `Action`; actions change the plain state; drawing only reads
//! it. Panels are functions `(&mut Ui, &State) → Actions`, so that they can be shown and rendered
//! without a window. Slow work runs on threads of its own and wakes the window when there is
//! something to show.
//!
//! ```no_run
//! use std::time::Instant;
//!
//! use flipmap_engine::choice::EngineRequest;
//! use flipmap_window::folders::Folders;
//! use flipmap_window::model::WindowOptions;
//! use flipmap_window::window;
//!
//! let options = WindowOptions {
//!     document: None,
//!     run: None,
//!     request: EngineRequest::default(),
//!     folders: Folders::none(),
//!     set_up: None,
//!     stats: None,
//!     film_command: None,
//! };
//! window::run(options, Instant::now(), |_close| {})?;
//! # Ok::<(), window::WindowError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod action;
mod answerable;
mod answers;
mod arrivals;
mod auto_budget;
mod background_work;
mod central;
mod clipboard;
pub mod colour_cycle;
mod commands;
mod compute_service;
mod descent;
mod dialog;
mod dispatch;
pub mod display;
pub mod dive;
mod egui_host;
mod energy_curve;
mod exploring;
pub mod export;
mod exports;
mod favourites;
mod film;
pub mod film_draft;
pub mod film_run;
mod finds;
pub mod folders;
mod gesture;
mod greeting;
mod histogram;
mod history;
mod in_view;
mod incoming;
mod integration;
mod kept_keys;
mod keys;
mod laboratory;
mod last_views;
mod leaving;
mod light;
mod magnet;
mod map;
mod map_callback;
mod meter;
mod mishap;
pub mod model;
mod movement;
mod news_pace;
mod notices;
mod outlook;
mod overlay;
mod panel_actions;
pub mod panels;
mod pendulum_card;
mod pin_drag;
mod pin_marks;
mod pin_paths;
pub mod pins;
pub mod places;
mod resize;
mod saving;
mod screen_picture;
pub mod sections;
pub mod settings;
mod settings_file;
mod side_panel;
mod small_pictures;
pub mod state;
mod stats;
mod status;
pub mod store;
mod swing;
mod thumbs;
mod time_left;
mod view_samples;
mod wake;
pub mod window;
mod window_error;
