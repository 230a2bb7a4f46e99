//! The options that say how a scene is computed, and how they become a setting.

use clap::{Args, ValueEnum};
use flipmap::engine::choice::{
    self, ChoiceError, Chosen, EngineRequest, IntegrationSetting, choose,
};
use flipmap::engine::method::Pace;
use flipmap::engine::{IntegratorConfig, Question, run_settings};
use flipmap::scene::{Document, PictureTable, RunTable, Scene};

use super::exit::Exit;
use super::options::set;

/// How to compute it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub struct RunOptions {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// lesson: RK4 at 120 steps a second in f32; fast: the best of f32; balanced (default): all
    /// but one pixel in a thousand within 1 ms; exact: every pixel checked, and marked where the
    /// checks disagree
    #[arg(long, value_name = "LEVEL")]
    accuracy: Option<String>,
    /// rk4, dopri5, dop853 or taylor: run exactly this instead of a level
    #[arg(long)]
    method: Option<String>,
    /// Seconds a step of rk4, as a number or a fraction
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    step: Option<String>,
    /// Error a step of the other methods may make
    #[arg(long, allow_hyphen_values = true)]
    tolerance: Option<String>,
    /// f32, df32, f64 or dd
    #[arg(long)]
    precision: Option<String>,
    /// Check every pixel, whatever the accuracy
    #[arg(long)]
    verify: bool,
    #[command(flatten)]
    pub engine: EngineOptions,
}

/// What to compute it on.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub struct EngineOptions {
    /// auto: the fastest of the measured profile
    #[arg(long, value_enum, default_value_t = EngineOption::Auto)]
    engine: EngineOption,
    /// Part of the name of the adapter to use
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Threads of the CPU engine (default: one for each core)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineOption {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

/// Without `--size`.
const DEFAULT_SIZE: [u32; 2] = [1024, 1024];

/// What is to be run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunSpec {
    /// A level or a config.
    pub setting: IntegrationSetting,
    /// Whether every pixel is checked.
    pub verify: bool,
    /// Pixels.
    pub size: [u32; 2],
}

impl EngineOptions {
    /// The engine asked for.
    pub fn request(&self, setting: IntegrationSetting) -> EngineRequest {
        EngineRequest {
            kind: match self.engine {
                EngineOption::Auto => choice::EngineKind::Auto,
                EngineOption::Gpu => choice::EngineKind::Gpu,
                EngineOption::Cpu => choice::EngineKind::Cpu,
            },
            adapter: self.adapter.clone(),
            threads: self.threads(),
            setting,
            ..EngineRequest::default()
        }
    }

    /// Threads of the processor to use.
    pub fn threads(&self) -> Option<usize> {
        self.threads.map(|threads| threads as usize)
    }

    /// Refuses options that contradict each other.
    pub fn check(&self) -> Result<(), Exit> {
        let usage = |message: &str| Err(Exit::Usage(message.to_string()));
        match self.engine {
            EngineOption::Cpu if self.adapter.is_some() => {
                usage("--adapter names a graphics adapter; leave it out with --engine cpu")
            }
            EngineOption::Gpu if self.threads.is_some() => {
                usage("--threads is for the processor; leave it out with --engine gpu")
            }
            _ => Ok(()),
        }
    }
}

impl RunOptions {
    /// Whether something was said of how to integrate.
    pub fn says_how(&self) -> bool {
        let words = [&self.accuracy, &self.method, &self.step, &self.tolerance, &self.precision];
        self.verify || words.into_iter().any(Option::is_some)
    }

    /// Fills in the document's run table, so that it says what ran, and gives the same typed.
    pub fn settle(&self, document: &mut Document) -> Result<RunSpec, Exit> {
        let mut size = document.run.size.unwrap_or(DEFAULT_SIZE);
        set(&mut size, "--size", &self.size, parse_size)?;
        if size.iter().any(|side| !(1..=PictureTable::LONGEST_SIDE).contains(side)) {
            let text = format!("{}x{}", size[0], size[1]);
            return Err(Exit::Usage(format!("--size is '{text}'; {SIZE}")));
        }
        let kept = std::mem::take(&mut document.run);
        let (setting, run) = run_settings::resolve(self.words_over(&kept))
            .map_err(|error| Exit::Usage(error.to_string()))?;
        let run = RunTable { size: Some(size), verify: run.verify || self.verify, ..run };
        let verify = run_settings::verifies(setting, &run);
        document.run = run;
        Ok(RunSpec { setting, verify, size })
    }

    /// What is said on the command line, over what the scene's file kept: a level there replaces
    /// any config in the file, a method there its step or tolerance.
    fn words_over(&self, kept: &RunTable) -> RunTable {
        let kept = if self.accuracy.is_some() { RunTable::default() } else { kept.clone() };
        let method = self.method.clone().or(kept.method.clone());
        let same_method = self.method.is_none() || self.method == kept.method;
        let of_kept = |text: Option<String>| text.filter(|_| same_method);
        RunTable {
            size: None,
            accuracy: self.accuracy.clone().or(kept.accuracy),
            step: self.step.clone().or(of_kept(kept.step)),
            tolerance: self.tolerance.clone().or(of_kept(kept.tolerance)),
            precision: self.precision.clone().or(of_kept(kept.precision)),
            method,
            verify: kept.verify,
        }
    }
}

/// Starts an engine; what takes long is told.
pub fn start(request: &EngineRequest) -> Result<Chosen, ChoiceError> {
    choose(request, &|text| super::tell(&format!("flipmap: {text}")))
}

/// The engine that ran before, where the choice is free: another would give other last digits.
pub fn prefer_engine(request: EngineRequest, engine: &str, adapter: &str) -> EngineRequest {
    match (request.kind, &request.adapter, engine) {
        (choice::EngineKind::Auto, None, "cpu") => {
            EngineRequest { kind: choice::EngineKind::Cpu, ..request }
        }
        (choice::EngineKind::Auto, None, _) => EngineRequest {
            kind: choice::EngineKind::Gpu,
            adapter: Some(adapter.to_string()),
            ..request
        },
        _ => request,
    }
}

/// Refuses steps that are too many for the budget.
pub fn check_steps(scene: &Scene, config: IntegratorConfig) -> Result<(), Exit> {
    let question = Question::from(scene);
    if question.build.gravity.value() > 0.0 {
        Pace::new(&question, &config).map_err(|error| Exit::Usage(error.to_string()))?;
    }
    Ok(())
}

const SIZE: &str = "it must be WIDTHxHEIGHT with both between 1 and 1000000 pixels";

/// Two sides with an x between them.
pub fn sides(text: &str) -> Option<[u32; 2]> {
    let (width, height) = text.split_once('x')?;
    Some([width.parse().ok()?, height.parse().ok()?])
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    sides(text).ok_or(SIZE.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap::engine::{Accuracy, Precision};

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
