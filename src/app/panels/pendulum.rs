//! The pendulum of the selected pin: played, scrubbed, and compared with the map's outcome.

mod drawing;
mod facts;
mod plot;

use egui::{Atom, Button, Response, Role, Slider, Stroke, Ui, WidgetInfo};

use crate::app::flight::playback::SPEEDS;
use crate::app::pins::{Pin, PinAction, Pins};
use crate::lab::drawing::{CANVAS, FAINT, INK};

pub use drawing::miniature;

/// Shows the pins and the selected one's pendulum; returns the user's actions on them. Requests
/// another frame only while that pendulum plays.
pub fn pendulum_panel(ui: &mut Ui, pins: &Pins) -> Vec<PinAction> {
    let mut actions = Vec::new();
    tabs(ui, pins, &mut actions);
    match pins.selected() {
        Some(pin) => {
            drawing::pendulum(ui, pins.build(), pin);
            clock(ui, pin, &mut actions);
            ui.separator();
            facts::facts(ui, pin);
            plot::separation(ui, pin);
        }
        None => {
            ui.label("Click a pixel of the map to pin it and to watch its pendulum.");
        }
    }
    if pins.is_playing() {
        ui.ctx().request_repaint();
    }
    actions
}

/// Shows one button per pin, with its colour and letter.
fn tabs(ui: &mut Ui, pins: &Pins, actions: &mut Vec<PinAction>) {
    let selected = pins.selected().map(|pin| pin.id);
    ui.horizontal_wrapped(|ui| {
        for pin in pins.iter() {
            let is_selected = selected == Some(pin.id);
            let dot = Atom::paint([10.0; 2], |ui, args| {
                ui.painter().circle_filled(args.rect.center(), 5.0, pin.badge.colour());
            });
            let tab = Button::selectable(is_selected, (dot, pin.badge.letter().to_string()));
            let tab = ui.add(tab).on_hover_text("Show this pin");
            let name = format!("Pin {}", pin.badge.letter());
            tab.widget_info(|| WidgetInfo::selected(Role::Button, true, is_selected, &name));
            if tab.clicked() && !is_selected {
                actions.push(PinAction::Select(pin.id));
            }
        }
    });
}

/// Shows the buttons to play or pause, restart and remove, and the sliders for time and speed.
fn clock(ui: &mut Ui, pin: &Pin, actions: &mut Vec<PinAction>) {
    let Pin { id, playback, .. } = *pin;
    ui.horizontal(|ui| {
        let mut button = |name: &str, action| {
            if ui.button(name).clicked() {
                actions.push(action);
            }
        };
        if playback.is_playing() {
            button("Pause", PinAction::Pause(id));
        } else {
            button("Play", PinAction::Play(id));
        }
        button("Restart", PinAction::Restart(id));
        button("Remove", PinAction::Remove(id));
    });
    // The rails take the width that the names and the numbers leave.
    let rail_width = (ui.available_width() - 170.0).max(60.0);
    egui::Grid::new("clock").num_columns(3).show(ui, |ui| {
        ui.spacing_mut().slider_width = rail_width;
        moment(ui, pin, actions);
        ui.end_row();
        let mut speed = playback.speed();
        let name = ui.label("Speed");
        let slider = Slider::new(&mut speed, SPEEDS).logarithmic(true).show_value(false);
        if ui.add(slider).labelled_by(name.id).changed() {
            actions.push(PinAction::Speed(id, speed));
        }
        ui.label(format!("{speed:.2} ×"));
        ui.end_row();
    });
}

/// Shows the time slider with the flip marked on it.
fn moment(ui: &mut Ui, pin: &Pin, actions: &mut Vec<PinAction>) {
    let record = pin.flight.record();
    let (end_secs, mut secs) = (record.end_secs(), pin.shown_secs());
    let name = ui.label("Time");
    let slider = Slider::new(&mut secs, 0.0..=end_secs).show_value(false);
    let rail = ui.add(slider).labelled_by(name.id);
    if let Some(flip) = record.own.flip.filter(|flip| flip.secs.hi <= end_secs) {
        mark_flip(ui, &rail, (flip.secs.hi / end_secs) as f32);
    }
    if rail.changed() {
        actions.push(PinAction::Scrub(pin.id, secs));
    }
    ui.label(format!("{:.2} of {} s", pin.shown_secs(), facts::round_secs(end_secs)));
}

/// Draws a tick across the rail at a fraction of its length.
fn mark_flip(ui: &Ui, rail: &Response, share: f32) {
    let shape = ui.visuals().handle_shape;
    let aspect = match shape {
        egui::style::HandleShape::Rect { aspect_ratio } => aspect_ratio,
        egui::style::HandleShape::Circle => 1.0,
    };
    // The range over which egui lets the middle of a handle travel.
    let travel = rail.rect.x_range().shrink(rail.rect.height() / 2.5 * aspect);
    let x = egui::lerp(travel.min..=travel.max, share);
    let stroke = Stroke::new(2.0, ui.visuals().strong_text_color());
    ui.painter().vline(x, rail.rect.y_range(), stroke);
}
