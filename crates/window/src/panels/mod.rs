//! The panels beside the map: each shows plain state and returns the user's actions.

pub mod accuracy;
pub mod card;
mod colour_strip;
pub mod colours;
pub mod descent;
pub mod export;
mod field;
pub mod film;
mod ground;
pub mod help;
pub mod layers;
pub mod map_legend;
pub mod notices;
pub mod pendulum;
pub mod places;
mod plane_diagram;
pub mod scene;
mod sentence;
pub mod status;
mod stops;
pub mod timeline;
pub mod toolbar;
pub mod view;
pub mod window;
