//! Progress of the work: a bar on a terminal, lines of JSON for machines, silence elsewhere.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::time::{Duration, Instant};

use clap::ValueEnum;
use indicatif::{HumanCount, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

/// Values of `--progress`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum Mode {
    /// Progress bar if standard error is a terminal.
    #[default]
    Auto,
    /// No progress display.
    None,
    /// One JSON object per second on standard error.
    Json,
}

/// A display of the number of pixels, samples or frames that are done.
pub(super) struct Progress {
    bar: ProgressBar,
    json: bool,
    total: u64,
    unit: &'static str,
    begun: Instant,
    last_line: Instant,
}

impl Progress {
    /// Starts at zero of `total` units of the given name.
    pub(super) fn new(mode: Mode, total: u64, unit: &'static str) -> Self {
        let shown = mode == Mode::Auto && stderr().is_terminal();
        let target =
            if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(total), target);
        let style = format!(
            "{{wide_bar}} {{percent}}% · {{human_pos}} of {{human_len}} {unit} · {{rate}} · {{eta}} \
             left{{msg}}"
        );
        let style = ProgressStyle::with_template(&style).expect("a valid template");
        let rate = move |state: &ProgressState, out: &mut dyn Write| write_rate(state, out, unit);
        bar.set_style(style.with_key("rate", rate));
        let now = Instant::now();
        Progress { bar, json: mode == Mode::Json, total, unit, begun: now, last_line: now }
    }

    /// Shows `done` units as done, and the text `doing` after them.
    pub(super) fn set(&mut self, done: u64, doing: Option<String>) {
        self.bar.set_message(doing.map_or_else(String::new, |doing| format!(" · {doing}")));
        if done == self.bar.position() {
            return;
        }
        self.bar.set_position(done);
        let complete = done == self.total;
        if self.json && (complete || self.last_line.elapsed() >= Duration::from_secs(1)) {
            self.last_line = Instant::now();
            let secs = self.begun.elapsed().as_secs_f64();
            let rate = done as f64 / secs.max(1e-9);
            let secs_left = (self.total - done) as f64 / rate.max(1e-9);
            let line = serde_json::json!({
                "done": done, "total": self.total, format!("{}_per_sec", self.unit): rate,
                "secs_left": secs_left,
            });
            super::tell(&line.to_string());
        }
    }
}

fn write_rate(state: &ProgressState, out: &mut dyn Write, unit: &str) {
    // Writing to the bar's own buffer cannot fail.
    let _ = write!(out, "{} {unit} a second", HumanCount(state.per_sec() as u64));
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
