//! A meter of how fast the map is being computed.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Recent readings of a count.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meter {
    readings: VecDeque<(Instant, u64)>,
}

/// Length of time for which readings count as recent.
const WINDOW: Duration = Duration::from_millis(1500);

impl Meter {
    /// Takes a reading of a count that only grows.
    pub(crate) fn read(&mut self, now: Instant, count: u64) {
        if self.readings.back().is_none_or(|(_, last)| *last != count) {
            self.readings.push_back((now, count));
        }
        while self.readings.front().is_some_and(|(then, _)| now.duration_since(*then) > WINDOW) {
            self.readings.pop_front();
        }
    }

    /// Returns the growth of the count per second; 0 with fewer than two readings.
    pub(crate) fn rate(&self) -> f64 {
        match (self.readings.front(), self.readings.back()) {
            (Some((from, first)), Some((to, last))) if to > from => {
                (last - first) as f64 / to.duration_since(*from).as_secs_f64()
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_is_of_the_last_moments() {
        let (mut meter, begun) = (Meter::default(), Instant::now());
        let at = |ms| begun + Duration::from_millis(ms);
        meter.read(at(0), 0);
        assert_eq!(meter.rate(), 0.0);
        meter.read(at(500), 1000);
        assert_eq!(meter.rate(), 2000.0);
        meter.read(at(1000), 4000);
        meter.read(at(1900), 4900);
        assert_eq!(meter.rate(), 3900.0 / 1.4);
        meter.read(at(9000), 4900);
        assert_eq!(meter.rate(), 0.0, "nothing lately");
    }
}
