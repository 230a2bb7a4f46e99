//! The film panel: the keys of the camera's path, a preview of it, and films being made.

use egui::{Button, ComboBox, DragValue, Grid, Slider, TextEdit, Ui};

use super::export::{ExportAction, ExportStatus, statuses};
use super::field::number;
use super::sentence::sentence;
use crate::film_draft::FilmDraft;
use flipmap_numbers::number_text::significant;
use flipmap_screen::flight::playback::Playback;

/// An action of the user in the panel.
#[derive(Clone, Debug, PartialEq)]
pub enum FilmAction {
    /// Appends the current view as a key.
    Add,
    /// Changes the draft to this one.
    Change(Box<FilmDraft>),
    /// Moves the map to the key with this index.
    Go(usize),
    /// Moves the clock of the preview.
    Preview(Playback),
    /// Reads the keys from their file.
    OpenKeys,
    /// Writes the keys to their file.
    SaveKeys,
    /// Lets the user choose the film's file in the desktop's dialog.
    Browse,
    /// Makes the film.
    Start,
    /// Acts on a film that is being made.
    Export(ExportAction),
}

/// Common sizes of frames, in pixels.
const SIZES: [(&str, [u32; 2]); 4] = [
    ("640 × 360", [640, 360]),
    ("1280 × 720 (HD)", [1280, 720]),
    ("1920 × 1080 (Full HD)", [1920, 1080]),
    ("3840 × 2160 (4K)", [3840, 2160]),
];
/// Range of times between two keys, s.
const STEP_SECS: std::ops::RangeInclusive<f64> = 0.1..=600.0;
/// Range of a frame's sides, in pixels.
const SIDE_PX: std::ops::RangeInclusive<f64> = 16.0..=8192.0;

/// Shows the draft of a film and the films being made; returns the user's actions.
pub fn film_panel(ui: &mut Ui, draft: &FilmDraft, exports: &[ExportStatus]) -> Vec<FilmAction> {
    let mut actions = Vec::new();
    if ui.button("Add this view").clicked() {
        actions.push(FilmAction::Add);
    }
    let mut new = draft.clone();
    if draft.keys.is_empty() {
        ui.label("A film goes from view to view. Add the first, move the map, and add the next.");
    } else {
        keys(ui, &mut new, &mut actions);
    }
    if draft.keys.len() > 1 {
        preview(ui, draft, &mut actions);
    }
    keys_file(ui, &mut new, &mut actions);
    ui.separator();
    output(ui, &mut new, &mut actions);
    if new != *draft {
        actions.push(FilmAction::Change(Box::new(new)));
    }
    let problem = draft.problem();
    let can = problem.is_none();
    let name = match std::path::Path::new(&draft.path).is_file() {
        true => "Make film and replace the file",
        false => "Make film",
    };
    if ui.add_enabled(can, Button::new(name)).clicked() {
        actions.push(FilmAction::Start);
    }
    if let (Some(problem), false) = (problem, draft.keys.is_empty()) {
        let colour = ui.visuals().text_color();
        ui.label(sentence(ui, &problem, colour));
    }
    let films = statuses(ui, exports, |export| export.is_film);
    actions.extend(films.into_iter().map(FilmAction::Export));
    actions
}

/// Shows the keys, each with its time and width.
fn keys(ui: &mut Ui, draft: &mut FilmDraft, actions: &mut Vec<FilmAction>) {
    let steps = draft.steps_secs();
    let mut removed = None;
    Grid::new("film keys").num_columns(4).show(ui, |ui| {
        for (place, key) in draft.keys.clone().iter().enumerate() {
            let number = place + 1;
            if place == 0 {
                ui.label("starts");
            } else {
                let mut secs = steps[place];
                let field = DragValue::new(&mut secs).range(STEP_SECS).speed(0.1).suffix(" s");
                let field = ui.add(field.max_decimals(1));
                field.widget_info(|| {
                    egui::WidgetInfo::labeled(
                        egui::Role::SpinButton,
                        true,
                        format!("Seconds to key {number}"),
                    )
                });
                if field.changed() {
                    draft.set_step(place, secs);
                }
            }
            let width = key.scene.view.width_rad().hi;
            let name = format!("{number}: {} wide", significant(width, 3));
            if ui.link(name).on_hover_text("Go there").clicked() {
                actions.push(FilmAction::Go(place));
            }
            let button = ui.small_button("×");
            button.widget_info(|| {
                egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Remove key {number}"))
            });
            if button.on_hover_text("Remove").clicked() {
                removed = Some(place);
            }
            ui.end_row();
        }
    });
    if let Some(place) = removed {
        draft.remove(place);
    }
}

/// Shows the clock of the preview.
fn preview(ui: &mut Ui, draft: &FilmDraft, actions: &mut Vec<FilmAction>) {
    let (mut clock, end_secs) = (draft.clock, draft.secs());
    ui.horizontal(|ui| {
        if clock.is_playing() {
            if ui.button("Pause").clicked() {
                clock.pause();
            }
        } else if ui.button("Preview").clicked() {
            clock.play(end_secs);
        }
        let mut secs = clock.time_secs();
        ui.spacing_mut().slider_width = (ui.available_width() - 110.0).max(40.0);
        let slider = Slider::new(&mut secs, 0.0..=end_secs).show_value(false);
        let slider = ui.add(slider);
        slider.widget_info(|| egui::WidgetInfo::slider(true, secs, "Moment of the film"));
        if slider.changed() {
            clock.pause();
            clock.scrub(secs);
        }
        ui.label(format!("{secs:.1} of {end_secs:.1} s"));
    });
    if clock != draft.clock {
        actions.push(FilmAction::Preview(clock));
    }
}

fn keys_file(ui: &mut Ui, draft: &mut FilmDraft, actions: &mut Vec<FilmAction>) {
    ui.horizontal_wrapped(|ui| {
        let label = ui.label("Keyframes file");
        let width = ui.available_width().max(60.0);
        let field = TextEdit::singleline(&mut draft.keys_path).desired_width(width);
        ui.add(field).labelled_by(label.id);
        let named = !draft.keys_path.trim().is_empty();
        if ui.add_enabled(named, Button::new("Open keys")).clicked() {
            actions.push(FilmAction::OpenKeys);
        }
        if ui.add_enabled(named && !draft.keys.is_empty(), Button::new("Save keys")).clicked() {
            actions.push(FilmAction::SaveKeys);
        }
    });
}

fn output(ui: &mut Ui, draft: &mut FilmDraft, actions: &mut Vec<FilmAction>) {
    Grid::new("film").num_columns(2).show(ui, |ui| {
        let label = ui.label("Film to");
        ui.horizontal(|ui| {
            let width = (ui.available_width() - 80.0).max(60.0);
            let field = TextEdit::singleline(&mut draft.path).desired_width(width);
            ui.add(field).labelled_by(label.id).on_hover_text(
                ".mp4, .mkv (lossless), .gif or .webp through ffmpeg, or a folder of pictures",
            );
            if ui.button("Choose…").clicked() {
                actions.push(FilmAction::Browse);
            }
        });
        ui.end_row();
        let label = ui.label("Frames");
        let shown = SIZES.iter().find(|(_, size)| *size == draft.size);
        let shown = shown.map_or("other", |(name, _)| *name);
        let combo = ComboBox::from_id_salt("frames").selected_text(shown).show_ui(ui, |ui| {
            for (name, size) in SIZES {
                ui.selectable_value(&mut draft.size, size, name);
            }
        });
        combo.response.labelled_by(label.id);
        ui.end_row();
        for (name, side) in ["Frame width", "Frame height"].into_iter().zip(&mut draft.size) {
            if let Some(new) = number(ui, name, " px", f64::from(*side), SIDE_PX) {
                *side = new.round() as u32;
            }
            ui.end_row();
        }
        if let Some(new) = number(ui, "Per second", "", draft.fps, 1.0..=240.0) {
            draft.fps = new;
        }
        ui.end_row();
    });
}
