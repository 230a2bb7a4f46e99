//! A single pendulum simulated in fixed steps, shared by the first two figures.

use std::ops::RangeInclusive;

use egui::{Grid, Response, Ui};

use super::clock::Clock;
use super::controls::{GRAVITIES, MASSES, number};
use super::drawing::{FigureCanvas, angle_of, end, turning};
use super::energy::Energy;
use super::set_up::SetUpWord;
use super::zero_height::ZeroHeight;
use flipmap_pendulum::simple::{Crossings, MAX_AMPLITUDE, Simple, Swing};

/// Number of steps per second.
const STEPS_A_SEC: f64 = 480.0;

/// Range of the rod in m.
const RODS: RangeInclusive<f64> = 0.1..=5.0;
/// Range of the release in rad.
const AMPLITUDES: RangeInclusive<f64> = -MAX_AMPLITUDE..=MAX_AMPLITUDE;
/// Number of steps between two remembered states.
const PATH_EVERY: u64 = 6;
/// Number of remembered states, which span ten seconds.
const PATH: usize = 801;

/// A mass on a rod, released from rest.
#[derive(Clone, Debug)]
pub(super) struct SinglePendulumSimulation {
    /// Length and gravity of the pendulum.
    pub simple: Simple,
    /// Mass in kg.
    pub mass: f64,
    /// Angle of the release in rad.
    pub amplitude: f64,
    /// State at the last step.
    pub swing: Swing,
    /// The clock of the steps.
    pub clock: Clock,
    /// Zero crossings of the angle since the release.
    pub crossings: Crossings,
    /// Past states with their times in s, in order of time.
    pub path: Vec<(f64, Swing)>,
    /// True while the user holds the bob.
    pub held: bool,
    /// The height from which potential energy is counted.
    pub zero: ZeroHeight,
}

impl SinglePendulumSimulation {
    /// Creates a pendulum released at an angle.
    pub(super) fn from(amplitude: f64) -> Self {
        SinglePendulumSimulation {
            simple: Simple { length: 1.0, gravity: 9.81 },
            mass: 1.0,
            amplitude,
            swing: Swing { angle: amplitude, speed: 0.0 },
            clock: Clock::new(1.0 / STEPS_A_SEC),
            crossings: Crossings::default(),
            path: Vec::new(),
            held: false,
            zero: ZeroHeight::default(),
        }
    }

    /// Releases the pendulum again, at an angle.
    pub(super) fn release(&mut self, amplitude: f64) {
        self.amplitude = amplitude.clamp(-MAX_AMPLITUDE, MAX_AMPLITUDE);
        self.swing = Swing { angle: self.amplitude, speed: 0.0 };
        self.clock = Clock::new(self.clock.step_secs);
        self.crossings = Crossings::default();
        self.path.clear();
    }

    /// Advances by `elapsed_secs`, unless the bob is held.
    pub(super) fn advance(&mut self, elapsed_secs: f64) {
        if self.held {
            return;
        }
        let step = self.clock.step_secs;
        let from = self.clock.taken;
        for k in 0..self.clock.due(elapsed_secs) as u64 {
            let secs = (from + k) as f64 * step;
            if (from + k).is_multiple_of(PATH_EVERY) {
                self.path.push((secs, self.swing));
            }
            self.crossings.look(&self.simple, secs, self.swing, step);
            self.swing = self.simple.step(self.swing, step);
        }
        let old = self.path.len().saturating_sub(PATH);
        self.path.drain(..old);
    }

    /// Returns the current state, which may lie between two steps.
    pub(super) fn now(&self) -> Swing {
        self.simple.step(self.swing, self.clock.share() * self.clock.step_secs)
    }

    /// Returns the current angle in rad.
    pub(super) fn angle(&self) -> f64 {
        self.now().angle
    }

    /// Seconds since the release.
    pub(super) fn secs(&self) -> f64 {
        self.clock.secs() + self.clock.share() * self.clock.step_secs
    }

    /// Returns the position of the bob in metres.
    pub(super) fn bob(&self) -> [f64; 2] {
        end([0.0; 2], self.simple.length, self.angle())
    }

    /// Holds the bob while it is dragged, and releases it where the drag ends: from rest, or with the
    /// pointer's speed if it can be thrown.
    pub(super) fn drag(&mut self, stage: &FigureCanvas, response: &Response, is_thrown: bool) {
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            self.held = true;
            self.release(angle_of([0.0; 2], stage.place(at)));
        } else if self.held {
            self.held = false;
            let velocity = response.ctx.input(|input| input.pointer.velocity());
            if is_thrown {
                self.throw(stage.velocity(velocity));
            }
        }
    }

    /// Gives the bob a velocity in m/s, as far as it turns round before the top, if that is a throw.
    fn throw(&mut self, velocity: [f64; 2]) {
        let Simple { length, gravity } = self.simple;
        let Some(speed) = turning(velocity, self.swing.angle, length) else { return };
        // Energy conservation: ω²/2 = (g/r)(cos θ − cos θ0).
        let cos = self.swing.angle.cos();
        let most = (2.0 * gravity / length * (cos - MAX_AMPLITUDE.cos()).max(0.0)).sqrt();
        let speed = speed.clamp(-most, most);
        let highest = cos - 0.5 * speed * speed * length / gravity;
        self.swing.speed = speed;
        self.amplitude = highest.clamp(-1.0, 1.0).acos().min(MAX_AMPLITUDE).copysign(speed);
    }

    /// Returns the energy of a state.
    pub(super) fn energy(&self, swing: Swing) -> Energy {
        let (mass, Simple { length, gravity }) = (self.mass, self.simple);
        let kinetic = 0.5 * mass * (length * swing.speed).powi(2);
        let potential = mass * gravity * length * (1.0 - swing.angle.cos());
        Energy::new([kinetic, potential], mass * gravity * self.zero.above_m)
    }

    /// Returns the set-up of the figure, without the height of zero energy.
    pub(super) fn set_up(&self) -> Vec<SetUpWord> {
        let simple = &self.simple;
        vec![
            SetUpWord::numbers("start", [self.amplitude], AMPLITUDES),
            SetUpWord::numbers("rod", [simple.length], RODS),
            SetUpWord::numbers("mass", [self.mass], MASSES),
            SetUpWord::numbers("gravity", [simple.gravity], GRAVITIES),
        ]
    }

    /// Begins again as the numbers of a set-up say.
    pub(super) fn take_set_up(&mut self, numbers: &[f64]) {
        if let &[amplitude, length, mass, gravity] = numbers {
            self.simple = Simple { length, gravity };
            self.mass = mass;
            self.release(amplitude);
        }
    }

    /// Shows the sliders for length, mass, gravity and the angle of release, and a release button.
    pub(super) fn controls(&mut self, ui: &mut Ui) {
        let mut amplitude = self.amplitude;
        let mut changed = false;
        Grid::new("single").num_columns(2).show(ui, |ui| {
            changed |= number(ui, "Rod r", " m", &mut self.simple.length, RODS);
            changed |= number(ui, "Mass m", " kg", &mut self.mass, MASSES);
            changed |= number(ui, "Gravity g", " m/s²", &mut self.simple.gravity, GRAVITIES);
            let range = AMPLITUDES;
            changed |= number(ui, "Let go at θ", " rad", &mut amplitude, range);
        });
        if changed {
            self.release(amplitude);
        }
        if ui.button("Let go again").clicked() {
            self.release(self.amplitude);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_do_not_change_the_swing() {
        let (mut often, mut seldom) =
            (SinglePendulumSimulation::from(2.0), SinglePendulumSimulation::from(2.0));
        (0..720).for_each(|_| often.advance(1.0 / 240.0));
        (0..30).for_each(|_| seldom.advance(0.1));
        assert!((often.swing.angle - seldom.swing.angle).abs() < 1e-12);
        assert!((often.secs() - 3.0).abs() < 1e-6);
        // A pendulum that is held does not move.
        often.held = true;
        let before = often.swing;
        often.advance(1.0);
        assert_eq!(often.swing, before);
    }

    #[test]
    fn a_thrown_bob_turns_round_at_its_amplitude() {
        for (angle, velocity) in [(0.3, 2.0), (-1.0, -3.0), (1.0, 60.0)] {
            let mut thrown = SinglePendulumSimulation::from(angle);
            thrown.throw([velocity * angle.cos(), velocity * angle.sin()]);
            assert!(velocity.abs() > 50.0 || (thrown.swing.speed - velocity).abs() < 1e-12);
            let mut farthest: f64 = 0.0;
            for _ in 0..2000 {
                thrown.advance(0.005);
                farthest = farthest.max(thrown.swing.angle.abs());
            }
            let off = farthest - thrown.amplitude.abs();
            assert!(off.abs() < 2e-3, "{angle}, {velocity}: {farthest} for {}", thrown.amplitude);
        }
    }
}
