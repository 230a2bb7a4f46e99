//! The pendulum of the selected pin: played, scrubbed, and compared with the map's outcome.

mod drawing;
mod facts;
mod plot;

use std::time::Duration;

use egui::{Atom, Button, Response, Role, Slider, Stroke, Ui, WidgetInfo, vec2};

use crate::pins::{Pin, PinAction, Pins};
use flipmap_lab::drawing::{CANVAS, FAINT, INK};
use flipmap_numbers::number_text::fixed;
use flipmap_screen::flight::playback::SPEEDS;

pub(crate) use drawing::miniature;

/// Height of the stage on the card as a share of its width.
const CARD_ASPECT: f32 = 0.8;
/// Height in points that the tabs and the clock take below a stage that fills the window.
const BELOW_STAGE: f32 = 135.0;
/// Time between two frames of flying pendulums, at about 30 frames per second.
pub const FRAME: Duration = Duration::from_millis(33);

/// Returns the colour that the map gives to a time in s; none if it paints no times.
pub type TimeColour<'a> = &'a dyn Fn(f64) -> Option<egui::Color32>;

/// Shows the pins, the stage, the selected pin's clock and, once opened, its numbers; returns the
/// user's actions on them. Trails have the colours of the map at their times.
pub fn pendulum_card(ui: &mut Ui, pins: &Pins, colour_at: TimeColour) -> Vec<PinAction> {
    let mut actions = Vec::new();
    tabs(ui, pins, &mut actions);
    if let Some(pin) = pins.selected() {
        let width = ui.available_width();
        drawing::stage(ui, pins, pin, vec2(width, width * CARD_ASPECT), colour_at);
        facts::headline(ui, pin);
        clock(ui, pins, pin, &mut actions);
        ui.collapsing("Numbers", |ui| {
            facts::facts(ui, pin);
            plot::separation(ui, pin);
        });
    }
    next_frame(ui, pins);
    actions
}

/// Shows the stage in all the available space; returns the user's actions on the pins.
pub(crate) fn stage(ui: &mut Ui, pins: &Pins, colour_at: TimeColour) -> Vec<PinAction> {
    let mut actions = Vec::new();
    if let Some(pin) = pins.selected() {
        let size = ui.available_size() - vec2(0.0, BELOW_STAGE);
        drawing::stage(ui, pins, pin, size.max(vec2(1.0, 1.0)), colour_at);
        tabs(ui, pins, &mut actions);
        clock(ui, pins, pin, &mut actions);
    }
    next_frame(ui, pins);
    actions
}

/// Asks for another frame while the pendulums fly.
pub(crate) fn next_frame(ui: &Ui, pins: &Pins) {
    if pins.is_playing() {
        ui.ctx().request_repaint_after(FRAME);
    }
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

/// Shows the clock as wide as the panel, and the buttons to play or pause, restart and remove.
fn clock(ui: &mut Ui, pins: &Pins, pin: &Pin, actions: &mut Vec<PinAction>) {
    moment(ui, pins, pin, actions);
    ui.horizontal(|ui| {
        let mut button = |name: &str, action| {
            if ui.button(name).clicked() {
                actions.push(action);
            }
        };
        if pins.is_playing() {
            button("Pause", PinAction::Pause);
        } else {
            button("Play", PinAction::Play);
        }
        button("Restart", PinAction::Restart);
        button("Remove", PinAction::Remove(pin.id));
    });
    ui.horizontal(|ui| {
        let mut speed = pins.clock().speed();
        let name = ui.label("Speed");
        // The rail takes the width that the number leaves.
        ui.spacing_mut().slider_width = (ui.available_width() - 60.0).max(30.0);
        let slider = Slider::new(&mut speed, SPEEDS).logarithmic(true).show_value(false);
        if ui.add(slider).labelled_by(name.id).changed() {
            actions.push(PinAction::Speed(speed));
        }
        ui.label(format!("{} ×", fixed(speed, 2)));
    });
}

/// Shows the time, and below it the slider with the flip marked on it.
fn moment(ui: &mut Ui, pins: &Pins, pin: &Pin, actions: &mut Vec<PinAction>) {
    let record = pin.flight.record();
    let (end_secs, mut secs) = (record.end_secs(), pins.clock().time_secs().min(record.end_secs()));
    let name = ui
        .horizontal(|ui| {
            let name = ui.label("Time");
            ui.label(format!("{} of {} s", fixed(secs, 2), facts::round_secs(end_secs)));
            name
        })
        .inner;
    ui.spacing_mut().slider_width = ui.available_width();
    let slider = Slider::new(&mut secs, 0.0..=end_secs).show_value(false);
    let rail = ui.add(slider).labelled_by(name.id);
    if let Some(flip) = record.own.flip.filter(|flip| flip.secs.hi <= end_secs) {
        mark_flip(ui, &rail, (flip.secs.hi / end_secs) as f32);
    }
    if rail.changed() {
        actions.push(PinAction::Scrub(secs));
    }
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
