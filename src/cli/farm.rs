//! The code that `video`, `plan`, `run`, `verify` and `merge` share.

use std::path::Path;

use flipmap_engine::choice::Chosen;
use flipmap_render::farm::{self, OpenChoices, Parts, Plan, RunError, Task, TaskKind};
use flipmap_render::film::ffmpeg::{Codec, Encoding, FilmQuality};
use flipmap_render::film::{self, FilmRecipe, FilmRenderError};
use flipmap_render::output::{Destination, read_text, shell_word};
use flipmap_render::tiles::Renderer;
use flipmap_scene::film::{Film, FilmKind};
use flipmap_scene::{Document, Sampling};

use super::exit::Exit;
use super::picture_options::PictureOptions;
use super::progress::Mode;
use super::run_options::in_words;
use super::stop;
use super::watch::CommandLine;

/// Reads a plan and derives its task.
pub(super) fn open(path: &Path) -> Result<Task, Exit> {
    let refuse = |why: String| Exit::Usage(format!("{} {why}", path.display()));
    let text = read_text(path).map_err(|error| refuse(format!("cannot be read: {error}")))?;
    let plan = Plan::parse(&text).map_err(|why| refuse(why.to_string()))?;
    Task::new(plan, path).map_err(|why| refuse(why.to_string()))
}

/// Finds the parts that exist already, and prints the names of damaged files.
pub(super) fn scan(task: &Task) -> anyhow::Result<Parts> {
    let parts = Parts::scan(&task.folder, task.forms())?;
    for (path, why) in parts.damaged() {
        super::tell(&format!(
            "flipmap: {} is cut short or altered ({why}); flipmap run computes its samples again",
            path.display()
        ));
    }
    Ok(parts)
}

/// Returns the number of samples that some shards lack.
pub(super) fn missing(task: &Task, shards: std::ops::RangeInclusive<u32>) -> anyhow::Result<u64> {
    let parts = scan(task)?;
    let pieces = shards.flat_map(|shard| task.missing(shard, &parts));
    Ok(pieces.map(|piece| piece.samples(task)).sum())
}

/// Computes the missing samples of some shards; if none are missing, returns the existing parts.
pub(super) fn compute(
    task: &Task,
    shards: std::ops::RangeInclusive<u32>,
    chosen: Chosen,
    mode: Mode,
) -> anyhow::Result<Option<Parts>> {
    let mut parts = scan(task)?;
    parts.remove_damaged()?;
    let pieces: Vec<_> = shards.flat_map(|shard| task.missing(shard, &parts)).collect();
    let total: u64 = pieces.iter().map(|piece| piece.samples(task)).sum();
    if total == 0 {
        super::tell("flipmap: all samples exist already");
        return Ok(Some(parts));
    }
    drop(parts);
    let following = chosen.following.clone();
    let mut renderer = Renderer::try_from(chosen)?;
    super::tell(&format!(
        "flipmap: {total} of {} samples to compute, {}",
        task.samples(),
        in_words(renderer.engine(), &task.config),
    ));
    let watch = CommandLine::new(mode, "samples", Some(following));
    let computed = farm::compute(task, &pieces, &mut renderer, &watch);
    drop(watch);
    let counts = computed.map_err(stopped)?;
    super::tell(&format!(
        "flipmap: {} samples, {} of them simulated, in {}",
        counts.pixels,
        counts.simulated,
        task.folder.display()
    ));
    Ok(None)
}

fn stopped(error: RunError) -> anyhow::Error {
    match error {
        RunError::Stopped => Exit::Again.into(),
        error => error.into(),
    }
}

/// Returns the parts of a task, or an error if shards are incomplete.
pub(super) fn complete(task: &Task, plan: &Path) -> anyhow::Result<Parts> {
    let parts = scan(task)?;
    let missing = task.missing_shards(&parts);
    if missing.is_empty() { Ok(parts) } else { Err(lacks(&missing, task, plan, 1).into()) }
}

/// Failure that lists the incomplete shards; the first shard has the number `from`.
pub(super) fn lacks(missing: &[u32], task: &Task, plan: &Path, from: u32) -> Exit {
    let number = |shard: &u32| (shard - 1 + from).to_string();
    let some: Vec<String> = missing.iter().take(8).map(number).collect();
    let counted = if from == 1 { "" } else { " --from 0" };
    let more = if missing.len() > some.len() { ", …" } else { "" };
    let are = if missing.len() == 1 { "is" } else { "are" };
    Exit::Missing(format!(
        "{} of {} shards {are} not complete ({}{more}): complete each with flipmap run {} --shard N{counted}",
        missing.len(),
        task.plan.shards,
        some.join(", "),
        shell_word(plan)
    ))
}

/// Where a film goes, how it is encoded, and how progress is shown.
pub(super) struct FilmOutput<'a> {
    pub path: &'a Path,
    /// What the user called it.
    pub told: &'a Path,
    pub encoding: Option<Encoding>,
    pub mode: Mode,
}

/// Paints a film from its parts.
pub(super) fn paint(
    task: &Task,
    mut parts: Parts,
    options: &PictureOptions,
    to: &FilmOutput,
) -> anyhow::Result<()> {
    let (TaskKind::Film(film, _) | TaskKind::Frames(film, _)) = &task.work else { return Ok(()) };
    let mut document = film.keys[0].scene.clone();
    let samples = document.picture.samples;
    options.apply(&mut document)?;
    check_samples(samples, &document)?;
    if film.kind() == FilmKind::Flips {
        spread(task, film, &mut parts, options, &mut document)?;
        film::settle_colours(film, &mut document.picture)?;
    } else {
        document = document.checked()?;
    }
    let FilmOutput { path: output, told, encoding, mode } = *to;
    let recipe = FilmRecipe { film, document: &document, output };
    let watch = CommandLine::new(mode, "frames", None);
    let painted = recipe.merge(encoding, task, &mut parts, &watch);
    drop(watch);
    painted.map_err(|error| match error {
        // Written frames are not made again; a film in one file is made anew.
        FilmRenderError::Stopped if Codec::of(output).is_none() => anyhow::Error::from(Exit::Again),
        FilmRenderError::Stopped => Exit::Unwritten.into(),
        // Ctrl-C in a terminal reaches ffmpeg too.
        FilmRenderError::Ffmpeg(_) if stop::asked() => Exit::Unwritten.into(),
        error => error.into(),
    })?;
    tell_made(film, told);
    Ok(())
}

/// Says that a film is complete.
pub(super) fn tell_made(film: &Film, output: &Path) {
    let Film { size: [width, height], frames, fps, .. } = film;
    let output = Destination::from(output);
    let frames = if *frames == 1 { "1 frame".to_string() } else { format!("{frames} frames") };
    super::tell(&format!("flipmap: {frames} of {width}x{height} at {fps} per second in {output}"));
}

/// Rejects more or fewer samples per pixel than were planned.
pub(super) fn check_samples(planned: Sampling, document: &Document) -> Result<(), Exit> {
    if document.picture.samples == planned {
        return Ok(());
    }
    Err(Exit::Usage(format!("--samples is {planned} in the plan and can no longer change")))
}

/// Spreads the colours of a deep film over its own times, and prints their range.
fn spread(
    task: &Task,
    film: &Film,
    parts: &mut Parts,
    options: &PictureOptions,
    document: &mut Document,
) -> anyhow::Result<()> {
    if !options.spreads_film(document, film) {
        return Ok(());
    }
    let open = OpenChoices {
        cycles: !options.says_cycles(),
        palette: options.says_no_palette(),
        repeat: !options.says_repeat(),
    };
    let picture = &mut document.picture;
    if farm::spread_film(task, parts, open, picture)?
        && let [first, .., last] = picture.times[..]
    {
        super::tell(&format!(
            "flipmap: colours are spread over the film's own times, {first:.2} to {last:.2} s, in \
             {} {} of {}; --times budget spreads them over the whole budget",
            picture.cycles,
            if picture.cycles == 1.0 { "cycle" } else { "cycles" },
            picture.palette
        ));
    }
    Ok(())
}

/// Rejects a film that could not be painted or written; returns how a file is encoded.
pub(super) fn check(recipe: &FilmRecipe, quality: FilmQuality) -> anyhow::Result<Option<Encoding>> {
    recipe.check(quality).map_err(|error| match error {
        FilmRenderError::Ffmpeg(why) => Exit::usage(&why).into(),
        FilmRenderError::Picture(why) => why.into(),
        error => error.into(),
    })
}
