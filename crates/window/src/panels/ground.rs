//! The colours outside the palette, each a button that opens a picker.

use egui::Ui;

use flipmap_scene::palette::{Ground, GroundTable, colour_text};

/// Width of a button in points, which lets all three stand in a row.
const BUTTON_POINTS: f32 = 24.0;

/// Shows the colours of starts without an answer and of the curve, and stores changed ones in
/// `own`.
pub(super) fn grounds(ui: &mut Ui, own: &mut GroundTable, shown: Ground) {
    let colours = [
        ("Unflipped", &mut own.unflipped, shown.unflipped),
        ("Forbidden", &mut own.forbidden, shown.forbidden),
        ("Curve", &mut own.curve, shown.curve),
    ];
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().interact_size.x = BUTTON_POINTS;
        for (name, own, shown) in colours {
            let mut colour = shown;
            let button = ui.color_edit_button_srgb(&mut colour);
            button.labelled_by(ui.label(name).id);
            if colour != shown {
                *own = Some(colour_text(colour));
            }
        }
    });
}
