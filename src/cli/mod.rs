//! The command line: typed options become a scene and a job.

mod compare;
mod continued;
mod deeper;
mod depth;
mod doctor;
pub mod exit;
mod explore;
mod farm;
mod film_options;
mod hunt;
mod lab;
mod options;
mod outputs;
mod picture_options;
mod plan;
mod progress;
mod render;
mod report;
mod run_options;
mod spread;
mod stop;
mod trace;
mod video;

use std::path::Path;

use anyhow::Context;
use clap::{Parser, Subcommand};
use flipmap::output::{Destination, SafeFile};

/// Every possible double pendulum at once: each pixel is a pendulum let go at rest at
/// (θ1, θ2), its colour the time until its second bob flips over the top.
#[derive(Parser)]
#[command(version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Subcommand)]
enum Verb {
    /// Wander through the map in a window (the default).
    Explore(Box<explore::Options>),
    /// Draw a map to a picture, an array of flip times, or both.
    Render(Box<render::Options>),
    /// Follow a filament from a scene to a deeper one that still has structure.
    Deeper(Box<deeper::Options>),
    /// Make a film: a zoom, a walk through scenes, or one view in which something changes.
    Video(Box<video::Options>),
    /// Plan a large still or a film in shards.
    Plan(Box<plan::PlanOptions>),
    /// Compute what is missing of a plan's shards; code 75 when stopped, then run again.
    Run(plan::RunShards),
    /// Print the shards that are not complete; code 4 if there are any.
    Verify(plan::VerifyOptions),
    /// Join a plan's shards when they are complete: a still's files, or a film (-o FILM.mp4, FOLDER).
    Merge(Box<plan::MergeOptions>),
    /// Follow one pendulum with the gold standard: t, angles, speeds, energy error, flips.
    Trace(Box<trace::Options>),
    /// Compare two results of one size; code 3 where they differ too much.
    Compare(compare::Options),
    /// Draw a live figure of the lesson as a still, or write its data.
    Lab(lab::Options),
    /// Measure the engines of this machine, speed against error, and write a report.
    Report(report::Options),
    /// Show the adapters, check their arithmetic, and say what would be used and why.
    Doctor(doctor::Options),
}

/// Runs the program.
pub fn run() -> anyhow::Result<()> {
    match Cli::parse().verb.unwrap_or(Verb::Explore(Box::default())) {
        Verb::Explore(options) => explore::run(&options),
        Verb::Render(options) => render::run(&options),
        Verb::Deeper(options) => deeper::run(&options),
        Verb::Video(options) => video::run(&options),
        Verb::Plan(options) => plan::plan(&options),
        Verb::Run(options) => plan::run(&options),
        Verb::Verify(options) => plan::verify(&options),
        Verb::Merge(options) => plan::merge(&options),
        Verb::Trace(options) => trace::run(&options),
        Verb::Compare(options) => compare::run(&options),
        Verb::Lab(options) => lab::run(&options),
        Verb::Report(options) => report::run(&options),
        Verb::Doctor(options) => doctor::run(&options),
    }
}

/// Prints to standard error; with nobody reading there it is nobody's error.
fn tell(text: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Prints to standard output; a reader that has gone away is an ordinary error.
fn say(text: &str) -> anyhow::Result<()> {
    use std::io::Write;
    Ok(writeln!(std::io::stdout(), "{text}")?)
}

/// A file (- for standard output) with these bytes, or which option could not be obeyed.
fn write_whole(path: &Path, option: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let destination = Destination::from(path);
    SafeFile::write_whole(&destination, bytes)
        .with_context(|| format!("{option}: cannot write {destination}"))
}
