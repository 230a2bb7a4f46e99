//! The colours of the user's own gradient, each a button that opens a picker.

use egui::{Grid, Role, Ui, WidgetInfo};

use flipmap_scene::palette::gradient::{STOPS, list_text, parse_list};
use flipmap_scene::palette::{Palette, Rgb};

/// Number of colours that a copy of a palette begins with.
const COPIED: u32 = 7;
/// Largest number of colours that are edited one by one.
const MAX_EDITED_COLOURS: usize = 24;

/// Shows the colours of a palette, and changes, adds or removes them in `palette`. A palette with a
/// name must first be copied.
pub(super) fn stops(ui: &mut Ui, palette: &mut String) {
    let stops = parse_list(palette).filter(|stops| stops.len() <= MAX_EDITED_COLOURS);
    let Some(mut stops) = stops else {
        let copy = ui.button("Edit a copy of the palette");
        if copy.on_hover_text("Its colours become a gradient of your own").clicked() {
            *palette = copied(palette).unwrap_or_default();
        }
        return;
    };
    let (mut added, mut removed) = (None, None);
    Grid::new("stops").num_columns(3).show(ui, |ui| {
        let count = stops.len();
        for (place, colour) in stops.iter_mut().enumerate() {
            let name = format!("Stop {}", place + 1);
            let label = ui.label(&name);
            ui.color_edit_button_srgb(colour).labelled_by(label.id);
            ui.horizontal(|ui| {
                let can_add = count < *STOPS.end();
                added = added.or(act(ui, "+", &format!("Add after stop {}", place + 1), can_add)
                    .then_some(place));
                let can_remove = count > *STOPS.start();
                removed =
                    removed.or(act(ui, "−", &format!("Remove stop {}", place + 1), can_remove)
                        .then_some(place));
            });
            ui.end_row();
        }
    });
    if let Some(place) = added {
        let next = stops[(place + 1).min(stops.len() - 1)];
        stops.insert(place + 1, between(stops[place], next));
    } else if let Some(place) = removed {
        stops.remove(place);
    }
    *palette = list_text(&stops);
}

/// Shows a small button, which screen readers call by `name`; returns true if it was clicked.
fn act(ui: &mut Ui, sign: &str, name: &str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, egui::Button::new(sign).small());
    button.widget_info(|| WidgetInfo::labeled(Role::Button, enabled, name));
    button.on_hover_text(name).clicked()
}

/// Returns evenly spaced colours of a palette as a list.
fn copied(palette: &str) -> Option<String> {
    let palette = Palette::named(palette).ok()?;
    let stop = |k: u32| palette.colour(f64::from(k) / f64::from(COPIED - 1));
    Some(list_text(&(0..COPIED).map(stop).collect::<Vec<_>>()))
}

fn between(a: Rgb, b: Rgb) -> Rgb {
    [0, 1, 2].map(|i| a[i].midpoint(b[i]))
}
