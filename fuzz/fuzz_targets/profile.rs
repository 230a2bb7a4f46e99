#![no_main]
#[allow(dead_code, reason = "each target has one parser")]
#[path = "../parsers.rs"]
mod parsers;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| parsers::profile(bytes));
