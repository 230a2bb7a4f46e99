//! Why a window cannot be opened, or had to close.

use super::display::UnusableScale;
use super::egui_host::HostError;
use super::mishap::GONE;

/// The reason why the window could not be opened or had to close.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// No display is available; holds the reason.
    #[error("no window can be opened here ({0}); use flipmap render for pictures without a window")]
    Display(String),
    /// The system refused the window; holds the reason.
    #[error("the system refused the window: {0}")]
    Window(String),
    /// The display is no longer there.
    #[error("{GONE}")]
    Gone,
    /// A library panicked; holds what it said.
    #[error("the window ended unexpectedly ({0}); the settings and the keys of the film are kept")]
    Panicked(String),
    /// The display has a scale at which no window can be laid out.
    #[error(transparent)]
    Scale(#[from] UnusableScale),
    /// No driver draws in the colours of the display.
    #[error(
        "the display has {0} bits a pixel, and no graphics driver here draws the window in them; \
         use a display of 24 bits, or flipmap render for pictures without a window"
    )]
    Depth(u16),
    /// No graphics device can draw the window.
    #[error(transparent)]
    Host(#[from] HostError),
    /// The graphics device was lost again and again.
    #[error(
        "the graphics device was lost again and again; the view was saved. Update the graphics \
         driver, or look with software graphics"
    )]
    Lost,
    /// The measurements could not be written.
    #[error("cannot write the measurements to {path}: {source}")]
    Stats {
        /// Path of the file.
        path: String,
        /// Cause of the failure.
        source: std::io::Error,
    },
}
