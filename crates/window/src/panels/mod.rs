//! The panels beside the map: each shows plain state and returns the user's actions.

pub(crate) mod accuracy;
mod colour_strip;
pub mod colours;
pub(crate) mod command_palette;
pub(crate) mod descent;
pub mod export;
mod field;
pub mod film;
mod gradient_strip;
mod ground;
pub(crate) mod help;
mod icon;
pub(crate) mod layers;
pub(crate) mod map_legend;
pub(crate) mod notices;
pub mod pendulum;
pub mod places;
mod plane_diagram;
pub(crate) mod question_tiles;
pub(crate) mod rail;
pub mod scene;
mod sentence;
pub mod status;
pub(crate) mod tiles;
pub(crate) mod timeline;
pub(crate) mod toolbar;
pub(crate) mod view;
pub(crate) mod whereabouts;
pub(crate) mod window;

pub(crate) use field::meant;
