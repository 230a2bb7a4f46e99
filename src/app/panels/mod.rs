//! The panels beside the map: what they show is plain state, what they answer are actions.

pub mod colours;
pub mod export;
mod field;
pub mod pendulum;
pub mod places;
pub mod scene;
