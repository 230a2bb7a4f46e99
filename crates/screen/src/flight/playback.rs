//! The clock that sets the moment of a flight to show.

use std::ops::RangeInclusive;

/// Range of playback speeds, in simulated seconds per second.
pub const SPEEDS: RangeInclusive<f64> = 0.1..=10.0;

/// The playback state of a watched flight: its time, speed, and whether it plays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playback {
    time_secs: f64,
    speed: f64,
    playing: bool,
}

impl Default for Playback {
    /// Starts at the release, playing in real time.
    fn default() -> Self {
        Playback { time_secs: 0.0, speed: 1.0, playing: true }
    }
}

impl Playback {
    /// Returns a playback that is paused at the release.
    pub fn at_rest() -> Self {
        Playback { playing: false, ..Playback::default() }
    }

    /// Simulated seconds since the release.
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Playback speed in simulated seconds per second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Returns true if the playback is running.
    pub fn is_playing(&self) -> bool {
        self.playing
    }

    /// Advances by `elapsed_secs` of real time in a flight known up to `end_secs`. Stops at the end
    /// of a `complete` flight; waits for more at the end of an incomplete one.
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

    /// Resumes from the current time, or from the release if the playback had reached `end_secs`.
    pub fn play(&mut self, end_secs: f64) {
        if self.time_secs >= end_secs {
            self.time_secs = 0.0;
        }
        self.playing = true;
    }

    /// Stops at the current time.
    pub fn pause(&mut self) {
        self.playing = false;
    }

    /// Plays from the release.
    pub fn restart(&mut self) {
        self.time_secs = 0.0;
        self.playing = true;
    }

    /// Jumps to a moment, without starting or stopping the playback.
    pub fn scrub(&mut self, secs: f64) {
        self.time_secs = secs.max(0.0);
    }

    /// Sets the speed in simulated seconds per second, clamped to [`SPEEDS`].
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
