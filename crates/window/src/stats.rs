//! The window's measurements of itself: how soon the map is there, how often it is drawn, how fast
//! it responds, and what it shows. `flipmap explore --stats FILE` writes them whenever the view is
//! complete and still and when the window closes; the debug panel shows them.

use std::path::Path;
use std::time::{Duration, Instant};

use super::model::AppModel;
use flipmap_numbers::Scalar;
use flipmap_render::output::{Destination, SafeFile};
use flipmap_render::tiles::explorer::ViewProgress;
use flipmap_scene::location;

/// Measurements since the window was opened.
#[derive(Debug)]
pub(crate) struct Stats {
    begun: Instant,
    window_secs: Option<f64>,
    first_coarse_secs: Option<f64>,
    full_secs: Option<f64>,
    frames: Vec<f32>,
    /// Frames while the map was dragged and something was computed.
    panning: Stretch,
    /// Frames while a figure of the laboratory was shown.
    figure: Stretch,
    /// Arrival times of input that no frame has shown yet.
    waiting: Vec<Instant>,
    latencies: Vec<f32>,
}

/// Number and total time of consecutive frames of one kind.
#[derive(Debug, Default)]
struct Stretch {
    since: Option<Instant>,
    frames: u32,
    secs: f64,
}

/// Largest number of frames and of latencies measured: about an hour's worth.
const MAX_FRAMES: usize = 1 << 18;

impl Default for Stats {
    fn default() -> Self {
        Stats {
            begun: Instant::now(),
            window_secs: None,
            first_coarse_secs: None,
            full_secs: None,
            frames: Vec::new(),
            panning: Stretch::default(),
            figure: Stretch::default(),
            waiting: Vec::new(),
            latencies: Vec::new(),
        }
    }
}

/// Quantiles of many numbers.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Quantiles {
    /// Number of values.
    pub count: usize,
    /// Median: half of the values are at most this.
    pub p50: f32,
    /// 95th percentile: 95 of 100 values are at most this.
    pub p95: f32,
    /// Largest value.
    pub max: f32,
}

/// The state of a window: what it shows and holds.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub(crate) struct Holdings {
    /// Location of the view, as a line that can be pasted.
    pub location: String,
    /// Width and height of the map in physical pixels; it begins at the window's upper left corner.
    pub map_px: [f64; 2],
    /// Number of tiles of the finest level in view.
    pub tiles: usize,
    /// Number of those tiles that are computed.
    pub tiles_done: usize,
    /// True if nothing is left to compute, except finer samples at edges.
    pub idle: bool,
    /// True if finer samples at edges are being computed.
    pub refines: bool,
    /// Starts of the pinned pixels in rad.
    pub pins: Vec<[f64; 2]>,
    /// Number of pins whose flight has ended.
    pub flown: usize,
    /// Notices that are shown.
    pub notices: Vec<String>,
    /// Name of the laboratory's figure that is shown instead of the map.
    pub figure: Option<&'static str>,
    /// Values that the user has set in the figure, the start first.
    pub figure_set: Vec<f64>,
    /// Number of starts integrated.
    pub simulated: u64,
    /// Number of right-hand sides evaluated for them.
    pub rhs_evaluations: u64,
    /// Size of the cached tiles in bytes.
    pub cache_bytes: usize,
}

/// All measurements, in the form in which they are written.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct StatsReport {
    /// Current state of the window.
    #[serde(flatten)]
    pub holdings: Holdings,
    /// Time from the start of the program to the first frame, in s.
    pub window_secs: Option<f64>,
    /// Time to the first frame with something drawn for every cell in view, in s.
    pub first_coarse_secs: Option<f64>,
    /// Time to the first frame with the whole view at its finest level, in s.
    pub full_secs: Option<f64>,
    /// Time to make and present a frame, in ms.
    pub frame_ms: Option<Quantiles>,
    /// Latency from input to the frame that shows it, in ms; input that came during another frame
    /// counts from the beginning of that frame, so the latency is never underestimated.
    pub input_ms: Option<Quantiles>,
    /// Number of frames drawn while the map was dragged and something was being computed.
    pub panning_frames: u32,
    /// Duration of that dragging in s.
    pub panning_secs: f64,
    /// Frames per second during that dragging.
    pub panning_fps: Option<f64>,
    /// Time for which figures of the laboratory were shown, in s.
    pub figure_secs: f64,
    /// Frames per second during that time.
    pub figure_fps: Option<f64>,
    /// Largest memory the process ever held, in bytes, if the system reports it.
    pub peak_bytes: Option<u64>,
}

impl Holdings {
    /// Returns the state of the window of a model.
    pub(crate) fn of(model: &AppModel) -> Self {
        let (state, explorer) = (&model.state, &model.compute.explorer);
        let (progress, counts) = (explorer.progress(), explorer.counts());
        Holdings {
            location: location::text(&state.document().scene()),
            map_px: (state.canvas * state.pixels_per_point).to_array(),
            tiles: progress.wanted,
            tiles_done: progress.done,
            idle: progress.idle,
            refines: progress.refines,
            pins: state.pins.iter().map(|pin| pin.start.angle.map(Scalar::to_f64)).collect(),
            flown: state.pins.iter().filter(|p| p.flight.record().ending.is_some()).count(),
            notices: state.notices.iter().map(|notice| notice.text.clone()).collect(),
            figure: model.figure_shown(),
            figure_set: model.lab.set(),
            simulated: counts.simulated,
            rhs_evaluations: counts.effort.rhs_evaluations,
            cache_bytes: explorer.bytes(),
        }
    }
}

impl Stats {
    /// Creates empty measurements that count from the start of the program.
    pub(crate) fn since(begun: Instant) -> Self {
        Stats { begun, ..Stats::default() }
    }

    /// Records an input that came at `earliest` or later.
    pub(crate) fn input(&mut self, earliest: Instant) {
        self.waiting.push(earliest);
    }

    /// Records a presented frame that began at `began` and shows this progress.
    pub(crate) fn frame(&mut self, began: Instant, progress: &ViewProgress, dragging: bool) {
        let now = Instant::now();
        let secs = (now - self.begun).as_secs_f64();
        self.window_secs.get_or_insert(secs);
        if progress.covered && progress.wanted > 0 {
            self.first_coarse_secs.get_or_insert(secs);
        }
        if progress.is_complete() {
            self.full_secs.get_or_insert(secs);
        }
        push(&mut self.frames, now - began);
        for came in self.waiting.drain(..) {
            push(&mut self.latencies, now - came);
        }
        self.panning.frame(now, dragging && !progress.idle);
    }

    /// Records whether the frame showed a figure of the laboratory.
    pub(crate) fn figure(&mut self, shown: bool) {
        self.figure.frame(Instant::now(), shown);
    }

    /// Returns the measurements so far.
    pub(crate) fn report(&self, holdings: Holdings) -> StatsReport {
        StatsReport {
            holdings,
            window_secs: self.window_secs,
            first_coarse_secs: self.first_coarse_secs,
            full_secs: self.full_secs,
            frame_ms: quantiles(&self.frames),
            input_ms: quantiles(&self.latencies),
            panning_frames: self.panning.frames,
            panning_secs: self.panning.secs,
            panning_fps: self.panning.fps(),
            figure_secs: self.figure.secs,
            figure_fps: self.figure.fps(),
            peak_bytes: peak_bytes(),
        }
    }
}

impl Stretch {
    fn frame(&mut self, now: Instant, goes_on: bool) {
        if let Some(since) = self.since.filter(|_| goes_on) {
            self.frames += 1;
            self.secs += (now - since).as_secs_f64();
        }
        self.since = goes_on.then_some(now);
    }

    fn fps(&self) -> Option<f64> {
        (self.secs > 0.0).then(|| f64::from(self.frames) / self.secs)
    }
}

impl StatsReport {
    /// Returns the report as lines of text for people.
    pub(crate) fn lines(&self) -> Vec<String> {
        let secs = |name: &str, secs: Option<f64>| secs.map(|secs| format!("{name} {secs:.2} s"));
        let ms = |name: &str, all: Option<Quantiles>| {
            all.map(|q| format!("{name} {:.0} ms, p95 {:.0}, most {:.0}", q.p50, q.p95, q.max))
        };
        let mib = |bytes: u64| bytes >> 20;
        [
            secs("first frame", self.window_secs),
            secs("first map", self.first_coarse_secs),
            secs("whole map", self.full_secs),
            ms("frame", self.frame_ms),
            ms("input", self.input_ms),
            self.panning_fps.map(|fps| format!("dragging {fps:.0} frames/s")),
            self.figure_fps.map(|fps| format!("laboratory {fps:.0} frames/s")),
            Some(format!("tiles {} MiB", mib(self.holdings.cache_bytes as u64))),
            self.peak_bytes.map(|bytes| format!("memory, at most {} MiB", mib(bytes))),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// Writes the report as JSON.
    pub(crate) fn write(&self, path: &Path) -> std::io::Result<()> {
        let mut file = SafeFile::create(&Destination::from(path))?;
        serde_json::to_writer_pretty(&mut file, self).map_err(std::io::Error::other)?;
        file.finish()
    }
}

fn push(list: &mut Vec<f32>, took: Duration) {
    if list.len() < MAX_FRAMES {
        list.push(1e3 * took.as_secs_f32());
    }
}

fn quantiles(numbers: &[f32]) -> Option<Quantiles> {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| sorted[((sorted.len() - 1) as f64 * share).round() as usize];
    (!sorted.is_empty()).then(|| Quantiles {
        count: sorted.len(),
        p50: at(0.5),
        p95: at(0.95),
        max: at(1.0),
    })
}

/// Returns the largest resident size of this process in bytes, as Linux reports it.
fn peak_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib << 10)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn progress(done: usize, covered: bool) -> ViewProgress {
        let (share, idle) = (done as f64 / 10.0, done == 10);
        ViewProgress {
            level: 3,
            wanted: 10,
            done,
            share,
            way: share,
            covered,
            idle,
            refines: false,
        }
    }

    #[test]
    fn the_map_is_first_there_then_whole() {
        let mut stats = Stats::default();
        let now = Instant::now();
        stats.frame(now, &progress(0, false), false);
        let report = stats.report(Holdings::default());
        assert!(report.window_secs.is_some() && report.first_coarse_secs.is_none());
        stats.frame(now, &progress(2, true), false);
        assert!(stats.report(Holdings::default()).full_secs.is_none());
        stats.frame(now, &progress(10, true), false);
        let report = stats.report(Holdings { simulated: 7, ..Holdings::default() });
        assert!(report.full_secs >= report.first_coarse_secs);
        let written = serde_json::to_value(&report).unwrap();
        assert_eq!(written["simulated"], 7, "what is held lies beside what was measured");
        assert_eq!(report.frame_ms.unwrap().count, 3);
    }

    #[test]
    fn every_input_waits_for_the_next_frame() {
        let mut stats = Stats::default();
        let earlier = Instant::now() - Duration::from_millis(40);
        stats.input(earlier);
        stats.input(earlier);
        stats.frame(Instant::now(), &progress(0, false), true);
        stats.frame(Instant::now(), &progress(0, false), true);
        let report = stats.report(Holdings::default());
        let latency = report.input_ms.unwrap();
        assert!(latency.count == 2 && latency.p50 >= 40.0);
        assert_eq!(report.panning_frames, 1, "from one frame of a drag to the next");
    }

    #[test]
    fn quantiles_are_of_the_sorted() {
        let all: Vec<f32> = (1..=100).rev().map(|k| k as f32).collect();
        let q = quantiles(&all).unwrap();
        assert_eq!((q.count, q.p95, q.max), (100, 95.0, 100.0));
        assert!(quantiles(&[]).is_none());
    }
}
