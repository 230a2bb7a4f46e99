//! The scale of times: where along the range of its colours a time lies.

use crate::Scale;

/// A map from times to shares of a range.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeScale {
    scale: Scale,
    /// Seconds at which equal steps of the range lie; at least two, rising.
    times: Vec<f64>,
    /// Logarithm of the ratio of each two neighbours.
    logs: Vec<f64>,
}

impl TimeScale {
    /// The scale between these times, at least two of them and rising.
    pub(super) fn new(scale: Scale, times: Vec<f64>) -> Self {
        let logs = times.windows(2).map(|pair| (pair[1] / pair[0]).ln()).collect();
        TimeScale { scale, times, logs }
    }

    /// The first and the last time with a colour of its own, in s.
    pub fn range_secs(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// The share of the range that lies before a time, from 0 to 1: a height that rises with the time
    /// and has no steps, whatever its colours have.
    pub fn height(&self, secs: f64) -> f64 {
        let steps = self.times.len() - 1;
        let step = self.times.partition_point(|&time| time <= secs).clamp(1, steps) - 1;
        let [from, to] = [self.times[step], self.times[step + 1]];
        let within = match self.scale {
            Scale::Log | Scale::Steps => (secs / from).ln() / self.logs[step],
            Scale::Linear => (secs - from) / (to - from),
        };
        ((step as f64 + within) / steps as f64).clamp(0.0, 1.0)
    }

    /// The share of the range whose colour a height has: one for each step if the scale has steps.
    pub(super) fn coloured(&self, height: f64) -> f64 {
        if self.scale != Scale::Steps {
            return height;
        }
        let steps = (self.times.len() - 1) as f64;
        ((height * steps).floor().min(steps - 1.0) + 0.5) / steps
    }

    /// The time at a height, in s: the number that a legend writes beside its colours.
    pub fn secs_at(&self, height: f64) -> f64 {
        let steps = self.times.len() - 1;
        let along = height.clamp(0.0, 1.0) * steps as f64;
        let step = (along as usize).min(steps - 1);
        let ([from, to], within) = ([self.times[step], self.times[step + 1]], along - step as f64);
        match self.scale {
            Scale::Log | Scale::Steps => from * (to / from).powf(within),
            Scale::Linear => from + (to - from) * within,
        }
    }
}
