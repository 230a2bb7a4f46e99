//! `flipmap render`: renders a scene as a picture, as tiles, as an array of flip times, as a map of
//! trust, or as several of these.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::run_settings::RunSpec;
use flipmap_engine::trust::{AccuracyEstimate, Opinion};
use flipmap_engine::{Accuracy, Cells, Engine, IntegratorConfig, Trust};
use flipmap_render::output::{Paths, PictureRecipe, RenderError, RenderedPicture};
use flipmap_render::tiles::{self, Counts, Renderer, SavedPixels};
use flipmap_scene::question::QuestionName;
use flipmap_scene::{Document, Grid, PixelAxes, Sampling, Scene, location};

use super::continued::Continued;
use super::depth::{depth_object, tell_depth};
use super::exit::Exit;
use super::foresight;
use super::option_names::by_option;
use super::options::SceneOptions;
use super::outputs::OutputOptions;
use super::picture_options::PictureOptions;
use super::progress::Mode;
use super::run_options::{RunOptions, in_words, start};
use super::spread::spread;
use super::stop;
use super::watch::CommandLine;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Follow pixels as cells first, for measurements: auto (where it saves time), never or always
    #[arg(hide_short_help = true, long, value_name = "WHEN", default_value_t, value_parser = cells())]
    cells: Cells,
    /// Save pixels that can go on in this file, and resume from it with a larger --budget or --at;
    /// takes one sample per pixel
    #[arg(hide_short_help = true, long, value_name = "FILE")]
    state: Option<PathBuf>,
    /// Print the settings that ran, the counts and the timings as one JSON object
    #[arg(hide_short_help = true, long, conflicts_with = "dry_run")]
    json: bool,
    /// Say how many samples there are to compute, how long that takes and how large the files become,
    /// and compute nothing
    #[arg(hide_short_help = true, long)]
    dry_run: bool,
    /// Progress display on standard error
    #[arg(hide_short_help = true, long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    run: RunOptions,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    outputs: OutputOptions,
}

fn cells() -> impl TypedValueParser<Value = Cells> {
    let names = PossibleValuesParser::new(Cells::ALL.map(|cells| cells.to_string()));
    names.try_map(|name| name.parse())
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let begun = Instant::now();
    let (mut document, spec, outputs) = prepare(options)?;
    let (scene, paths) = (document.scene(), outputs.paths());
    let mut continued =
        options.state.as_deref().map(|path| Continued::open(path, &document)).transpose()?;
    paths.check(&document.picture)?;
    if options.dry_run {
        return foresee(options, &document, &spec, &paths);
    }
    let mut request =
        options.run.engine.request(spec.setting, spec.verify).answering(&document.question);
    if let Some(continued) = &continued {
        request = continued.prefer_engine(request);
    }
    let mut chosen = start(&request)?;
    let (config, why, following) = (chosen.config, chosen.why.clone(), chosen.following.clone());
    stop::listen()?;
    tiles::check_feasible(&scene, spec.size(), &config, options.cells)
        .map_err(|error| Exit::usage(&error))?;
    warn_of_missing_digits(&scene, spec.size());
    if let Some(continued) = &mut continued {
        check_has_states(&scene, spec.size(), &config, options.cells)?;
        continued.check_ran(chosen.engine.as_ref(), config)?;
    }
    if let Some(weight) = options.picture.weight_of_view(&document) {
        spread(&mut document, spec.size(), config, chosen.engine.as_mut(), weight)?;
    }
    let recipe = PictureRecipe {
        document: &document,
        size: spec.size(),
        cells: options.cells,
        paths: &paths,
    };
    let mut renderer = Renderer::try_from(chosen)?;
    announce(renderer.engine(), config, spec.verify, &why);
    let preparing = begun.elapsed();
    let watch = CommandLine::new(options.progress, unit_of(&document), Some(following));
    let mut saved = continued.as_mut().map(Continued::take);
    let rendered = recipe.render(&mut renderer, &mut saved, &watch);
    drop(watch);
    let keeps = saved.as_ref().is_some_and(|saved| !saved.is_empty());
    let writing = write_state(continued, saved)?;
    let RenderedPicture { counts, opinion, mut clock } =
        rendered.or_else(|error| interrupted(error, keeps))?;
    let outlook = outlook(&spec, &scene, (config, options.cells), renderer.engine())?;
    clock.output += writing;
    let seconds =
        [preparing + clock.setup, clock.compute, clock.output].map(|part| part.as_secs_f64());
    let (engine, verified) = (renderer.engine(), spec.verify);
    let ran = RunSummary { engine, config, verified, outlook, opinion, counts, seconds };
    if options.json {
        let made = made(&document, spec.size(), &paths);
        super::say(&serde_json::to_string_pretty(&object(&ran, &scene, made))?)?;
    }
    tell(&ran, &scene);
    Ok(())
}

/// Says what the render would take; refuses a state of pixels that have none.
fn foresee(
    options: &Options,
    document: &Document,
    spec: &RunSpec,
    paths: &Paths,
) -> anyhow::Result<()> {
    let state = options.state.as_deref();
    if state.is_some() {
        let config = &spec.setting.configs()[0];
        check_has_states(&document.scene(), spec.size(), config, options.cells)?;
    }
    foresight::tell_render(&options.run.engine, document, spec, paths, state)
}

/// Returns what progress counts.
fn unit_of(document: &Document) -> &'static str {
    if document.picture.samples == Sampling::SINGLE { "pixels" } else { "samples" }
}

/// Rejects a state of pixels that have none.
fn check_has_states(
    scene: &Scene,
    size: [u32; 2],
    config: &IntegratorConfig,
    cells: Cells,
) -> Result<(), Exit> {
    if !tiles::follows_cells(&Grid::new(scene, size), config, cells) {
        return Ok(());
    }
    let message = "--state cannot be used here, because pixels this close together are followed in \
                   groups, which have no states: flipmap plan splits the work so that finished parts \
                   are kept";
    Err(Exit::Usage(message.to_string()))
}

/// Resolves the options, and rejects impossible ones before anything is computed.
fn prepare(options: &Options) -> anyhow::Result<(Document, RunSpec, OutputOptions)> {
    if options.json {
        super::check_stdout()?;
    }
    options.run.engine.check()?;
    let mut document = options.scene.document()?;
    let spec = options.run.settle(&mut document)?;
    options.picture.apply(&mut document)?;
    document.view = document.view.fitted(spec.size().map(f64::from));
    let outputs = options.outputs.or_picture_of(options.scene.scene.as_deref())?;
    let inputs: Vec<_> =
        options.scene.file().into_iter().chain(options.picture.palette_file()).collect();
    outputs.check(options.json, spec.verify, options.state.as_deref(), &inputs)?;
    settle_samples(options, &mut document, (spec.size(), &outputs));
    check_state(options, &document, &spec)?;
    check_picture(&document, spec.size())?;
    Ok((document.settled(), spec, outputs))
}

/// Writes the state, if there is one, and returns the time it took.
fn write_state(
    continued: Option<Continued>,
    saved: Option<SavedPixels>,
) -> anyhow::Result<Duration> {
    let writing = Instant::now();
    if let Some(mut continued) = continued {
        continued.put(saved.unwrap_or_default());
        continued.write()?;
    }
    Ok(writing.elapsed())
}

/// Estimates how much of a picture is right if `balanced` made it without checks.
fn outlook(
    spec: &RunSpec,
    scene: &Scene,
    how: (IntegratorConfig, Cells),
    engine: &mut dyn Engine,
) -> anyhow::Result<Option<AccuracyEstimate>> {
    // A growth is a mean along the path, and chaotic starts are what it is for.
    let is_mean = scene.question.ask == QuestionName::Growth;
    if spec.setting != IntegrationSetting::Accuracy(Accuracy::Balanced) || spec.verify || is_mean {
        return Ok(None);
    }
    let outlook = tiles::outlook(scene, spec.size(), how, engine, &|| !stop::asked())?;
    Ok(Some(outlook.ok_or(Exit::Interrupted)?))
}

/// The engine and settings that made a picture, with estimates and checks of its correctness.
struct RunSummary<'a> {
    engine: &'a dyn Engine,
    config: IntegratorConfig,
    verified: bool,
    outlook: Option<AccuracyEstimate>,
    opinion: Option<Opinion>,
    counts: Counts,
    /// Seconds of setup, computing and output.
    seconds: [f64; 3],
}

/// Converts an error; a stop has exit codes of its own, with and without pixels that were kept.
fn interrupted<T>(error: RenderError, keeps: bool) -> anyhow::Result<T> {
    match (error, keeps) {
        (RenderError::Stopped, true) => Err(Exit::Unwritten.into()),
        (RenderError::Stopped, false) => Err(Exit::Interrupted.into()),
        (error, _) => Err(error.into()),
    }
}

fn announce(engine: &dyn Engine, config: IntegratorConfig, verify: bool, why: &str) {
    let checked = if verify { ", every pixel checked" } else { "" };
    super::tell(&format!("flipmap: {}{checked}; {why}", in_words(engine, &config)));
}

/// Warns if pixels lie closer together than the centre's last digit.
pub(super) fn warn_of_missing_digits(scene: &Scene, size: [u32; 2]) {
    let pixel = Grid::new(scene, size).pixel_rad();
    let needed = (-pixel.log10()).ceil() as usize;
    let given = scene.view.center.iter().map(|text| decimals(text)).min().unwrap_or(0);
    if pixel < TOO_SMALL_FOR_ROUND_CENTRES && given < needed {
        super::tell(&format!(
            "flipmap: warning: pixels are {pixel:.1e} {} apart, but --center has {given} digits \
             after the decimal point: {} are missing, unless the centre is meant to be that round",
            scene.plane.axes()[0].unit(),
            needed - given
        ));
    }
}

/// Pixel spacing in rad above which the centre may well be a round number.
const TOO_SMALL_FOR_ROUND_CENTRES: f64 = 1e-9;

/// Number of decimal places of a number, taking its exponent into account.
fn decimals(text: &str) -> usize {
    let (digits, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let after = digits.trim().split_once('.').map_or(0, |(_, after)| after.len() as i64);
    (after - exponent.trim().parse::<i64>().unwrap_or(0)).max(0) as usize
}

/// Takes one sample per pixel in place of corners, which a very large picture cannot have. For a
/// state, does so only if `--samples` was not given.
fn settle_samples(
    options: &Options,
    document: &mut Document,
    (size, outputs): ([u32; 2], &OutputOptions),
) {
    let picture = &mut document.picture;
    let asked = options.picture.says_samples();
    if options.state.is_some() && !asked && picture.samples == Sampling::Corners {
        picture.samples = Sampling::SINGLE;
    }
    let fitting = picture.samples_of(size);
    if fitting != picture.samples && outputs.are_painted() {
        super::tell(
            "flipmap: a picture of more than 33554432 pixels has one sample in each of them",
        );
    }
    picture.samples = fitting;
}

fn check_state(options: &Options, document: &Document, spec: &RunSpec) -> Result<(), Exit> {
    if options.state.is_none() {
        return Ok(());
    }
    let why = if spec.verify {
        "checks start at the release: omit --verify and --accuracy exact"
    } else if document.picture.samples != Sampling::SINGLE {
        "it stores one sample per pixel: omit --samples, or give --samples 1"
    } else {
        return Ok(());
    };
    Err(Exit::Usage(format!("--state cannot be used here, because {why}")))
}

fn check_picture(document: &Document, size: [u32; 2]) -> Result<(), Exit> {
    let picture = &document.picture;
    picture.check().and_then(|()| picture.check_size(size)).map_err(|why| Exit::usage(&why))
}

/// The JSON object of what was made: the scene, where its pixels lie, and the files.
fn made(document: &Document, size: [u32; 2], paths: &Paths) -> serde_json::Value {
    let axes = PixelAxes::new(&document.scene(), size);
    let files = by_option(paths).into_iter().map(|(option, path)| {
        (option.to_string(), serde_json::Value::from(path.to_string_lossy()))
    });
    serde_json::json!({
        "scene": document.text(),
        "location": location::text(&document.scene()),
        "size": size,
        "axes": axes.axes.map(|axis| serde_json::json!({
            "name": axis.name(),
            "unit": axis.unit(),
        })),
        "center": axes.center,
        "first_pixel": axes.coordinates(0, 0),
        "first_pixel_from_center": axes.offset(0, 0),
        "per_column": axes.right,
        "per_row": axes.down(),
        "files": files.collect::<serde_json::Map<_, _>>(),
    })
}

/// The JSON object of a run.
fn object(ran: &RunSummary, scene: &Scene, made: serde_json::Value) -> serde_json::Value {
    let RunSummary { engine, config, counts, seconds, .. } = ran;
    let estimated = ran.outlook.map(|outlook| outlook.opinion).filter(|opinion| opinion.asked > 0);
    let trust: serde_json::Map<String, serde_json::Value> = Trust::ALL
        .iter()
        .map(|(word, trust)| (word.to_string(), counts.trusts[*trust as usize].into()))
        .collect();
    serde_json::json!({
        "version": env!("CARGO_PKG_VERSION"),
        "made": made,
        "engine": engine.kind(),
        "adapter": engine.adapter(),
        "method": config.method.name(),
        "precision": config.precision.to_string(),
        "setting": config.method.setting(),
        "verified": ran.verified,
        "pixels": counts.pixels,
        "simulated": counts.simulated,
        "flipped": counts.flipped,
        "unflipped": counts.unflipped,
        "forbidden": counts.forbidden,
        "uncertain": counts.uncertain(),
        "failed": counts.failed,
        "trust": trust,
        "outlook": ran.outlook.map(|outlook| serde_json::json!({
            "sampled": outlook.sampled,
            "expected_right": outlook.expected_right(),
            "beyond_horizon": outlook.beyond as f64 / outlook.sampled.max(1) as f64,
        })),
        "integrated_directly": ran.opinion.or(estimated).map(|opinion| serde_json::json!({
            "pixels": opinion.asked,
            "contradicted": opinion.contradicted,
        })),
        "depth": counts.effort.depth.map(|depth| depth_object(depth, *config, scene)),
        "rhs_evaluations": counts.effort.rhs_evaluations,
        "gpu": engine.gpu_stats(),
        "seconds": { "setup": seconds[0], "compute": seconds[1], "output": seconds[2] },
    })
}

/// Prints the counts, the timings and the warnings of a run.
fn tell(ran: &RunSummary, scene: &Scene) {
    let RunSummary { counts, seconds, .. } = ran;
    let Counts { pixels, simulated, flipped, unflipped, forbidden, failed, .. } = *counts;
    let [done, not_done] = scene.question.ask.kind().counted;
    super::tell(&format!(
        "flipmap: {pixels} pixels: {flipped} {done}, {unflipped} {not_done}, {forbidden} forbidden, \
         {failed} failed; {simulated} samples integrated in {:.2} s ({:.2} s setup, {:.2} s output)",
        seconds[1], seconds[0], seconds[2]
    ));
    if let Some(depth) = counts.effort.depth {
        tell_depth(depth, ran.config, scene, counts);
    }
    let warnings = [
        ran.outlook.and_then(|outlook| outlook.warning()),
        ran.opinion.and_then(|opinion| opinion.warning()),
    ];
    for warning in warnings.into_iter().flatten() {
        super::tell(&format!("flipmap: warning: {warning}"));
    }
    if ran.verified {
        let [_, agreed, confirmed, settled, uncertain] = counts.trusts;
        super::tell(&format!(
            "flipmap: checked: {agreed} agreed at once, {confirmed} confirmed with more digits, \
             {settled} settled in double-double, {uncertain} uncertain"
        ));
    }
}
