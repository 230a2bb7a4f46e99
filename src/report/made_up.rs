//! A report that nobody measured, for the tests of those that write it.

use super::*;
use crate::physics::{Outcome, Status};

/// Two rows and a refusal of an engine, one measurement missing.
pub fn report() -> Report {
    let flip = |time| Outcome::flipped(time);
    let still = Outcome::without_time(Status::Unflipped);
    let pairs = [(flip(1.0), flip(1.0)), (flip(7.1), flip(7.0)), (still, still)];
    let row = |recipe, us| {
        let mut row = Row::named("cpu", "2 threads, no SIMD", Some(2), recipe);
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
    Report {
        machine: Machine::here(vec!["cpu (2 threads, no SIMD)".to_string()]),
        quick: true,
        sample: 3,
        complete: false,
        missing: vec!["cpu: something|else".to_string()],
        targets: targets::judge(&rows),
        rows,
        not_offered: vec![refusal],
        specialising: Vec::new(),
        motion: Vec::new(),
        sections: vec![Section {
            title: "Hard cases".to_string(),
            blocks: vec![Block::Text("None yet.".to_string())],
        }],
    }
}

#[test]
fn the_page_needs_nothing_else() {
    let report = report();
    let page = html::write(&pages::title(&report), &pages::sections(&report).unwrap());
    for outside in ["http", "src=", "<link", "@import", "url("] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.matches("<svg").count() == 2 && page.contains("Hard cases"));
}

#[test]
fn every_file_says_what_is_missing() {
    let mut report = report();
    let markdown =
        |report: &Report| markdown::write(&pages::title(report), &pages::sections(report).unwrap());
    let text = markdown(&report);
    assert!(text.contains("INCOMPLETE: 1 measurements") && text.contains("something\\|else"));
    report.missing.clear();
    report.complete = true;
    let text = markdown(&report);
    assert!(!text.contains("INCOMPLETE") && text.contains("Complete; "));
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
    assert_eq!(
        (object["complete"].as_bool(), object["missing"][0].as_str()),
        (Some(false), Some("cpu: something|else"))
    );
}
