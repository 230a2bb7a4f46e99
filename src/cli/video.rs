//! `flipmap video`: makes a film from keys, from scenes, or of a zoom.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use flipmap_engine::run_settings::RunSpec;
use flipmap_render::farm::{FilmSamples, FilmSamplesError, Plan, PlannedOutput, Task};
use flipmap_render::film::FilmRecipe;
use flipmap_render::film::ffmpeg::{Codec, FilmQuality, arguments, tried};
use flipmap_render::output::UnfinishedFolder;
use flipmap_scene::film::{Film, FilmKind};

use super::exit::Exit;
use super::film_options::FilmOptions;
use super::foresight::{Foresight, samples_size};
use super::frames::check_film;
use super::progress::Mode;
use super::run_options::start;
use super::same_file::{keep_apart, keep_from_frames};
use super::{farm, frames, stop};

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Film to write: .mp4, .mkv (lossless), .gif or .webp through ffmpeg, a folder of numbered
    /// pictures, or - for an .mp4 on standard output
    #[arg(short, long, value_name = "FILM")]
    pub output: PathBuf,
    #[command(flatten)]
    pub quality: QualityOptions,
    /// Folder that keeps the samples, to resume after a stop or to change colours (default:
    /// FILM.samples)
    #[arg(hide_short_help = true, long, value_name = "FOLDER")]
    pub cache: Option<PathBuf>,
    /// Print the ffmpeg command line and exit
    #[arg(hide_short_help = true, long)]
    print_ffmpeg: bool,
    /// Say how many frames and samples there are, how long they take and how much room they need, and
    /// compute nothing
    #[arg(hide_short_help = true, long)]
    dry_run: bool,
    /// Progress display on standard error
    #[arg(hide_short_help = true, long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    #[command(flatten)]
    pub film: FilmOptions,
}

/// Options that say how a film in one file is encoded.
#[derive(Args, Clone, Copy, Debug)]
pub(super) struct QualityOptions {
    /// Quality of an .mp4 or .webp, 1 to 100 (default: 69 and 90)
    #[arg(hide_short_help = true, long, value_name = "Q", value_parser = clap::value_parser!(u8).range(1..=100))]
    quality: Option<u8>,
    /// Colours of an .mp4 at full resolution (4:4:4), which fewer players show
    #[arg(hide_short_help = true, long)]
    full_chroma: bool,
}

impl From<QualityOptions> for FilmQuality {
    fn from(options: QualityOptions) -> Self {
        FilmQuality { level: options.quality, full_chroma: options.full_chroma }
    }
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    if options.output.as_os_str() != "-" {
        return make(options, &options.output);
    }
    if options.print_ffmpeg {
        let message = "--print-ffmpeg needs the film's file (-o FILM.mp4): ffmpeg has to seek in an \
                       .mp4, which standard output does not allow";
        return Err(Exit::Usage(message.to_string()).into());
    }
    super::check_stdout()?;
    // ffmpeg has to seek in an .mp4.
    let folder = UnfinishedFolder::create_in(&std::env::temp_dir())
        .context("cannot make a temporary folder for the film")?;
    let film = folder.path().join("film.mp4");
    make(options, &film).map_err(|error| match error.downcast_ref() {
        // The samples lie in the temporary folder.
        Some(Exit::Again | Exit::Unwritten) if options.cache.is_none() => Exit::Interrupted.into(),
        _ => error,
    })?;
    if film.exists() {
        io::copy(&mut File::open(&film)?, &mut io::stdout().lock())
            .context("cannot write the film to standard output")?;
    }
    Ok(())
}

/// Makes the film of the options in a file or a folder.
fn make(options: &Options, output: &Path) -> anyhow::Result<()> {
    options.film.run.engine.check()?;
    let (film, spec) = options.film.film()?;
    let codec = codec_of(output)?;
    if codec.is_none() && FilmQuality::from(options.quality) != FilmQuality::default() {
        let message = "--quality and --full-chroma are for an .mp4 (--quality also for a .webp); the \
                       pictures of a folder lose nothing";
        return Err(Exit::Usage(message.to_string()).into());
    }
    if options.print_ffmpeg {
        return print(codec, &film, options);
    }
    if options.dry_run {
        // The check of a folder would make it.
        if codec.is_some() {
            let recipe = FilmRecipe { film: &film, document: &film.keys[0].scene, output };
            farm::check(&recipe, options.quality.into())?;
        }
        if film.kind() == FilmKind::Flips {
            FilmSamples::check(&samples_folder(options, output)?)
                .map_err(|error| refused_samples(error, options, output))?;
        }
        return foresee(film, &spec, options);
    }
    keep_from_frames(&options.film.files(), output)?;
    if film.kind() != FilmKind::Flips {
        return frames::run(options, output, &film, &spec);
    }
    let document = &film.keys[0].scene;
    let recipe = FilmRecipe { film: &film, document, output };
    let encoding = farm::check(&recipe, options.quality.into())?;
    let samples = FilmSamples::open(&samples_folder(options, output)?)
        .map_err(|error| refused_samples(error, options, output))?;
    let request = options.film.run.engine.request(spec.setting, spec.verify);
    // Another engine would differ from the existing samples in the last digits.
    let request = match samples.earlier() {
        Some(earlier) => earlier.request_like(request),
        None => request,
    };
    let chosen = start(&request)?;
    check_film(&film, chosen.config)?;
    let task = samples.task(film, spec.verify, &chosen)?;
    stop::listen()?;
    let parts = match farm::compute(&task, 1..=1, chosen, options.progress)? {
        Some(parts) => parts,
        None => farm::complete(&task, samples.plan())?,
    };
    let output =
        farm::FilmOutput { path: output, told: &options.output, encoding, mode: options.progress };
    farm::paint(&task, parts, &options.film.picture, &output)
}

/// Says what a film would take: its frames, its samples with their time, and the room for them.
fn foresee(film: Film, spec: &RunSpec, options: &Options) -> anyhow::Result<()> {
    let Film { frames, size: [width, height], fps, .. } = film;
    let keeps_samples = film.kind() == FilmKind::Flips;
    let engine = &options.film.run.engine;
    let document = &film.keys[0].scene;
    let chosen = start(&engine.request(spec.setting, spec.verify).answering(&document.question))?;
    let channels = document.question.ask.kind().channels.len();
    let plan = (chosen.engine.as_ref(), chosen.config, spec.verify);
    let plan = Plan::new(PlannedOutput::Film(film), 1, plan, false);
    let samples = Task::new(plan, &options.output)?.samples();
    let secs = f64::from(frames) / fps;
    super::say(&format!("{frames} frames of {width}x{height} at {fps} per second: {secs:.1} s"))?;
    super::say(&Foresight::of(engine, spec.setting, spec.verify, samples).sentence())?;
    match keeps_samples {
        true => super::say(&format!("--cache: {}", samples_size(samples, channels))),
        false => super::say("no samples are kept, only frames"),
    }
}

/// Returns the folder of the samples: that of `--cache`, or the one beside the film.
fn samples_folder(options: &Options, output: &Path) -> Result<PathBuf, Exit> {
    let Some(cache) = &options.cache else { return Ok(FilmSamples::beside(output)) };
    keep_apart(&[], &[("-o", output), ("--cache", cache)])?;
    Ok(cache.clone())
}

/// Converts the error of a folder of samples.
fn refused_samples(error: FilmSamplesError, options: &Options, output: &Path) -> Exit {
    match error {
        FilmSamplesError::Name(_) if options.cache.is_none() => Exit::Failed(format!(
            "-o: the name {} leaves no room for .samples: shorten it, or give --cache",
            output.display()
        )),
        FilmSamplesError::Foreign(_) => Exit::Usage(format!("--cache: {error}")),
        error => Exit::Failed(format!("--cache: {error}")),
    }
}

/// Returns the codec for the extension of a file name, or `None` for a folder.
pub(super) fn codec_of(output: &Path) -> Result<Option<Codec>, Exit> {
    let refuse = |why| Exit::Usage(format!("-o {}: {why}", output.display()));
    Codec::of_film(output).map_err(refuse)
}

fn print(codec: Option<Codec>, film: &Film, options: &Options) -> anyhow::Result<()> {
    let Some(codec) = codec else {
        let message =
            "--print-ffmpeg is for an .mp4, .mkv, .gif or .webp; a folder needs no ffmpeg";
        return Err(Exit::Usage(message.to_string()).into());
    };
    let (output, quality) = (options.output.as_path(), options.quality.into());
    let encoding = tried(codec, quality, film.into(), output).map_err(|why| Exit::usage(&why))?;
    let words = arguments(&encoding, film.into(), output);
    let quoted = words.iter().map(|word| {
        let word = word.to_string_lossy();
        let plain = word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./:=,+".contains(c));
        if plain { word.into_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
    });
    super::say(&format!("ffmpeg {}", quoted.collect::<Vec<_>>().join(" ")))
}
