//! Rules of the sources: sizes, prose, examples, the corpus of the fuzzers, and kernels that every
//! driver accepts.

mod architecture;
mod examples;
mod fuzz_corpus;
mod kernels;
mod matches;
mod prose;
#[path = "../common/shader_structs.rs"]
mod shader_structs;
#[path = "../common/sources.rs"]
mod sources;
