//! Panels of the window and figures of the laboratory, driven without a window.

#[macro_use]
#[path = "../common/adapter.rs"]
mod adapter;
mod lab;
mod layouts;
mod pendulum;
mod share;
mod side;
