//! The hard cases, each once for every available engine, and the one case that gives a warning.

use std::process::Output;

use crate::common::gpu_engine;
use assert_cmd::Command;
use flipmap_engine::Engine;
use flipmap_engine::cpu::CpuEngine;
use flipmap_report::hard::{HardBench, cases};

fn all_hold(engine: Box<dyn Engine>) {
    let (kind, mut bench) = (engine.kind(), HardBench::new(engine));
    let mut broken = Vec::new();
    for case in cases().into_iter().filter(|case| case.is_for(kind)) {
        let begun = std::time::Instant::now();
        let finding = case.measure(&mut bench);
        let told = format!("{}: {}", case.name, finding.measured);
        println!("{:.1} s {told}", begun.elapsed().as_secs_f64());
        if !finding.held {
            broken.push(format!("{told}\n    expected: {}", case.expected));
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

#[test]
fn all_hold_on_the_processor() {
    all_hold(Box::new(CpuEngine::new(None).unwrap()));
}

#[test]
#[cfg_attr(no_gpu, ignore = "FLIPMAP_NO_GPU=1 declares that there is no adapter")]
fn all_hold_on_an_adapter() {
    all_hold(Box::new(gpu_engine()));
}

#[test]
fn every_case_says_what_and_why() {
    let cases = cases();
    assert_eq!(cases.len(), 17);
    let names: std::collections::BTreeSet<&str> = cases.iter().map(|case| case.name).collect();
    assert_eq!(names.len(), cases.len(), "names are told apart");
    assert!(cases.iter().all(|case| !case.expected.is_empty() && case.why.len() > 40));
}

/// Renders a window of 32 × 32 pixels so narrow that neighbours round to one start.
fn rendered(width: &str, raw: &std::path::Path) -> Output {
    Command::cargo_bin("flipmap")
        .unwrap()
        .args(["render", "--center=2.1,2.3", "--width", width, "--size", "32x32"])
        .args(["--method", "rk4", "--step", "1/120", "--precision", "f64", "--engine", "cpu"])
        .arg("--raw")
        .arg(raw)
        .output()
        .unwrap()
}

/// The numbers in a `.npy` file of f64.
fn numbers(raw: &std::path::Path) -> Vec<f64> {
    let bytes = std::fs::read(raw).unwrap();
    let head = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
    bytes[head..].as_chunks::<8>().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect()
}

#[test]
fn a_window_deeper_than_its_centre_has_digits_is_warned_of() {
    let folder = tempfile::tempdir().unwrap();
    let raw = folder.path().join("times.npy");
    let said = |output: Output| {
        assert!(output.status.success(), "{output:?}");
        String::from_utf8(output.stderr).unwrap()
    };
    assert!(!said(rendered("1e-6", &raw)).contains("warning"));
    let warned = said(rendered("4e-15", &raw));
    assert!(warned.contains("--center has 1 digits") && warned.contains("15 are missing"));
    // Below the resolution of f64 the map is smooth here.
    let times = numbers(&raw);
    assert!(times.iter().all(|time| (time - times[0]).abs() < 1e-11), "{times:?}");
}
