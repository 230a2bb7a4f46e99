//! An invented report for the tests of the code that writes reports.

use super::depth::UsByWay;
use super::*;
use flipmap_engine::EngineKind;
use flipmap_pendulum::{Outcome, Status};

/// A report with two rows, a refusal by an engine, and one measurement missing.
pub(super) fn report() -> Report {
    let flip = |time| Outcome::flipped(time);
    let still = Outcome::without_time(Status::Unflipped);
    let pairs = [(flip(1.0), flip(1.0)), (flip(7.1), flip(7.0)), (still, still)];
    let row = |config, us| {
        let mut row = Row::named(EngineKind::Cpu, "2 threads, no SIMD", Some(2), config);
        (row.us_per_pixel, row.times_scalar, row.spread) = (us, 70.0 / us, 0.05);
        row.errors = Errors::of(&pairs);
        row.bands = statistics::bands(&pairs);
        row
    };
    let rows = vec![row(plan::LESSON, 2.0), row(plan::BALANCED, 6.0)];
    let refusal = Refusal {
        engine: "cpu (2 threads)".to_string(),
        what: "dop853 in df32".to_string(),
        reason: "the processor has no such <thing>".to_string(),
    };
    let mut exact = row(plan::BALANCED, 11.0);
    exact.checks = Some(Checks { pixels: 3, agreed: 2, settled: 1, ..Checks::default() });
    let mut report = Report {
        machine: Machine::here(vec!["cpu (2 threads, no SIMD)".to_string()]),
        quick: true,
        sample: 3,
        missing: vec!["cpu: something|else".to_string()],
        rows,
        not_offered: vec![refusal],
        exact: vec![exact],
        windows: vec![window(&pairs)],
        late: vec![late()],
        depth: vec![depth(2e-3, &pairs), depth(2e-18, &pairs)],
        questions: vec![question()],
        zooms: films::ZOOMS.iter().map(zoom).collect(),
        painting: Some(PaintingRow { film_samples: 1_000_000, frames: 24, secs: 6.0 }),
        hard: vec![hard()],
        ..Report::default()
    };
    report.claims = claims::claims(&report);
    report
}

/// A zoom of a million samples a second.
fn zoom(zoom: &films::ShortZoom) -> ZoomRow {
    let (engine, config) = ("cpu".to_string(), plan::BALANCED);
    ZoomRow { engine, config, width_rad: zoom.width_rad, samples: 3_000_000, secs: 3.0 }
}

/// A row of another question.
fn question() -> QuestionRow {
    QuestionRow {
        question: "state",
        budget_secs: 12.0,
        engine: "cpu".to_string(),
        config: plan::BALANCED,
        us_per_pixel: 20.0,
        compared: 256,
        right: 0.996,
        median_error: Some(2e-9),
        p90_error: Some(1e-6),
        tolerance: "1e-3 rad",
    }
}

/// A row of deep zoom.
pub(super) fn depth(width_rad: f64, pairs: &[(Outcome, Outcome)]) -> DepthRow {
    DepthRow {
        engine: "cpu".to_string(),
        config: plan::BALANCED,
        width_rad,
        budget_secs: 60.0,
        digits: 40,
        first_secs: 0.5,
        errors: Errors::of(pairs),
        rhs_per_pixel: 2000.0,
        steps_per_pixel: 150.0,
        us_per_pixel: 20.0,
        us_by_way: Some(UsByWay { directly: None, by_cells: 30.0, by_lines: 20.0 }),
    }
}

const FLIPS: Flips = Flips { unflipped: Some(0.25), median_secs: Some(21.5) };

fn window(pairs: &[(Outcome, Outcome)]) -> WindowRow {
    let window = &windows::WINDOWS[0];
    WindowRow {
        window: window.name.to_string(),
        place: window.place(),
        rule: window.rule,
        engine: "cpu".to_string(),
        config: plan::BALANCED,
        judge: window.judge.words(),
        errors: Errors::of(pairs),
        flips: FLIPS,
        least_right: window.least_right(),
    }
}

fn late() -> LateRow {
    LateRow {
        window: "late".to_string(),
        place: "somewhere".to_string(),
        engine: "cpu".to_string(),
        flips: FLIPS,
        checks: Checks { pixels: 10, confirmed: 9, settled: 1, ..Checks::default() },
        oracle_asked: 2,
        oracle_disagrees: 0,
    }
}

fn hard() -> HardRow {
    HardRow {
        case: "made up",
        engine: "cpu".to_string(),
        expected: "nothing",
        why: "nobody measured it",
        measured: "nothing".to_string(),
        held: true,
    }
}

#[test]
fn json_has_the_agreed_names() {
    let object = serde_json::to_value(report()).unwrap();
    let row = &object["rows"][0];
    for name in [
        "engine",
        "adapter",
        "method",
        "precision",
        "setting",
        "us_per_pixel",
        "spread",
        "right_1ms",
        "wrong_class",
        "median",
        "p90",
        "p99",
        "max",
        "rhs_per_pixel",
        "steps_per_pixel",
        "lane_use",
        "times_scalar",
        "bands",
    ] {
        assert!(row.get(name).is_some(), "{name}");
    }
    assert_eq!(
        (row["method"].as_str(), row["setting"].as_str()),
        (Some("rk4"), Some("step 1/120"))
    );
    assert_eq!(row["bands"][0]["name"], "0–2 s");
    assert_eq!(row["bands"][0]["right_1ms"], 1.0);
    assert!(object["machine"]["cpu"].is_string());
    let claim = object["targets"][0].as_object().unwrap();
    assert_eq!(claim.keys().collect::<Vec<_>>(), ["measured", "met", "name", "target"]);
    assert_eq!(
        (object["complete"].as_bool(), object["missing"][0].as_str()),
        (Some(false), Some("cpu: something|else"))
    );
}
