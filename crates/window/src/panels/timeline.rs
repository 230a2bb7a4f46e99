//! Time on the map: a clock by which pixels light up as their pendulums flip.

use egui::{Slider, Ui};

use crate::action::Action;
use flipmap_screen::flight::playback::{Playback, SPEEDS};

/// Shows the clock of a map whose pendulums run for `budget_secs`; returns the action that changes
/// it.
pub(crate) fn timeline(ui: &mut Ui, playback: &Playback, budget_secs: f64) -> Option<Action> {
    let mut new = *playback;
    let mut open = true;
    ui.horizontal(|ui| {
        if playback.is_playing() {
            if ui.button("Pause").clicked() {
                new.pause();
            }
        } else if ui.button("Play").clicked() {
            new.play(budget_secs);
        }
        let mut speed = playback.speed();
        let name = ui.label("Speed");
        ui.spacing_mut().slider_width = 70.0;
        let slider = Slider::new(&mut speed, SPEEDS).logarithmic(true).show_value(false);
        if ui.add(slider).labelled_by(name.id).changed() {
            new.set_speed(speed);
        }
        let name = ui.label("Flipped by");
        let mut secs = playback.time_secs();
        // The rail takes the width that the number and the last button leave. A slider that shows
        // the number would round it, and so change the clock.
        ui.spacing_mut().slider_width = (ui.available_width() - 130.0).max(40.0);
        let slider = Slider::new(&mut secs, 0.0..=budget_secs).show_value(false);
        if ui.add(slider).labelled_by(name.id).changed() {
            new.scrub(secs);
        }
        ui.label(format!("{secs:.2} s"));
        open = !ui.button("Close").on_hover_text("Show the whole map again").clicked();
    });
    if new.is_playing() {
        ui.ctx().request_repaint();
    }
    (!open || new != *playback).then_some(Action::Timeline(open.then_some(new)))
}
