//! The clock that a flight is watched by.

use std::ops::RangeInclusive;

/// How many simulated seconds may pass in a second.
pub const SPEEDS: RangeInclusive<f64> = 0.1..=10.0;

/// Where a watched flight is, and how it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    time_secs: f64,
    speed: f64,
    playing: bool,
}

impl Default for Playback {
    /// From the release, as fast as it is, going.
    fn default() -> Self {
        Playback { time_secs: 0.0, speed: 1.0, playing: true }
    }
}

impl Playback {
    /// Simulated seconds since the release.
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Simulated seconds in a second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Whether it goes on by itself.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Goes on by `elapsed_secs` of real time in a flight known up to `end_secs`. At the end of
    /// a `complete` flight it stops; before, it waits there for more.
    pub fn advance(&mut self, elapsed_secs: f64, end_secs: f64, complete: bool) {
        if self.playing {
            let ahead = self.time_secs + elapsed_secs * self.speed;
            self.time_secs = ahead.min(end_secs.max(self.time_secs));
        }
        if complete && self.time_secs >= end_secs {
            self.time_secs = end_secs;
            self.playing = false;
        }
    }

    /// Goes on from where it is, or from the release where it had come to `end_secs`.
    pub fn play(&mut self, end_secs: f64) {
        if self.time_secs >= end_secs {
            self.time_secs = 0.0;
        }
        self.playing = true;
    }

    /// Stops where it is.
    pub fn pause(&mut self) {
        self.playing = false;
    }

    /// Goes on from the release.
    pub fn restart(&mut self) {
        self.time_secs = 0.0;
        self.playing = true;
    }

    /// Goes to a moment; whether it plays does not change.
    pub fn scrub(&mut self, secs: f64) {
        self.time_secs = secs.max(0.0);
    }

    /// Simulated seconds in a second from now on, within [`SPEEDS`].
    pub fn set_speed(&mut self, speed: f64) {
        self.speed = speed.clamp(*SPEEDS.start(), *SPEEDS.end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_hour_of_frames_does_not_drift() {
        let mut playback = Playback::default();
        playback.set_speed(0.7);
        for _ in 0..3600 * 60 {
            playback.advance(1.0 / 60.0, 1e9, false);
        }
        assert!((playback.time_secs() - 3600.0 * 0.7).abs() < 1e-6);
    }

    #[test]
    fn it_waits_for_a_flight_under_way_and_stops_at_the_end_of_a_complete_one() {
        let mut playback = Playback::default();
        playback.advance(2.0, 1.5, false);
        assert_eq!((playback.time_secs(), playback.is_playing()), (1.5, true));
        playback.advance(2.0, 3.0, true);
        assert_eq!((playback.time_secs(), playback.is_playing()), (3.0, false));
        playback.play(3.0);
        assert_eq!((playback.time_secs(), playback.is_playing()), (0.0, true));
    }

    #[test]
    fn a_moment_ahead_of_what_is_known_is_kept_until_the_end_is_known() {
        let mut playback = Playback::default();
        playback.scrub(12.0);
        playback.advance(0.1, 3.0, false);
        assert_eq!(playback.time_secs(), 12.0);
        playback.advance(0.1, 10.0, true);
        assert_eq!(playback.time_secs(), 10.0);
    }

    #[test]
    fn a_pause_stays_and_speeds_are_kept_in_range() {
        let mut playback = Playback::default();
        playback.pause();
        playback.advance(5.0, 30.0, true);
        assert_eq!(playback.time_secs(), 0.0);
        playback.set_speed(1e3);
        assert_eq!(playback.speed(), 10.0);
        playback.scrub(7.0);
        playback.restart();
        assert_eq!((playback.time_secs(), playback.is_playing()), (0.0, true));
    }
}
