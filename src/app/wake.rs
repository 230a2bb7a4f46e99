//! What wakes a sleeping window from outside.

use std::time::{Duration, Instant};

/// Why the window was woken.
#[derive(Debug)]
pub enum Woken {
    /// Something is to be drawn at this moment.
    Draw(Instant),
    /// A thread of ours has news.
    News,
    /// The window is to close.
    Quit,
    /// A screen reader wants something.
    Accessibility(accesskit_event::Event),
}

/// A moment so far away that it never comes.
const NEVER: Duration = Duration::from_secs(1 << 30);

impl Woken {
    /// To draw after a delay.
    pub fn after(delay: Duration) -> Self {
        Woken::Draw(Instant::now() + delay.min(NEVER))
    }
}

/// What screen readers ask for.
pub mod accesskit_event {
    /// A request.
    #[derive(Debug)]
    pub enum Event {
        /// Begin to tell.
        Wanted,
        /// Do this.
        Action(egui::accesskit::ActionRequest),
        /// Tell no more.
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
