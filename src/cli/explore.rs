//! `flipmap explore`: opens the map in a window.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use clap::Args;
use flipmap_lab::set_up::{PREFIX, parse};
use flipmap_window::display;
use flipmap_window::film_run::FilmOrder;
use flipmap_window::folders::Folders;
use flipmap_window::model;
pub(super) use flipmap_window::window::{self, WindowError};

use super::exit::Exit;
use super::options::SceneOptions;
use super::picture_options::PictureOptions;
#[cfg(unix)]
use super::restart::again;
use super::run_options::RunOptions;
use super::same_file::keep_apart;
use super::stop;
#[cfg(unix)]
use super::tell;

#[derive(Args, Debug, Default)]
pub(super) struct Options {
    /// Do not read or write settings and bookmarks
    #[arg(hide_short_help = true, long)]
    no_config: bool,
    /// Write the window's own measurements as JSON whenever the view is complete, and on exit
    #[arg(hide_short_help = true, long, value_name = "FILE.json")]
    stats: Option<PathBuf>,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    picture: PictureOptions,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let begun = Instant::now();
    mend_environment()?;
    let stats = options.stats.as_deref().map(|path| ("--stats", path));
    keep_apart(options.scene.file().as_slice(), stats.as_slice())?;
    options.run.engine.check()?;
    let set_up = set_up(&options.scene)?;
    let scene = options.scene.scene.as_deref().filter(|_| set_up.is_none());
    let words = &options.scene.words;
    let mut document = words.apply(words.base(scene)?)?;
    let spec = options.run.settle(&mut document)?;
    let plain = document.picture.clone();
    options.picture.apply(&mut document)?;
    document.picture.check().map_err(|why| Exit::usage(&why))?;
    let is_given = options.scene.is_given() || document.picture != plain;
    let folders = if options.no_config { Folders::none() } else { Folders::of_user() };
    let options = model::WindowOptions {
        run: options.run.says_how().then(|| document.run.clone()),
        document: (is_given && set_up.is_none()).then_some(document),
        set_up,
        request: options.run.engine.request(spec.setting, spec.verify),
        folders,
        stats: options.stats.clone(),
        film_command: Some(film_command),
    };
    let shown = window::run(options, begun, |close| {
        if let Err(error) = stop::listen_and(close) {
            log::warn!("signals will close the window without saving: {error}");
        }
    });
    match shown {
        Err(WindowError::Scale(why)) => open_unscaled(why),
        Err(why @ WindowError::Host(_)) => Err(Exit::Unavailable(why.to_string()).into()),
        Err(why) => Err(why.into()),
        Ok(()) if stop::asked() => Err(Exit::Interrupted.into()),
        Ok(()) => Ok(()),
    }
}

/// Returns the line that sets up a figure of the laboratory, if that is what was named.
fn set_up(options: &SceneOptions) -> Result<Option<String>, Exit> {
    let line = options.scene.as_ref().filter(|scene| scene.starts_with(PREFIX));
    if let Some(line) = line {
        parse(line).map_err(|error| Exit::Usage(error.to_string()))?;
    }
    Ok(line.cloned())
}

/// Starts the program again if its environment has variables with which no window could be opened, or
/// lacks the one that keeps memory together.
#[cfg(unix)]
fn mend_environment() -> anyhow::Result<()> {
    let bad = display::bad_variables(|name| std::env::var_os(name));
    if bad.is_empty() && std::env::var_os(HEAPS).is_some() {
        return Ok(());
    }
    bad.iter().for_each(|variable| tell(&format!("flipmap: {}", variable.why)));
    let Err(error) = again(|command| {
        bad.iter().for_each(|variable| _ = command.env_remove(variable.name));
        if std::env::var_os(HEAPS).is_none() {
            command.env(HEAPS, FEW_HEAPS);
        }
    });
    // Without the program's file, a window that needs more memory is better than none.
    if bad.is_empty() { Ok(()) } else { Err(error.into()) }
}

/// Variable with the number of heaps that glibc divides its memory into: by default one for each thread
/// up to eight for each core, and software Vulkan, with twenty threads, leaves what it frees in all of
/// them. After 30 s of random input the window held 430 to 1090 MiB, and 360 with two heaps.
#[cfg(unix)]
const HEAPS: &str = "MALLOC_ARENA_MAX";
#[cfg(unix)]
const FEW_HEAPS: &str = "2";

/// Starts the program again with the scale 1, because the display's own is unusable.
#[cfg(unix)]
fn open_unscaled(why: display::UnusableScale) -> anyhow::Result<()> {
    const UNSCALED: &str = "1";
    if std::env::var_os(display::SCALE_VARIABLE).is_some_and(|value| value == UNSCALED) {
        return Err(why.into());
    }
    tell(&format!("flipmap: {why}, so 1 is used"));
    let Err(error) = again(|command| _ = command.env(display::SCALE_VARIABLE, UNSCALED));
    Err(error.into())
}

#[cfg(not(unix))]
fn mend_environment() -> anyhow::Result<()> {
    Ok(())
}

#[cfg(not(unix))]
fn open_unscaled(why: display::UnusableScale) -> anyhow::Result<()> {
    Err(why.into())
}

/// The command line that makes a film from the window.
fn film_command(order: &FilmOrder) -> std::io::Result<Command> {
    let mut command = Command::new(std::env::current_exe()?);
    let [width, height] = order.size;
    command.arg("video").arg(order.keys).arg("-o").arg(order.output);
    command.args(["--size", &format!("{width}x{height}"), "--fps", &order.fps.to_string()]);
    command.args(["--progress", "json"]);
    if let Some(kind) = order.engine.kind {
        command.args(["--engine", &kind.to_string()]);
    }
    if let Some(adapter) = &order.engine.adapter {
        command.args(["--adapter", adapter]);
    }
    if let Some(threads) = order.engine.threads {
        command.args(["--threads", &threads.to_string()]);
    }
    Ok(command)
}
