//! What each action does: the model passes it to the components that it concerns.

use std::path::Path;
use std::sync::Arc;

use super::action::{Action, Look};
use super::dialog::{DialogAnswer, FileDialog};
use super::integration::Integration;
use super::model::{AppModel, Asking};
use super::settings::Settings;
use super::state::{AppState, Effect};
use flipmap_engine::choice::EngineRequest;
use flipmap_engine::run_settings::RunSpec;
use flipmap_numbers::Exact;
use flipmap_render::output::{read_document, read_gradient};
use flipmap_scene::PictureTable;
use flipmap_screen::pin_start::PinStart;

const NO_DIALOG: &str = "The desktop has no file dialog (no portal answers)";

impl AppModel {
    /// Carries out actions in order and returns the effects that only the window can have.
    pub fn act(&mut self, actions: Vec<Action>) -> Vec<Effect> {
        actions.into_iter().filter_map(|action| self.carry_out(action)).collect()
    }

    fn carry_out(&mut self, action: Action) -> Option<Effect> {
        if self.steers_dive(&action) {
            return None;
        }
        self.films.give_way_to(&action, &mut self.state);
        self.state.shown.greeting &= !action.is_of_map();
        let shown = || Box::new(self.state.as_drawn());
        match action {
            Action::SavePicture => {
                let beside: &Path = self.forms.export.path.as_ref();
                let path = self.saved_pictures.next_path(beside, "flipmap", "png");
                Some(Effect::SavePicture(shown(), path))
            }
            Action::CopyPicture => Some(Effect::CopyPicture(shown())),
            Action::CopyLocation => Some(Effect::Copy(self.state.copied_location())),
            Action::CopyLink => Some(Effect::Copy(self.state.copied_link())),
            Action::CopySetUp => {
                self.state.notices.tell("The set-up was copied: paste it anywhere, or here.");
                Some(Effect::Copy(self.lab.set_up_text()))
            }
            Action::FullScreen => Some(Effect::FullScreen),
            #[cfg(feature = "rigs")]
            Action::LoseDevice => Some(Effect::LoseDevice),
            Action::Quit => self.quit(),
            Action::Wheel(factor, about) => {
                let zoom = self.wheel(factor, about);
                self.carry_out(zoom)
            }
            action => {
                self.change(action);
                None
            }
        }
    }

    /// Carries out an action that has no effect outside the model.
    fn change(&mut self, action: Action) {
        let state = &mut self.state;
        match action {
            Action::Look(look) => self.look(look),
            Action::Hover(point) => state.pointer = point,
            Action::Drawing(drawing) => state.drawing = drawing,
            Action::GoDeeper => self.films.toggle_descent(state, &self.request, &self.wake),
            Action::Lab(figure) => self.show_figure(figure),
            Action::InLab(action) => self.in_lab(action),
            Action::OpenInLab(figure, start) => self.open_in_lab(figure, start),
            Action::FromLab(start) => self.aimed_in_lab(start),
            Action::Pin(point) => self.pin(self.state.pixel_at(point)),
            Action::HoldPin(pin) => state.pins.held = pin,
            Action::MovePin(point) => self.move_pin(point),
            Action::Unpin => state.take_back_pin(),
            Action::Pins(action) => state.pins.apply(action),
            Action::PlayPause => self.play_or_pause(),
            Action::Scene(scene) => {
                state.ask(&scene);
                self.follow(false);
            }
            Action::Picture(picture) => state.paint(picture),
            Action::Light(point) => state.light_from(point),
            Action::ColourCycle(cycle) => state.shown.cycle = cycle,
            Action::Favourite(digit) => state.show_favourite(digit, &self.settings),
            Action::KeepFavourite(digit) => state.keep_favourite(digit, &mut self.settings),
            Action::Timeline(clock) => state.set_timeline(clock),
            Action::Accuracy(level) => self.compute_with(|how| how.spec = RunSpec::of_level(level)),
            Action::Engine(kind) => self.compute_with(|how| how.kind = kind),
            Action::TryAgain => self.follow(true),
            Action::Layers(layers) => state.layers = layers,
            Action::Panel(name) => state.open_panel(name),
            Action::Section(section) => state.choose_section(section),
            Action::Toggle(dialog) => state.toggle(dialog),
            Action::Escape => self.escape(),
            Action::Show(document) => self.go_to(|state| state.show(&document)),
            Action::Visit(document) => self.go_to(|state| state.visit(*document)),
            Action::Open(path) => self.open(&path),
            Action::AskForFile => self.asking = Some(Asking::Open(FileDialog::open(self.waker()))),
            Action::Paste(text) => self.paste(&text),
            Action::Find(angle) => state.find(angle),
            Action::HoldNotices => state.notices.hold(),
            Action::Dismiss(id) => state.notices.dismiss(id),
            Action::UiScale(scale) => state.look.ui_scale = Settings::within_ui_scales(scale),
            Action::Theme(theme) => state.look.theme = theme,
            Action::Animate(animate) => state.look.animate = animate,
            Action::Edges(edges) => state.look.edges = edges,
            // What the window itself does was taken out before.
            Action::SavePicture
            | Action::CopyPicture
            | Action::CopyLocation
            | Action::CopyLink
            | Action::CopySetUp
            | Action::FullScreen
            | Action::Wheel(..)
            | Action::Quit => {}
            #[cfg(feature = "rigs")]
            Action::LoseDevice => {}
        }
    }

    /// Goes somewhere, and opens the engine that `go` asks for by returning true.
    pub(super) fn go_to(&mut self, go: impl FnOnce(&mut AppState) -> bool) {
        let reopens = go(&mut self.state);
        self.follow(reopens);
    }

    /// Lets the wheel and the space bar steer a dive instead of the map; returns true if they did.
    fn steers_dive(&mut self, action: &Action) -> bool {
        match action {
            Action::Look(Look::Zoom { factor, .. }) | Action::Wheel(factor, _) => {
                self.films.quicken_dive(&mut self.state, *factor)
            }
            Action::PlayPause => self.films.pause_dive(&mut self.state),
            _ => false,
        }
    }

    /// Carries out a movement of the view. Through the history, the question or a favourite may
    /// change with it.
    fn look(&mut self, look: Look) {
        if look == Look::Back && self.state.bring_back_favourite(&mut self.settings) {
            return;
        }
        self.state.look(look);
        if matches!(look, Look::Back | Look::Forward) {
            self.state.restore_pins(self.waker());
            self.follow(false);
        }
    }

    /// Changes how pixels are computed, and opens the engine for it.
    fn compute_with(&mut self, change: impl FnOnce(&mut Integration)) {
        change(&mut self.state.integration);
        self.follow(true);
    }

    /// Follows a change of what is computed: opens another engine if `reopens` is true or the
    /// question needs one, and relaunches the pins' flights if the physics has changed.
    pub(super) fn follow(&mut self, reopens: bool) {
        let wanted = self.engine_request();
        let outgrown = self.compute.config().is_some_and(|config| wanted.outgrows(&config));
        if reopens || wanted.kind != self.request.kind || outgrown {
            self.request = wanted;
            self.compute.reopen(self.request.clone());
        }
        self.state.pins.relaunch(&self.state.scene(), self.waker());
    }

    /// Returns the request for the engine that answers what the state asks.
    pub(super) fn engine_request(&self) -> EngineRequest {
        self.state.engine_request(&self.request, self.compute.config())
    }

    /// Returns a function that wakes the window from any thread.
    pub(super) fn waker(&self) -> impl Fn() + Clone + Send + Sync + use<> {
        let wake = Arc::clone(&self.wake);
        move || wake()
    }

    /// Pins the pixel at the first of these places of the lattice; the second is its neighbour's.
    pub(super) fn pin(&mut self, places: [[Exact; 2]; 2]) {
        // If nothing is pinned, a second click has nothing to take back.
        self.state.pins.clicked = None;
        let scene = self.state.scene();
        let Some(start) = PinStart::on_plane(&scene, self.state.camera.reach, places) else {
            self.state.notices.tell("No pendulum has the section's energy here.");
            return;
        };
        let told = self.state.told_at(&mut self.compute.explorer, places[0]);
        let wake = self.waker();
        match self.state.pins.add(start, told, wake) {
            Ok(id) => {
                self.state.pins.clicked = Some(id);
            }
            Err(error) => self.state.notices.fail(format!("{error}.")),
        }
    }

    /// Shows a file: a picture written by this program, a scene, or a gradient as the palette.
    fn open(&mut self, path: &Path) {
        if let Some(gradient) = read_gradient(path) {
            match gradient {
                Ok(palette) => {
                    self.state.picture = PictureTable { palette, ..self.state.picture.clone() };
                }
                Err(error) => self.state.notices.fail(format!("{error}.")),
            }
            return;
        }
        match read_document(path) {
            Ok(document) => {
                self.settings.remember(path);
                self.carry_out(Action::Show(Box::new(document)));
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
            (Some(asking), DialogAnswer::Missing) => {
                let instead = asking.instead();
                self.state.notices.fail(format!("{NO_DIALOG}: {instead}."));
            }
            _ => {}
        }
    }
}
