//! A double pendulum simulated in fixed steps, shared by the third and fourth figures.

use egui::Response;

use super::clock::Clock;
use super::controls::{ANGLES, GRAVITIES, LENGTHS, MASSES, SPEEDS};
use super::drawing::{FigureCanvas, angle_of, ends, turning, wrapped};
use super::energy::{Energy, hanging_m};
use super::set_up::SetUpWord;
use super::zero_height::ZeroHeight;
use flipmap_numbers::number_text::fixed;
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::integrator::rk4;
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::{Kind, PendulumSpec};

/// Number of steps per second.
const STEPS_A_SEC: f64 = 960.0;
/// Number of past states that the trail shows.
const TRAIL: usize = 480;
/// Number of past states that are remembered, which span ten seconds.
const PATH: usize = 1200;
/// Distance in points within which a handle can be grabbed.
const HANDLE_POINTS: f32 = 12.0;
/// Largest speed in rad/s of a throw.
const FASTEST: f64 = 25.0;
/// Number of steps between two remembered states.
const PATH_EVERY: u64 = 8;

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
    /// Past states with their times in s, in order of time.
    pub path: Vec<(f64, State<f64>)>,
    /// Index of the bob that the user holds.
    pub held: Option<usize>,
    /// The height from which potential energy is counted.
    pub zero: ZeroHeight,
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
            path: Vec::new(),
            held: None,
            zero: ZeroHeight::default(),
        }
    }

    /// Releases the pendulum again, from state `start`.
    pub(super) fn release(&mut self, start: State<f64>) {
        (self.start, self.state) = (start, start);
        self.clock = Clock::new(self.clock.step_secs);
        self.path.clear();
    }

    /// Returns the set-up of the figure, without friction and the height of zero energy.
    pub(super) fn set_up(&self) -> Vec<SetUpWord> {
        let PendulumSpec { kind, gravity, .. } = &self.build;
        let State { angle, speed } = self.start;
        vec![
            SetUpWord::numbers("start", angle, ANGLES),
            SetUpWord::numbers("masses", self.build.masses_kg(), MASSES),
            SetUpWord::numbers("lengths", self.build.lengths_m(), LENGTHS),
            SetUpWord::numbers("gravity", [gravity.value()], GRAVITIES),
            SetUpWord::numbers("speeds", speed, SPEEDS),
            SetUpWord::name("kind", usize::from(*kind == Kind::Rods), &["points", "rods"]),
        ]
    }

    /// Begins again as the numbers of a set-up say.
    pub(super) fn take_set_up(&mut self, numbers: &[f64]) {
        let &[t1, t2, m1, m2, l1, l2, gravity, w1, w2, kind] = numbers else { return };
        let kind = if kind > 0.0 { Kind::Rods } else { Kind::Points };
        self.build = PendulumSpec::new(kind, [m1, m2], [l1, l2], gravity);
        self.release(State { angle: [t1, t2], speed: [w1, w2] });
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
            if (from + k).is_multiple_of(PATH_EVERY) {
                self.path.push(((from + k) as f64 * self.clock.step_secs, self.state));
            }
            let change = rk4(&pendulum, &self.state, self.clock.step_secs, Turning::Fresh);
            self.state = self.state.plus(&change);
        }
        let old = self.path.len().saturating_sub(PATH);
        self.path.drain(..old);
    }

    /// Returns the current state, which may lie between two steps.
    pub(super) fn now(&self) -> State<f64> {
        let share = self.clock.share() * self.clock.step_secs;
        let change = rk4(&self.pendulum(), &self.state, share, Turning::Fresh);
        self.state.plus(&change)
    }

    /// Returns the energy of a state.
    pub(super) fn energy(&self, state: &State<f64>) -> Energy {
        Energy::of(&self.build, state, self.zero_m())
    }

    /// Returns the height in m above the pivot from which potential energy is counted.
    pub(super) fn zero_m(&self) -> f64 {
        hanging_m(&self.build) + self.zero.above_m
    }

    /// Seconds since the release.
    pub(super) fn secs(&self) -> f64 {
        self.clock.secs() + self.clock.share() * self.clock.step_secs
    }

    /// Holds the bob nearest the pointer while it is dragged, then releases it with the pointer's
    /// speed, and the other from rest. A handle, which turns the rod with the same index, takes
    /// precedence over the bobs.
    pub(super) fn drag(
        &mut self,
        stage: &FigureCanvas,
        response: &Response,
        handles: Option<[[f64; 2]; 2]>,
    ) {
        let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) else {
            if let Some(rod) = self.held.take() {
                let velocity = response.ctx.input(|input| input.pointer.velocity());
                self.throw(rod, stage.velocity(velocity));
            }
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

    /// Releases the pendulum with one rod turning as a velocity in m/s of its end turns it, if that is
    /// a throw.
    fn throw(&mut self, rod: usize, velocity: [f64; 2]) {
        let mut start = State::rest(self.state.angle);
        let speed = turning(velocity, start.angle[rod], self.build.lengths_m()[rod]);
        start.speed[rod] = speed.unwrap_or(0.0).clamp(-FASTEST, FASTEST);
        self.release(start);
    }

    /// Describes both angles in words.
    pub(super) fn told(&self) -> String {
        told(self.now().angle)
    }

    /// Draws the pendulum with its trail.
    pub(super) fn draw(&self, stage: &FigureCanvas) {
        let past = &self.path[self.path.len().saturating_sub(TRAIL)..];
        let trail = past.iter().map(|(_, state)| ends(self.build.lengths_m(), state.angle)[1]);
        stage.trail(&trail.collect::<Vec<_>>(), stage.tint.parts[1]);
        draw_rods(stage, &self.build, self.now().angle);
    }
}

/// Describes two angles in words.
pub(super) fn told(angle: [f64; 2]) -> String {
    let [theta1, theta2] = angle.map(|angle| fixed(wrapped(angle), 3));
    format!("θ1 is {theta1} rad, θ2 is {theta2} rad")
}

/// Draws the rods and bobs, or the bars, of a pendulum.
pub(super) fn draw_rods(stage: &FigureCanvas, build: &PendulumSpec, angle: [f64; 2]) {
    let [first, second] = ends(build.lengths_m(), angle);
    let (ink, [one, two, ..]) = (stage.tint.ink, stage.tint.parts);
    stage.rod([0.0; 2], first, ink);
    stage.rod(first, second, ink);
    stage.pivot();
    let [m1, m2] = build.masses_kg();
    match build.kind {
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
        assert!(often.path.len() > 200 && often.path.len() <= PATH);
    }

    #[test]
    fn a_thrown_bob_has_the_speed_of_the_pointer_across_its_rod() {
        let mut simulation = DoublePendulumSimulation::from([0.5, 1.2]);
        let along = |angle: f64| [angle.cos(), angle.sin()];
        let [x, y] = along(1.2);
        simulation.throw(1, [3.0 * x - 5.0 * y, 3.0 * y + 5.0 * x]);
        assert!((simulation.start.speed[1] - 3.0).abs() < 1e-12, "{:?}", simulation.start);
        assert_eq!((simulation.start.speed[0], simulation.start.angle), (0.0, [0.5, 1.2]));
        // The end of the rod moves as it was thrown.
        let before = ends([1.0; 2], simulation.state.angle)[1];
        simulation.advance(1.0 / STEPS_A_SEC);
        let after = ends([1.0; 2], simulation.state.angle)[1];
        let speed = [0, 1].map(|i| (after[i] - before[i]) * STEPS_A_SEC);
        assert!((speed[0] / x - 3.0).abs() < 0.1 && (speed[1] / y - 3.0).abs() < 0.1, "{speed:?}");
        simulation.throw(0, [0.1, 0.0]);
        assert_eq!(simulation.start.speed, [0.0; 2], "a slow hand lets go");
    }
}
