//! The mapping of times to colours, with a legend. Nothing here recomputes anything.

use egui::{Color32, Grid, Mesh, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2, vec2};

use super::field::{number, plain};
use crate::physics::Outcome;
use crate::scene::palette::{FAILED, FORBIDDEN, Palette, Rgb, Tones, UNFLIPPED};
use crate::scene::{Build, PictureTable, QuestionTable, Scale};

/// An action of the user on the colours.
#[derive(Clone, Debug, PartialEq)]
pub enum ColourAction {
    /// Paints the map with these picture settings.
    Paint(PictureTable),
    /// Spreads the palette over the times in view.
    Equalise,
}

/// Shows how the picture of a scene is painted; `has_samples` is true if the view has samples to
/// spread the palette over.
pub fn colours_panel(
    ui: &mut Ui,
    picture: &PictureTable,
    build: &Build,
    question: &QuestionTable,
    has_samples: bool,
) -> Option<ColourAction> {
    let Ok(tones) = Tones::new(picture, build.unit_secs(), question.budget.secs) else {
        return back(ui, picture);
    };
    let mut new = picture.clone();
    legend(ui, &tones, picture.palette.as_str());
    ui.separator();
    palettes(ui, &mut new);
    ui.separator();
    range(ui, &mut new, &tones);
    let spread = ui.add_enabled(has_samples, egui::Button::new("Equalise to this view"));
    let spread = spread.on_hover_text("Every colour is seen equally often");
    if spread.clicked() {
        return Some(ColourAction::Equalise);
    }
    if let Some(action) = back(ui, picture) {
        return Some(action);
    }
    (new != *picture && new.check().is_ok()).then_some(ColourAction::Paint(new))
}

/// Shows a button that restores the default colours; the energy curve and the samples stay.
fn back(ui: &mut Ui, picture: &PictureTable) -> Option<ColourAction> {
    let PictureTable { curve, samples, .. } = *picture;
    let plain = PictureTable { curve, samples, ..PictureTable::default() };
    let button = ui.add_enabled(*picture != plain, egui::Button::new("Back to the default"));
    button.clicked().then_some(ColourAction::Paint(plain))
}

fn palettes(ui: &mut Ui, picture: &mut PictureTable) {
    Grid::new("palettes").num_columns(2).show(ui, |ui| {
        for name in Palette::names() {
            ui.radio_value(&mut picture.palette, name.to_string(), name);
            if let Ok(palette) = Palette::named(name) {
                let colour = |share| palette.colour(share);
                let response = strip(ui, 14.0, colour);
                response.widget_info(|| {
                    WidgetInfo::labeled(Role::Image, true, format!("Colours of {name}"))
                });
            }
            ui.end_row();
        }
    });
    ui.checkbox(&mut picture.reverse, "Reverse the palette");
}

fn range(ui: &mut Ui, picture: &mut PictureTable, tones: &Tones) {
    Grid::new("range").num_columns(2).show(ui, |ui| {
        let [from, to] = tones.range_secs();
        let (first, last) = (*PictureTable::SECS.start(), *PictureTable::SECS.end());
        if let Some(from) = number(ui, "From", " s", from, first..=to / APART) {
            picture.times = vec![from, to];
        }
        ui.end_row();
        if let Some(to) = number(ui, "To", " s", to, from * APART..=last) {
            picture.times = vec![from, to];
        }
        ui.end_row();
        ui.label("Scale");
        ui.horizontal(|ui| {
            let log = ui.radio_value(&mut picture.scale, Scale::Log, "log");
            log.on_hover_text("Equal ratios of times are equal steps of colour");
            let linear = ui.radio_value(&mut picture.scale, Scale::Linear, "linear");
            linear.on_hover_text("Equal differences of times are equal steps of colour");
        });
        ui.end_row();
        let cycles = number(ui, "Cycles", "", picture.cycles, PictureTable::CYCLES);
        picture.cycles = cycles.unwrap_or(picture.cycles);
        ui.end_row();
    });
    if picture.times.len() > 2 {
        ui.label(format!("Spread in {} steps", picture.times.len() - 1));
    }
}

/// Least ratio of the end of a range to its beginning.
const APART: f64 = 1.001;

/// Shows all colours with times under them, and those of the outcomes without a time.
fn legend(ui: &mut Ui, tones: &Tones, name: &str) {
    let [from, to] = tones.range_secs().map(plain);
    let response = strip(ui, 22.0, |share| tones.colour(&Outcome::flipped(tones.secs_at(share))));
    let told = format!("Legend: {name} from {from} s to {to} s");
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, told.as_str()));
    ticks(ui, response.rect, tones);
    ui.horizontal_wrapped(|ui| {
        for (colour, what) in
            [(UNFLIPPED, "not within the budget"), (FORBIDDEN, "forbidden"), (FAILED, "failed")]
        {
            let (rect, _) = ui.allocate_exact_size(vec2(12.0, 12.0), Sense::hover());
            ui.painter().rect_filled(rect, 2.0, rgb(colour));
            ui.label(what);
        }
    });
}

/// Shows times at the quarters of the strip.
fn ticks(ui: &mut Ui, strip: Rect, tones: &Tones) {
    let (rect, _) = ui.allocate_exact_size(vec2(strip.width(), 16.0), Sense::hover());
    let font = egui::TextStyle::Small.resolve(ui.style());
    let ink = ui.visuals().text_color();
    for (quarter, align) in (0..=4u8).zip([
        egui::Align2::LEFT_TOP,
        egui::Align2::CENTER_TOP,
        egui::Align2::CENTER_TOP,
        egui::Align2::CENTER_TOP,
        egui::Align2::RIGHT_TOP,
    ]) {
        let share = f64::from(quarter) / 4.0;
        let x = rect.left() + rect.width() * share as f32;
        ui.painter().vline(x, rect.top() - 3.0..=rect.top(), (1.0, ink));
        let text = format!("{} s", three_digits(tones.secs_at(share)));
        ui.painter().text(pos2(x, rect.top() + 1.0), align, text, font.clone(), ink);
    }
}

/// Formats seconds to three significant digits, enough beside a colour.
fn three_digits(secs: f64) -> String {
    let unit = 10f64.powf(secs.log10().floor() - 2.0);
    plain((secs / unit).round() * unit)
}

/// Draws a band of colours from left to right.
fn strip(ui: &mut Ui, height: f32, colour: impl Fn(f64) -> Rgb) -> Response {
    const STEPS: u32 = 256;
    let width = ui.available_width().min(360.0);
    let (rect, response) = ui.allocate_exact_size(vec2(width, height), Sense::hover());
    let mut mesh = Mesh::default();
    for step in 0..STEPS {
        let edge = |step: u32| rect.left() + rect.width() * step as f32 / STEPS as f32;
        let part = Rect::from_x_y_ranges(edge(step)..=edge(step + 1), rect.y_range());
        let share = (f64::from(step) + 0.5) / f64::from(STEPS);
        mesh.add_colored_rect(part, rgb(colour(share)));
    }
    ui.painter().add(mesh);
    response
}

fn rgb([r, g, b]: Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}
