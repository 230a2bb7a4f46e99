//! Events that wake a sleeping window from outside.

use std::time::{Duration, Instant};

use super::clipboard::Pasted;

/// The reason why the window was woken.
#[derive(Debug)]
pub(crate) enum Woken {
    /// Something is to be drawn at this moment.
    Draw(Instant),
    /// A background thread has news.
    News,
    /// The window is to close.
    Quit,
    /// The clipboard was read.
    Pasted(Pasted),
    /// A screen reader has a request.
    Accessibility(accesskit_event::Event),
}

/// A delay so long that it never ends.
const NEVER: Duration = Duration::from_secs(1 << 30);

impl Woken {
    /// Returns a request to draw after a delay.
    pub(crate) fn after(delay: Duration) -> Self {
        Woken::Draw(Instant::now() + delay.min(NEVER))
    }
}

/// Requests of screen readers.
pub(crate) mod accesskit_event {
    /// A request of a screen reader.
    #[derive(Debug)]
    pub(crate) enum Event {
        /// Asks for descriptions of the interface.
        Wanted,
        /// Asks for this action.
        Action(egui::accesskit::ActionRequest),
        /// Asks for no more descriptions of the interface.
        Unwanted,
    }
}

impl From<egui_winit::accesskit_winit::Event> for Woken {
    fn from(event: egui_winit::accesskit_winit::Event) -> Self {
        use accesskit_event::Event;
        use egui_winit::accesskit_winit::WindowEvent;
        Woken::Accessibility(match event.window_event {
            WindowEvent::InitialTreeRequested => Event::Wanted,
            WindowEvent::ActionRequested(request) => Event::Action(request),
            WindowEvent::AccessibilityDeactivated => Event::Unwanted,
        })
    }
}
