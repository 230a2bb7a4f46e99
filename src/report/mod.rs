//! What the program can say about its own correctness: lists of claims, each with the measurement
//! that would refute it.

pub mod hard;
