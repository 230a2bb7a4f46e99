//! The panels beside the map: what they show is plain state, what they answer are actions.

pub mod accuracy;
pub mod help;
pub mod layers;
pub mod notices;
pub mod pendulum;
pub mod status;
