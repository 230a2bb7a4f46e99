//! The form for exporting the view, and the progress of exports.

use std::path::Path;

use egui::{Button, ComboBox, Grid, Label, ProgressBar, RichText, TextEdit, Ui};

use super::field::number;
use super::sentence::sentence;
use crate::export::{ExportKind, ExportStage};
use flipmap_scene::{PictureTable, Sampling};

/// The next export, as entered in the form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportForm {
    /// Path of the file.
    pub path: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// True if the picture has the size of the map in the window.
    pub as_window: bool,
    /// Samples of each pixel.
    pub samples: Sampling,
    /// True if more than one sample is taken only where colours change.
    pub adaptive: bool,
    /// The content of the file.
    pub what: ExportKind,
}

impl ExportKind {
    /// All contents, each with its name and the extension of its files.
    pub(crate) const ALL: [(&'static str, &'static str, ExportKind); 2] =
        [("picture", "png", ExportKind::Png), ("raw numbers", "npy", ExportKind::Raw)];

    /// Returns the extension of the files.
    pub(crate) fn ending(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// An export, as the panel shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportStatus {
    /// Name of the file.
    pub name: String,
    /// The progress of the export.
    pub stage: ExportStage,
    /// True if it is a film, which the film panel shows.
    pub is_film: bool,
}

/// An action of the user in the panel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportAction {
    /// Changes the form to this one.
    Change(ExportForm),
    /// Lets the user choose the file in the desktop's dialog.
    Browse,
    /// Starts the export described by the form.
    Start,
    /// Cancels the export with this index.
    Cancel(usize),
    /// Removes the finished export with this index from the list.
    Dismiss(usize),
}

/// Common sizes to choose from, in pixels.
const PRESETS: [(&str, [u32; 2]); 6] = [
    ("1024 × 1024", [1024, 1024]),
    ("4096 × 4096", [4096, 4096]),
    ("1920 × 1080 (Full HD)", [1920, 1080]),
    ("2560 × 1440", [2560, 1440]),
    ("3840 × 2160 (4K)", [3840, 2160]),
    ("7680 × 4320 (8K)", [7680, 4320]),
];

impl Default for ExportForm {
    fn default() -> Self {
        ExportForm {
            path: "map.png".to_string(),
            size: [1920, 1080],
            as_window: true,
            samples: PictureTable::default().samples,
            adaptive: false,
            what: ExportKind::Png,
        }
    }
}

impl ExportForm {
    /// Takes the size of the map in pixels, unless another was chosen, and the samples of the
    /// picture that is shown.
    pub(crate) fn follow(&mut self, map_px: [u32; 2], picture: &PictureTable) {
        (self.samples, self.adaptive) = (picture.samples, picture.adaptive);
        if self.as_window {
            self.size = map_px;
        }
    }

    /// Returns the reason why the export cannot begin, as a sentence; none if it can.
    pub(crate) fn problem(&self) -> Option<String> {
        if self.path.trim().is_empty() {
            return Some("Name the file to write.".to_string());
        }
        if Path::new(&self.path).is_dir() {
            return Some("This is a folder: name a file in it.".to_string());
        }
        let (samples, adaptive) = (self.samples, self.adaptive);
        let picture = PictureTable { samples, adaptive, ..PictureTable::default() };
        picture.check_size(self.size).err().map(|error| error.to_string())
    }

    /// Returns true if the export would replace an existing file.
    pub(crate) fn replaces(&self) -> bool {
        Path::new(&self.path).is_file()
    }

    /// Returns the form for another content; an extension that fits the old content changes too.
    fn of(&self, what: ExportKind) -> Self {
        let old = format!(".{}", self.what.ending());
        let path = match self.path.strip_suffix(&old) {
            Some(stem) => format!("{stem}.{}", what.ending()),
            None => self.path.clone(),
        };
        ExportForm { path, what, ..self.clone() }
    }
}

/// Shows the form and every export; returns the user's actions.
pub fn export_panel(ui: &mut Ui, form: &ExportForm, exports: &[ExportStatus]) -> Vec<ExportAction> {
    let (mut new, mut actions) = (form.clone(), Vec::new());
    Grid::new("export").num_columns(2).show(ui, |ui| {
        kind(ui, &mut new);
        file(ui, &mut new, &mut actions);
        size(ui, &mut new);
        if new.what == ExportKind::Png {
            samples(ui, &mut new);
        }
    });
    if new != *form {
        actions.push(ExportAction::Change(new));
    }
    begin(ui, form, &mut actions);
    actions.extend(statuses(ui, exports, |export| !export.is_film));
    actions
}

/// Lets the user choose the samples of each pixel.
fn samples(ui: &mut Ui, form: &mut ExportForm) {
    let (least, most) = PictureTable::SAMPLES.into_inner();
    let range = f64::from(least)..=f64::from(most);
    let along = f64::from(form.samples.along());
    if let Some(new) = number(ui, "Anti-aliasing", " samples a side", along, range) {
        form.samples = match new.round() as u32 {
            1 => Sampling::Corners,
            along => Sampling::Square(along),
        };
    }
    ui.end_row();
    ui.label("");
    if form.samples.along() > 1 {
        ui.checkbox(&mut form.adaptive, "only where colours change");
    } else {
        let mut corners = form.samples == Sampling::Corners;
        ui.checkbox(&mut corners, "smart: finer where colours change");
        form.samples = if corners { Sampling::Corners } else { Sampling::SINGLE };
    }
    ui.end_row();
}

/// Shows the exports that `shown` accepts; returns the user's actions on them.
pub(super) fn statuses(
    ui: &mut Ui,
    exports: &[ExportStatus],
    shown: impl Fn(&ExportStatus) -> bool,
) -> Vec<ExportAction> {
    let mut actions = Vec::new();
    for (index, export) in exports.iter().enumerate().filter(|(_, export)| shown(export)) {
        ui.separator();
        ui.push_id(index, |ui| status(ui, index, export, &mut actions));
    }
    actions
}

fn kind(ui: &mut Ui, form: &mut ExportForm) {
    ui.label("Kind");
    ui.horizontal(|ui| {
        for (name, _, what) in ExportKind::ALL {
            if ui.radio(form.what == what, name).clicked() {
                *form = form.of(what);
            }
        }
    });
    ui.end_row();
}

fn file(ui: &mut Ui, form: &mut ExportForm, actions: &mut Vec<ExportAction>) {
    let label = ui.label("File");
    ui.horizontal(|ui| {
        let width = (ui.available_width() - 80.0).max(100.0);
        let field = TextEdit::singleline(&mut form.path).desired_width(width);
        ui.add(field).labelled_by(label.id);
        if ui.button("Browse…").clicked() {
            actions.push(ExportAction::Browse);
        }
    });
    ui.end_row();
    // A bare name does not show the folder of the file.
    if let (false, Ok(whole)) = (form.path.trim().is_empty(), std::path::absolute(&form.path)) {
        ui.label("");
        ui.add(Label::new(RichText::new(whole.display().to_string()).weak().small()).wrap());
        ui.end_row();
    }
}

/// Words for the size of the map in the window.
const AS_WINDOW: &str = "as the window";

fn size(ui: &mut Ui, form: &mut ExportForm) {
    let label = ui.label("Size");
    let shown = PRESETS.iter().find(|(_, size)| *size == form.size);
    let shown = match form.as_window {
        true => AS_WINDOW,
        false => shown.map_or("other", |(name, _)| *name),
    };
    let combo = ComboBox::from_id_salt("size").selected_text(shown).show_ui(ui, |ui| {
        ui.selectable_value(&mut form.as_window, true, AS_WINDOW);
        for (name, size) in PRESETS {
            if ui.selectable_label(!form.as_window && form.size == size, name).clicked() {
                (form.size, form.as_window) = (size, false);
            }
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
    let longest = f64::from(PictureTable::MAX_SIDE);
    for (name, side) in ["Width", "Height"].into_iter().zip(&mut form.size) {
        if let Some(new) = number(ui, name, " px", f64::from(*side), 1.0..=longest) {
            *side = new.round() as u32;
            form.as_window = false;
        }
        ui.end_row();
    }
}

fn begin(ui: &mut Ui, form: &ExportForm, actions: &mut Vec<ExportAction>) {
    let problem = form.problem();
    let name = if form.replaces() { "Export and replace the file" } else { "Export" };
    if ui.add_enabled(problem.is_none(), Button::new(name)).clicked() {
        actions.push(ExportAction::Start);
    }
    if let Some(problem) = problem {
        let colour = ui.visuals().text_color();
        ui.label(sentence(ui, &problem, colour));
    }
}

fn status(ui: &mut Ui, index: usize, export: &ExportStatus, actions: &mut Vec<ExportAction>) {
    let name = &export.name;
    ui.label(name);
    match &export.stage {
        ExportStage::Starting(what) => ui.label(format!("{what}…")),
        ExportStage::Running { share, pace } => {
            let text = format!("{:.0} %, {pace}", share * 100.0);
            ui.add(ProgressBar::new(*share as f32).text(text))
        }
        ExportStage::Done { secs } => ui.label(format!("Done in {secs:.1} s")),
        ExportStage::Cancelled { resumes: false } => ui.label("Stopped; no file was left"),
        ExportStage::Cancelled { resumes: true } => {
            ui.label("Stopped; filmed again, it continues where it stopped")
        }
        ExportStage::Failed(why) => ui.label(format!("Not exported: {why}")),
    };
    let (button, action) = match export.stage {
        ExportStage::Starting(_) | ExportStage::Running { .. } => {
            ("Stop", ExportAction::Cancel(index))
        }
        _ => ("Dismiss", ExportAction::Dismiss(index)),
    };
    let response = ui.button(button);
    response.widget_info(|| {
        egui::WidgetInfo::labeled(egui::Role::Button, true, format!("{button} {name}"))
    });
    if response.clicked() {
        actions.push(action);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_kind_takes_its_ending_along() {
        let form = ExportForm::default();
        assert_eq!(form.of(ExportKind::Raw).path, "map.npy");
        assert_eq!(form.of(ExportKind::Raw).of(ExportKind::Png), form);
        let own = ExportForm { path: "map".to_string(), ..form };
        assert_eq!(own.of(ExportKind::Raw).path, "map");
        for (place, (_, _, what)) in ExportKind::ALL.into_iter().enumerate() {
            assert_eq!(what as usize, place);
        }
    }

    #[test]
    fn what_cannot_begin_says_why() {
        let folder = tempfile::tempdir().unwrap();
        let form = |path: &Path, size| ExportForm {
            path: path.display().to_string(),
            size,
            ..ExportForm::default()
        };
        let map = folder.path().join("map.png");
        assert_eq!(form(&map, [10, 10]).problem(), None);
        assert!(form(folder.path(), [10, 10]).problem().unwrap().contains("folder"));
        assert!(form(Path::new(" "), [10, 10]).problem().unwrap().contains("Name"));
        assert!(form(&map, [0, 10]).problem().unwrap().contains("0x10"));
        assert!(!form(&map, [10, 10]).replaces());
        std::fs::write(&map, "").unwrap();
        assert!(form(&map, [10, 10]).replaces());
    }

    #[test]
    fn the_size_is_that_of_the_window_until_another_is_chosen() {
        let mut form = ExportForm::default();
        let samples = Sampling::Square(3);
        let fine = PictureTable { samples, adaptive: true, ..PictureTable::default() };
        form.follow([970, 776], &fine);
        assert_eq!((form.size, form.samples, form.adaptive), ([970, 776], samples, true));
        form.as_window = false;
        form.follow([640, 480], &PictureTable::default());
        assert_eq!(
            (form.size, form.samples, form.adaptive),
            ([970, 776], Sampling::Corners, false)
        );
    }
}
