//! The ways in which a hunt computes its windows: both engines, every method and precision that is
//! checked, and cells wherever they can be followed.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use flipmap_engine::choice::{ChoiceError, Chosen, EngineRequest, IntegrationSetting, choose};
use flipmap_engine::{Accuracy, Cells, EngineKind, IntegratorConfig, Method, Precision};
use flipmap_render::tiles::Renderer;
use flipmap_scene::question::Needs;

/// A way to compute a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct How {
    pub kind: EngineKind,
    /// The configuration whose answers are checked; none for that of `exact`.
    pub config: Option<IntegratorConfig>,
    pub cells: Cells,
}

/// The configurations that can be checked, beside that of `exact`.
const CONFIGS: [(Method, Precision); 8] = [
    (Method::LESSON, Precision::F32),
    (Method::LESSON, Precision::F64),
    (Method::dopri5(5e-8), Precision::F32),
    (Method::dopri5(1e-9), Precision::F64),
    (Method::dop853(5e-8), Precision::F32),
    (Method::dop853(1e-11), Precision::F64),
    (Method::Taylor { tolerance: 1e-15 }, Precision::F64),
    (Method::Taylor { tolerance: 1e-25 }, Precision::Dd),
];

impl How {
    /// Draws a way. Half of all windows are computed as by default.
    pub(super) fn draw(random: &mut fastrand::Rng, kind: Option<EngineKind>) -> Self {
        let any = if random.u8(0..4) == 0 { EngineKind::Gpu } else { EngineKind::Cpu };
        let (method, precision) = CONFIGS[random.usize(0..CONFIGS.len())];
        let config = (random.u8(0..4) == 0).then_some(IntegratorConfig { method, precision });
        let cells = match random.u8(0..6) {
            0 => Cells::Always,
            1 => Cells::Never,
            _ => Cells::Auto,
        };
        How { kind: kind.unwrap_or(any), config, cells }
    }

    /// The options that select it.
    pub(super) fn options(&self) -> String {
        let mut settings =
            vec![("engine", self.kind.to_string()), ("cells", self.cells.to_string())];
        match self.config {
            None => settings.push(("accuracy", Accuracy::Exact.to_string())),
            Some(IntegratorConfig { method, precision }) => {
                let limit = match method.tolerance() {
                    None => ("step", "1/120".to_string()),
                    Some(tolerance) => ("tolerance", format!("{tolerance:e}")),
                };
                let method = ("method", method.name().to_string());
                settings.extend([method, ("precision", precision.to_string()), limit]);
                settings.push(("verify", String::new()));
            }
        }
        let option = |(setting, value): &(&str, String)| match value.as_str() {
            "" => format!("--{setting}"),
            value => format!("--{setting}={value}"),
        };
        settings.iter().map(option).collect::<Vec<_>>().join(" ")
    }
}

/// The renderers of a hunt, each made when it is first needed.
pub(super) struct Renderers {
    request: EngineRequest,
    made: HashMap<String, Option<Renderer>>,
}

impl Renderers {
    /// Renderers for a user's request.
    pub(super) fn new(request: &EngineRequest) -> Self {
        Renderers { request: request.clone(), made: HashMap::new() }
    }

    /// The renderer that computes a way and returns such ends; none where this machine has no engine
    /// that does.
    pub(super) fn of(
        &mut self,
        how: &How,
        ends: Needs,
    ) -> Result<Option<&mut Renderer>, ChoiceError> {
        let setting = match how.config {
            Some(config) => IntegrationSetting::Explicit(config),
            None => IntegrationSetting::Accuracy(Accuracy::Exact),
        };
        let request = EngineRequest {
            kind: Some(how.kind),
            setting,
            ends,
            verify: true,
            ..self.request.clone()
        };
        let renderer = match self.made.entry(format!("{:?} {setting:?} {ends:?}", how.kind)) {
            Entry::Occupied(made) => made.into_mut(),
            Entry::Vacant(place) => place.insert(made(&request)?),
        };
        Ok(renderer.as_mut())
    }
}

fn made(request: &EngineRequest) -> Result<Option<Renderer>, ChoiceError> {
    let is_refused = |config: &IntegratorConfig| config.check_needs(request.ends).is_err();
    match choose(request, &|_| {}) {
        Ok(Chosen { config, .. }) if is_refused(&config) => Ok(None),
        Ok(chosen) => Ok(Some(Renderer::try_from(chosen)?)),
        // No adapter, or none that is trusted with it.
        Err(ChoiceError::NoAdapter(_) | ChoiceError::Engine(_)) => Ok(None),
        Err(error) => Err(error),
    }
}
