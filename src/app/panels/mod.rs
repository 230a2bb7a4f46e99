//! The panels beside the map: what they show is plain state, what they answer are actions.

pub mod pendulum;
