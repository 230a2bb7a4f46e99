//! The question before a window closes while exports are running.

use egui::{Align2, Context, Vec2, Window};

use super::action::Action;
use super::model::AppModel;
use super::state::{Dialog, Effect};

impl AppModel {
    /// Returns the effect that closes the window; none if the user is asked first. Asked twice, the
    /// window closes.
    pub(super) fn quit(&mut self) -> Option<Effect> {
        let asks = !self.exports.at_stake().is_empty() && !self.state.shown.leaving;
        self.state.shown.leaving = asks;
        (!asks).then_some(Effect::Quit)
    }

    /// Asks whether the window should close, and says what is kept; returns the answer, if any.
    pub(super) fn ask_before_leaving(&mut self, ctx: &Context) -> Option<Action> {
        let at_stake = self.exports.at_stake();
        self.state.shown.leaving &= !at_stake.is_empty();
        if !self.state.shown.leaving {
            return None;
        }
        let mut answer = None;
        let window = Window::new("Close the window?").collapsible(false).resizable(false);
        window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).default_width(400.0).show(ctx, |ui| {
            for sentence in at_stake {
                ui.label(sentence);
                ui.add_space(6.0);
            }
            ui.horizontal(|ui| {
                if ui.button("Keep it open").clicked() {
                    answer = Some(Action::Toggle(Dialog::Leaving));
                }
                if ui.button("Close the window").clicked() {
                    answer = Some(Action::Quit);
                }
            });
        });
        answer
    }
}
