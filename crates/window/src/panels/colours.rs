//! The mapping of answers to colours, with a legend. Changing it recomputes nothing.

use std::collections::BTreeMap;

use egui::{Button, ComboBox, Grid, Role, Slider, TextEdit, Ui, WidgetInfo};

use super::colour_strip::{legend, strip};
use super::field::number;
use super::gradient_strip::{BARS, gradient_strip};
use super::ground::grounds;
use crate::colour_cycle::{CYCLE_SPEEDS, ColourCycle};
use crate::histogram::bars;
use flipmap_scene::palette::gradient_file::ENDINGS;
use flipmap_scene::palette::{AnswerColours, Palette, Tones, random_palette};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{PictureTable, Scale, Scene};

/// An action of the user on the colours.
#[derive(Clone, Debug, PartialEq)]
pub enum ColourAction {
    /// Paints the map with these picture settings.
    Paint(PictureTable),
    /// Spreads the palette over the times in view.
    Equalise,
    /// Starts, changes or stops the animation of the palette.
    Cycle(ColourCycle),
    /// Keeps the palette of the map under a name.
    KeepPalette(String),
    /// Removes the palette with this name from the list of kept ones.
    ForgetPalette(String),
}

/// What the colours panel shows.
#[derive(Clone, Copy, Debug)]
pub struct ColoursView<'a> {
    /// How the map is painted.
    pub picture: &'a PictureTable,
    /// What is painted.
    pub scene: &'a Scene,
    /// True if the view has samples to spread the palette over.
    pub has_samples: bool,
    /// Animation of the palette.
    pub cycle: &'a ColourCycle,
    /// Flip times in s at evenly spaced places of the view.
    pub times_secs: &'a [f64],
    /// Palettes that the user has kept, by name.
    pub kept: &'a BTreeMap<String, String>,
}

/// Shows how a map is painted; returns what the user changes.
pub fn colours_panel(ui: &mut Ui, view: &ColoursView) -> Option<ColourAction> {
    let ColoursView { picture, scene, .. } = *view;
    let (unit_secs, question) = (scene.build.unit_secs(), &scene.question);
    let (Ok(colours), Ok(tones)) =
        (AnswerColours::new(scene, picture), Tones::new(picture, unit_secs, question.budget.secs))
    else {
        return back(ui, picture);
    };
    let mut new = picture.clone();
    legend(ui, &colours, (question.ask, &picture.palette), false);
    if question.ask.kind().channels.len() > 1 {
        channels(ui, &mut new, question.ask);
    }
    ui.separator();
    palettes(ui, &mut new, view.kept);
    let of_times = if question.ask.is_time() { view.times_secs } else { &[] };
    gradient_strip(ui, &mut new, &bars(of_times, &tones, BARS));
    let mut action = keeping(ui, picture, view.kept);
    grounds(ui, &mut new.colours, colours.ground());
    ui.checkbox(&mut new.denoise, "Smooth the grain of chaos").on_hover_text(
        "Where neighbouring pixels are unrelated, each shows the mean of those along its band",
    );
    if question.ask.is_time() {
        ui.separator();
        range(ui, &mut new, &tones);
        repeats(ui, &mut new, picture);
        action = animated(ui, view.has_samples, view.cycle).or(action);
    }
    if colours.times().is_some() {
        ui.separator();
        relief(ui, &mut new);
    }
    let paint = || (new != *picture && new.check().is_ok()).then_some(ColourAction::Paint(new));
    back(ui, picture).or(action).or_else(paint)
}

/// Shows a button that restores the default colours; the energy curve and the samples stay.
fn back(ui: &mut Ui, picture: &PictureTable) -> Option<ColourAction> {
    let PictureTable { curve, samples, bits, .. } = *picture;
    let plain = PictureTable { curve, samples, bits, ..PictureTable::default() };
    let button = ui.add_enabled(*picture != plain, Button::new("Reset"));
    button.clicked().then_some(ColourAction::Paint(plain))
}

/// Shows the choice of the channel that is painted.
fn channels(ui: &mut Ui, picture: &mut PictureTable, ask: QuestionName) {
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

/// Shows the list of palettes, those of the user's own last.
fn palettes(ui: &mut Ui, picture: &mut PictureTable, kept: &BTreeMap<String, String>) {
    let built_in = Palette::names().map(|name| (name, name));
    let kept = kept.iter().map(|(name, text)| (name.as_str(), text.as_str()));
    let mut listed: Vec<(String, String)> =
        built_in.chain(kept).map(|(name, text)| (name.to_string(), text.to_string())).collect();
    if !listed.iter().any(|(_, text)| *text == picture.palette) {
        // The user's own gradient or a random palette, while it is in use.
        let name = Palette::named(&picture.palette).map_or("", |palette| palette.name);
        listed.push((name.to_string(), picture.palette.clone()));
    }
    let strip_width = (0.5 * ui.available_width() - NAME_WIDTH).max(0.0);
    Grid::new("palettes").num_columns(4).show(ui, |ui| {
        for pair in listed.chunks(2) {
            for (name, text) in pair {
                let Ok(palette) = Palette::named(text) else { continue };
                ui.radio_value(&mut picture.palette, text.clone(), name);
                ui.allocate_ui(egui::vec2(strip_width, 14.0), |ui| {
                    let response = strip(ui, 14.0, |share| palette.colour(share));
                    let told = format!("Colours of {name}");
                    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &told));
                });
            }
            ui.end_row();
        }
    });
    let die = ui.button("Random palette");
    if die.on_hover_text("Every press draws another one; the scene keeps its number").clicked() {
        picture.palette = any_palette();
    }
    ui.label(format!("Drop a gradient on the window: .{}.", ENDINGS.join(", .")));
    ui.checkbox(&mut picture.reverse, "Reverse the palette");
}

/// Shows the field and the button that keep a palette of the user's own under a name, or the button
/// that removes it from the list.
fn keeping(
    ui: &mut Ui,
    picture: &PictureTable,
    kept: &BTreeMap<String, String>,
) -> Option<ColourAction> {
    let palette = &picture.palette;
    if Palette::names().any(|name| name == palette) {
        return None;
    }
    if let Some((name, _)) = kept.iter().find(|(_, text)| *text == palette) {
        let forget = ui.button(format!("Remove {name} from the list"));
        return forget.clicked().then(|| ColourAction::ForgetPalette(name.clone()));
    }
    let typed = ui.scope_id().with("palette's name");
    let mut name: String = ui.data(|data| data.get_temp(typed)).unwrap_or_default();
    let keep = ui.horizontal(|ui| {
        let label = ui.label("Save as");
        let field = TextEdit::singleline(&mut name).desired_width(120.0).char_limit(MAX_NAME);
        ui.add(field).labelled_by(label.id);
        let is_taken = kept.contains_key(name.trim()) || Palette::named(name.trim()).is_ok();
        let button = ui.add_enabled(!name.trim().is_empty() && !is_taken, Button::new("Save"));
        let why = if is_taken { "Another palette has this name" } else { "Type a name first" };
        button
            .on_hover_text("Adds it to the list of palettes")
            .on_disabled_hover_text(why)
            .clicked()
    });
    let chosen = name.trim().to_string();
    ui.data_mut(|data| data.insert_temp(typed, name));
    keep.inner.then_some(ColourAction::KeepPalette(chosen))
}

/// Largest number of letters of a palette's name.
const MAX_NAME: usize = 24;

/// Width of a palette's name with its button, and of the gaps beside them, in points.
const NAME_WIDTH: f32 = 88.0;

/// Returns the name of a random palette, with a number that is short enough to read out.
pub(crate) fn any_palette() -> String {
    random_palette(fastrand::u32(1..10_000))
}

/// Shows the offset and the mirroring of the palette. Mirroring is turned on when the palette
/// begins to repeat, unless the palette is cyclic.
fn repeats(ui: &mut Ui, new: &mut PictureTable, old: &PictureTable) {
    if old.cycles == 1.0 && new.cycles > 1.0 {
        new.mirror = !Palette::is_cyclic(&new.palette);
    }
    ui.horizontal(|ui| {
        let name = ui.label("Offset");
        ui.spacing_mut().slider_width = 90.0;
        ui.add(Slider::new(&mut new.offset, PictureTable::OFFSETS).max_decimals(3))
            .labelled_by(name.id);
        ui.checkbox(&mut new.mirror, "Mirrored")
            .on_hover_text("Every second run through the palette goes backwards: no seam");
    });
}

/// Shows the button that equalises the palette to the view, and the controls of the animation.
fn animated(ui: &mut Ui, has_samples: bool, cycle: &ColourCycle) -> Option<ColourAction> {
    let spread = ui.add_enabled(has_samples, Button::new("Equalise to this view"));
    if spread.on_hover_text("Every colour is seen equally often").clicked() {
        return Some(ColourAction::Equalise);
    }
    let mut new = *cycle;
    ui.horizontal(|ui| {
        ui.checkbox(&mut new.runs, "Cycle colours");
        let name = ui.label("Speed");
        ui.spacing_mut().slider_width = 70.0;
        let speed = Slider::new(&mut new.speed, CYCLE_SPEEDS).logarithmic(true).show_value(false);
        ui.add(speed).labelled_by(name.id);
    });
    (new != *cycle).then_some(ColourAction::Cycle(new))
}

/// Shows the controls of the light from the side.
fn relief(ui: &mut Ui, picture: &mut PictureTable) {
    Grid::new("relief").num_columns(2).show(ui, |ui| {
        ui.spacing_mut().slider_width = 120.0;
        let name = ui.label("Relief");
        ui.add(Slider::new(&mut picture.relief, PictureTable::RELIEFS).max_decimals(2))
            .labelled_by(name.id)
            .on_hover_text("Light from the side on a landscape whose height is the time");
        ui.end_row();
        let name = ui.label("Light from");
        let light = Slider::new(&mut picture.light, 0.0..=360.0).suffix("°").max_decimals(0);
        ui.add_enabled(picture.relief > 0.0, light)
            .labelled_by(name.id)
            .on_hover_text("Anticlockwise from the right");
        ui.end_row();
    });
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
