//! Pause, speed and scrubbing, which work the same for every figure.

use std::time::{Duration, Instant};

use egui::{Slider, Ui};

use super::LiveFigure;
use flipmap_numbers::number_text::{column, fixed};

/// The state of a figure's playback.
#[derive(Clone, Debug, PartialEq)]
pub struct Playing {
    /// True if the figure is paused.
    pub paused: bool,
    /// Speed in simulated seconds per second: one of [`SPEEDS`].
    pub speed: f64,
    /// Moment in s at which the user holds the slider.
    held_at: Option<f64>,
    /// Moment in s to reach by running the figure again.
    goal_secs: Option<f64>,
    /// The stopwatch.
    stopwatch: Stopwatch,
}

/// A stopwatch in the figure's own time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Stopwatch {
    #[default]
    Zero,
    /// Running since this moment in s.
    Since(f64),
    /// Stopped after this time in s.
    After(f64),
}

impl Stopwatch {
    /// Returns what it shows at a moment; it begins again when the figure does.
    fn secs(self, now_secs: f64) -> f64 {
        match self {
            Stopwatch::Zero => 0.0,
            Stopwatch::Since(begun_secs) => (now_secs - begun_secs).max(0.0),
            Stopwatch::After(secs) => secs,
        }
    }

    /// Starts, stops or clears it, in this order.
    fn press(&mut self, now_secs: f64) {
        *self = match *self {
            Stopwatch::Zero => Stopwatch::Since(now_secs),
            Stopwatch::Since(_) => Stopwatch::After(self.secs(now_secs)),
            Stopwatch::After(_) => Stopwatch::Zero,
        };
    }
}

/// Speeds in simulated seconds per second, each with its name.
pub(crate) const SPEEDS: [(f64, &str); 5] =
    [(0.01, "1/100"), (0.1, "1/10"), (0.25, "1/4"), (0.5, "1/2"), (1.0, "1")];
/// Width in points that the buttons of the speeds need beside the slider; keys change the speed
/// without them.
const SPEEDS_WIDTH: f32 = 560.0;
/// Width in points that the stopwatch needs beside the slider.
const WATCH_WIDTH: f32 = 400.0;
/// Longest piece of time in s by which a figure is advanced when it is run again.
const PIECE_SECS: f64 = 0.05;
/// Longest time that a frame may spend on running a figure again.
const SLICE: Duration = Duration::from_millis(6);
/// Smallest range of the slider in s.
const RANGE_SECS: f64 = 60.0;

impl Default for Playing {
    fn default() -> Self {
        Playing::at_speed(1.0)
    }
}

impl Playing {
    /// Creates a playback at a speed in simulated seconds per second.
    pub(crate) fn at_speed(speed: f64) -> Self {
        Playing { paused: false, speed, held_at: None, goal_secs: None, stopwatch: Stopwatch::Zero }
    }

    /// Returns true if the next frame will look different.
    pub fn is_moving(&self) -> bool {
        self.goal_secs.is_some() || !(self.paused || self.held_at.is_some())
    }

    /// Goes to a moment of the figure by running it again from its start. It runs in pieces so that
    /// no frame waits for it, and the moment is the same as on the first run.
    pub(crate) fn seek(&mut self, secs: f64) {
        self.goal_secs = Some(secs.max(0.0));
    }

    /// Takes the next slower (−1) or faster (1) speed.
    pub fn shift_speed(&mut self, by: isize) {
        let now = SPEEDS.iter().position(|(speed, _)| *speed == self.speed);
        let next = now.unwrap_or(SPEEDS.len() - 1).saturating_add_signed(by);
        self.speed = SPEEDS[next.min(SPEEDS.len() - 1)].0;
    }

    /// Advances a figure by a frame of `elapsed_secs`.
    pub(crate) fn advance(&mut self, live: &mut dyn LiveFigure, elapsed_secs: f64) {
        match self.goal_secs {
            Some(goal) => self.run_again(live, goal, Instant::now() + SLICE),
            None if self.is_moving() => live.advance(elapsed_secs * self.speed),
            None => {}
        }
    }

    fn run_again(&mut self, live: &mut dyn LiveFigure, goal_secs: f64, until: Instant) {
        if live.secs() > goal_secs {
            live.restart();
        }
        loop {
            let before = live.secs();
            if before < goal_secs {
                live.advance(PIECE_SECS.min(goal_secs - before));
            }
            // A figure that is held or has ended does not advance.
            if live.secs() >= goal_secs || live.secs() <= before {
                self.goal_secs = None;
                return;
            }
            if Instant::now() >= until {
                return;
            }
        }
    }

    /// Shows the playback controls of a figure.
    pub(super) fn bar(&mut self, ui: &mut Ui, live: &mut dyn LiveFigure, briefly: bool) {
        ui.horizontal(|ui| {
            if ui.button(if self.paused { "Play" } else { "Pause" }).clicked() {
                self.paused = !self.paused;
            }
            if ui.button("Restart").clicked() {
                self.goal_secs = None;
                live.restart();
            }
            if !briefly && ui.available_width() >= SPEEDS_WIDTH {
                self.speeds(ui);
            }
            if ui.available_width() >= WATCH_WIDTH {
                let now_secs = live.secs();
                let watch = format!("Stopwatch {} s", fixed(self.stopwatch.secs(now_secs), 2));
                let watch = ui.button(watch).on_hover_text("Starts, stops and clears it");
                if watch.clicked() {
                    self.stopwatch.press(now_secs);
                }
            }
            self.scrubber(ui, live.secs());
        });
    }

    /// Shows a button for every speed.
    fn speeds(&mut self, ui: &mut Ui) {
        ui.label("Speed");
        for (speed, name) in SPEEDS {
            ui.selectable_value(&mut self.speed, speed, name);
        }
    }

    fn scrubber(&mut self, ui: &mut Ui, now_secs: f64) {
        let mut secs = self.held_at.or(self.goal_secs).unwrap_or(now_secs);
        let range = 0.0..=RANGE_SECS * (secs / RANGE_SECS).ceil().max(1.0);
        let name = ui.label("Time");
        ui.spacing_mut().slider_width = (ui.available_width() - 90.0).max(20.0);
        let slider = ui.add(Slider::new(&mut secs, range).show_value(false));
        let slider = slider.labelled_by(name.id);
        if slider.changed() {
            self.seek(secs);
        }
        self.held_at = slider.dragged().then_some(secs);
        ui.monospace(format!("{} s", column(now_secs, 2, 6)));
    }
}

#[cfg(test)]
mod tests {
    use crate::{Figure, Lab};

    #[test]
    fn a_moment_is_the_same_whether_run_once_or_sought() {
        for figure in Figure::all() {
            let (mut once, mut sought) = (Lab::new(figure), Lab::new(figure));
            let Some(live) = once.live() else { continue };
            (0..430).for_each(|_| live.advance(1.0 / 60.0));
            for goal in [12.0, 430.0 / 60.0] {
                sought.playing.seek(goal);
                sought.playing.paused = true;
                while sought.playing.is_moving() {
                    sought.advance(1.0 / 60.0);
                }
                let reached = sought.live().unwrap().secs();
                assert!((reached - goal).abs() < 0.02, "{figure:?}: {reached} for {goal}");
            }
            let (told, again) = (once.live().unwrap().told(), sought.live().unwrap().told());
            assert_eq!(told, again, "{figure:?}");
            // The figure must move, so another moment has another description.
            once.live().unwrap().advance(0.2);
            assert_ne!(once.live().unwrap().told(), again, "{figure:?}");
        }
    }

    #[test]
    fn time_stands_still_and_runs_slowly() {
        let mut lab = Lab::new(Figure::Double);
        let secs = |lab: &mut Lab| {
            let before = lab.live().unwrap().secs();
            (0..20).for_each(|_| lab.advance(0.05));
            lab.live().unwrap().secs() - before
        };
        assert!((secs(&mut lab) - 1.0).abs() < 1e-6);
        lab.playing.shift_speed(-2);
        assert!((secs(&mut lab) - 0.25).abs() < 1e-6);
        lab.playing.shift_speed(-9);
        assert!((secs(&mut lab) - 0.01).abs() < 1e-6);
        lab.playing.paused = true;
        assert!(secs(&mut lab) == 0.0 && !lab.playing.is_moving());
        lab.playing.shift_speed(9);
        lab.playing.paused = false;
        assert!((secs(&mut lab) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn the_stopwatch_measures_in_the_figures_time() {
        let mut watch = super::Stopwatch::Zero;
        watch.press(2.0);
        assert!((watch.secs(5.5) - 3.5).abs() < 1e-12);
        watch.press(6.0);
        assert_eq!(watch.secs(99.0), 4.0, "it is stopped");
        watch.press(7.0);
        assert_eq!(watch.secs(99.0), 0.0);
        watch.press(9.0);
        assert_eq!(watch.secs(0.0), 0.0, "the figure began again");
    }
}
