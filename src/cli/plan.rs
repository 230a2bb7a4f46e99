//! `flipmap plan`, `run`, `verify` and `merge`: work in shards, on one machine or many.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use flipmap_engine::Accuracy;
use flipmap_engine::choice::IntegrationSetting;
use flipmap_engine::run_settings::RunSpec;
use flipmap_render::farm::{MergeError, Plan, PlanError, PlannedOutput, StillPass, Task, TaskKind};
use flipmap_render::film::{FilmRecipe, check_insets};
use flipmap_render::output::{Paths, read_text, shell_word};
use flipmap_scene::{Document, Sampling, Scene};

use super::exit::Exit;
use super::film_options::FilmOptions;
use super::foresight::{Foresight, samples_size};
use super::frames::check_film;
use super::option_names::by_option;
use super::outputs::OutputOptions;
use super::picture_options::PictureOptions;
use super::progress::Mode;
use super::run_options::{EngineOptions, check_steps, start};
use super::spread::spread;
use super::video::{QualityOptions, codec_of};
use super::watch::CommandLine;
use super::{farm, stop};

#[derive(Args, Debug)]
pub(super) struct PlanOptions {
    /// Number of shards
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(Plan::MAX_SHARDS)))]
    shards: u32,
    /// Plan one more sample at each pixel's centre, which --raw, --exr and --trust need if
    /// --samples is above 1
    #[arg(hide_short_help = true, long)]
    numbers: bool,
    /// Plan file to write; the computed parts are stored next to it
    #[arg(short, long, value_name = "PLAN.toml")]
    output: PathBuf,
    /// Say how many samples a shard has, how long it takes and how much room the parts need, and write
    /// no plan
    #[arg(hide_short_help = true, long)]
    dry_run: bool,
    #[command(flatten)]
    film: FilmOptions,
}

#[derive(Args, Debug)]
pub(super) struct RunShards {
    /// Plan file
    plan: PathBuf,
    /// Shard to compute, or a range such as 2-5 (default: all)
    #[arg(long, value_name = "N|A-B")]
    shard: Option<String>,
    #[command(flatten)]
    counted: Counted,
    /// Say how many samples are missing and how long they take, and compute nothing
    #[arg(long)]
    dry_run: bool,
    /// Progress display on standard error
    #[arg(long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    #[command(flatten)]
    engine: EngineOptions,
}

#[derive(Args, Debug)]
pub(super) struct VerifyOptions {
    /// Plan file
    plan: PathBuf,
    #[command(flatten)]
    counted: Counted,
}

/// Option that says how shards are counted.
#[derive(Args, Clone, Copy, Debug)]
struct Counted {
    /// Number of the first shard: 1, or 0 for job arrays that count from it
    #[arg(long, value_name = "0|1", default_value_t = 1, value_parser = clap::value_parser!(u32).range(0..=1))]
    from: u32,
}

impl Counted {
    /// Returns the shards that a text names, of `count`, counted from 1.
    fn shards(self, text: Option<&str>, count: u32) -> Result<std::ops::RangeInclusive<u32>, Exit> {
        let Some(text) = text else { return Ok(1..=count) };
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let number = |text: &str| Some(text.parse::<u32>().ok()?.checked_sub(self.from)? + 1);
        match number(first).zip(number(last)) {
            Some((first, last)) if first <= last && last <= count => Ok(first..=last),
            _ => {
                let last = count - 1 + self.from;
                Err(Exit::Usage(format!(
                    "--shard is '{text}'; it must be a number from {0} to {last}, or a range of two \
                     such numbers, as in {0}-{last}",
                    self.from
                )))
            }
        }
    }

    /// Returns the number by which a shard, counted from 1, is told.
    fn told(self, shard: u32) -> u32 {
        shard - 1 + self.from
    }
}

#[derive(Args, Debug)]
pub(super) struct MergeOptions {
    /// Plan file
    plan: PathBuf,
    /// Progress display on standard error
    #[arg(long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    #[command(flatten)]
    quality: QualityOptions,
    #[command(flatten)]
    picture: PictureOptions,
    #[command(flatten)]
    outputs: OutputOptions,
}

/// Runs `flipmap plan`.
pub(super) fn plan(options: &PlanOptions) -> anyhow::Result<()> {
    options.film.run.engine.check()?;
    let (mut what, spec) = what(options)?;
    check_overwrites_only_plans(&options.output)?;
    if options.output.extension().is_some_and(|ending| ending == "parts") {
        let message =
            "-o names a plan, and .parts is the ending of the folder beside it: name a .toml";
        return Err(Exit::Usage(message.to_string()).into());
    }
    super::check_name(&options.output, "-o", &["toml", "plan"])?;
    super::check(&options.output, "-o")?;
    let scene = match &what {
        PlannedOutput::Still(document) => document.scene(),
        PlannedOutput::Film(film) => film.keys[0].scene.scene(),
    };
    let request =
        options.film.run.engine.request(spec.setting, spec.verify).answering(&scene.question);
    let mut chosen = start(&request)?;
    match &mut what {
        PlannedOutput::Film(film) => check_film(film, chosen.config)?,
        PlannedOutput::Still(document) => {
            check_steps(&scene, chosen.config)?;
            let weight = options.film.picture.weight_of_view(document);
            // Colours take samples, and no count of them.
            if let Some(weight) = weight.filter(|_| !options.dry_run) {
                spread(document, spec.size(), chosen.config, chosen.engine.as_mut(), weight)?;
            }
        }
    }
    let engine = (chosen.engine.as_ref(), chosen.config, spec.verify);
    let mut plan = Plan::new(what, options.shards, engine, options.numbers);
    if options.film.run.engine.is_open() && request.kind.is_none() {
        plan = plan.for_any_engine();
    }
    if options.dry_run {
        return foresee(plan, &scene, spec.setting, options);
    }
    super::write_whole(&options.output, "-o", plan.text().as_bytes())?;
    let task = Task::new(plan, &options.output)?;
    super::tell(&format!(
        "flipmap: {} samples in {}; to compute: flipmap run {} --shard N, N from 1 to {}, or \
         from 0 with --from 0",
        task.samples(),
        match options.shards {
            1 => "1 shard".to_string(),
            shards => format!("{shards} shards"),
        },
        shell_word(&options.output),
        options.shards
    ));
    Ok(())
}

/// Says what a plan would take: the samples of a shard with their time, and the room for all parts.
fn foresee(
    plan: Plan,
    scene: &Scene,
    setting: IntegrationSetting,
    options: &PlanOptions,
) -> anyhow::Result<()> {
    let channels = scene.question.ask.kind().channels.len();
    let verify = plan.verify;
    let samples = Task::new(plan, &options.output)?.samples();
    let of_shard = samples.div_ceil(u64::from(options.shards));
    let effort = Foresight::of(&options.film.run.engine, setting, verify, of_shard);
    match options.shards {
        1 => super::say(&effort.sentence())?,
        shards => super::say(&format!("each of {shards} shards: {}", effort.sentence()))?,
    }
    super::say(&format!("parts: {}", samples_size(samples, channels)))
}

/// Refuses to overwrite a file that is not a plan: keys and scenes are TOML too.
fn check_overwrites_only_plans(path: &Path) -> Result<(), Exit> {
    if !path.is_file() {
        return Ok(());
    }
    let text = read_text(path).ok();
    match text.map(|text| Plan::parse(&text)) {
        None | Some(Err(PlanError::Syntax(_))) => {
            let file = path.display();
            Err(Exit::Usage(format!("-o {file} already exists and is not a plan")))
        }
        Some(_) => Ok(()),
    }
}

fn what(options: &PlanOptions) -> anyhow::Result<(PlannedOutput, RunSpec)> {
    if options.film.says_film() {
        let (film, spec) = options.film.film()?;
        check_insets(&film, &film.keys[0].scene.picture)?;
        return Ok((PlannedOutput::Film(film), spec));
    }
    let words = &options.film.words;
    let mut document = words.apply(words.base(options.film.scene())?)?;
    options.film.picture.check_even("a shard does not know the colours of its neighbours")?;
    options.film.picture.apply(&mut document)?;
    document.picture.adaptive = false;
    let spec = options.film.run.settle(&mut document)?;
    document.view = document.view.fitted(spec.size().map(f64::from));
    document.picture.check()?;
    document.picture.check_size(spec.size())?;
    document.picture.samples = document.picture.samples_of(spec.size());
    Ok((PlannedOutput::Still(Box::new(document.settled())), spec))
}

/// Runs `flipmap run`.
pub(super) fn run(options: &RunShards) -> anyhow::Result<()> {
    options.engine.check()?;
    let task = farm::open(&options.plan)?;
    let shards = options.counted.shards(options.shard.as_deref(), task.plan.shards)?;
    if options.dry_run {
        let missing = farm::missing(&task, shards)?;
        let effort = Foresight::of(&options.engine, setting_of(&task), task.plan.verify, missing);
        return super::say(&effort.sentence());
    }
    let request =
        options.engine.request(IntegrationSetting::Explicit(task.config), task.plan.verify);
    let chosen = start(&task.plan.request_like(request)).with_context(|| {
        let engine = &task.plan.engine;
        format!("the plan is for the {engine} engine; choose another with --engine and --adapter")
    })?;
    stop::listen()?;
    farm::compute(&task, shards, chosen, options.progress)?;
    Ok(())
}

/// Returns the setting of a task's configuration: the level that it belongs to, if any.
fn setting_of(task: &Task) -> IntegrationSetting {
    let is_it = |level: &Accuracy| {
        level.configs().contains(&task.config) && (*level == Accuracy::Exact) == task.plan.verify
    };
    let level = Accuracy::ALL.into_iter().map(|(_, level)| level).find(is_it);
    level.map_or(IntegrationSetting::Explicit(task.config), IntegrationSetting::Accuracy)
}

/// Runs `flipmap verify`.
pub(super) fn verify(options: &VerifyOptions) -> anyhow::Result<()> {
    let task = farm::open(&options.plan)?;
    let parts = farm::scan(&task)?;
    let missing = task.missing_shards(&parts);
    for shard in &missing {
        super::say_if_heard(&options.counted.told(*shard).to_string())?;
    }
    if missing.is_empty() {
        Ok(())
    } else {
        Err(farm::lacks(&missing, &task, &options.plan, options.counted.from).into())
    }
}

/// Runs `flipmap merge`.
pub(super) fn merge(options: &MergeOptions) -> anyhow::Result<()> {
    let task = farm::open(&options.plan)?;
    stop::listen()?;
    match &task.work {
        TaskKind::Film(film, _) | TaskKind::Frames(film, _) => {
            let paths = options.outputs.paths();
            let [("-o", output)] = by_option(&paths)[..] else {
                let only = "a film takes one output: -o FILM.mp4, -o FILM.mkv or -o FOLDER";
                return Err(Exit::Usage(only.to_string()).into());
            };
            codec_of(output)?;
            spares_parts(&task.folder, &paths)?;
            let recipe = FilmRecipe { film, document: &film.keys[0].scene, output };
            let encoding = farm::check(&recipe, options.quality.into())?;
            let parts = farm::complete(&task, &options.plan)?;
            let (path, told, mode) = (output, output, options.progress);
            let output = farm::FilmOutput { path, told, encoding, mode };
            farm::paint(&task, parts, &options.picture, &output)
        }
        TaskKind::Still(document, passes) => merge_still(&task, document, passes, options),
    }
}

/// Refuses outputs in the folder of the parts, which they could replace.
fn spares_parts(parts: &Path, paths: &Paths) -> Result<(), Exit> {
    let whole = |path: &Path| path.canonicalize().ok();
    let Some(parts) = whole(parts) else { return Ok(()) };
    let is_inside = |(_, path): &(&str, &Path)| {
        let folder = path.parent().map(|folder| Path::new(".").join(folder));
        let places = [whole(path), folder.as_deref().and_then(whole)];
        places.into_iter().flatten().any(|place| place.starts_with(&parts))
    };
    match by_option(paths).into_iter().find(is_inside) {
        Some((option, _)) => Err(Exit::Usage(format!(
            "{option} lies in {}, which holds the plan's parts: name a file elsewhere",
            parts.display()
        ))),
        None => Ok(()),
    }
}

fn merge_still(
    task: &Task,
    document: &Document,
    passes: &[StillPass],
    options: &MergeOptions,
) -> anyhow::Result<()> {
    let mut document = document.clone();
    let samples = document.picture.samples;
    options.picture.apply(&mut document)?;
    document.picture.check()?;
    let plan = [("the plan", options.plan.as_path())];
    let inputs: Vec<_> = plan.into_iter().chain(options.picture.palette_file()).collect();
    options.outputs.check(false, task.plan.verify, None, &inputs)?;
    let paths = options.outputs.paths();
    spares_parts(&task.folder, &paths)?;
    farm::check_samples(samples, &document)?;
    if options.picture.says_of_view() {
        let message = "--times view is for plan, which samples the view; merge takes times in \
                       seconds";
        return Err(Exit::Usage(message.to_string()).into());
    }
    let numbers = paths.raw.is_some() || paths.exr.is_some() || paths.trust.is_some();
    if numbers && !passes.iter().any(|pass| pass.sampling == Sampling::SINGLE) {
        let message = "the plan has several --samples per pixel and no values at pixel centres; \
                       --raw, --exr and --trust need a plan made with --numbers";
        return Err(Exit::Usage(message.to_string()).into());
    }
    paths.check(&document.picture)?;
    let mut parts = farm::complete(task, &options.plan)?;
    let watch = CommandLine::new(options.progress, "samples", None);
    let merged = flipmap_render::farm::merge_still(&document, passes, &mut parts, &paths, &watch);
    merged.map_err(|error| match error {
        MergeError::Stopped => anyhow::Error::from(Exit::Unwritten),
        error => error.into(),
    })
}
