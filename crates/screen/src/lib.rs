//! The map on a screen, which the window shares with a page in a browser. This crate knows neither
//! windows nor panels: it is given a graphics device and the known samples, and draws.
//!
//! * [`camera`] holds the view as numbers, the mapping between points of the screen and of the
//!   plane, and smooth moves; [`reach`] is the part of a plane that it can show;
//! * [`canvas`] chooses what is drawn of each cell in view, and is the graphics card's part of the
//!   drawing;
//! * [`hover`] finds the sample under the pointer, and [`pin_start`] the start of its pendulum;
//! * [`captions`] says in words what a sample is; [`samples_in_view`] finds those of the view, over
//!   whose times [`spread`] spreads the colours;
//! * [`flight`] integrates that pendulum by the gold standard and keeps its motion, so that any
//!   moment can be shown.
//!
//! ```
//! use flipmap_screen::camera::{Camera, Screen};
//! use flipmap_screen::hover::sample_at;
//! use flipmap_screen::pin_start::PinStart;
//! use flipmap_screen::reach::Reach;
//! use glam::DVec2;
//!
//! let camera = Camera::whole(Reach::TORUS);
//! let screen = Screen { camera, size: DVec2::new(800.0, 600.0), pixels_per_point: 1.0 };
//! let place = screen.angle_at(DVec2::new(120.0, -40.0));
//! let start = PinStart::at_rest(sample_at(place, screen.level()));
//! println!("θ1 = {}, θ2 = {}", start.angle[0], start.angle[1]);
//! ```
#![cfg_attr(not(test), warn(clippy::unwrap_used))]

pub mod camera;
pub mod canvas;
pub mod captions;
pub mod flight;
pub mod hover;
mod meant;
pub mod pin_start;
pub mod reach;
pub mod samples_in_view;
pub mod spread;
#[cfg(test)]
mod tests;

pub use meant::meant;
