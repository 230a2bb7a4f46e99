//! Each parser on each input of the fuzzers' corpora, without a fuzzer.

#[path = "../../fuzz/parsers.rs"]
mod parsers;

use std::fs;
use std::path::Path;

use parsers::{PARSERS, Parser};

/// Runs a parser on all inputs in its folder; returns their number.
fn replayed(name: &str, parser: Parser) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let inputs = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{name}: {error}"));
    let paths: Vec<_> = inputs.map(|input| input.unwrap().path()).collect();
    for path in &paths {
        println!("{}", path.display());
        parser(&fs::read(path).unwrap());
    }
    paths.len()
}

#[test]
fn every_parser_survives_its_corpus() {
    for (name, parser) in PARSERS {
        let count = replayed(name, parser);
        assert!(count >= 5, "{name} has only {count} inputs");
    }
}

#[test]
#[should_panic(expected = "panics on its input")]
fn a_parser_that_panics_is_noticed() {
    replayed("scene", |_| panic!("panics on its input"));
}

#[test]
fn every_parser_is_a_target() {
    let manifest = include_str!("../../fuzz/Cargo.toml");
    for (name, _) in PARSERS {
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
        let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/fuzz_targets");
        assert!(target.join(format!("{name}.rs")).exists(), "{name}");
    }
    assert_eq!(manifest.matches("[[bin]]").count(), PARSERS.len());
}
