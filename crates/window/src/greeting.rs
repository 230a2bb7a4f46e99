//! The greeting of the first start: the map lights up by its clock, and three pendulums swing on
//! it, each with one line.

use egui::{Align2, Area, Frame, Id, Rect, Ui, vec2};

use super::action::Action;
use super::model::AppModel;
use super::overlay;
use super::panels::pendulum;
use super::state::Dialog;
use super::swing::HoverSwing;
use flipmap_numbers::{Exact, Scalar};
use flipmap_screen::flight::playback::Playback;

/// Starts in rad on the home map, each with what its pendulum shows.
const PENDULUMS: [([f64; 2], &str); 3] = [
    ([0.7, 0.5], "Too little energy: never over the top"),
    ([3.3, 1.4], "Let go up here, it flips at once"),
    ([1.75, -1.1], "Here a hair's breadth decides: chaos"),
];
/// What can be done, in one line.
const HINT: &str = "Each point is a pendulum let go from rest; its colour is the time until it \
                    flips. Click one, turn the wheel to zoom, press D to dive, Ctrl+K for the rest.";
/// Speed of the map's clock against the pendulums' own time.
const CLOCK_SPEED: f64 = 2.0;

/// The three pendulums while they swing, and whether the clock has begun.
#[derive(Debug, Default)]
pub(crate) struct Greeting {
    swings: [HoverSwing; 3],
    has_begun: bool,
}

impl AppModel {
    /// Shows the greeting over the map, if it is open; returns the user's actions.
    pub(super) fn greet(&mut self, ui: &Ui, map: Rect) -> Vec<Action> {
        if !self.state.shown.greeting {
            if std::mem::take(&mut self.greeting).has_begun {
                self.state.shown.timeline = None;
            }
            return Vec::new();
        }
        self.light_up();
        let (scene, screen) = (self.state.scene(), self.state.screen());
        let now_secs = ui.input(|input| input.time);
        let painter = ui.painter_at(map);
        for (swing, (start, line)) in self.greeting.swings.iter_mut().zip(PENDULUMS) {
            let place = start.map(Exact::from_f64);
            let angle = swing.follow(&scene, Some(place), now_secs).unwrap_or(start);
            let point = screen.point_of(screen.camera.offset_of(place));
            let at = overlay::position(map, point);
            if !map.contains(at) {
                continue;
            }
            let below = at + vec2(0.0, 8.0);
            let caption = overlay::placed(&painter, below, Align2::CENTER_TOP, line);
            pendulum::miniature(&painter, (at, caption.rect), &scene.build, angle);
            caption.draw(&painter);
        }
        let waits = self.greeting.swings.iter().filter_map(|swing| swing.next_secs(now_secs));
        if let Some(secs) = waits.min_by(f64::total_cmp) {
            ui.ctx().request_repaint_after(std::time::Duration::from_secs_f64(secs));
        }
        hint(ui, map).into_iter().collect()
    }

    /// Starts the clock of the map once the map is complete.
    fn light_up(&mut self) {
        if self.greeting.has_begun || !self.progress().is_complete() {
            return;
        }
        self.greeting.has_begun = true;
        let mut clock = Playback::default();
        clock.set_speed(CLOCK_SPEED);
        clock.play(self.state.question.budget.secs);
        self.state.set_timeline(Some(clock));
    }
}

/// Shows what can be done, with a button that ends the greeting.
fn hint(ui: &Ui, map: Rect) -> Option<Action> {
    let width = 420.0_f32.min(map.width() - 32.0).max(1.0);
    let area = Area::new(Id::unique("greeting")).pivot(Align2::CENTER_BOTTOM);
    let shown = area.fixed_pos(map.center_bottom() - vec2(0.0, 16.0)).show(ui.ctx(), |ui| {
        Frame::popup(ui.style()).inner_margin(12).show(ui, |ui| {
            ui.set_width(width);
            ui.label(HINT);
            ui.add_space(8.0);
            ui.button("Look around").clicked()
        })
    });
    shown.inner.inner.then_some(Action::Toggle(Dialog::Greeting))
}
