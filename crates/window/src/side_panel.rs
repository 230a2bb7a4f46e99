//! The side panel: the rail, and beside it the panels of one section.

use egui::{Align, ScrollArea, TextureHandle, Ui};

use super::action::Action;
use super::descent::DescentPath;
use super::model::AppModel;
use super::panels::accuracy::{Computing, accuracy_panel};
use super::panels::colours::{ColoursView, colours_panel};
use super::panels::descent::{self, descent_panel};
use super::panels::export::export_panel;
use super::panels::film::film_panel;
use super::panels::layers::layers_panel;
use super::panels::places::places_panel;
use super::panels::question_tiles;
use super::panels::rail::{RAIL_POINTS, rail};
use super::panels::scene::scene_panel;
use super::panels::view::view_panel;
use super::panels::window::window_panel;
use super::sections::Section;
use flipmap_lab::Figure;
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Document, PictureTable, Scene};

/// Width of the panels beside the rail in points, whatever they show.
const PANEL_POINTS: f32 = 310.0;
/// Width in points below which the panels lie over the map, which keeps its size.
const DRAWER_BELOW: f32 = 700.0;
/// Least width in points of the map that a drawer leaves uncovered.
const UNCOVERED: f32 = 60.0;

/// Panels one below the other, each under its heading.
struct Sections<'a> {
    ui: &'a mut Ui,
    wanted: Option<&'static str>,
    is_first: bool,
}

impl Sections<'_> {
    /// Shows a panel, and scrolls to it if it is wanted.
    fn show<T>(&mut self, name: &'static str, contents: impl FnOnce(&mut Ui) -> T) -> T {
        if !std::mem::take(&mut self.is_first) {
            self.ui.add_space(8.0);
            self.ui.separator();
        }
        let heading = self.ui.strong(name);
        if self.wanted == Some(name) {
            heading.scroll_to_me(Some(Align::TOP));
        }
        self.ui.add_space(4.0);
        self.ui.push_id(name, contents).inner
    }
}

impl AppModel {
    /// Shows the rail, and the open section beside it; in a narrow window the section lies over the
    /// map. Returns the user's actions.
    pub(super) fn side(&mut self, ui: &mut Ui) -> Vec<Action> {
        self.take_answer();
        let width = ui.available_width();
        let open = self.state.shown.section;
        let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(2);
        let bar = egui::Panel::right("rail").resizable(false).exact_size(RAIL_POINTS).frame(frame);
        let mut actions: Vec<Action> =
            bar.show(ui, |ui| rail(ui, open)).inner.into_iter().collect();
        let Some(section) = open else { return actions };
        if width >= DRAWER_BELOW {
            let side = egui::Panel::right("side").resizable(false).exact_size(PANEL_POINTS);
            side.show(ui, |ui| actions.extend(self.section(ui, section)));
        } else {
            actions.extend(self.drawer(ui, section));
        }
        actions
    }

    /// Shows a section over the right part of the map.
    fn drawer(&mut self, ui: &Ui, section: Section) -> Vec<Action> {
        let rest = ui.available_rect_before_wrap();
        let frame = egui::Frame::side_top_panel(ui.style()).inner_margin(8);
        let width = PANEL_POINTS.min(rest.width() - UNCOVERED).max(1.0);
        self.forms.drawer_points = width;
        let size = egui::vec2(width, rest.height());
        let area = egui::Area::new(egui::Id::unique("drawer"));
        let corner = rest.right_top() - egui::vec2(width, 0.0);
        let shown = area.fixed_pos(corner).show(ui.ctx(), |ui| {
            frame
                .show(ui, |ui| {
                    ui.set_max_size((size - egui::vec2(16.0, 16.0)).max(egui::Vec2::ZERO));
                    ui.set_min_size(ui.max_rect().size());
                    self.section(ui, section)
                })
                .inner
        });
        shown.inner
    }

    /// Shows the panels of a section.
    fn section(&mut self, ui: &mut Ui, section: Section) -> Vec<Action> {
        let mut actions = Vec::new();
        let wanted = self.state.shown.panel.take();
        ui.heading(section.name());
        ui.add_space(4.0);
        let area = ScrollArea::vertical().id_salt(section.name()).auto_shrink(false);
        area.show(ui, |ui| {
            let mut panels = Sections { ui, wanted, is_first: true };
            match section {
                Section::Explore => self.explore(&mut panels, &mut actions),
                Section::Scene => self.pendulum_and_question(&mut panels, &mut actions),
                Section::Colours => self.colours_and_layers(&mut panels, &mut actions),
                Section::Film => self.files(&mut panels, &mut actions),
                Section::Lab => actions.extend(panels.show("Figures", figures)),
                Section::Settings => self.preferences(&mut panels, &mut actions),
            }
            self.follow_focus(ui);
        });
        actions
    }

    /// Scrolls to the control that the keyboard has just reached.
    fn follow_focus(&mut self, ui: &Ui) {
        let focused = ui.memory(|memory| memory.focused());
        if std::mem::replace(&mut self.forms.focused, focused) == focused {
            return;
        }
        let reached = focused.and_then(|id| ui.ctx().read_response(id));
        if let Some(control) = reached.filter(|control| control.layer_id == ui.layer_id()) {
            ui.scroll_to_rect(control.rect.expand(8.0), None);
        }
    }

    fn explore(&mut self, panels: &mut Sections, actions: &mut Vec<Action>) {
        actions.extend(panels.show("Where you are", |ui| self.whereabouts(ui)));
        actions.extend(panels.show("Find", |ui| self.finds_panel(ui)));
        actions.extend(panels.show("Deeper", |ui| self.deeper_section(ui)));
        actions.extend(panels.show("Places", |ui| {
            let done = places_panel(ui, &self.places, &self.forms.place, &mut self.thumbnails);
            let mut actions: Vec<_> =
                done.into_iter().filter_map(|action| self.place(action)).collect();
            self.recent(ui, &mut actions);
            actions
        }));
        actions.extend(panels.show("View", |ui| {
            let (camera, axes) = (self.state.target(), self.state.plane.axes());
            view_panel(ui, &mut self.forms.view, &camera, axes)
        }));
    }

    fn pendulum_and_question(&mut self, panels: &mut Sections, actions: &mut Vec<Action>) {
        self.picture_questions();
        let pictures = &mut self.exploring.questions;
        let scene = self.state.scene();
        let changed = panels.show("Scene", |ui| {
            let ctx = ui.ctx().clone();
            scene_panel(ui, &scene, |place| pictures.texture(&ctx, place).map(TextureHandle::id))
        });
        actions.extend(changed.map(|scene| Action::Scene(Box::new(scene))));
        actions.extend(panels.show("Accuracy", |ui| accuracy_panel(ui, &self.computing())));
    }

    /// Begins to compute what each question would show of the view, once the view is complete.
    fn picture_questions(&mut self) {
        if !self.progress().is_complete() || self.state.moving.is_some() {
            return;
        }
        let shown = self.state.document();
        let asked = QuestionName::ALL.map(|ask| {
            let mut question = shown.question;
            if ask != question.ask {
                question_tiles::choose(&mut question, ask);
            }
            let scene = Scene { question, ..shown.scene() }.without_unused();
            let mut picture = shown.picture.clone();
            picture.forget_view_times();
            if ask != shown.question.ask {
                // Each question has channels and values of its own.
                picture = PictureTable { times: Vec::new(), channel: None, ..picture };
            }
            Document { picture, ..shown.clone().with_scene(scene) }
        });
        self.exploring.questions.of(asked.into(), &self.wake);
    }

    fn colours_and_layers(&mut self, panels: &mut Sections, actions: &mut Vec<Action>) {
        actions.extend(panels.show("Palette", |ui| self.colour_section(ui)));
        actions.extend(panels.show("Layers", |ui| layers_panel(ui, &self.state.layers)));
    }

    fn files(&mut self, panels: &mut Sections, actions: &mut Vec<Action>) {
        let map_px = (self.state.canvas * self.state.pixels_per_point).round().as_uvec2();
        self.forms.export.follow(map_px.to_array(), &self.state.picture);
        self.forms.exporting = true;
        panels.show("Export", |ui| {
            let statuses = self.exports.statuses();
            for action in export_panel(ui, &self.forms.export, &statuses) {
                self.export(action);
            }
        });
        actions.extend(panels.show("Film", |ui| self.film_section(ui)));
    }

    fn preferences(&mut self, panels: &mut Sections, actions: &mut Vec<Action>) {
        let (state, settings) = (&self.state, &mut self.settings);
        actions.extend(panels.show("Window", |ui| window_panel(ui, state, settings)));
        if self.state.shown.debug {
            panels.show("Measured", |ui| {
                for line in self.measurements() {
                    ui.monospace(line);
                }
            });
        }
    }

    /// Shows the panel of the automatic descent.
    fn deeper_section(&mut self, ui: &mut Ui) -> Vec<Action> {
        let DescentPath { running, scenes, .. } = &self.films.descent;
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
        let progress = self.progress();
        let (state, explorer) = (&self.state, &mut self.compute.explorer);
        let view = ColoursView {
            picture: &state.picture,
            scene: &state.scene(),
            has_samples: progress.done > 0,
            cycle: &state.shown.cycle,
            times_secs: self.times_in_view.follow(state, explorer, progress.is_complete()),
            kept: &self.settings.palettes,
        };
        let done = colours_panel(ui, &view);
        done.and_then(|action| self.colour(action))
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

/// Shows the figures of the laboratory, each with its sentence.
fn figures(ui: &mut Ui) -> Vec<Action> {
    let mut actions = Vec::new();
    for figure in Figure::all() {
        let title = format!("{} ({})", figure.title(), figure.key().name());
        if ui.link(title).clicked() {
            actions.push(Action::Lab(Some(figure)));
        }
        ui.weak(figure.sentence());
        ui.add_space(4.0);
    }
    actions
}
