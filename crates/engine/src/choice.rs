//! The choice of an engine and a configuration: what was requested, what is available, and the
//! reason for the choice.

use super::adapters::{self, Adapter, GpuTuning, INSTALL_HINT};
use super::cpu::CpuEngine;
use super::depth::{DepthEngine, Following};
use super::profile::{Profile, ProfileRow};
use super::threads::threads_beside;
use super::{Accuracy, Engine, EngineError, EngineKind, IntegratorConfig, Precision};
use flipmap_scene::question::Needs;
use flipmap_scene::{QuestionSettings, SceneError};

/// A user's request for an engine.
#[derive(Clone, Debug, PartialEq)]
pub struct EngineRequest {
    /// The kind of engine; `None` for the fastest in the measured profile.
    pub kind: Option<EngineKind>,
    /// Part of the adapter's name, if an adapter is requested.
    pub adapter: Option<String>,
    /// Number of threads of the CPU engine.
    pub threads: Option<usize>,
    /// The accuracy level or the configuration to compute with.
    pub setting: IntegrationSetting,
    /// The ends that the configuration has to compute, if any configuration of the level can.
    pub ends: Needs,
    /// True if answers are checked even at levels other than `exact` (see
    /// [`EngineRequest::verifies`]).
    pub verify: bool,
    /// Settings of an adapter that change no answer.
    pub tuning: GpuTuning,
    /// True if an adapter is served by a thread of its own, so that it never waits for its caller.
    pub own_thread: bool,
}

impl EngineRequest {
    /// Restricts the request to an engine and a precision that can answer a question. For growth
    /// and returns this is the processor unless the request names an engine or an adapter, because
    /// profiles do not compare engines on these questions.
    #[must_use]
    pub fn answering(self, question: &QuestionSettings) -> Self {
        let ends = question.ask.kind().needs;
        let is_named = self.kind.is_some() || self.adapter.is_some();
        let kind = if ends.are_carried() && !is_named { Some(EngineKind::Cpu) } else { self.kind };
        EngineRequest { kind, ends, ..self }
    }

    /// Requests an engine that ran before, unless this request names one: another engine would differ
    /// in the last digits.
    #[must_use]
    pub fn preferring(self, engine: EngineKind, adapter: &str) -> Self {
        match (self.kind, &self.adapter, engine) {
            (None, None, EngineKind::Cpu) => EngineRequest { kind: Some(engine), ..self },
            (None, None, EngineKind::Gpu) => {
                EngineRequest { kind: Some(engine), adapter: Some(adapter.to_string()), ..self }
            }
            _ => self,
        }
    }

    /// Returns true if answers will be checked. The kernel that checks them is tested first; an
    /// adapter on which it fails leaves the checks to the processor.
    pub fn verifies(&self) -> bool {
        self.verify || self.setting == IntegrationSetting::Accuracy(Accuracy::Exact)
    }

    /// Returns true if `config` cannot compute the ends of this request, but another configuration
    /// that satisfies the request can.
    pub fn outgrows(&self, config: &IntegratorConfig) -> bool {
        let can = |config: &IntegratorConfig| config.check_needs(self.ends).is_ok();
        !can(config) && self.configs().iter().any(can)
    }

    /// Returns the configurations that satisfy the setting and compute the ends, the preferred one
    /// first; if none computes the ends, all that satisfy the setting.
    fn configs(&self) -> Vec<IntegratorConfig> {
        let mut configs = self.setting.configs();
        if configs.iter().any(|config| config.check_needs(self.ends).is_ok()) {
            configs.retain(|config| config.check_needs(self.ends).is_ok());
        }
        configs
    }
}

impl Default for EngineRequest {
    fn default() -> Self {
        let setting = IntegrationSetting::Accuracy(Accuracy::default());
        EngineRequest {
            kind: None,
            adapter: None,
            threads: None,
            setting,
            ends: Needs::Outcome,
            verify: false,
            tuning: GpuTuning::default(),
            own_thread: true,
        }
    }
}

/// The required accuracy level, or an explicit configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntegrationSetting {
    /// Any configuration that keeps the level's promise.
    Accuracy(Accuracy),
    /// Exactly this configuration.
    Explicit(IntegratorConfig),
}

impl Default for IntegrationSetting {
    fn default() -> Self {
        IntegrationSetting::Accuracy(Accuracy::default())
    }
}

impl IntegrationSetting {
    /// The configurations that satisfy the setting, the preferred one first.
    pub fn configs(self) -> Vec<IntegratorConfig> {
        match self {
            IntegrationSetting::Accuracy(accuracy) => accuracy.configs(),
            IntegrationSetting::Explicit(config) => vec![config],
        }
    }
}

/// Reasons why no engine fits the request.
#[derive(Debug, thiserror::Error)]
pub enum ChoiceError {
    /// There is no adapter, or none passed the self-check, and the processor was not allowed.
    #[error("{0}")]
    NoAdapter(String),
    /// The requested adapter is not present.
    #[error("{0}")]
    UnknownAdapter(#[source] SceneError),
    /// An engine could not be started.
    #[error(transparent)]
    Engine(#[from] EngineError),
}

/// The chosen engine and configuration, with one sentence on why.
pub struct Chosen {
    /// The engine, ready to run.
    pub engine: Box<dyn Engine>,
    /// The configuration to run on it.
    pub config: IntegratorConfig,
    /// Reason for the choice, in words for the user.
    pub why: String,
    /// Progress in following the middle of a deep view.
    pub following: Following,
    /// The request that was met.
    pub request: EngineRequest,
}

/// Chooses and starts an engine; `tell` receives a message before anything that takes long.
pub fn choose(request: &EngineRequest, tell: &dyn Fn(&str)) -> Result<Chosen, ChoiceError> {
    // Whatever the engine is, it is refused before it is measured and its kernels are compiled.
    request.configs()[0].check_needs(request.ends)?;
    let chosen = match (request.kind, &request.adapter) {
        (Some(EngineKind::Cpu), _) if request.ends.are_carried() => {
            cpu(request, "the engine for this question unless another is named".to_string())?
        }
        (Some(EngineKind::Cpu), _) => cpu(request, "as named".to_string())?,
        (Some(EngineKind::Gpu), _) | (None, Some(_)) => first_trusted(request)?
            .map_err(|why| ChoiceError::NoAdapter(format!("{why}; or use the cpu engine")))?,
        (None, None) => automatic(request, tell)?,
    };
    let engine = DepthEngine::new(chosen.engine, threads_beside(request.threads))?
        .telling(chosen.following.clone());
    Ok(Chosen { engine: Box::new(engine), ..chosen })
}

/// Chooses the fastest engine of the profile. Opens no adapter if only the processor has the
/// method, or if profiles do not compare engines by it.
fn automatic(request: &EngineRequest, tell: &dyn Fn(&str)) -> Result<Chosen, ChoiceError> {
    let configs = request.configs();
    if !configs.iter().any(Adapter::has_kernels) {
        let why = "only the processor has this method and precision";
        return cpu(request, if cfg!(feature = "gpu") { why } else { INSTALL_HINT }.to_string());
    }
    if configs.iter().all(|config| config.method.is_series()) {
        return cpu(request, "engines are not compared by this method".to_string());
    }
    let profile = Profile::get(request.threads, tell);
    let Some(row) = fastest(&profile, request.setting) else {
        return first_trusted(request)?.or_else(|why| cpu(request, why));
    };
    let passed_over = |rival: &ProfileRow| {
        let is_faster = rival.us_per_pixel < row.us_per_pixel;
        rival.software && rival.accuracy == row.accuracy && is_faster
    };
    let is_any = profile.rows.iter().any(passed_over);
    let but = if is_any { " but for graphics in software" } else { "" };
    let why = format!(
        "{:.1} µs a pixel on this machine, the fastest of its profile{but}",
        row.us_per_pixel
    );
    if row.engine == EngineKind::Cpu {
        return cpu(request, why);
    }
    let setting = match request.setting {
        IntegrationSetting::Accuracy(_) => {
            row.config().map_or(request.setting, IntegrationSetting::Explicit)
        }
        config => config,
    };
    let (adapter, verify) = (Some(row.adapter.clone()), request.verifies());
    let request = EngineRequest { adapter, setting, verify, ..request.clone() };
    match first_trusted(&request)? {
        Ok(chosen) => Ok(Chosen { why, ..chosen }),
        Err(why) => cpu(&request, why),
    }
}

/// Returns the fastest row for a setting: a row of its level or, for an explicit configuration, of
/// the level whose configurations are most like it.
fn fastest(profile: &Profile, setting: IntegrationSetting) -> Option<&ProfileRow> {
    match setting {
        IntegrationSetting::Accuracy(accuracy) => profile.fastest(accuracy, |_| true),
        IntegrationSetting::Explicit(config) => {
            let offers =
                |row: &ProfileRow| row.engine == EngineKind::Gpu || CpuEngine::offers(&config);
            let like = Accuracy::ALL.iter().map(|(_, accuracy)| *accuracy).find(|accuracy| {
                accuracy.configs().iter().any(|other| {
                    other.precision == config.precision
                        && other.method.name() == config.method.name()
                })
            });
            let like = like.unwrap_or(match config.precision {
                Precision::F32 => Accuracy::Fast,
                _ => Accuracy::Balanced,
            });
            profile.fastest(like, offers)
        }
    }
}

fn cpu(request: &EngineRequest, why: String) -> Result<Chosen, ChoiceError> {
    let configs = request.configs();
    let config = configs.iter().find(|config| CpuEngine::offers(config)).unwrap_or(&configs[0]);
    CpuEngine::require(config)?;
    let engine = Box::new(CpuEngine::new(request.threads)?);
    let following = Following::default();
    Ok(Chosen { engine, config: *config, why, following, request: request.clone() })
}

/// Opens the first adapter that matches and is trusted with the setting; otherwise returns the
/// reasons why none is.
fn first_trusted(request: &EngineRequest) -> Result<Result<Chosen, String>, ChoiceError> {
    let fitting = adapters::matching(request.adapter.as_deref())?;
    if fitting.is_empty() {
        return Ok(Err(INSTALL_HINT.to_string()));
    }
    let profile = Profile::kept(request.threads);
    let mut failures = Vec::new();
    for adapter in fitting {
        let configs = configs_on(&adapter, request, profile.as_ref());
        match adapter.serve(request, configs)? {
            Ok(chosen) => return Ok(Ok(chosen)),
            Err(why) => failures.push(format!("{}: {why}", adapter.name())),
        }
    }
    Ok(Err(failures.join("; ")))
}

/// The configurations that satisfy a request; the one that is fastest on the adapter comes first if
/// it is known.
fn configs_on(
    adapter: &Adapter,
    request: &EngineRequest,
    profile: Option<&Profile>,
) -> Vec<IntegratorConfig> {
    let mut configs = request.configs();
    if let (IntegrationSetting::Accuracy(accuracy), Some(profile)) = (request.setting, profile) {
        let name = adapter.name();
        let fastest = profile.fastest(accuracy, |row| row.adapter == name);
        let place = fastest
            .and_then(ProfileRow::config)
            .and_then(|config| configs.iter().position(|other| *other == config));
        if let Some(place) = place {
            configs[..=place].rotate_right(1);
        }
    }
    configs
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_scene::question::QuestionName;

    #[test]
    fn a_card_answers_in_a_precision_that_can() {
        let request = |ask| {
            let question = QuestionSettings { ask, ..QuestionSettings::default() };
            let kind = Some(EngineKind::Gpu);
            EngineRequest { kind, ..EngineRequest::default() }.answering(&question)
        };
        assert_eq!(request(QuestionName::Flip).configs(), Accuracy::Balanced.configs());
        for ask in [QuestionName::Growth, QuestionName::Return] {
            assert_eq!(request(ask).kind, Some(EngineKind::Gpu));
        }
        assert_eq!(request(QuestionName::Return).configs(), Accuracy::Balanced.configs());
        assert_eq!(request(QuestionName::Growth).configs(), [Accuracy::Balanced.configs()[0]]);
        // A window that showed flips in pairs of f32 needs another engine for growth.
        for config in Accuracy::Balanced.configs() {
            let is_first = config == Accuracy::Balanced.configs()[0];
            assert_eq!(request(QuestionName::Growth).outgrows(&config), !is_first);
            assert!(!request(QuestionName::Flip).outgrows(&config));
        }
    }

    /// Holds for requests from the library, from Python, from a plan and from a window.
    #[test]
    fn exact_is_verified() {
        let request = |accuracy, verify| {
            let setting = IntegrationSetting::Accuracy(accuracy);
            let (kind, threads) = (Some(EngineKind::Cpu), Some(1));
            EngineRequest { kind, threads, setting, verify, ..EngineRequest::default() }
        };
        assert!(request(Accuracy::Exact, false).verifies());
        assert!(request(Accuracy::Fast, true).verifies());
        assert!(!request(Accuracy::Balanced, false).verifies());
    }
}
