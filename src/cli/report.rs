//! `flipmap report`: measures the speed and error of this machine's engines.

use std::io::{IsTerminal, stderr};
use std::path::PathBuf;

use anyhow::Context;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use flipmap_engine::{Accuracy, choice};
use flipmap_report::{BackendFilter, Chapter, Folder, ReportError, Session, Thoroughness};
use flipmap_scene::number_within;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::exit::Exit;
use super::hunt;
use super::progress::Mode;
use super::run_options::EngineOption;
use super::stop;

#[derive(Args, Debug)]
pub(super) struct Options {
    /// Folder for report.json, report.md and report.html
    #[arg(short, long, value_name = "FOLDER", default_value = "report")]
    output: PathBuf,
    /// Measure fewer settings and fewer starts, in a few minutes instead of half an hour or more
    #[arg(long)]
    quick: bool,
    /// Measure only these chapters
    #[arg(long, value_name = "CHAPTER,…", value_delimiter = ',', value_parser = chapter(), conflicts_with = "hunt")]
    only: Vec<Chapter>,
    /// Engines to measure; auto: every adapter and the CPU
    #[arg(long, value_enum, default_value_t = EngineOption::Auto)]
    engine: EngineOption,
    /// Measure only the adapters whose names contain this text
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Number of threads of the CPU engine (default: one per core)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Maximum number of starts to compare with the gold standard (default: 20000; with --quick
    /// 5000)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    sample: Option<u32>,
    /// Progress display on standard error
    #[arg(long, value_enum, default_value_t = Mode::Auto)]
    pub progress: Mode,
    /// Instead of measuring, search random scenes for this many minutes for pixels that --accuracy
    /// exact gets wrong but does not mark; findings are printed as commands and kept in hunt.json
    #[arg(long, value_name = "MINUTES", value_parser = minutes)]
    hunt: Option<f64>,
    /// Seed from which the random scenes of a hunt are drawn
    #[arg(long, value_name = "N", default_value_t = 1, requires = "hunt")]
    seed: u64,
}

fn chapter() -> impl TypedValueParser<Value = Chapter> {
    let names = PossibleValuesParser::new(Chapter::ALL.map(Chapter::name));
    names.map(|name| Chapter::named(&name).expect("one of the names"))
}

fn minutes(text: &str) -> Result<f64, String> {
    number_within(text, 0.01..=1e5, "minutes")
}

pub(super) fn run(options: &Options) -> anyhow::Result<()> {
    let field = field(options)?;
    if let Some(minutes) = options.hunt {
        let setting = choice::IntegrationSetting::Accuracy(Accuracy::Exact);
        let adapter = options.adapter.clone();
        let request = choice::EngineRequest {
            kind: options.engine.into(),
            adapter,
            threads: field.threads,
            setting,
            ..Default::default()
        };
        return hunt::run(minutes, options.seed, &options.output, &request);
    }
    check_chapters(options)?;
    let folder = Folder::create(&options.output).context("-o")?;
    stop::listen()?;
    let care = care(options);
    let mut session = Session::open(&field, care, &options.only, &stop::asked)
        .map_err(|error| explained(error, &folder, None))?;
    let progress = ReportProgress::new(options.progress, session.len());
    while let Some(name) = session.next_name() {
        progress.begin(session.done(), name);
        session.advance(&stop::asked).map_err(|error| explained(error, &folder, Some(&session)))?;
        folder.write(session.report())?;
        progress.finish(session.done());
    }
    let path = folder.path().join("report.html");
    super::tell(&format!("flipmap: wrote the report to {}", path.display()));
    Ok(())
}

/// Refuses chapters that a quick report does not have.
fn check_chapters(options: &Options) -> Result<(), Exit> {
    match options.only.iter().find(|chapter| options.quick && !chapter.is_quick()) {
        Some(chapter) => {
            let name = chapter.name();
            Err(Exit::Usage(format!(
                "--quick does not measure the chapter given to --only: {name}"
            )))
        }
        None => Ok(()),
    }
}

fn field(options: &Options) -> Result<BackendFilter, Exit> {
    let field = BackendFilter {
        only_gpu: options.engine == EngineOption::Gpu,
        only_cpu: options.engine == EngineOption::Cpu,
        adapter: options.adapter.clone(),
        threads: options.threads.map(|threads| threads as usize),
    };
    if field.only_cpu && field.adapter.is_some() {
        let message = "--adapter names a graphics adapter and cannot be used with --engine cpu";
        return Err(Exit::Usage(message.to_string()));
    }
    Ok(field)
}

fn care(options: &Options) -> Thoroughness {
    let care = if options.quick { Thoroughness::QUICK } else { Thoroughness::FULL };
    let sample = options.sample.map_or(care.sample, |sample| sample as usize);
    Thoroughness { sample, ..care }
}

/// Converts an error to one with an exit code; a stop says what it left behind.
fn explained(error: ReportError, folder: &Folder, session: Option<&Session>) -> anyhow::Error {
    match (error, session) {
        (ReportError::Choice(error), _) => error.into(),
        (ReportError::Stopped, Some(session)) if session.done() > 0 => {
            let message = format!(
                "stopped; {} holds {} of {} measurements and says what is missing",
                folder.path().display(),
                session.done(),
                session.len()
            );
            Exit::Partly(message).into()
        }
        (ReportError::Stopped, _) => {
            Exit::Partly("stopped before anything was measured".to_string()).into()
        }
        (error, _) => error.into(),
    }
}

/// A display of the number of measurements done: a bar on a terminal, or one JSON object for each.
struct ReportProgress {
    bar: ProgressBar,
    json: bool,
    total: usize,
}

impl ReportProgress {
    fn new(mode: Mode, total: usize) -> Self {
        let shown = mode == Mode::Auto && stderr().is_terminal();
        let target =
            if shown { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(total as u64), target);
        let style = "{bar:30} {pos} of {len} · {eta} left · {wide_msg}";
        bar.set_style(ProgressStyle::with_template(style).expect("a valid template"));
        ReportProgress { bar, json: mode == Mode::Json, total }
    }

    fn begin(&self, done: usize, name: &str) {
        self.bar.set_message(name.to_string());
        self.tell(done, Some(name));
    }

    fn finish(&self, done: usize) {
        self.bar.set_position(done as u64);
        if done == self.total {
            self.tell(done, None);
        }
    }

    fn tell(&self, done: usize, now: Option<&str>) {
        if self.json {
            let secs = self.bar.elapsed().as_secs_f64();
            let line = serde_json::json!({
                "done": done, "total": self.total, "secs": secs, "now": now,
            });
            super::tell(&line.to_string());
        }
    }
}

impl Drop for ReportProgress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
