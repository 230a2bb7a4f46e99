//! The mapping of answers to colours, with a legend. Nothing here recomputes anything.

use egui::{ComboBox, Grid, Role, Ui, WidgetInfo};

use super::colour_strip::{legend, strip};
use super::field::number;
use super::ground::grounds;
use crate::question::Ask;
use crate::scene::palette::{AnswerColours, Palette, Tones};
use crate::scene::{PictureTable, Scale, Scene};

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
    scene: &Scene,
    has_samples: bool,
) -> Option<ColourAction> {
    let (unit_secs, question) = (scene.build.unit_secs(), &scene.question);
    let (Ok(colours), Ok(tones)) =
        (AnswerColours::new(scene, picture), Tones::new(picture, unit_secs, question.budget.secs))
    else {
        return back(ui, picture);
    };
    let mut new = picture.clone();
    legend(ui, &colours, question.ask, picture.palette.as_str());
    if question.ask.kind().channels.len() > 1 {
        channels(ui, &mut new, question.ask);
    }
    ui.separator();
    palettes(ui, &mut new);
    grounds(ui, &mut new.colours, colours.ground());
    if question.ask.is_time() {
        ui.separator();
        range(ui, &mut new, &tones);
        let spread = ui.add_enabled(has_samples, egui::Button::new("Equalise to this view"));
        let spread = spread.on_hover_text("Every colour is seen equally often");
        if spread.clicked() {
            return Some(ColourAction::Equalise);
        }
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

/// Shows the choice of the channel that is painted.
fn channels(ui: &mut Ui, picture: &mut PictureTable, ask: Ask) {
    const NATURAL: &str = "as is natural";
    ui.horizontal(|ui| {
        let label = ui.label("Channel");
        let shown = picture.channel.as_deref().unwrap_or(NATURAL).to_string();
        let combo = ComboBox::from_id_salt("channel").selected_text(shown).show_ui(ui, |ui| {
            ui.selectable_value(&mut picture.channel, None, NATURAL);
            for channel in ask.kind().channels {
                let name = Some(channel.name.to_string());
                ui.selectable_value(&mut picture.channel, name, channel.name);
            }
            if let Some((name, _)) = ask.kind().tint {
                ui.selectable_value(&mut picture.channel, Some(name.to_string()), name);
            }
        });
        combo.response.labelled_by(label.id);
    });
}

fn palettes(ui: &mut Ui, picture: &mut PictureTable) {
    Grid::new("palettes").num_columns(2).show(ui, |ui| {
        // The user's own gradient, while it is in use.
        let own = picture.palette.starts_with('#').then(|| picture.palette.clone());
        let named = Palette::names().map(str::to_string);
        for text in named.chain(own) {
            let Ok(palette) = Palette::named(&text) else { continue };
            ui.radio_value(&mut picture.palette, text, palette.name);
            let response = strip(ui, 14.0, |share| palette.colour(share));
            response.widget_info(|| {
                WidgetInfo::labeled(Role::Image, true, format!("Colours of {}", palette.name))
            });
            ui.end_row();
        }
    });
    ui.label("Drop a gradient on the window: .map, .ugr or .gpl.");
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
            let steps = ui.radio_value(&mut picture.scale, Scale::Steps, "steps");
            steps.on_hover_text("One colour for all between two of the times");
        });
        ui.end_row();
        let cycles = number(ui, "Cycles", "", picture.cycles, PictureTable::CYCLES);
        picture.cycles = cycles.unwrap_or(picture.cycles);
        ui.end_row();
    });
    if picture.times.len() > 2 {
        ui.label(format!("Stretched over {} intervals of time", picture.times.len() - 1));
    }
}

/// Least ratio of the end of a range to its beginning.
const APART: f64 = 1.001;
