//! The command line: turns typed options into a scene and a job.

mod compare;
mod continued;
mod deeper;
mod depth;
mod doctor;
#[cfg(unix)]
pub(crate) mod driver_cache;
mod examples;
pub(crate) mod exit;
#[cfg(feature = "window")]
mod explore;
mod farm;
mod film_options;
mod foresight;
mod frames;
mod hunt;
#[cfg(feature = "window")]
mod lab;
mod manual;
mod measure;
mod option_names;
mod options;
mod outputs;
mod picture_options;
mod plan;
mod progress;
mod render;
mod report;
#[cfg(unix)]
mod restart;
mod run_options;
mod same_file;
mod size;
mod spread;
pub(crate) mod stop;
mod suggested;
mod trace;
mod version;
mod video;
mod voice;
mod watch;

use std::path::Path;

use anyhow::Context;
#[cfg(not(feature = "window"))]
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, Subcommand};
use flipmap_render::output::{Destination, SafeFile, check_ending};

use exit::Exit;
use progress::Mode;
use voice::{Voice, tell};

/// Draw every possible double pendulum at once: each pixel is a pendulum released from rest at
/// (θ1, θ2), coloured by the time until its second bob flips over the top.
#[derive(Parser)]
#[command(version, disable_version_flag = true, max_term_width = 100, after_long_help = examples::FLIPMAP)]
struct Cli {
    /// Print version
    #[arg(short = 'V', long)]
    version: bool,

    /// Print licences and sources as well (with --version)
    #[arg(long, requires = "version")]
    verbose: bool,

    /// Say nothing but warnings and errors
    #[arg(short, long, global = true)]
    quiet: bool,

    #[command(subcommand)]
    verb: Option<Verb>,
}

#[derive(Subcommand)]
enum Verb {
    /// Explore the map in a window (the default).
    #[cfg(feature = "window")]
    Explore(Box<explore::Options>),
    /// Render a map as a picture, an array of flip times, or both.
    #[command(after_long_help = examples::RENDER)]
    Render(Box<render::Options>),
    /// Find a deeper scene that still has structure by zooming in along a filament.
    Deeper(Box<deeper::Options>),
    /// Make a film: a zoom, a tour of several scenes, or one view in which a parameter changes.
    #[command(after_long_help = examples::VIDEO)]
    Video(Box<video::Options>),
    /// Plan a large still or a film as shards that can be computed independently.
    Plan(Box<plan::PlanOptions>),
    /// Compute what is missing from a plan's shards; exits with 75 if stopped (rerun to resume).
    Run(plan::RunShards),
    /// Print the numbers of a plan's incomplete shards; exits with 4 if there are any.
    Verify(plan::VerifyOptions),
    /// Merge a plan's complete shards into a still's files or a film (-o FILM.mp4 or -o FOLDER).
    Merge(Box<plan::MergeOptions>),
    /// Trace one pendulum with the gold standard: time, angles, speeds, energy error and flips.
    #[command(after_long_help = examples::TRACE)]
    Trace(Box<trace::Options>),
    /// Compare two results of the same size; exits with 3 if they differ too much.
    Compare(compare::Options),
    /// Measure a scene: areas, survival, the dimension of its edges, basin entropy, with 95 % intervals.
    #[command(after_long_help = examples::MEASURE)]
    Measure(Box<measure::Options>),
    /// Draw one of the lesson's live figures as a still, or write its data.
    #[cfg(feature = "window")]
    Lab(lab::Options),
    /// Measure the speed and error of this machine's engines, and write a report.
    Report(report::Options),
    /// List the graphics adapters, check their arithmetic, and show what would be used and why.
    Doctor(doctor::Options),
    /// Print shell completions, to be saved where the shell looks for them.
    Completions(manual::CompletionOptions),
    /// Print a page of the manual, as in flipmap man render | man -l -
    Man(manual::ManOptions),
}

impl Verb {
    /// Returns how progress is shown.
    fn progress(&self) -> Mode {
        match self {
            Verb::Render(options) => options.progress,
            Verb::Video(options) => options.progress,
            Verb::Run(options) => options.progress,
            Verb::Merge(options) => options.progress,
            Verb::Report(options) => options.progress,
            Verb::Measure(options) => options.progress,
            _ => Mode::Auto,
        }
    }
}

/// Parses the command line and runs the subcommand.
pub(crate) fn run() -> anyhow::Result<()> {
    let Cli { version, verbose, quiet, verb } =
        Cli::try_parse().unwrap_or_else(|error| exit::leave(&error));
    if version {
        return version::say(verbose);
    }
    let verb = verb.unwrap_or_else(default_verb);
    voice::set(if verb.progress() == Mode::Json { Voice::Json } else { Voice::of(quiet) });
    match verb {
        #[cfg(feature = "window")]
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
        Verb::Measure(options) => measure::run(&options),
        #[cfg(feature = "window")]
        Verb::Lab(options) => lab::run(&options),
        Verb::Report(options) => report::run(&options),
        Verb::Doctor(options) => doctor::run(&options),
        Verb::Completions(options) => manual::completions(Cli::command(), &options),
        Verb::Man(options) => manual::man(Cli::command(), &options),
    }
}

#[cfg(feature = "window")]
fn default_verb() -> Verb {
    Verb::Explore(Box::default())
}

/// Exits with a usage error: the default subcommand needs the window.
#[cfg(not(feature = "window"))]
fn default_verb() -> Verb {
    let text = "this build has no window; give a subcommand, as in flipmap render -o map.png";
    Cli::command().error(ErrorKind::MissingSubcommand, text).exit()
}

/// Prints a line to standard output; a closed pipe is an ordinary error, and so is an output that was
/// closed before the program began.
fn say(text: &str) -> anyhow::Result<()> {
    use std::io::Write;
    check_stdout()?;
    writeln!(std::io::stdout(), "{text}").context("cannot write standard output")
}

/// Refuses a standard output that was closed before the program began.
fn check_stdout() -> anyhow::Result<()> {
    SafeFile::check(&Destination::Stdout).context("cannot write standard output")
}

/// Prints a line to standard output; a closed pipe is ignored, as the exit code says the same.
fn say_if_heard(text: &str) -> anyhow::Result<()> {
    say(text).or_else(|error| match flipmap_render::output::is_broken_pipe(error.as_ref()) {
        true => Ok(()),
        false => Err(error),
    })
}

/// Refuses an output whose name ends like a file of another kind.
fn check_name(path: &Path, option: &str, endings: &[&str]) -> Result<(), Exit> {
    let refuse = |why| Exit::Usage(format!("{option}: cannot write {}: {why}", path.display()));
    check_ending(path, endings).map_err(refuse)
}

/// Refuses an output that could not be written; the error names the option that asked for it.
fn check(path: &Path, option: &str) -> anyhow::Result<()> {
    let destination = Destination::from(path);
    SafeFile::check(&destination).with_context(|| format!("{option}: cannot write {destination}"))
}

/// Writes a whole file (- for standard output); the error names the option that asked for it.
fn write_whole(path: &Path, option: &str, bytes: &[u8]) -> anyhow::Result<()> {
    let destination = Destination::from(path);
    SafeFile::write_whole(&destination, bytes)
        .with_context(|| format!("{option}: cannot write {destination}"))
}
