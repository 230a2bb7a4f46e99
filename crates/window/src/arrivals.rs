//! When events of the user came, as well as can be known. The system hands them over without a
//! time, and those that come while a frame is drawn wait until it is done: what is certain is the
//! earliest moment at which they may have come.

use std::time::{Duration, Instant};

/// The earliest moments at which the events of the turns of the event loop may have come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrivals {
    /// Beginning of this turn of the loop.
    turn_began: Instant,
    /// Moment at which the loop last began to wait.
    waits_since: Instant,
    earliest: Instant,
}

/// Time above which the loop did wait: an event that was there already would have ended the wait
/// sooner.
const WAITED: Duration = Duration::from_millis(2);

impl Arrivals {
    /// Begins at a moment.
    pub(crate) fn new(now: Instant) -> Self {
        Arrivals { turn_began: now, waits_since: now, earliest: now }
    }

    /// Begins a turn of the loop, which handles the events that came before `now`. After a wait they
    /// have just come, otherwise at any time since the last turn began.
    pub(crate) fn begin_turn(&mut self, now: Instant) {
        let waited = now.saturating_duration_since(self.waits_since) > WAITED;
        self.earliest = if waited { now } else { self.turn_began };
        self.turn_began = now;
    }

    /// Records that the loop begins to wait.
    pub(crate) fn wait(&mut self, now: Instant) {
        self.waits_since = now;
    }

    /// Returns the earliest moment at which the events of this turn may have come.
    pub(crate) fn earliest(&self) -> Instant {
        self.earliest
    }
}

/// The times that egui is told, so that the time between two clicks counts and not that of the
/// frames that show them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FrameTimes {
    begun: Instant,
    last: Instant,
    /// Earliest moment of the newest press or release that no frame has shown yet, and true if there
    /// was a release.
    button: Option<(Instant, bool)>,
    /// Time by which the last click may have come later than its frame says.
    doubt: Duration,
}

/// The times of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrameTime {
    /// Time of the frame in s: that of its clicks, if it shows any.
    pub secs: f64,
    /// Time in s from one click to the next within which they are a double click.
    pub double_click_secs: f64,
}

/// Time in s within which two clicks are a double click.
const DOUBLE_CLICK_SECS: f64 = 0.3;

impl FrameTimes {
    /// Begins at a moment.
    pub(crate) fn new(now: Instant) -> Self {
        FrameTimes { begun: now, last: now, button: None, doubt: Duration::ZERO }
    }

    /// Records that a button was pressed or released at this moment or later.
    pub(crate) fn button(&mut self, earliest: Instant, released: bool) {
        let before = self.button.is_some_and(|(_, released)| released);
        self.button = Some((earliest, released || before));
    }

    /// Returns the times of a frame that begins now; they never go back.
    pub(crate) fn frame(&mut self, now: Instant) -> FrameTime {
        let doubt = self.doubt;
        let button = self.button.take();
        self.last = button.map_or(now, |(earliest, _)| earliest).max(self.last);
        if button.is_some_and(|(_, released)| released) {
            self.doubt = now.saturating_duration_since(self.last);
        }
        FrameTime {
            secs: (self.last - self.begun).as_secs_f64(),
            double_click_secs: DOUBLE_CLICK_SECS + doubt.as_secs_f64(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Event, Modifiers, PointerButton, RawInput, Rect, Sense, pos2, vec2};

    const AT: egui::Pos2 = pos2(40.0, 30.0);

    /// Returns the counts of the clicks that frames of this duration in ms show, if a button is
    /// pressed or released at these moments in ms.
    fn clicks(frame_ms: u64, buttons_ms: &[u64]) -> Vec<u32> {
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        let (ctx, mut times) = (egui::Context::default(), FrameTimes::new(begun));
        let (mut arrivals, mut now_ms) = (Arrivals::new(begun), 0);
        let (mut counts, mut pressed) = (Vec::new(), true);
        let mut coming = buttons_ms.iter().copied().peekable();
        arrivals.wait(begun);
        for frame in 0..8 {
            // The loop waits for an event, and otherwise draws on. No event comes before the first
            // frame, since which egui knows what can be clicked.
            let next_ms = coming.peek().copied().filter(|_| frame > 0);
            now_ms = next_ms.map_or(now_ms + 500, |next_ms| now_ms.max(next_ms));
            arrivals.begin_turn(at(now_ms));
            let mut events = vec![Event::PointerMoved(AT)];
            while coming.next_if(|ms| *ms <= now_ms).is_some() {
                times.button(arrivals.earliest(), !pressed);
                let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
                events.push(Event::PointerButton { pos: AT, button, pressed, modifiers });
                pressed = !pressed;
            }
            let FrameTime { secs, double_click_secs } = times.frame(at(now_ms));
            ctx.options_mut(|all| all.input_options.max_double_click_delay = double_click_secs);
            let time = Some(secs);
            let screen_rect = Some(Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0)));
            let raw = RawInput { time, events, screen_rect, ..RawInput::default() };
            // Nothing draws the textures.
            ctx.run_ui(raw, |ui| {
                let response = ui.allocate_rect(ui.max_rect(), Sense::click_and_drag());
                if response.clicked() {
                    counts.push(if response.double_clicked() { 2 } else { 1 });
                }
            })
            .textures_delta
            .clear();
            now_ms += frame_ms;
            arrivals.wait(at(now_ms));
        }
        counts
    }

    #[test]
    fn the_time_between_clicks_decides_whatever_frames_take() {
        for frame_ms in [5, 16, 150, 300, 450] {
            let double = clicks(frame_ms, &[1000, 1060, 1180, 1240]);
            assert_eq!(double.last(), Some(&2), "{frame_ms} ms: {double:?}");
            let pressed_long = clicks(frame_ms, &[1000, 1120, 1250, 1370]);
            assert_eq!(pressed_long.last(), Some(&2), "{frame_ms} ms: {pressed_long:?}");
            let apart = clicks(frame_ms, &[1000, 1060, 2180, 2240]);
            assert_eq!(apart, [1, 1], "{frame_ms} ms");
        }
    }

    #[test]
    fn events_that_end_a_wait_have_just_come_and_others_during_the_frame() {
        let begun = Instant::now();
        let at = |ms: u64| begun + Duration::from_millis(ms);
        let mut arrivals = Arrivals::new(begun);
        arrivals.wait(at(0));
        arrivals.begin_turn(at(700));
        assert_eq!(arrivals.earliest(), at(700));
        // A frame of 300 ms follows.
        arrivals.wait(at(1000));
        arrivals.begin_turn(at(1000));
        assert_eq!(arrivals.earliest(), at(700));
    }

    #[test]
    fn time_never_goes_back() {
        let begun = Instant::now();
        let mut times = FrameTimes::new(begun);
        let mut secs = |at: u64| times.frame(begun + Duration::from_secs(at)).secs;
        assert_eq!(secs(2), 2.0);
        times.button(begun + Duration::from_secs(1), false);
        let mut secs = |at: u64| times.frame(begun + Duration::from_secs(at)).secs;
        assert_eq!((secs(3), secs(4)), (2.0, 4.0));
    }
}
