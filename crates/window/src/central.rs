//! The middle of the window: the map, and the pendulum at the pointer.

use std::time::Duration;

use egui::{Rect, Ui};

use super::action::Action;
use super::commands::Command;
use super::map::{Hovered, caption, map};
use super::model::AppModel;
use super::overlay;
use super::panels::map_legend::map_legend;
use super::panels::pendulum;
use super::panels::toolbar::toolbar;
use super::state::AppState;
use flipmap_pendulum::Rule;
use flipmap_scene::palette::{AnswerColours, Ground};
use flipmap_scene::{PendulumSpec, Plane, QuestionSettings, Scene, SceneError};
use flipmap_screen::canvas::colours::{CardColours, gliding_colours};
use flipmap_screen::hover;

/// Time between looks for the denoised picture, while it is computed.
const CALMED_EVERY: Duration = Duration::from_millis(100);

/// Returns a pendulum and the rule of its energy curve; none if no energy divides its map.
fn curve_of(
    (build, question, plane): (PendulumSpec, QuestionSettings, &Plane),
) -> Option<(PendulumSpec, Rule)> {
    let rule = question.watched();
    let divides = rule != Rule::Neither && plane.is_at_rest() && build.gravity.value() > 0.0;
    divides.then_some((build, rule))
}

impl AppModel {
    /// Shows the map in the rest of the window, with its overlays and the toolbar.
    pub(super) fn canvas(&mut self, ui: &mut Ui, commands: &[Command]) -> Vec<Action> {
        let size = ui.available_size_before_wrap();
        let canvas = glam::DVec2::new(f64::from(size.x), f64::from(size.y)).max(glam::DVec2::ONE);
        self.state.resize(canvas, f64::from(ui.ctx().pixels_per_point()));
        // This frame may be drawn before the next turn of the compute service.
        let (state, descent) = (&self.state, &self.films.descent);
        self.compute.aim(|config| descent.passing(state.view_target(config)));
        // Samples that have come since the last frame are never drawn in colours that do not suit
        // them: a later view would flash in the last colour of the one before.
        self.spread_colours();
        let screen = self.state.screen();
        let scene = self.state.scene();
        let now_secs = ui.input(|input| input.time);
        let colours = match self.colours(&scene, now_secs) {
            Ok(colours) => colours,
            // A picture table is checked before it gets here.
            Err(error) => {
                ui.label(error.to_string());
                return Vec::new();
            }
        };
        let fades = self.animates();
        self.map_renderer.fading.begin(fades.then_some(now_secs));
        // A processor takes too long to draw many samples per pixel while the map moves.
        let has_time = self.map_renderer.is_quick || self.state.rests();
        self.map_renderer.finer_levels =
            if has_time { self.state.look.edges.refinements() } else { 0 };
        self.map_renderer.ground = self.ground_to_calm();
        let frame = self.map_renderer.frame(&screen, &mut self.compute.explorer, colours);
        if self.map_renderer.fading.is_running() || self.map_renderer.glide.is_under_way() {
            ui.ctx().request_repaint();
        }
        if self.map_renderer.is_grainy() {
            ui.ctx().request_repaint_after(CALMED_EVERY);
        }
        let hovered = self.state.pointer.map(|point| {
            let [place, _] = hover::sample_at(screen.angle_at(point), screen.level());
            Hovered { place, answer: self.state.answer_at(&mut self.compute.explorer, place) }
        });
        let rect = ui.available_rect_before_wrap();
        // What lies over the map stays clear of the drawer.
        let free = rect.with_max_x(rect.right() - self.forms.drawer_points);
        let mut actions = map(ui, &self.state, frame, hovered, self.drawn_curve());
        self.legend_on(ui, free, &scene);
        self.swing_at_pointer(ui, rect, &scene, hovered);
        pendulum::next_frame(ui, &self.state.pins);
        if self.forms.exporting {
            overlay::draw_export_frame(&ui.painter_at(rect), rect, self.forms.export.size);
        }
        actions.extend(self.pendulum_card(ui, free));
        actions.extend(self.greet(ui, rect));
        // The laboratory has tabs of its own.
        if self.state.shown.side && !self.state.shown.lab {
            let history = &self.state.history;
            let ways = [self.state.has_back(), history.has_forward()];
            actions.extend(toolbar(ui, free, commands, ways));
        }
        actions
    }

    /// Shows the legend on a part of the map, if it is wanted.
    fn legend_on(&self, ui: &Ui, part: Rect, scene: &Scene) {
        let colours = AnswerColours::new(scene, &self.state.picture);
        if let (true, Ok(colours)) = (self.state.layers.legend, colours) {
            let of = (scene.question.ask, self.state.picture.palette.as_str());
            let has_failed = self.compute.explorer.counts().failed > 0;
            map_legend(ui.ctx(), part, &colours, of, has_failed);
        }
    }

    /// Returns the pendulum and the rule of the tiles that are drawn, for their energy curve; none
    /// if they have no curve or it is hidden.
    fn drawn_curve(&self) -> Option<(PendulumSpec, Rule)> {
        let AppState { build, question, ref plane, layers, .. } = self.state;
        let drawn = self.compute.explorer.drawn();
        let drawn = drawn.map_or((build, question, plane), |p| (p.build, p.question, &p.plane));
        if layers.curve { curve_of(drawn) } else { None }
    }

    /// Returns the colours of pixels without an answer if the map is to be denoised: it rests, is
    /// complete and shows its own colours.
    fn ground_to_calm(&self) -> Option<Ground> {
        let (state, progress) = (&self.state, self.progress());
        // Hatches are no grain.
        let has_hatches = state.layers.trust && state.integration.spec.verify;
        let is_plain = !has_hatches && state.shown.timeline.is_none();
        let calm = progress.is_complete() && is_plain && state.rests() && state.picture.denoise;
        Ground::of(&state.picture).ok().filter(|_| calm && !state.shown.cycle.runs)
    }

    /// Returns true if tiles fade in and colours glide, which would be too slow where the processor
    /// draws.
    fn animates(&self) -> bool {
        self.map_renderer.is_quick && self.state.look.animate
    }

    /// Returns the colours of the map, which may be changing to others.
    fn colours(&mut self, scene: &Scene, now_secs: f64) -> Result<CardColours, SceneError> {
        let glides = self.animates();
        let AppState { picture, layers, .. } = &self.state;
        let answers = AnswerColours::new(scene, picture)?;
        let scale = answers.times().map(|(_, tones)| tones.scale());
        let glide = &mut self.map_renderer.glide;
        let shown = scale.and_then(|scale| glide.shown(picture, scale, now_secs, glides));
        let (shown, until_secs) =
            (shown.as_ref().unwrap_or(picture), self.state.shown_until_secs());
        gliding_colours(picture, shown, scene, until_secs, layers.trust)
    }

    /// Draws the pendulum at the pointer once the view rests and is complete.
    fn swing_at_pointer(&mut self, ui: &Ui, rect: Rect, scene: &Scene, hovered: Option<Hovered>) {
        let (state, progress) = (&self.state, self.progress());
        let moves = state.dragging || state.moving.is_some() || state.drawing.is_some();
        let calm = state.layers.swing && !moves && progress.is_complete();
        let place = hovered.filter(|_| calm).map(|hovered| hovered.place);
        let now_secs = ui.input(|input| input.time);
        let angle = self.swing.follow(scene, place, now_secs);
        if let (Some(angle), Some(pointer), Some(hovered)) = (angle, self.state.pointer, hovered) {
            let (painter, at) = (ui.painter_at(rect), overlay::position(rect, pointer));
            let caption = caption(&painter, rect, &self.state, (pointer, &hovered)).rect;
            pendulum::miniature(&painter, (at, caption), &scene.build, angle);
        }
        if let Some(secs) = self.swing.next_secs(now_secs) {
            ui.ctx().request_repaint_after(Duration::from_secs_f64(secs));
        }
    }
}
