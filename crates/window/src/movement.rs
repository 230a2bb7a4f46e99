//! Movements of the view and their effects on the camera.

use glam::DVec2;

use super::action::Look;
use super::state::AppState;
use flipmap_numbers::Exact;
use flipmap_screen::camera::{Camera, Move, MovePace};

impl AppState {
    /// Returns true if neither the user nor a move in progress moves the map.
    pub fn rests(&self) -> bool {
        self.moving.is_none() && !self.dragging
    }

    /// Carries out a movement of the view.
    pub(super) fn look(&mut self, look: Look) {
        match look {
            Look::Drag(by) => {
                self.moving = None;
                self.dragging = true;
                self.camera = self.camera.moved(-self.screen().offset_at(by));
            }
            Look::Release => self.dragging = false,
            Look::Zoom { factor, about } => {
                let target = self.aimed_screen();
                self.go(target.camera.zoomed(factor, target.offset_at(about)));
            }
            Look::Box(corners) => self.zoom_to_box(corners),
            Look::Turn([from, to]) => {
                self.moving = None;
                self.dragging = true;
                self.camera = self.screen().turned(from, to);
            }
            Look::Stretch(factor) => self.go(self.target().stretched(factor)),
            Look::Step(share) => {
                let target = self.aimed_screen();
                self.go(target.camera.moved(target.offset_at(share * self.canvas)));
            }
            Look::Home => self.go(Camera::home(self.camera.reach, self.canvas)),
            Look::Back => {
                let then = self.history.back();
                self.restore(then);
            }
            Look::Forward => {
                let then = self.history.forward();
                self.restore(then);
            }
            Look::To(camera) => self.go(camera),
        }
    }

    /// Moves to a camera: smoothly, or with a jump if the user prefers it.
    pub(super) fn go(&mut self, to: Camera) {
        self.go_at(to, MovePace::Quick);
    }

    /// Centres the map on a start.
    pub(super) fn find(&mut self, angle: [Exact; 2]) {
        self.go(Camera { center: angle, ..self.target() });
    }

    /// Glides to a camera as a step of a dive, which is not recorded in the history.
    pub(super) fn glide(&mut self, to: Camera, pace: MovePace) {
        self.go_at(to, pace);
        self.dragging = true;
    }

    /// Stays where a glide has come to.
    pub(super) fn stay(&mut self) {
        (self.moving, self.dragging) = (None, false);
    }

    /// Jumps to a camera; `on_the_way` is true if it will be moved again at once.
    pub(super) fn jump(&mut self, to: Camera, on_the_way: bool) {
        (self.camera, self.moving, self.dragging) = (to, None, on_the_way);
    }

    fn go_at(&mut self, to: Camera, pace: MovePace) {
        if self.look.animate {
            self.moving = Some(Move { from: self.camera, to, began_secs: self.now_secs, pace });
        } else {
            (self.camera, self.moving) = (to, None);
        }
    }

    fn zoom_to_box(&mut self, [a, b]: [DVec2; 2]) {
        let size = (a - b).abs();
        // A box of a few points is an unsteady click.
        if size.max_element() < 4.0 {
            return;
        }
        let screen = self.screen();
        let factor = (self.canvas / size.max(DVec2::ONE)).min_element();
        let there = self.camera.moved(screen.offset_at((a + b) / 2.0));
        self.go(there.zoomed(factor, DVec2::ZERO));
    }
}
