//! The pendulum of the selected pin.
