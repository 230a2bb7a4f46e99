//! The panels at the side, one below the other.

use egui::{Align, CollapsingHeader, ScrollArea, Ui};

use super::action::Action;
use super::descent::DescentPath;
use super::model::AppModel;
use super::panels::accuracy::{Computing, accuracy_panel};
use super::panels::colours::colours_panel;
use super::panels::descent::{self, descent_panel};
use super::panels::export::export_panel;
use super::panels::film::film_panel;
use super::panels::layers::layers_panel;
use super::panels::pendulum::pendulum_panel;
use super::panels::places::places_panel;
use super::panels::scene::scene_panel;
use super::panels::view::view_panel;
use super::panels::window::window_panel;
use super::state::Dialog;
use flipmap_lab::Figure;
use flipmap_numbers::Scalar;
use flipmap_pendulum::State;

/// Headings of the panels, and other words, in lower case, for what is in them.
pub(super) const PANELS: [(&str, &str); 11] = [
    ("Pendulum of a pixel", "pins trail twin plot energy phase"),
    ("View", "centre width rotate stretch"),
    ("Places", "bookmarks scenes save this view"),
    ("Deeper", "zoom descent filament"),
    (
        "Scene",
        "question growth state first flips return chaos lyapunov mass length gravity friction \
         budget time plane section speeds rods points bob",
    ),
    ("Accuracy", "engine method tolerance gpu cpu exact balanced fast precision check"),
    ("Colours", "palette gradient relief times equalise cycles legend"),
    ("Layers", "legend grid curve trust swing borders"),
    ("Export", "save picture png screenshot image poster tiles"),
    ("Film", "video movie keyframes mp4 animation"),
    ("Window", "settings preferences theme cache edges anti-aliasing scale"),
];

/// Panels one below the other; the one with the wanted heading is opened.
struct Sections<'a> {
    ui: &'a mut Ui,
    wanted: Option<&'static str>,
}

impl Sections<'_> {
    /// Shows a panel; returns true if it is open.
    fn show(&mut self, heading: &str, open: bool, contents: impl FnOnce(&mut Ui)) -> bool {
        let wanted = self.wanted == Some(heading);
        let header = CollapsingHeader::new(heading).default_open(open);
        let shown = header.open(wanted.then_some(true)).show(self.ui, contents);
        if wanted {
            shown.header_response.scroll_to_me(Some(Align::TOP));
        }
        shown.openness > 0.0
    }
}

impl AppModel {
    /// Shows the panels and returns the user's actions in them.
    pub(super) fn side_panel(&mut self, ui: &mut Ui) -> Vec<Action> {
        self.take_answer();
        let mut actions = Vec::new();
        let wanted = self.state.shown.panel.take();
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let mut panels = Sections { ui, wanted };
            let open = !self.state.pins.is_empty();
            panels.show("Pendulum of a pixel", true, |ui| {
                actions.extend(pendulum_panel(ui, &self.state.pins).into_iter().map(Action::Pins));
                actions.extend(self.lab_buttons(ui));
            });
            panels.show("View", false, |ui| {
                let (camera, axes) = (self.state.target(), self.state.plane.axes());
                actions.extend(view_panel(ui, &mut self.forms.view, &camera, axes));
            });
            panels.show("Places", !open, |ui| {
                let done = places_panel(ui, &self.places, &self.forms.place, &mut self.thumbnails);
                actions.extend(done.into_iter().filter_map(|action| self.place(action)));
                self.recent(ui, &mut actions);
            });
            panels.show("Deeper", false, |ui| actions.extend(self.deeper_section(ui)));
            panels.show("Scene", false, |ui| {
                let changed = scene_panel(ui, &self.state.scene());
                actions.extend(changed.map(|scene| Action::Scene(Box::new(scene))));
            });
            panels.show("Accuracy", false, |ui| {
                actions.extend(accuracy_panel(ui, &self.computing()));
            });
            panels.show("Colours", false, |ui| {
                actions.extend(self.colour_section(ui));
            });
            panels.show("Layers", false, |ui| {
                actions.extend(layers_panel(ui, &self.state.layers));
            });
            let map_px = (self.state.canvas * self.state.pixels_per_point).round().as_uvec2();
            self.forms.export.follow(map_px.to_array(), &self.state.picture);
            let exporting = panels.show("Export", false, |ui| {
                let statuses = self.exports.statuses();
                for action in export_panel(ui, &self.forms.export, &statuses) {
                    self.export(action);
                }
            });
            self.forms.exporting |= exporting;
            panels.show("Film", false, |ui| actions.extend(self.film_section(ui)));
            panels.show("Window", false, |ui| {
                actions.extend(window_panel(ui, &self.state, &mut self.settings));
            });
            if self.state.shown.debug {
                panels.show("Measured", true, |ui| {
                    self.measured.iter().for_each(|line| {
                        ui.monospace(line);
                    })
                });
            }
        });
        actions
    }

    /// Shows the panel of the automatic descent.
    fn deeper_section(&mut self, ui: &mut Ui) -> Vec<Action> {
        let DescentPath { running, scenes } = &self.films.descent;
        let done = descent_panel(ui, &descent::DescentView { going: running.is_some(), scenes });
        done.into_iter().filter_map(|action| self.films.deeper(action, &self.state)).collect()
    }

    /// Shows the film panel.
    fn film_section(&mut self, ui: &mut Ui) -> Vec<Action> {
        let done = film_panel(ui, &self.films.draft, &self.exports.statuses());
        done.into_iter().filter_map(|action| self.film(action)).collect()
    }

    /// Shows the colours panel.
    fn colour_section(&mut self, ui: &mut Ui) -> Option<Action> {
        let state = &self.state;
        let any = self.compute.explorer.progress().done > 0;
        let done = colours_panel(ui, &state.picture, &state.scene(), any, &state.shown.cycle);
        done.and_then(|action| self.colour(action))
    }

    /// Shows buttons that open the selected pin's start in a figure of the laboratory.
    fn lab_buttons(&self, ui: &mut Ui) -> Vec<Action> {
        let Some(pin) = self.state.pins.selected() else { return Vec::new() };
        let angle = pin.start.angle.map(|theta| theta.wrapped().to_f64());
        let start = State { angle, speed: pin.start.launches[0].speed.map(|speed| speed.hi) };
        let mut actions = Vec::new();
        ui.horizontal_wrapped(|ui| {
            if ui.button("Whole window (F)").clicked() {
                actions.push(Action::Toggle(Dialog::Stage));
            }
            ui.label("In the lab:");
            for figure in [Figure::Machine, Figure::Integrators, Figure::Twenty] {
                if ui.button(figure.name()).on_hover_text(figure.title()).clicked() {
                    actions.push(Action::OpenInLab(figure, start));
                }
            }
        });
        actions
    }

    /// Shows the files opened last, and a button that opens another one.
    fn recent(&self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ui.separator();
        if ui.button("Open a picture or scene…").clicked() {
            actions.push(Action::AskForFile);
        }
        for path in &self.settings.recent {
            let name = std::path::Path::new(path).file_name().map(|name| name.to_string_lossy());
            let name = name.unwrap_or_else(|| path.as_str().into());
            if ui.link(format!("Open {name}")).on_hover_text(path).clicked() {
                actions.push(Action::Open(path.into()));
            }
        }
    }

    fn computing(&self) -> Computing {
        let engine = self.compute.engine();
        let rate = self.meter.rate();
        let cost_us = match self.state.integration.spec.setting {
            flipmap_engine::choice::IntegrationSetting::Accuracy(level) if rate > 0.0 => {
                vec![(level, 1e6 / rate)]
            }
            _ => Vec::new(),
        };
        Computing {
            setting: self.state.integration.spec.setting,
            kind: self.state.integration.kind,
            config: self.compute.config(),
            engine: engine.map(|(name, adapter, why)| (name.to_string(), adapter, why.to_string())),
            failed: self.compute.has_failed(),
            cost_us,
        }
    }
}
