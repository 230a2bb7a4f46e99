//! The scale of times: the position of a time in the range of colours.

use crate::Scale;

/// A map from times to shares of a range.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeScale {
    scale: Scale,
    /// Times in s at the ends of equal steps of the range; at least two, ascending.
    times: Vec<f64>,
    /// Logarithms of the ratios of neighbouring times.
    logs: Vec<f64>,
}

impl TimeScale {
    /// Returns the scale through these times, of which there are at least two, ascending.
    pub(super) fn new(scale: Scale, times: Vec<f64>) -> Self {
        let logs = times.windows(2).map(|pair| (pair[1] / pair[0]).ln()).collect();
        TimeScale { scale, times, logs }
    }

    /// Returns the first and the last time with a colour of its own, in s.
    pub fn range_secs(&self) -> [f64; 2] {
        [self.times[0], self.times[self.times.len() - 1]]
    }

    /// Returns the times in s at which one colour ends and the next begins, with the first and the
    /// last; none if the colours have no steps.
    pub(super) fn edges_secs(&self) -> Option<&[f64]> {
        (self.scale == Scale::Steps).then_some(&self.times)
    }

    /// Returns the height of a time: its position in the range, from 0 to 1. The height rises with
    /// the time without steps, even if the colours have steps.
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

    /// Returns the position whose colour a height has: the middle of its step if the scale has
    /// steps, or else the height itself.
    pub(super) fn coloured(&self, height: f64) -> f64 {
        if self.scale != Scale::Steps {
            return height;
        }
        let steps = (self.times.len() - 1) as f64;
        ((height * steps).floor().min(steps - 1.0) + 0.5) / steps
    }

    /// Returns the time at a height in s, as a legend writes it beside its colours.
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
