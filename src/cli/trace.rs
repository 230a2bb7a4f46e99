//! `flipmap trace`: follows one pendulum, at rest or thrown, with the gold standard in double-double.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use flipmap_pendulum::passes::Pass;
use flipmap_render::output::{Destination, SafeFile, Trace, TraceError, is_stdout};

use super::exit::Exit;
use super::options::SceneOptions;
use super::same_file::keep_apart;
use super::stop;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Angles in rad at which the pendulum is released from rest, with any number of digits, or as
    /// in -95deg,0.5pi; followed by the speeds in rad/s if it is thrown
    #[arg(long, value_name = "θ1,θ2[,ω1,ω2]", allow_hyphen_values = true)]
    start: String,
    /// Simulated seconds to trace
    #[arg(long, value_name = "SECONDS", default_value = "30", allow_hyphen_values = true)]
    until: String,
    /// Simulated seconds between rows
    #[arg(long, value_name = "SECONDS", default_value = "0.01", allow_hyphen_values = true)]
    every: String,
    /// Table to write (default: standard output)
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    /// Print the flips as one JSON object on standard output; requires -o
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    scene: SceneOptions,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let scene = options.scene.document()?.scene();
    let output = options.output.as_deref().map(|path| ("-o", path));
    keep_apart(options.scene.file().as_slice(), output.as_slice())?;
    if let Some(path) = &options.output {
        super::check_name(path, "-o", &["csv"])?;
    }
    let Options { start, until, every, .. } = options;
    let mut trace = Trace::from_text(&scene, start, until, every)?;
    let to_stdout = options.output.as_ref().is_none_or(|path| is_stdout(path));
    if options.json && to_stdout {
        return Err(
            Exit::Usage("--json needs -o FILE.csv: both would use standard output".into()).into()
        );
    }
    if to_stdout {
        super::check_stdout()?;
    }
    let destination = Destination::from(options.output.as_deref().unwrap_or("-".as_ref()));
    let mut out = match &options.output {
        Some(_) => SafeFile::create(&destination)
            .with_context(|| format!("-o: cannot write {destination}"))?,
        None => SafeFile::stdout()?,
    };
    stop::listen()?;
    trace.write_table(&mut out, &|_, _| !stop::asked()).map_err(|error| match error {
        TraceError::Stopped => Exit::Interrupted.into(),
        TraceError::Write(error) => {
            anyhow::Error::from(error).context(format!("cannot write {destination}"))
        }
        TraceError::NotFinite => error.into(),
    })?;
    out.finish().with_context(|| format!("cannot write {destination}"))?;
    tell(options, trace.passes())
}

/// Prints the crossings; the first of each bob is its flip.
fn tell(options: &Options, passages: &[Pass]) -> anyhow::Result<()> {
    let first = |bob| passages.iter().find(|p| p.bob == bob).map(|p| p.time.hi);
    if options.json {
        let list: Vec<_> = passages
            .iter()
            .map(|p| serde_json::json!({ "bob": p.bob, "time": p.time.hi }))
            .collect();
        let object = serde_json::json!({
            "first_flip": first(1), "second_flip": first(2), "passages": list,
        });
        return super::say(&serde_json::to_string_pretty(&object)?);
    }
    for (bob, name) in [(1, "first"), (2, "second")] {
        match passages.iter().find(|p| p.bob == bob) {
            Some(flip) => super::tell(&format!("flipmap: the {name} bob flips at {} s", flip.time)),
            None => super::tell(&format!("flipmap: the {name} bob does not flip")),
        }
    }
    for Pass { bob, time, .. } in passages {
        super::tell(&format!("flipmap: bob {bob} passes the top at {:.12} s", time.hi));
    }
    Ok(())
}
