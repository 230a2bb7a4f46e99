//! A double pendulum simulated in fixed steps, shared by the third and fourth figures.

use egui::Response;

use super::clock::Clock;
use super::drawing::{FigureCanvas, angle_of, ends, wrapped};
use flipmap_numbers::number_text::fixed;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::integrator::rk4;
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::{Kind, PendulumSpec};

/// Number of steps per second.
const STEPS_A_SEC: f64 = 960.0;
/// Number of points of the trail.
const TRAIL: usize = 480;
/// Distance in points within which a handle can be grabbed.
const HANDLE_POINTS: f32 = 12.0;
/// Number of steps between two points of the trail.
const TRAIL_EVERY: u64 = 8;

/// A double pendulum, released from rest or thrown.
#[derive(Clone, Debug)]
pub(super) struct DoublePendulumSimulation {
    /// The pendulum's kind, masses, lengths and gravity.
    pub build: PendulumSpec,
    /// State at the release.
    pub start: State<f64>,
    /// State at the last step.
    pub state: State<f64>,
    /// The clock of the steps.
    pub clock: Clock,
    /// Past positions of the second bob in metres, the latest last.
    pub trail: Vec<[f64; 2]>,
    /// Index of the bob that the user holds.
    pub held: Option<usize>,
}

impl DoublePendulumSimulation {
    /// Creates a default pendulum released at two angles in rad.
    pub(super) fn from(angle: [f64; 2]) -> Self {
        let start = State::rest(angle);
        DoublePendulumSimulation {
            build: PendulumSpec::default(),
            start,
            state: start,
            clock: Clock::new(1.0 / STEPS_A_SEC),
            trail: Vec::new(),
            held: None,
        }
    }

    /// Releases the pendulum again, from state `start`.
    pub(super) fn release(&mut self, start: State<f64>) {
        (self.start, self.state) = (start, start);
        self.clock = Clock::new(self.clock.step_secs);
        self.trail.clear();
    }

    /// Returns the angles of the start, the masses, the lengths, the gravity, and the speeds of the
    /// start.
    pub(super) fn set(&self) -> Vec<f64> {
        let gravity = self.build.gravity.value();
        let (masses, lengths) = (self.build.masses_kg(), self.build.lengths_m());
        let State { angle, speed } = self.start;
        [&angle[..], &masses, &lengths, &[gravity], &speed].concat()
    }

    /// Returns the five coefficients of the equations of motion.
    pub(super) fn pendulum(&self) -> Pendulum<f64> {
        self.build.pendulum()
    }

    /// Advances by `elapsed_secs`, unless a bob is held.
    pub(super) fn advance(&mut self, elapsed_secs: f64) {
        if self.held.is_some() {
            return;
        }
        let pendulum = self.pendulum();
        let from = self.clock.taken;
        for k in 0..self.clock.due(elapsed_secs) as u64 {
            if (from + k).is_multiple_of(TRAIL_EVERY) {
                self.trail.push(ends(self.build.lengths_m(), self.state.angle)[1]);
            }
            let change = rk4(&pendulum, &self.state, self.clock.step_secs, Turning::Fresh);
            self.state = self.state.plus(&change);
        }
        let old = self.trail.len().saturating_sub(TRAIL);
        self.trail.drain(..old);
    }

    /// Returns the current state, which may lie between two steps.
    pub(super) fn now(&self) -> State<f64> {
        let share = self.clock.share() * self.clock.step_secs;
        let change = rk4(&self.pendulum(), &self.state, share, Turning::Fresh);
        self.state.plus(&change)
    }

    /// Seconds since the release.
    pub(super) fn secs(&self) -> f64 {
        self.clock.secs() + self.clock.share() * self.clock.step_secs
    }

    /// Holds the bob nearest the pointer while it is dragged, then releases both from rest. A
    /// handle, which turns the rod with the same index, takes precedence over the bobs.
    pub(super) fn drag(
        &mut self,
        stage: &FigureCanvas,
        response: &Response,
        handles: Option<[[f64; 2]; 2]>,
    ) {
        let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) else {
            self.held = None;
            return;
        };
        let bobs = ends(self.build.lengths_m(), self.state.angle);
        let rod = self.held.unwrap_or_else(|| {
            let pressed = response.ctx.input(|input| input.pointer.press_origin()).unwrap_or(at);
            let away = |place: [f64; 2]| (stage.at(place) - pressed).length();
            let handle =
                handles.and_then(|handles| (0..2).find(|&rod| away(handles[rod]) <= HANDLE_POINTS));
            handle.unwrap_or_else(|| usize::from(away(bobs[1]) < away(bobs[0])))
        });
        let mut angle = self.state.angle.map(wrapped);
        angle[rod] = angle_of([[0.0; 2], bobs[0]][rod], stage.place(at));
        self.release(State::rest(angle));
        self.held = Some(rod);
    }

    /// Describes both angles in words.
    pub(super) fn told(&self) -> String {
        let [theta1, theta2] = self.now().angle.map(|angle| fixed(wrapped(angle), 3));
        format!("θ1 is {theta1} rad, θ2 is {theta2} rad")
    }

    /// Draws the pendulum with its trail.
    pub(super) fn draw(&self, stage: &FigureCanvas) {
        let [first, second] = ends(self.build.lengths_m(), self.now().angle);
        let (ink, [one, two, ..]) = (stage.tint.ink, stage.tint.parts);
        stage.trail(&self.trail, two);
        stage.rod([0.0; 2], first, ink);
        stage.rod(first, second, ink);
        stage.pivot();
        let [m1, m2] = self.build.masses_kg();
        match self.build.kind {
            Kind::Points => {
                stage.bob(first, m1, one);
                stage.bob(second, m2, two);
            }
            Kind::Rods => {
                stage.bar([0.0; 2], first, m1, one);
                stage.bar(first, second, m2, two);
            }
        }
    }
}

/// Returns the five coefficients of the default pendulum's equations of motion.
pub(super) fn pendulum() -> Pendulum<f64> {
    PendulumSpec::default().pendulum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_is_kept_and_frames_do_not_matter() {
        let (mut often, mut seldom) = (
            DoublePendulumSimulation::from([2.0, 1.0]),
            DoublePendulumSimulation::from([2.0, 1.0]),
        );
        let energy = often.pendulum().energy(&often.state);
        (0..480).for_each(|_| often.advance(1.0 / 240.0));
        (0..20).for_each(|_| seldom.advance(0.1));
        let apart = (often.state.angle[1] - seldom.state.angle[1]).abs();
        assert!(apart < 1e-12 && (often.secs() - 2.0).abs() < 1e-6);
        assert!((often.pendulum().energy(&often.state) / energy - 1.0).abs() < 1e-7);
        assert!(often.trail.len() > 200 && often.trail.len() <= TRAIL);
    }
}
