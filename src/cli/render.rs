//! `flipmap render`: a scene to a picture, an array of flip times, or both.

use std::io::{IsTerminal, Write, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::Context;
use clap::Args;
use flipmap::engine::choice::choose;
use flipmap::engine::method::Pace;
use flipmap::engine::{Engine, Precision, Question, Recipe};
use flipmap::output::{Destination, NpyWriter, Painter, PngWriter, RowOrder, SafeFile};
use flipmap::scene::palette::Palette;
use flipmap::scene::{Document, Grid, Scene};
use flipmap::tiles::{Counts, Order, Samples, Work};

use super::exit::{Exit, is_broken_pipe};
use super::options::{RunOptions, SceneOptions};
use super::progress::{Mode, Progress};
use super::stop;

#[derive(Args, Debug)]
pub struct Options {
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    picture: PictureOptions,
    /// The picture to write (- for standard output)
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
    /// Flip times to write as a NumPy array (- for standard output)
    #[arg(long, value_name = "FILE.npy")]
    raw: Option<PathBuf>,
    /// Print what ran, the counts and the times as one JSON object
    #[arg(long)]
    json: bool,
    /// How to show progress
    #[arg(long, value_enum, default_value_t = Mode::Auto)]
    progress: Mode,
}

#[derive(Args, Debug)]
#[command(next_help_heading = "Picture")]
struct PictureOptions {
    /// Colour table: batlow, viridis, magma, cividis or romao (cyclic)
    #[arg(long, value_name = "NAME")]
    palette: Option<String>,
    /// N × N samples a pixel, whose colours are averaged
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    samples: Option<u32>,
    /// Leave out the energy curve
    #[arg(long)]
    no_curve: bool,
}

/// Seconds spent, by what for.
#[derive(Default)]
struct Clock {
    setup: Duration,
    compute: Duration,
    output: Duration,
}

/// How often a stop is looked for.
const PATIENCE: Duration = Duration::from_millis(50);
/// Samples in a row of a picture.
const LONGEST_ROW: u32 = 1 << 20;

pub fn run(options: &Options) -> anyhow::Result<()> {
    let begun = Instant::now();
    options.run.check()?;
    let mut document = options.scene.document()?;
    let (recipe, size) = options.run.settle(&mut document)?;
    apply(&options.picture, &mut document);
    check_outputs(options, &document, size)?;
    let scene = document.scene();
    check_numbers(&scene, size, recipe)?;
    let mut sinks = Sinks::open(options, &document, size)?;
    stop::listen()?;
    let chosen = choose(&options.run.wish(recipe.precision))?;
    let mut engine = chosen.engine;
    super::tell(&format!(
        "flipmap: {} engine, {} {} in {}; {}",
        engine.name(),
        recipe.method.name(),
        recipe.method.setting(),
        recipe.precision,
        chosen.why
    ));

    let mut clock = Clock { setup: begun.elapsed(), ..Clock::default() };
    let mut counts = Counts::default();
    for pass in sinks.passes(document.picture.samples) {
        let size = size.map(|side| side * pass.along);
        let done = compute(
            &scene,
            size,
            recipe,
            engine.as_mut(),
            options.progress,
            &mut |samples| sinks.write(&pass, samples),
            &mut clock,
        )?;
        counts = sum(counts, done);
    }
    let finishing = Instant::now();
    sinks.finish()?;
    clock.output += finishing.elapsed();
    report(options, engine.as_ref(), recipe, counts, &clock)
}

fn apply(options: &PictureOptions, document: &mut Document) {
    let picture = &mut document.picture;
    if let Some(palette) = &options.palette {
        picture.palette.clone_from(palette);
    }
    picture.samples = options.samples.unwrap_or(picture.samples);
    picture.curve &= !options.no_curve;
}

/// Refuses too many steps, and says when pixels lie closer than the numbers they start from.
fn check_numbers(scene: &Scene, size: [u32; 2], recipe: Recipe) -> Result<(), Exit> {
    let question = Question::from(scene);
    if question.pendulum.q > 0.0 {
        Pace::new(&question, &recipe)
            .map_err(|error| Exit::Usage(error.to_string()))?;
    }
    let pixel = Grid::new(scene, size).pixel_rad();
    let resolved = match recipe.precision {
        Precision::F32 | Precision::Df32 => 1e-14,
        Precision::F64 => 1e-15,
        Precision::Dd => 1e-31,
    };
    if pixel < resolved {
        super::tell(&format!(
            "flipmap: warning: pixels are {pixel:.1e} rad apart, but starts in {} are only told \
             apart at {resolved:.0e} rad: this picture is coarser than it looks",
            recipe.precision
        ));
    }
    Ok(())
}

/// Refuses what cannot be written, before anything is computed.
fn check_outputs(options: &Options, document: &Document, size: [u32; 2]) -> Result<(), Exit> {
    let usage = |message: String| Err(Exit::Usage(message));
    if options.output.is_none() && options.raw.is_none() {
        return usage("nothing to write: give -o FILE.png, --raw FILE.npy, or both".to_string());
    }
    let to_stdout = |path: &Option<PathBuf>| path.as_ref().is_some_and(|p| p.as_os_str() == "-");
    let streams = [to_stdout(&options.output), to_stdout(&options.raw), options.json];
    if streams.into_iter().filter(|&used| used).count() > 1 {
        return usage("only one of -o -, --raw - and --json can use standard output".to_string());
    }
    if streams[..2].contains(&true) && stdout().is_terminal() {
        let message = "-o - and --raw - write to a terminal here: redirect it, or name a file";
        return usage(message.to_string());
    }
    if options.output.is_some() && options.output == options.raw {
        return usage("-o and --raw name the same file; give each its own".to_string());
    }
    Palette::named(&document.picture.palette)
        .map_err(|why| Exit::Usage(format!("--palette: {why}")))?;
    let samples = document.picture.samples;
    if !(1..=8).contains(&samples) {
        return usage(format!("--samples is {samples}; it must lie between 1 and 8"));
    }
    if size[0] * samples > LONGEST_ROW {
        return usage(format!(
            "--size {} wide with --samples {samples} is {} samples a row; at most {LONGEST_ROW} fit",
            size[0],
            size[0] * samples
        ));
    }
    Ok(())
}

/// Runs one pass and hands its samples on, rows from the top.
fn compute(
    scene: &Scene,
    size: [u32; 2],
    recipe: Recipe,
    engine: &mut dyn Engine,
    mode: Mode,
    write: &mut dyn FnMut(&Samples) -> anyhow::Result<()>,
    clock: &mut Clock,
) -> anyhow::Result<Counts> {
    let mut work = Work::new(scene, size, recipe, Order::Straight, engine.job_size());
    let mut progress = Progress::new(mode, u64::from(size[0]) * u64::from(size[1]));
    let mut rows = RowOrder::default();
    while !work.is_done() {
        let computing = Instant::now();
        let finished = work.work(engine, Some(computing + PATIENCE))?;
        clock.compute += computing.elapsed();
        let writing = Instant::now();
        for tile in finished {
            for samples in rows.push(tile) {
                write(&samples)?;
                stop::check()?;
            }
        }
        clock.output += writing.elapsed();
        progress.set(work.counts().pixels);
        stop::check()?;
    }
    Ok(work.counts())
}

fn sum(a: Counts, b: Counts) -> Counts {
    Counts {
        pixels: a.pixels + b.pixels,
        simulated: a.simulated + b.simulated,
        flipped: a.flipped + b.flipped,
        unflipped: a.unflipped + b.unflipped,
        forbidden: a.forbidden + b.forbidden,
        failed: a.failed + b.failed,
        rhs_evaluations: a.rhs_evaluations + b.rhs_evaluations,
    }
}

/// One run over the picture, for the outputs that want its samples.
struct Pass {
    along: u32,
    picture: bool,
    raw: bool,
}

/// The files being written.
struct Sinks {
    picture: Option<(Painter, PngWriter<SafeFile>, Destination)>,
    raw: Option<(NpyWriter<SafeFile>, Destination)>,
}

impl Sinks {
    fn open(options: &Options, document: &Document, size: [u32; 2]) -> anyhow::Result<Self> {
        let picture = match &options.output {
            None => None,
            Some(path) => {
                let painter = Painter::new(&document.scene(), size, &document.picture)
                    .map_err(|why| Exit::Usage(format!("--palette: {why}")))?;
                let (file, name) = create("-o", path)?;
                Some((painter, PngWriter::new(file, size, document)?, name))
            }
        };
        let raw = match &options.raw {
            None => None,
            Some(path) => {
                let (file, name) = create("--raw", path)?;
                Some((NpyWriter::new(file, size)?, name))
            }
        };
        Ok(Sinks { picture, raw })
    }

    /// With several samples a pixel the array still holds the samples at the pixels' centres,
    /// in a pass of its own.
    fn passes(&self, along: u32) -> Vec<Pass> {
        let (picture, raw) = (self.picture.is_some(), self.raw.is_some());
        if along == 1 || !picture {
            return vec![Pass { along: 1, picture, raw }];
        }
        let mut passes = vec![Pass { along, picture, raw: false }];
        if raw {
            passes.push(Pass { along: 1, picture: false, raw });
        }
        passes
    }

    fn write(&mut self, pass: &Pass, samples: &Samples) -> anyhow::Result<()> {
        let both = self.picture.is_some() && self.raw.is_some();
        if let (true, Some((painter, png, name))) = (pass.picture, &mut self.picture) {
            let written = png.write(&painter.paint(samples));
            let written = written.with_context(|| format!("cannot write {name}"));
            if reader_left(written, both)? {
                self.picture = None;
            }
        }
        if let (true, Some((npy, name))) = (pass.raw, &mut self.raw) {
            let written = npy.write(samples).with_context(|| format!("cannot write {name}"));
            if reader_left(written, both)? {
                self.raw = None;
            }
        }
        Ok(())
    }

    /// Completes every file before any takes its place.
    fn finish(self) -> anyhow::Result<()> {
        let mut complete = Vec::new();
        let another = self.raw.is_some();
        if let Some((_, png, name)) = self.picture {
            let finished = png.finish().with_context(|| format!("cannot write {name}"));
            match finished {
                Err(error) if another && is_broken_pipe(&error) => {}
                finished => complete.push((finished?, name)),
            }
        }
        complete.extend(self.raw.map(|(npy, name)| (npy.into_inner(), name)));
        for (file, name) in &mut complete {
            file.flush().with_context(|| format!("cannot write {name}"))?;
        }
        for (file, name) in complete {
            file.finish().with_context(|| format!("cannot write {name}"))?;
        }
        Ok(())
    }
}

/// Whether an output lost its reader while another one is still wanted; any other failure is one.
fn reader_left(written: anyhow::Result<()>, another: bool) -> anyhow::Result<bool> {
    match written {
        Err(error) if another && is_broken_pipe(&error) => Ok(true),
        other => other.map(|()| false),
    }
}

fn create(option: &str, path: &Path) -> anyhow::Result<(SafeFile, Destination)> {
    let destination = Destination::from(path);
    let file = SafeFile::create(&destination)
        .with_context(|| format!("{option}: cannot write {destination}"))?;
    Ok((file, destination))
}

fn report(
    options: &Options,
    engine: &dyn Engine,
    recipe: Recipe,
    counts: Counts,
    clock: &Clock,
) -> anyhow::Result<()> {
    let Counts { pixels, simulated, flipped, unflipped, forbidden, failed, rhs_evaluations } =
        counts;
    let seconds = [clock.setup, clock.compute, clock.output].map(|part| part.as_secs_f64());
    if options.json {
        let object = serde_json::json!({
            "engine": engine.name(),
            "adapter": engine.adapter(),
            "method": recipe.method.name(),
            "precision": recipe.precision.to_string(),
            "setting": recipe.method.setting(),
            "pixels": pixels,
            "simulated": simulated,
            "flipped": flipped,
            "unflipped": unflipped,
            "forbidden": forbidden,
            "uncertain": 0,
            "failed": failed,
            "rhs_evaluations": rhs_evaluations,
            "seconds": { "setup": seconds[0], "compute": seconds[1], "output": seconds[2] },
        });
        super::say(&serde_json::to_string_pretty(&object)?)?;
    }
    super::tell(&format!(
        "flipmap: {pixels} pixels: {flipped} flipped, {unflipped} unflipped, {forbidden} forbidden, \
         {failed} failed; {simulated} simulated in {:.2} s ({:.2} s setup, {:.2} s output)",
        seconds[1], seconds[0], seconds[2]
    ));
    Ok(())
}
