//! What the panels' own actions do: on colours, places, exports and films.

use std::path::{Path, PathBuf};

use super::action::Action;
use super::dialog::FileDialog;
use super::export::{Export, ExportRequest};
use super::model::{AppModel, Asking};
use super::panels::colours::ColourAction;
use super::panels::export::ExportAction;
use super::panels::film::FilmAction;
use super::panels::places::PlaceAction;
use super::view_samples;
use flipmap_scene::palette::equalised;
use flipmap_scene::{PictureTable, Scale};

/// Number of steps in an equalised palette.
const EQUAL_STEPS: usize = 32;

impl AppModel {
    /// Carries out an action of the colours panel; returns the action for the map, if any.
    pub(super) fn colour(&mut self, action: ColourAction) -> Option<Action> {
        match action {
            ColourAction::Paint(picture) => Some(Action::Picture(picture)),
            ColourAction::Cycle(cycle) => Some(Action::ColourCycle(cycle)),
            ColourAction::KeepPalette(name) => {
                self.settings.palettes.insert(name, self.state.picture.palette.clone());
                None
            }
            ColourAction::ForgetPalette(name) => {
                self.settings.palettes.remove(&name);
                None
            }
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

    /// Carries out an action of the panel of places; returns the action for the map, if any.
    pub(super) fn place(&mut self, action: PlaceAction) -> Option<Action> {
        let changed = match action {
            PlaceAction::Change(form) => {
                self.forms.place = form;
                return None;
            }
            PlaceAction::Open(document) => return Some(Action::Show(document)),
            PlaceAction::Visit(document) => return Some(Action::Visit(document)),
            PlaceAction::Add(name) => {
                let picture = view_samples::picture(&self.state, &mut self.compute.explorer);
                self.places.add(&name, picture)
            }
            PlaceAction::Rename(old, new) => self.places.rename(&old, &new),
            PlaceAction::Delete(name) => self.places.delete(&name),
        };
        match changed {
            Ok(()) => self.forms.place.name = self.places.free_name(),
            Err(error) => self.state.notices.fail(format!("{error}.")),
        }
        None
    }

    /// Carries out an action of the export panel.
    pub(super) fn export(&mut self, action: ExportAction) {
        match action {
            ExportAction::Change(form) => {
                self.state.picture.samples = form.samples;
                self.state.picture.adaptive = form.adaptive;
                self.forms.export = form;
            }
            ExportAction::Browse => {
                let (ending, path) = (self.forms.export.what.ending(), &self.forms.export.path);
                let dialog = FileDialog::save(ending, path.as_ref(), self.waker());
                self.asking = Some(Asking::Export(dialog));
            }
            ExportAction::Start => {
                if let Err(problem) = self.start_export() {
                    self.state.notices.fail(problem);
                }
            }
            ExportAction::Cancel(index) => self.exports.cancel(index),
            ExportAction::Dismiss(index) => self.exports.dismiss(index),
        }
    }

    fn start_export(&mut self) -> Result<(), String> {
        let form = &self.forms.export;
        let path = PathBuf::from(&form.path);
        self.exports.check_free(&path)?;
        let (document, kind) = (self.state.document(), form.what);
        let request = ExportRequest { document, size: form.size, path, kind };
        self.exports.add(Export::start(request, self.engine_request(), self.waker()));
        Ok(())
    }

    /// Carries out an action of the film panel; returns the action for the map, if any.
    pub(super) fn film(&mut self, action: FilmAction) -> Option<Action> {
        let draft = &mut self.films.draft;
        let mut done = Ok(());
        match action {
            FilmAction::Add => draft.add(self.state.document()),
            FilmAction::Change(changed) => *draft = *changed,
            FilmAction::Preview(clock) => {
                draft.clock = clock;
                return self.films.previewed(&mut self.state);
            }
            FilmAction::Go(place) => {
                return Some(Action::Show(Box::new(draft.keys.get(place)?.scene.clone())));
            }
            FilmAction::OpenKeys => done = draft.open_keys(),
            FilmAction::SaveKeys => {
                done = draft.save_keys();
                if done.is_ok() {
                    self.state.notices.tell(format!("The keys are in {}.", draft.keys_path));
                }
            }
            FilmAction::Browse => {
                let path: &Path = self.films.draft.path.as_ref();
                self.asking = Some(Asking::Film(FileDialog::save("mp4", path, self.waker())));
            }
            FilmAction::Start => done = self.start_film(),
            FilmAction::Export(action) => self.export(action),
        }
        if let Err(problem) = done {
            self.state.notices.fail(problem);
        }
        None
    }

    fn start_film(&mut self) -> Result<(), String> {
        let request = self.films.request()?;
        self.exports.check_free(&request.path)?;
        self.exports.add(Export::start_film(request, self.engine_request(), self.waker()));
        Ok(())
    }
}
