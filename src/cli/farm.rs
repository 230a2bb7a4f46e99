//! The code that `video`, `plan`, `run`, `verify` and `merge` share.

use std::path::{Path, PathBuf};

use flipmap_engine::Cells;
use flipmap_engine::choice::{Chosen, EngineRequest};
use flipmap_render::farm::merge::{self, FilmSink, MergeError};
use flipmap_render::farm::{Parts, Plan, RunError, Task, TaskKind, WorkPiece, run};
use flipmap_render::film::ffmpeg::Codec;
use flipmap_render::output::{read_text, shell_word};
use flipmap_render::tiles::{Counts, Renderer};
use flipmap_scene::film::{Film, FilmKind};
use flipmap_scene::palette::Palette;
use flipmap_scene::{Document, Sampling};

use super::exit::Exit;
use super::picture_options::PictureOptions;
use super::progress::{Mode, Progress};
use super::run_options::prefer_engine;
use super::stop;

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

/// Requests the engine that a plan was made for, unless the request names another.
pub(super) fn request_like(plan: &Plan, request: EngineRequest) -> EngineRequest {
    prefer_engine(request, plan.engine, plan.adapter.as_deref().unwrap_or_default())
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
        "flipmap: {total} of {} samples to compute, {} engine, {} {} in {}",
        task.samples(),
        renderer.engine().kind(),
        task.config.method.name(),
        task.config.method.setting(),
        task.config.precision,
    ));
    let mut progress = Progress::of(mode, total, "samples");
    let mut counts = Counts::default();
    let scene_of = |piece: &WorkPiece| task.still(piece).map(|(scene, _)| scene);
    for pieces in pieces.chunk_by(|a, b| scene_of(a) == scene_of(b)) {
        hear_second_opinion(task, &pieces[0], &mut renderer)?;
        let before = counts;
        let computed = run(task, pieces, renderer.engine(), &mut |now| {
            counts = before;
            counts += *now;
            progress.set(counts.pixels, following.words());
            !stop::asked()
        });
        computed.map_err(stopped)?;
    }
    drop(progress);
    super::tell(&format!(
        "flipmap: {} samples, {} of them simulated, in {}",
        counts.pixels,
        counts.simulated,
        task.folder.display()
    ));
    Ok(None)
}

/// Integrates some pixels of the piece's still directly. Every shard takes the same pixels, so all
/// shards mark the same views.
fn hear_second_opinion(
    task: &Task,
    piece: &WorkPiece,
    renderer: &mut Renderer,
) -> anyhow::Result<()> {
    let Some((scene, pass)) = task.still(piece) else { return Ok(()) };
    let opinion =
        renderer.second_opinion(&scene, pass.pixels(), Cells::Auto, &|| !stop::asked())?;
    if let Some(warning) = opinion.and_then(|opinion| opinion.warning()) {
        super::tell(&format!("flipmap: {warning}"));
    }
    Ok(())
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
    if missing.is_empty() { Ok(parts) } else { Err(lacks(&missing, task, plan).into()) }
}

/// Failure that lists the incomplete shards.
pub(super) fn lacks(missing: &[u32], task: &Task, plan: &Path) -> Exit {
    let some: Vec<String> = missing.iter().take(8).map(ToString::to_string).collect();
    let more = if missing.len() > some.len() { ", …" } else { "" };
    Exit::Missing(format!(
        "{} of {} shards are not complete ({}{more}): complete each with flipmap run {} --shard N",
        missing.len(),
        task.plan.shards,
        some.join(", "),
        shell_word(plan)
    ))
}

/// Paints a film from its parts.
pub(super) fn paint(
    task: &Task,
    mut parts: Parts,
    options: &PictureOptions,
    output: &Path,
    mode: Mode,
) -> anyhow::Result<()> {
    let (TaskKind::Film(film, _) | TaskKind::Frames(film, _)) = &task.work else { return Ok(()) };
    let mut document = film.keys[0].scene.clone();
    let samples = document.picture.samples;
    options.apply(&mut document)?;
    check_samples(samples, &document)?;
    if film.kind() == FilmKind::Flips {
        settle_times(task, film, &mut parts, options, &mut document)?;
    } else {
        document = document.checked()?;
    }
    let sink = FilmSink::open(output, film, &document)?;
    let mut progress = Progress::of(mode, u64::from(film.frames), "frames");
    let mut keep_going = |frames| {
        progress.set(frames, None);
        !stop::asked()
    };
    let picture = &document.picture;
    let painted = match &task.work {
        TaskKind::Frames(_, frames) => {
            merge::frames(film, frames, picture, &mut parts, sink, &mut keep_going)
        }
        _ => merge::film(task, picture, &mut parts, sink, &mut keep_going),
    };
    drop(progress);
    painted.map_err(|error| match error {
        // Written frames are not made again; a film in one file is made anew.
        MergeError::Stopped if Codec::of(output).is_none() => anyhow::Error::from(Exit::Again),
        MergeError::Stopped => Exit::Unwritten.into(),
        // Ctrl-C in a terminal reaches ffmpeg too.
        MergeError::Ffmpeg(_) if stop::asked() => Exit::Unwritten.into(),
        error => error.into(),
    })?;
    let [width, height] = film.size;
    super::tell(&format!(
        "flipmap: {} frames of {width}x{height} at {} per second in {}",
        film.frames,
        film.fps,
        output.display()
    ));
    Ok(())
}

/// Settles the one colour scale of a film of flips, which each frame records.
fn settle_times(
    task: &Task,
    film: &Film,
    parts: &mut Parts,
    options: &PictureOptions,
    document: &mut Document,
) -> anyhow::Result<()> {
    let (decades, min_rad) = depth(film);
    if options.spreads_film(document, decades, min_rad) {
        spread(task, decades, parts, options, document)?;
    }
    document.picture.check()?;
    if document.picture.times.is_empty() {
        document.picture.times = merge::tones(film, &document.picture)?.range_secs().to_vec();
    }
    Ok(())
}

/// Rejects more or fewer samples per pixel than were planned.
pub(super) fn check_samples(planned: Sampling, document: &Document) -> Result<(), Exit> {
    if document.picture.samples == planned {
        return Ok(());
    }
    Err(Exit::Usage(format!("--samples is {planned} in the plan and can no longer change")))
}

/// Number of decades that a film zooms through, and the width of its narrowest key in rad.
fn depth(film: &Film) -> (f64, f64) {
    let widths = film.keys.iter().map(|key| key.scene.view.width_rad().hi);
    let (least, most) = widths.fold((f64::MAX, 0f64), |(a, b), w| (a.min(w), b.max(w)));
    ((most / least).log10(), least)
}

/// Decades of zoom for each run through the palette.
const DECADES_A_CYCLE: f64 = 2.0;

/// Spreads the colours of a deep film over its own times. Deeper views flip later, so the film
/// runs through the palette repeatedly; unless the user chose a palette, it is a cyclic one.
fn spread(
    task: &Task,
    decades: f64,
    parts: &mut Parts,
    options: &PictureOptions,
    document: &mut Document,
) -> anyhow::Result<()> {
    let times = merge::spread(task, parts)?;
    let [first, .., last] = times[..] else { return Ok(()) };
    let picture = &mut document.picture;
    picture.times = times;
    if !options.says_cycles() && picture.cycles == 1.0 {
        picture.cycles = (decades / DECADES_A_CYCLE).clamp(1.0, 100.0).round();
        if options.says_no_palette() && Palette::is_unchosen(&picture.palette) {
            picture.palette = Palette::CYCLIC.to_string();
        }
        if !options.says_repeat() {
            picture.mirror = picture.cycles > 1.0 && !Palette::is_cyclic(&picture.palette);
        }
    }
    super::tell(&format!(
        "flipmap: colours are spread over the film's own times, {first:.2} to {last:.2} s, in {} \
         cycles of {}; --times budget spreads them over the whole budget",
        picture.cycles, picture.palette
    ));
    Ok(())
}

/// Rejects a film that could not be written.
pub(super) fn check_output(output: &Path) -> Result<(), Exit> {
    FilmSink::check(output)
        .map_err(|error| Exit::Failed(format!("-o: cannot write {}: {error}", output.display())))
}

/// Default folder for the samples of a film.
pub(super) fn samples_beside(output: &Path) -> PathBuf {
    let mut name = output.file_name().unwrap_or(output.as_os_str()).to_os_string();
    name.push(".samples");
    output.with_file_name(name)
}
