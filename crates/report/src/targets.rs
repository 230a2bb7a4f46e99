//! Targets, compared with what was measured.

use serde::Serialize;

use super::levels::{rows_at, rows_with};
use super::plan::BALANCED_DF32;
use super::windows::{WINDOWS, Window};
use super::{Checks, DepthRow, LongFilm, Report, Row, films};
use flipmap_engine::{Accuracy, IntegratorConfig, Precision};

/// A target and its result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Target {
    /// Quantity that the target is about, and its engine.
    pub name: String,
    /// Required value, in words.
    pub target: String,
    /// Measured value, or `None` if it was not measured.
    pub measured: Option<f64>,
    /// True if the measured value meets the target, or `None` if it was not measured.
    pub met: Option<bool>,
}

/// A target for every engine that has rows of a kind.
struct TargetSpec {
    about: &'static str,
    of: RowSelector,
    target: &'static str,
    measure: fn(&Row) -> Option<f64>,
    /// Least and greatest value that meet the target.
    bounds: [f64; 2],
}

/// Selection of the rows that a target is about.
enum RowSelector {
    Level(Accuracy),
    Config(IntegratorConfig),
}

const ENDLESS: f64 = f64::INFINITY;

fn right(row: &Row) -> Option<f64> {
    row.errors.right_1ms
}

fn times_scalar(row: &Row) -> Option<f64> {
    Some(row.times_scalar)
}

/// Speed of each thread as a multiple of the scalar loop's, for the processor only.
fn times_scalar_per_core(row: &Row) -> Option<f64> {
    Some(row.times_scalar / row.threads? as f64)
}

fn unmarked_wrong(row: &Row) -> Option<f64> {
    Some(row.checks?.unmarked_wrong as f64)
}

fn marked_share(row: &Row) -> Option<f64> {
    row.checks?.marked_share()
}

/// Targets for the rows of the home map.
const TARGETS: [TargetSpec; 11] = [
    TargetSpec {
        about: "lesson: share right within 1 ms",
        of: RowSelector::Level(Accuracy::Lesson),
        target: "0.89 to 0.92, as the lesson is",
        measure: right,
        bounds: [0.89, 0.92],
    },
    TargetSpec {
        about: "lesson: speed",
        of: RowSelector::Level(Accuracy::Lesson),
        target: "at least 20 times the scalar loop",
        measure: times_scalar,
        bounds: [20.0, ENDLESS],
    },
    TargetSpec {
        about: "fast: share right within 1 ms",
        of: RowSelector::Level(Accuracy::Fast),
        target: "at least 0.925",
        measure: right,
        bounds: [0.925, ENDLESS],
    },
    TargetSpec {
        about: "fast: speed",
        of: RowSelector::Level(Accuracy::Fast),
        target: "at least 30 times the scalar loop",
        measure: times_scalar,
        bounds: [30.0, ENDLESS],
    },
    TargetSpec {
        about: "balanced: share right within 1 ms",
        of: RowSelector::Level(Accuracy::Balanced),
        target: "at least 0.999",
        measure: right,
        bounds: [0.999, ENDLESS],
    },
    TargetSpec {
        about: "balanced: speed",
        of: RowSelector::Level(Accuracy::Balanced),
        target: "at least 10 times the scalar loop",
        measure: times_scalar,
        bounds: [10.0, ENDLESS],
    },
    TargetSpec {
        about: "balanced: speed of each core",
        of: RowSelector::Level(Accuracy::Balanced),
        target: "at least 5 times the scalar loop on one core",
        measure: times_scalar_per_core,
        bounds: [5.0, ENDLESS],
    },
    TargetSpec {
        about: "balanced forced to df32: share right within 1 ms",
        of: RowSelector::Config(BALANCED_DF32),
        target: "at least 0.99",
        measure: right,
        bounds: [0.99, ENDLESS],
    },
    TargetSpec {
        about: "exact: wrong pixels that are not marked",
        of: RowSelector::Level(Accuracy::Exact),
        target: "none",
        measure: unmarked_wrong,
        bounds: [0.0, 0.0],
    },
    TargetSpec {
        about: "exact: share marked as uncertain",
        of: RowSelector::Level(Accuracy::Exact),
        target: "at most 0.001",
        measure: marked_share,
        bounds: [0.0, 0.001],
    },
    TargetSpec {
        about: "exact: speed",
        of: RowSelector::Level(Accuracy::Exact),
        target: "at least 4 times the scalar loop",
        measure: times_scalar,
        bounds: [4.0, ENDLESS],
    },
];

/// Judges every target on all that it is about; one without measurements is listed unmeasured.
pub(super) fn judge(report: &Report) -> Vec<Target> {
    let mut targets: Vec<Target> = TARGETS.iter().flat_map(|hope| hope.judge(report)).collect();
    targets.extend(WINDOWS.iter().map(|window| of_window(report, window)));
    targets.push(of_late(report));
    targets.extend(of_depth(report));
    targets.extend(of_hard(report));
    targets.extend(of_films(report));
    targets
}

fn of_window(report: &Report, window: &Window) -> Target {
    let row = report.windows.iter().find(|row| row.window == window.name);
    let measured = row.and_then(|row| row.errors.right_1ms);
    let name = format!("window {}: share right within 1 ms", window.name);
    let least = window.least_right();
    Target::new(name, &format!("at least {least}"), measured, [least, ENDLESS])
}

/// The target for all late windows together.
fn of_late(report: &Report) -> Target {
    let checks: Checks = report.late.iter().map(|row| row.checks).sum();
    let measured = (checks.pixels > 0).then_some(checks.unmarked_wrong as f64);
    let name = "exact beside double-double, late flips: wrong pixels that are not marked";
    Target::new(name.to_string(), "none", measured, [0.0, 0.0])
}

/// The targets for deep zoom, by engine and precision, judged by the worst of all widths.
fn of_depth(report: &Report) -> Vec<Target> {
    let mut targets = Vec::new();
    for rows in report.depth.chunk_by(|a, b| a.engine == b.engine && a.config == b.config) {
        let DepthRow { engine, config, .. } = &rows[0];
        let about = format!("deep zoom in {} on {engine}", config.precision);
        let least = match config.precision {
            Precision::F32 => 0.9,
            Precision::Df32 => 0.98,
            _ => 0.99,
        };
        let right = rows.iter().filter_map(|row| row.errors.right_1ms).reduce(f64::min);
        let name = format!("{about}: least share right within 1 ms at any width");
        targets.push(Target::new(name, &format!("at least {least}"), right, [least, ENDLESS]));
        for (what, most, of) in COSTS {
            let mut costs = rows.iter().filter(|row| row.width_rad <= WIDEST_RAD).map(of);
            let first = costs.next();
            let ratio = first.zip(costs.reduce(f64::max)).map(|(first, most)| most / first);
            let name = format!("{about}: {what} of a pixel, the most beside the widest view");
            targets.push(Target::new(name, &format!("at most {most} times"), ratio, [0.0, most]));
        }
    }
    targets
}

type Cost = (&'static str, f64, fn(&DepthRow) -> f64);

/// Width in rad of the widest view on the filament; most pixels of wider ones flip early.
const WIDEST_RAD: f64 = 0.01;
/// Limits on the cost of a deep pixel, as multiples of the cost in the widest view.
const COSTS: [Cost; 2] =
    [("steps", 1.0, |row| row.steps_per_pixel), ("time", 1.3, |row| row.us_per_pixel)];

/// The targets for the hard cases, by engine.
fn of_hard(report: &Report) -> Vec<Target> {
    let mut engines: Vec<&str> = report.hard.iter().map(|row| row.engine.as_str()).collect();
    engines.dedup();
    let all = "hard cases: share as expected";
    let target = |name: String, measured| Target::new(name, "all", measured, [1.0, 1.0]);
    if engines.is_empty() {
        return vec![target(all.to_string(), None)];
    }
    let of_engine = |engine: &str| {
        let rows = report.hard.iter().filter(|row| row.engine == engine);
        let held = rows.clone().filter(|row| row.held).count() as f64;
        target(format!("{all}, on {engine}"), Some(held / rows.count() as f64))
    };
    engines.into_iter().map(of_engine).collect()
}

/// Longest time that the long film may take, min.
const FILM_MINUTES: f64 = 20.0;

/// The target for the long film, unless none of it was measured.
fn of_films(report: &Report) -> Option<Target> {
    if !films::are_measured(report) {
        return None;
    }
    let minutes = LongFilm::of(report).map(|film| film.secs() / 60.0);
    let name = "film of 60 s to 6e-61 rad: minutes that it takes".to_string();
    Some(Target::new(name, &format!("at most {FILM_MINUTES}"), minutes, [0.0, FILM_MINUTES]))
}

impl TargetSpec {
    fn judge(&self, report: &Report) -> Vec<Target> {
        let rows = match self.of {
            RowSelector::Level(level) => rows_at(report, level),
            RowSelector::Config(config) => rows_with(report, config),
        };
        let measured: Vec<Target> = rows
            .into_iter()
            .filter_map(|row| {
                let name = format!("{}, on {}", self.about, row.short_name());
                Some(self.target(name, Some((self.measure)(row)?)))
            })
            .collect();
        if measured.is_empty() {
            return vec![self.target(self.about.to_string(), None)];
        }
        measured
    }

    fn target(&self, name: String, measured: Option<f64>) -> Target {
        Target::new(name, self.target, measured, self.bounds)
    }
}

impl Target {
    /// A target that is met if `measured` lies within `bounds`, both included.
    fn new(name: String, target: &str, measured: Option<f64>, bounds: [f64; 2]) -> Self {
        let met = measured.map(|measured| measured >= bounds[0] && measured <= bounds[1]);
        Target { name, target: target.to_string(), measured, met }
    }
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;
    use crate::plan::{BALANCED, FAST, LESSON};
    use flipmap_engine::EngineKind;

    fn row(config: IntegratorConfig, right: f64, times: f64) -> Row {
        let mut row = Row::named(EngineKind::Cpu, "2 threads", Some(2), config);
        (row.errors.right_1ms, row.times_scalar) = (Some(right), times);
        row
    }

    fn met(report: &Report, about: &str) -> Option<bool> {
        judge(report).iter().find(|target| target.name.starts_with(about)).unwrap().met
    }

    fn of_rows(rows: &[Row], about: &str) -> Option<bool> {
        met(&Report { rows: rows.to_vec(), ..fixtures::report() }, about)
    }

    #[test]
    fn targets_are_met_missed_or_not_measured() {
        for (about, config, good, bad) in [
            ("lesson: share", LESSON, (0.9, 1.0), (0.93, 1.0)),
            ("lesson: share", LESSON, (0.9, 1.0), (0.88, 1.0)),
            ("lesson: speed", LESSON, (0.0, 20.1), (0.0, 19.9)),
            ("fast: share", FAST, (0.926, 1.0), (0.924, 1.0)),
            ("fast: speed", FAST, (0.0, 30.1), (0.0, 29.9)),
            ("balanced: share", BALANCED, (0.9995, 1.0), (0.9985, 1.0)),
            ("balanced: share", BALANCED_DF32, (0.9995, 1.0), (0.9985, 1.0)),
            ("balanced: speed of each core", BALANCED, (0.0, 10.1), (0.0, 9.9)),
            ("balanced forced to df32", BALANCED_DF32, (0.991, 0.0), (0.989, 0.0)),
        ] {
            assert_eq!(of_rows(&[row(config, good.0, good.1)], about), Some(true), "{about}");
            assert_eq!(of_rows(&[row(config, bad.0, bad.1)], about), Some(false), "{about}");
            assert_eq!(of_rows(&[], about), None, "{about}");
        }
        assert_eq!(of_rows(&[row(LESSON, f64::NAN, 1.0)], "lesson: share"), Some(false));
    }

    fn exact(pixels: usize, marked: usize, unmarked_wrong: usize, times: f64) -> Report {
        let mut row = row(BALANCED, 1.0, times);
        row.checks = Some(Checks { pixels, marked, unmarked_wrong, ..Checks::default() });
        Report { exact: vec![row], ..fixtures::report() }
    }

    #[test]
    fn exact_may_not_lie_nor_mark_much_nor_dawdle() {
        for (about, good, bad) in [
            ("exact: wrong", exact(1000, 1, 0, 4.0), exact(1000, 1, 1, 4.0)),
            ("exact: share marked", exact(1000, 1, 0, 4.0), exact(1000, 2, 0, 4.0)),
            ("exact: speed", exact(1000, 1, 0, 4.0), exact(1000, 1, 0, 3.9)),
        ] {
            assert_eq!(met(&good, about), Some(true), "{about}");
            assert_eq!(met(&bad, about), Some(false), "{about}");
            let none = Report { exact: Vec::new(), ..fixtures::report() };
            assert_eq!(met(&none, about), None, "{about}");
        }
    }

    #[test]
    fn windows_late_flips_and_hard_cases_can_be_missed() {
        let judged = |change: &dyn Fn(&mut Report), about: &str| {
            let mut report = fixtures::report();
            change(&mut report);
            met(&report, about)
        };
        let name = fixtures::report().windows[0].window.clone();
        let window = |right: f64| {
            let change = move |report: &mut Report| {
                report.windows[0].errors.right_1ms = Some(right);
            };
            judged(&change, &format!("window {name}:"))
        };
        assert_eq!([0.9901, 0.9899].map(window), [Some(true), Some(false)]);
        let late = |wrong: usize| {
            let change = move |report: &mut Report| report.late[0].checks.unmarked_wrong = wrong;
            judged(&change, "exact beside double-double")
        };
        assert_eq!([0, 1].map(late), [Some(true), Some(false)]);
        let hard = |held: bool| {
            judged(&move |report: &mut Report| report.hard[0].held = held, "hard cases")
        };
        assert_eq!([true, false].map(hard), [Some(true), Some(false)]);
        let deep = |share: f64, steps: f64| {
            let change = move |report: &mut Report| {
                report.depth.iter_mut().for_each(|row| row.errors.right_1ms = Some(share));
                report.depth[1].steps_per_pixel = steps;
            };
            let about = "deep zoom in f64 on cpu: ";
            ["least share", "steps"].map(|what| judged(&change, &format!("{about}{what}")))
        };
        assert_eq!(deep(0.991, 150.0), [Some(true); 2]);
        assert_eq!(deep(0.989, 151.0), [Some(false); 2]);
        let film = |factor: f64| {
            let slow = move |report: &mut Report| {
                report.painting.as_mut().unwrap().secs *= factor;
            };
            judged(&slow, "film of 60 s")
        };
        // The frames of the invented report take a quarter of an hour, its samples a second.
        assert_eq!([1.33, 1.34].map(film), [Some(true), Some(false)]);
        let part = |report: &mut Report| report.painting = None;
        assert_eq!(judged(&part, "film of 60 s"), None);
        let clear = |report: &mut Report| {
            (report.windows, report.late, report.hard) = Default::default();
        };
        for about in [&format!("window {name}:"), "exact beside double-double", "hard cases"] {
            assert_eq!(judged(&clear, about), None, "{about}");
        }
    }
}
