//! `flipmap measure`: measures a scene with confidence intervals.

use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use flipmap_engine::Accuracy;
use flipmap_engine::choice::IntegrationSetting;
use flipmap_measure::{
    Findings, MeasureError, Statistic, Survey, SurveyFolder, SurveyOrder, table,
};
use flipmap_render::tiles::Renderer;
use flipmap_scene::in_a_row;

use super::exit::Exit;
use super::options::{SceneOptions, number_of};
use super::progress::Mode;
use super::run_options::{EngineOptions, in_words, start};
use super::stop;
use super::suggested::Suggested;
use super::watch::CommandLine;

#[derive(Args, Debug)]
pub(super) struct Options {
    #[arg(long, value_name = "LIST", value_delimiter = ',', hide_possible_values = true,
          help = format!("What to measure (default: all that the question allows): {}",
                         in_a_row(&Statistic::ALL.map(|(name, _)| name), "or")),
          value_parser = Suggested::of(&Statistic::ALL))]
    of: Vec<String>,
    /// Number of starts for areas and survival; everything else takes its share of it
    #[arg(long, value_name = "N", default_value_t = 200_000,
          value_parser = clap::value_parser!(u32).range(i64::from(*SurveyOrder::SAMPLES.start())..=i64::from(*SurveyOrder::SAMPLES.end())))]
    samples: u32,
    /// Seed of the starts: the same seed has the same starts on every machine
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Also count a pair of starts as different if its flips are farther apart than this
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    apart: Option<String>,
    /// Folder for measure.json, curves as CSV and SVG, and a page; run again to go on after a stop
    #[arg(short, long, value_name = "FOLDER")]
    output: Option<PathBuf>,
    /// Print the results as one JSON object
    #[arg(long)]
    json: bool,
    /// Progress display on standard error
    #[arg(hide_short_help = true, long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    #[command(flatten)]
    scene: SceneOptions,
    #[command(flatten)]
    engine: EngineOptions,
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    options.engine.check()?;
    let order = order(options)?;
    let mut survey = match &options.output {
        Some(path) => Survey::within(order, SurveyFolder::create(path).context("-o")?),
        None => Survey::new(order),
    }
    .map_err(explained)?;
    if options.output.is_none() {
        super::check_stdout()?;
    }
    stop::listen()?;
    let [known, all] = survey.extent();
    if known < all {
        let exact = IntegrationSetting::Accuracy(Accuracy::Exact);
        let request = options.engine.request(exact, true);
        let request = request.answering(&survey.order().scene.question);
        let chosen = start(&request)?;
        let words = in_words(&*chosen.engine, &chosen.config);
        super::tell(&format!("flipmap: {words}, every answer checked"));
        let mut renderer = Renderer::try_from(chosen)?;
        let watch = CommandLine::new(options.progress, "starts", None);
        survey.run(&mut renderer, &watch).map_err(|error| stopped(error, options))?;
    }
    let findings = survey.findings();
    refuse_nothing(&survey, &findings)?;
    survey.write()?;
    tell(options, &findings)
}

fn order(options: &Options) -> anyhow::Result<SurveyOrder> {
    let document = options.scene.document()?.settled();
    let mut order = SurveyOrder::of(document.scene());
    if !options.of.is_empty() {
        let refusal = |(name, why)| Exit::Usage(format!("--of is '{name}'; {why}"));
        order.of = Statistic::named(&options.of).map_err(refusal)?;
    }
    let apart = options.apart.as_deref();
    let apart_secs =
        apart.map(|text| number_of("--apart", text, SurveyOrder::APART_SECS, "seconds"));
    Ok(SurveyOrder {
        samples: options.samples,
        seed: options.seed,
        apart_secs: apart_secs.transpose()?,
        ..order
    })
}

/// Converts an error about a setting to a usage error.
fn explained(error: MeasureError) -> anyhow::Error {
    match error {
        MeasureError::Setting(error) => Exit::usage(&error).into(),
        error => error.into(),
    }
}

/// Converts a stop to an exit code: with a folder, what is complete is kept.
fn stopped(error: MeasureError, options: &Options) -> anyhow::Error {
    match error {
        MeasureError::Stopped if options.output.is_some() => Exit::Again.into(),
        MeasureError::Stopped => Exit::Interrupted.into(),
        error => explained(error),
    }
}

/// Fails if nothing that was ordered could be estimated.
fn refuse_nothing(survey: &Survey, findings: &Findings) -> Result<(), MeasureError> {
    let missing = |one: &Statistic| findings.missing.iter().find(|it| it.what == one.name());
    let all: Option<Vec<_>> = survey.order().of.iter().map(missing).collect();
    match all.as_deref() {
        Some([first, ..]) => {
            Err(MeasureError::Estimate { what: first.what, why: first.error.clone() })
        }
        _ => Ok(()),
    }
}

fn tell(options: &Options, findings: &Findings) -> anyhow::Result<()> {
    if options.json {
        return super::say(&serde_json::to_string_pretty(findings)?);
    }
    super::say(table(findings).trim_end())?;
    if let Some(path) = &options.output {
        let page = path.join("measure.html");
        super::tell(&format!("flipmap: wrote the results to {}", page.display()));
    }
    Ok(())
}
