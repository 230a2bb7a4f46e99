//! The effects of actions beyond the plain state: on files, flights and engines.

use std::sync::Arc;

use super::action::Action;
use super::dialog::{DialogAnswer, FileDialog};
use super::export::{Export, ExportKind, ExportRequest};
use super::model::{AppModel, Asking};
use super::panels::colours::ColourAction;
use super::panels::export::{ExportAction, ExportSubject};
use super::panels::places::PlaceAction;
use super::pin_start::PinStart;
use super::state::Effect;
use super::view_samples;
use flipmap_numbers::Exact;
use flipmap_render::output::Picture;
use flipmap_scene::palette::{AnswerColours, equalised};
use flipmap_scene::{PictureTable, Scale};

const NO_DIALOG: &str = "The desktop has no file dialog (no portal answers): type a path under \
                         Export, or drop a file on the window.";

/// Number of steps in an equalised palette.
const EQUAL_STEPS: usize = 32;

impl AppModel {
    /// Applies actions in order and returns the effects that only the window can carry out.
    pub(super) fn act(&mut self, actions: Vec<Action>) -> Vec<Effect> {
        for action in &actions {
            self.stop_descent_for(action);
            self.pause_film_for(action);
        }
        let actions: Vec<Action> =
            actions.into_iter().map(|action| self.in_place(action)).collect();
        let effects: Vec<Effect> =
            actions.into_iter().filter_map(|action| self.state.apply(action)).collect();
        effects.into_iter().filter_map(|effect| self.perform(effect)).collect()
    }

    /// Carries out an effect, or returns it if only the window can.
    pub(super) fn perform(&mut self, effect: Effect) -> Option<Effect> {
        match effect {
            Effect::Pin(places) => self.pin(*places),
            Effect::GoDeeper => self.toggle_descent(),
            Effect::Lab(figure) => self.show_figure(figure),
            Effect::InLab(action) => self.in_lab(action),
            Effect::OpenInLab(figure, start) => self.open_in_lab(figure, start),
            Effect::FromLab(start) => self.aimed_in_lab(start),
            Effect::Favourite(digit) => self.show_favourite(digit),
            Effect::KeepFavourite(digit) => self.keep_favourite(digit),
            Effect::Relaunch => self.relaunch(),
            Effect::Reopen => {
                self.reopen();
                self.relaunch();
            }
            Effect::Open(path) => self.open(&path),
            Effect::AskForFile => {
                let wake = Arc::clone(&self.wake);
                self.asking = Some(Asking::Open(FileDialog::open(move || wake())));
            }
            other => return Some(other),
        }
        None
    }

    /// Opens the engine that the state asks for.
    fn reopen(&mut self) {
        self.request = self.engine_request();
        self.compute.reopen(self.request.clone());
    }

    /// Relaunches the pins' flights if the physics has changed; otherwise they continue. Opens
    /// another engine if the question needs one.
    fn relaunch(&mut self) {
        let wanted = self.engine_request();
        let outgrown = self.compute.config().is_some_and(|config| wanted.outgrows(&config));
        if wanted.kind != self.request.kind || outgrown {
            self.reopen();
        }
        let wake = Arc::clone(&self.wake);
        self.state.pins.relaunch(&self.state.scene(), move || wake());
    }

    fn pin(&mut self, places: [[Exact; 2]; 2]) {
        let scene = self.state.scene();
        let Some(start) = PinStart::on_plane(&scene, self.state.camera.reach, places) else {
            self.state.notices.tell("No pendulum has the section's energy here.");
            return;
        };
        let told = self.told_at(places[0]);
        let wake = Arc::clone(&self.wake);
        match self.state.pins.add(start, told, move || wake()) {
            Ok(id) => {
                self.state.pins.clicked = Some(id);
                self.state.shown.side = true;
            }
            Err(error) => self.state.notices.fail(format!("{error}.")),
        }
    }

    /// Takes the answer of the open file dialog, if there is one.
    pub(super) fn take_answer(&mut self) {
        let answer = match &self.asking {
            Some(Asking::Open(dialog) | Asking::Export(dialog) | Asking::Film(dialog)) => {
                dialog.poll()
            }
            None => None,
        };
        let Some(answer) = answer else { return };
        match (self.asking.take(), answer) {
            (Some(Asking::Open(_)), DialogAnswer::File(path)) => self.open(&path),
            (Some(Asking::Export(_)), DialogAnswer::File(path)) => {
                self.forms.export.path = path.display().to_string();
            }
            (Some(Asking::Film(_)), DialogAnswer::File(path)) => {
                self.films.draft.path = path.display().to_string();
            }
            (_, DialogAnswer::Missing) => self.state.notices.fail(NO_DIALOG),
            _ => {}
        }
    }

    pub(super) fn colour(&mut self, action: ColourAction) -> Option<Action> {
        match action {
            ColourAction::Paint(picture) => Some(Action::Picture(picture)),
            ColourAction::Cycle(cycle) => Some(Action::ColourCycle(cycle)),
            ColourAction::Equalise => {
                let screen = self.state.screen();
                let times = view_samples::known_times(&screen, &mut self.compute.explorer);
                let times = equalised(times.into_iter(), EQUAL_STEPS);
                if times.len() < 2 {
                    self.state.notices.tell("Too few flips are in view to spread colours over.");
                    return None;
                }
                let picture = self.state.picture.clone();
                Some(Action::Picture(PictureTable { times, scale: Scale::Log, ..picture }))
            }
        }
    }

    pub(super) fn place(&mut self, action: PlaceAction) -> Option<Action> {
        let changed = match action {
            PlaceAction::Change(form) => {
                self.forms.place = form;
                return None;
            }
            PlaceAction::Open(document) => return Some(Action::Show(document)),
            PlaceAction::Add(name) => self.keep_place(&name),
            PlaceAction::Rename(old, new) => self.places.rename(&old, &new),
            PlaceAction::Delete(name) => self.places.delete(&name),
        };
        match changed {
            Ok(()) => self.forms.place.name = self.places.free_name(),
            Err(error) => self.state.notices.fail(format!("{error}.")),
        }
        None
    }

    fn keep_place(&mut self, name: &str) -> Result<(), super::places::PlaceError> {
        let document = self.state.document();
        let (screen, scene) = (self.state.screen(), document.scene());
        let colours = AnswerColours::new(&scene, &document.picture).ok();
        let explorer = &mut self.compute.explorer;
        let rgb = colours.map(|colours| view_samples::thumbnail(&screen, explorer, &colours));
        let size = view_samples::THUMBNAIL;
        let rgb = rgb.unwrap_or_else(|| vec![0x80; (3 * size[0] * size[1]) as usize]);
        self.places.add(name, Picture { document, size, rgb })
    }

    pub(super) fn export(&mut self, action: ExportAction) {
        match action {
            ExportAction::Change(form) => {
                self.state.picture.samples = form.samples;
                self.state.picture.adaptive = form.adaptive;
                self.forms.export = form;
            }
            ExportAction::Browse => {
                let (ending, path) = (self.forms.export.what.ending(), &self.forms.export.path);
                let wake = Arc::clone(&self.wake);
                let dialog = FileDialog::save(ending, path.as_ref(), move || wake());
                self.asking = Some(Asking::Export(dialog));
            }
            ExportAction::Start => self.start_export(),
            ExportAction::Cancel(index) => {
                if let Some(export) = self.exports.get(index) {
                    export.cancel();
                }
            }
            ExportAction::Dismiss(index) => {
                if index < self.exports.len() {
                    self.exports.remove(index);
                }
            }
        }
    }

    fn start_export(&mut self) {
        let form = self.forms.export.clone();
        let (document, path) = (self.state.document(), std::path::PathBuf::from(&form.path));
        if self.is_busy(&path) {
            return;
        }
        let kind = match form.what {
            ExportSubject::Png => ExportKind::Png,
            ExportSubject::Raw => ExportKind::Raw,
        };
        let request = ExportRequest { document, size: form.size, path, kind };
        let wake = Arc::clone(&self.wake);
        self.exports.push(Export::start(request, self.engine_request(), move || wake()));
    }

    /// Returns true, and tells the user, if an export is already writing the file.
    pub(super) fn is_busy(&mut self, path: &std::path::Path) -> bool {
        let busy = self.exports.iter().any(|export| export.will_write(path));
        if busy {
            let why = "is being exported already; wait for it, or choose another name";
            self.state.notices.fail(format!("{} {why}.", path.display()));
        }
        busy
    }
}
