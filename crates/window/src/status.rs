//! What the line below the map says, and the measurements that F12 shows.

use super::model::AppModel;
use super::panels::accuracy;
use super::panels::status::{StatusLine, depth_words, short};
use flipmap_numbers::number_text::{count, fixed, significant};

impl AppModel {
    /// Returns the content of the line below the map.
    pub(super) fn status(&self) -> StatusLine {
        let progress = self.progress();
        let [across, _] = self.state.plane.axes();
        StatusLine {
            progress,
            left_secs: self.estimates.time_left.secs(),
            asks: self.state.question.ask.kind().asks,
            width: self.state.camera.width(),
            unit: across.unit(),
            sure: self.sure(),
            depth: self.depth(),
            warning: self.estimates.forecast.warning(),
            doing: self.doing(),
        }
    }

    /// Returns how sure the answers are, in a few words and in full, with the engine; while there
    /// is no engine, its state.
    fn sure(&self) -> (String, String) {
        match (self.compute.engine(), self.compute.config()) {
            (Some((name, adapter, why)), Some(config)) => {
                let (short, promise) = accuracy::sure_words(self.state.integration.spec.setting);
                let method = accuracy::words(&config);
                let whole = format!("{promise}\n{method}\n{name}: {adapter}\n{why}");
                (short, whole)
            }
            _ => {
                let said = self.compute.opening().map(|said| match said.is_empty() {
                    true => "opening the engine…".to_string(),
                    false => said,
                });
                let said = said.unwrap_or_else(|| "no engine: see Accuracy".to_string());
                (said.clone(), said)
            }
        }
    }

    /// Returns facts about the depth of a deep view: a short text, and the full one.
    fn depth(&self) -> Option<(String, String)> {
        let (depth, config) = self.compute.explorer.depth().zip(self.compute.config())?;
        Some(depth_words(&depth, config.precision, self.state.question.budget.secs))
    }

    /// Returns the longer task in progress, or what the view lacks.
    fn doing(&self) -> Option<String> {
        let path = &self.films.descent;
        let diving = path.running.is_some().then(|| match path.pace.is_paused {
            true => "the dive is paused: Space goes on, Esc stays here".to_string(),
            false => format!(
                "diving, × {} a second: the wheel changes the pace, Space pauses, Esc stays",
                fixed(path.pace.octaves_a_sec().exp2(), 1)
            ),
        });
        let flat = self.spread.flat_secs().map(|secs| {
            let to =
                if secs > 0.0 { format!(" to {} s", significant(secs, 1)) } else { String::new() };
            format!("flat{to}: nothing smaller here; D follows the nearest filament")
        });
        self.compute.following().or(diving).or(self.compute.comparing()).or(flat)
    }

    /// Returns the lines of the window's measurements: the work, then what its owner measured.
    pub(super) fn measurements(&self) -> Vec<String> {
        let progress = self.progress();
        let simulated = self.compute.explorer.counts().simulated;
        let rate = if progress.idle { 0.0 } else { self.meter.rate() };
        let (_, how) = self.sure();
        let mut lines: Vec<String> = how.lines().map(str::to_string).collect();
        lines.push(format!("level {}", progress.level));
        lines.push(format!("{} pendulums since the start", count(simulated)));
        if rate > 0.0 {
            lines.push(format!("{} pendulums/s", short(rate)));
        }
        if let Some((short, _)) = self.depth() {
            lines.push(short);
        }
        lines.extend(self.measured.iter().cloned());
        lines
    }
}
