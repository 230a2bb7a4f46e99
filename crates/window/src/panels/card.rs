//! The card of the first start, with a few sentences on what the map shows.

use egui::{Align2, Vec2, Window};

use crate::action::Action;
use crate::state::Dialog;

/// Heading of the card.
const HEADING: &str = "What you are seeing";

/// Paragraphs on what the map shows in its default colours.
const TEXT: [&str; 3] = [
    "Every point of this map is a double pendulum that is let go from rest: from left to right the \
     angle of its first rod, upwards the angle of its second. Its colour is the time until the \
     second bob flips over the top.",
    "Where the map is black, the bob has not flipped within the budget of time. In the charcoal \
     lens it never will: it has too little energy, and the pale curve around it is the border. \
     Where colours lie side by side like threads, a hair's breadth decides. That is chaos, and it \
     goes on however far you zoom in.",
    "Drag and turn the wheel to wander, click to let a pendulum go, press D to dive to where the \
     pointer is. Ctrl+K finds everything by name, F1 lists the keys.",
];

/// Shows the card; returns an action if it is closed.
pub(crate) fn card(ctx: &egui::Context) -> Option<Action> {
    let mut closed = false;
    let window = Window::new(HEADING).collapsible(false).resizable(false).default_width(400.0);
    window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).show(ctx, |ui| {
        for paragraph in TEXT {
            ui.label(paragraph);
            ui.add_space(6.0);
        }
        closed = ui.button("Look around").clicked();
    });
    closed.then_some(Action::Toggle(Dialog::Card))
}
