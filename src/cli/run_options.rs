//! The options that control how a scene is computed, and their conversion into a setting.

use clap::{Args, ValueEnum};
use flipmap_engine::choice::{ChoiceError, Chosen, EngineRequest, IntegrationSetting, choose};
use flipmap_engine::run_settings::RunSpec;
use flipmap_engine::{
    Accuracy, Engine, EngineKind, GpuTuning, IntegratorConfig, Method, Precision,
};
use flipmap_render::tiles;
use flipmap_scene::{Document, PictureTable, RunTable, Scene, in_a_row};

use super::exit::Exit;
use super::options::set;
use super::size;
use super::suggested::Suggested;

/// Options that control how a scene is computed.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub(super) struct RunOptions {
    #[arg(long, value_name = "WxH", allow_hyphen_values = true, hide_possible_values = true,
          help = format!("Width and height of the picture in pixels, or {}", size::names()),
          value_parser = Suggested::of(&size::NAMED))]
    pub size: Option<String>,
    /// Accuracy level: lesson (RK4 in f32 at 120 steps per second), fast (as accurate as f32
    /// allows), balanced (the default: all but one pixel in a thousand within 1 ms) or exact
    /// (every pixel checked, and marked where the checks disagree)
    #[arg(long, value_name = "LEVEL", hide_possible_values = true,
          conflicts_with_all = ["method", "step", "tolerance", "precision"],
          value_parser = Suggested::of(&Accuracy::ALL))]
    accuracy: Option<String>,
    #[arg(hide_short_help = true, long, hide_possible_values = true,
          help = format!("Integration method instead of an accuracy level: {}",
                         in_a_row(&Method::names(), "or")),
          value_parser = Suggested(Method::names()))]
    method: Option<String>,
    /// Step of rk4 in seconds, as a number or a fraction
    #[arg(hide_short_help = true, long, value_name = "SECONDS", allow_hyphen_values = true)]
    step: Option<String>,
    /// Error tolerance per step of the other methods
    #[arg(hide_short_help = true, long, allow_hyphen_values = true)]
    tolerance: Option<String>,
    #[arg(hide_short_help = true, long, hide_possible_values = true,
          help = format!("Precision of the arithmetic: {}",
                         in_a_row(&Precision::ALL.map(|(name, _)| name), "or")),
          value_parser = Suggested::of(&Precision::ALL))]
    precision: Option<String>,
    /// Check every pixel, whatever the accuracy level
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    pub engine: EngineOptions,
}

/// Options that select the engine.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub(super) struct EngineOptions {
    /// Engine to compute with; auto: the fastest in the measured profile
    #[arg(long, value_enum, default_value_t = EngineOption::Auto)]
    engine: EngineOption,
    /// Use the graphics adapter whose name contains this text
    #[arg(hide_short_help = true, long, value_name = "NAME")]
    adapter: Option<String>,
    /// Number of threads of the CPU engine (default: one per core)
    #[arg(hide_short_help = true, long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
    /// Setting of the graphics engine that changes its speed but no answer, for measurements; can
    /// be repeated. The keys are pace (maximum ms of a submission without a window), first_slice
    /// (steps before anything is measured), slices (maximum per submission), slots (jobs on the
    /// device), job_size (starts per job), workgroup (32 to 256), subgroups and general (on or off)
    #[arg(hide_short_help = true, long, value_name = "KEY=VALUE", value_parser = tuning)]
    gpu: Vec<String>,
}

/// Refuses a setting or value that the graphics engine does not have.
fn tuning(text: &str) -> Result<String, String> {
    GpuTuning::default().with(text).map(|_| text.to_string())
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum EngineOption {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

impl From<EngineOption> for Option<EngineKind> {
    fn from(option: EngineOption) -> Self {
        match option {
            EngineOption::Auto => None,
            EngineOption::Gpu => Some(EngineKind::Gpu),
            EngineOption::Cpu => Some(EngineKind::Cpu),
        }
    }
}

impl EngineOptions {
    /// Returns the engine request for an integration setting; `verify` asks for checked answers.
    pub(super) fn request(&self, setting: IntegrationSetting, verify: bool) -> EngineRequest {
        EngineRequest {
            kind: self.engine.into(),
            adapter: self.adapter.clone(),
            threads: self.threads(),
            setting,
            verify,
            tuning: self.tuning(),
            ..EngineRequest::default()
        }
    }

    /// Settings of the graphics engine; each has been checked before.
    fn tuning(&self) -> GpuTuning {
        let all = self.gpu.iter();
        all.fold(GpuTuning::default(), |tuning, text| tuning.with(text).unwrap_or(tuning))
    }

    /// Returns true if neither an engine nor an adapter is named.
    pub(super) fn is_open(&self) -> bool {
        self.engine == EngineOption::Auto && self.adapter.is_none()
    }

    /// Number of threads for the CPU engine, if given.
    pub(super) fn threads(&self) -> Option<usize> {
        self.threads.map(|threads| threads as usize)
    }

    /// Rejects options that contradict each other.
    pub(super) fn check(&self) -> Result<(), Exit> {
        let usage = |message: &str| Err(Exit::Usage(message.to_string()));
        match self.engine {
            EngineOption::Cpu if self.adapter.is_some() => {
                usage("--adapter names a graphics adapter and cannot be used with --engine cpu")
            }
            EngineOption::Cpu if !self.gpu.is_empty() => {
                usage("--gpu tunes the graphics engine and cannot be used with --engine cpu")
            }
            EngineOption::Gpu if self.threads.is_some() => {
                usage("--threads applies to the CPU engine and cannot be used with --engine gpu")
            }
            _ => Ok(()),
        }
    }
}

impl RunOptions {
    /// Returns true if any option says how to integrate.
    #[cfg(feature = "window")]
    pub(super) fn says_how(&self) -> bool {
        let words = [&self.accuracy, &self.method, &self.step, &self.tolerance, &self.precision];
        self.verify || words.into_iter().any(Option::is_some)
    }

    fn words(&self) -> RunTable {
        RunTable {
            size: None,
            accuracy: self.accuracy.clone(),
            method: self.method.clone(),
            step: self.step.clone(),
            tolerance: self.tolerance.clone(),
            precision: self.precision.clone(),
            verify: self.verify,
        }
    }

    /// Fills in the document's run table, so that it records what ran, and returns the settings.
    pub(super) fn settle(&self, document: &mut Document) -> Result<RunSpec, Exit> {
        let mut size = document.run.size.unwrap_or(RunSpec::DEFAULT_SIZE);
        set(&mut size, "--size", &self.size, parse_size)?;
        if size.iter().any(|side| !(1..=PictureTable::MAX_SIDE).contains(side)) {
            let text = format!("{}x{}", size[0], size[1]);
            return Err(Exit::Usage(format!("--size is '{text}'; {}", range_of_size())));
        }
        let words = RunTable { size: Some(size), ..document.run.overlaid(self.words()) };
        let spec = RunSpec::resolve(words).map_err(|error| Exit::usage(&error))?;
        document.run = spec.table.clone();
        Ok(spec)
    }
}

/// Describes an engine and its settings. A graphics engine is called by its adapter, which may be a
/// program on the processor.
pub(super) fn in_words(engine: &dyn Engine, config: &IntegratorConfig) -> String {
    let adapter = match engine.kind() {
        EngineKind::Gpu => format!(" on {}", engine.adapter()),
        EngineKind::Cpu => String::new(),
    };
    let (method, setting) = (config.method.name(), config.method.setting());
    format!("{} engine{adapter}, {method} {setting} in {}", engine.kind(), config.precision)
}

/// Chooses and starts an engine, announcing on standard error whatever takes long.
pub(super) fn start(request: &EngineRequest) -> Result<Chosen, ChoiceError> {
    choose(request, &|text| super::tell(&format!("flipmap: {text}")))
}

/// Rejects a configuration that needs too many steps for the budget.
pub(super) fn check_steps(scene: &Scene, config: IntegratorConfig) -> Result<(), Exit> {
    tiles::check_steps(scene, &config).map_err(|error| Exit::usage(&error))
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    size::parse(text).ok_or_else(range_of_size)
}

fn range_of_size() -> String {
    format!(
        "it must be {}, each side between 1 and {} pixels",
        size::ways(),
        PictureTable::MAX_SIDE
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_remembers_how_it_was_made() {
        let mut document = Document::default();
        let lesson = RunOptions { method: Some("rk4".to_string()), ..RunOptions::default() };
        let made = lesson.settle(&mut document).unwrap();
        assert_eq!(RunOptions::default().settle(&mut document).unwrap(), made);
        let other = RunOptions { method: Some("dop853".to_string()), ..RunOptions::default() };
        let IntegrationSetting::Explicit(other) = other.settle(&mut document).unwrap().setting
        else {
            panic!()
        };
        assert_eq!((other.precision, other.method.tolerance()), (Precision::F64, Some(3e-13)));
        let level = RunOptions { accuracy: Some("exact".to_string()), ..RunOptions::default() };
        let plan = level.settle(&mut document).unwrap();
        assert!(plan.verify && plan.setting == IntegrationSetting::Accuracy(Accuracy::Exact));
        assert_eq!(RunOptions::default().settle(&mut document).unwrap(), plan);
    }
}
