//! Progress of the work: a bar on a terminal, a line a minute elsewhere, objects of JSON for
//! machines.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{HumanCount, HumanDuration, ProgressBar, ProgressState, ProgressStyle};

use super::voice::{self, Voice, tell, tell_json};

/// Values of `--progress`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Mode {
    /// Progress bar if standard error is a terminal, otherwise a line a minute.
    #[default]
    Auto,
    /// No progress display.
    None,
    /// One JSON object per second on standard error, where all else is said as JSON too.
    Json,
}

/// The ways to show progress.
enum Display {
    Bar(ProgressBar),
    /// Lines at this distance in time, as text or as JSON.
    Lines(Duration, Voice),
    Nothing,
}

/// A display of the number of pixels, samples or frames that are done.
pub(super) struct Progress {
    display: Display,
    done: u64,
    total: u64,
    unit: &'static str,
    begun: Instant,
    last_line: Instant,
}

impl Progress {
    /// Starts at zero of `total` units of the given name.
    pub(super) fn new(mode: Mode, total: u64, unit: &'static str) -> Self {
        let display = match mode {
            Mode::Json => Display::Lines(Duration::from_secs(1), Voice::Json),
            Mode::Auto if voice::current() == Voice::Quiet => Display::Nothing,
            Mode::Auto if stderr().is_terminal() => Display::Bar(bar(total, unit)),
            Mode::Auto => Display::Lines(Duration::from_secs(60), Voice::Plain),
            Mode::None => Display::Nothing,
        };
        let now = Instant::now();
        Progress { display, done: 0, total, unit, begun: now, last_line: now }
    }

    /// Shows `done` units as done, and the text `doing` after them.
    pub(super) fn set(&mut self, done: u64, doing: Option<String>) {
        if let Display::Bar(bar) = &self.display {
            bar.set_message(doing.as_ref().map_or_else(String::new, |doing| format!(" · {doing}")));
            bar.set_position(done);
        }
        let Display::Lines(pause, voice) = self.display else { return };
        let is_due = self.last_line.elapsed() >= pause;
        let is_end = voice == Voice::Json && done == self.total && done != self.done;
        if is_end || (is_due && (done != self.done || voice == Voice::Plain)) {
            self.last_line = Instant::now();
            match voice {
                Voice::Json => tell_json(&self.object(done)),
                _ => tell(&self.line(done, doing)),
            }
        }
        self.done = done;
    }

    /// Returns the units done per second, and the seconds left.
    fn rate(&self, done: u64) -> (f64, f64) {
        let rate = done as f64 / self.begun.elapsed().as_secs_f64().max(1e-9);
        (rate, (self.total - done) as f64 / rate.max(1e-9))
    }

    fn object(&self, done: u64) -> serde_json::Value {
        let (rate, secs_left) = self.rate(done);
        serde_json::json!({
            "done": done, "total": self.total, format!("{}_per_sec", self.unit): rate,
            "secs_left": secs_left,
        })
    }

    fn line(&self, done: u64, doing: Option<String>) -> String {
        let (_, secs_left) = self.rate(done);
        let percent = 100 * done / self.total.max(1);
        let left = match done {
            0 => String::new(),
            _ => format!(", about {} left", HumanDuration(Duration::from_secs_f64(secs_left))),
        };
        let doing = doing.map_or_else(String::new, |doing| format!(" · {doing}"));
        format!("flipmap: {percent} % of {} {}{left}{doing}", self.total, self.unit)
    }
}

fn bar(total: u64, unit: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let style = format!(
        "{{wide_bar}} {{percent}}% · {{human_pos}} of {{human_len}} {unit} · {{rate}}{{left}}{{msg}}"
    );
    let style = ProgressStyle::with_template(&style).expect("a valid template");
    let rate = move |state: &ProgressState, out: &mut dyn Write| write_rate(state, out, unit);
    bar.with_style(style.with_key("rate", rate).with_key("left", write_left))
}

fn write_rate(state: &ProgressState, out: &mut dyn Write, unit: &str) {
    // Writing to the bar's own buffer cannot fail.
    let _ = write!(out, "{} {unit} a second", HumanCount(state.per_sec() as u64));
}

/// Writes the time left; nothing is known of it before the first unit is done.
fn write_left(state: &ProgressState, out: &mut dyn Write) {
    if state.pos() > 0 {
        let _ = write!(out, " · {} left", HumanDuration(state.eta()));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_tells_how_far_and_how_long() {
        let mut progress = Progress::new(Mode::None, 200, "pixels");
        progress.begun = Instant::now() - Duration::from_secs(60);
        assert_eq!(progress.line(0, None), "flipmap: 0 % of 200 pixels");
        let line = progress.line(100, Some("26 digits".to_string()));
        assert_eq!(line, "flipmap: 50 % of 200 pixels, about 60 seconds left · 26 digits");
        assert_eq!(progress.object(200)["secs_left"], 0.0);
    }
}
