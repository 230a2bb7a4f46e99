//! The plan: a file that says what is wanted and how it is split.

use std::mem::take;

use serde::{Deserialize, Serialize};

use crate::output::sha256;
use flipmap_engine::choice::{EngineRequest, IntegrationSetting};
use flipmap_engine::run_settings::RunSpec;
use flipmap_engine::{Engine, EngineKind, IntegratorConfig, run_settings};
use flipmap_scene::film::Film;
use flipmap_scene::{Document, DocumentError, RunTable, one_line};

/// The plan format that this program reads and writes.
const FORMAT: u32 = 1;
/// Version of this program; another one may compute different last digits.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// A plan as it stands in its file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    format: u32,
    version: String,
    /// Digest of everything else in the file.
    sha256: String,
    /// Number of shards.
    pub shards: u32,
    /// True if every sample is checked.
    pub verify: bool,
    /// True if arrays of numbers are wanted as well as a picture with several samples per pixel.
    pub numbers: bool,
    /// True if each shard takes the fastest engine where it runs, with the plan's method and
    /// precision; `engine` and `adapter` are then those of the machine that planned.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub any_engine: bool,
    /// The kind of engine.
    pub engine: EngineKind,
    /// Name of the adapter, for a `gpu` only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub adapter: Option<String>,
    #[serde(rename = "recipe")]
    config: RunTable,
    #[serde(skip_serializing_if = "Option::is_none")]
    still: Option<Document>,
    #[serde(skip_serializing_if = "Option::is_none")]
    film: Option<Film>,
}

/// The output that is wanted.
#[derive(Clone, Debug, PartialEq)]
pub enum PlannedOutput {
    /// One picture.
    Still(Box<Document>),
    /// A film of many pictures.
    Film(Film),
}

/// Reasons why a file is not a plan that can be followed.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// A text that is not TOML, or not a plan.
    #[error("is not a plan: {0}")]
    Syntax(String),
    /// A plan made by another version of the program.
    #[error("was made by flipmap {0}, and this is {VERSION}: plan it again with this one")]
    Version(String),
    /// A plan that was edited after it was made.
    #[error(
        "was changed after it was planned, as its checksum (`sha256`) tells: plan it again with what you \
         want"
    )]
    Changed,
    /// A plan without exactly one still or film, or with one that is not valid.
    #[error("cannot be used: {0}; plan it again")]
    Inside(String),
}

impl Plan {
    /// Creates a plan of `shards` shards, with the engine and configuration that were chosen for
    /// `what`.
    pub fn new(
        what: PlannedOutput,
        shards: u32,
        (engine, config, verify): (&dyn Engine, IntegratorConfig, bool),
        numbers: bool,
    ) -> Self {
        let adapter = (engine.kind() == EngineKind::Gpu).then(|| engine.adapter());
        let (still, film) = match what {
            PlannedOutput::Still(document) => (Some(*document), None),
            PlannedOutput::Film(film) => (None, Some(film)),
        };
        let mut plan = Plan {
            format: FORMAT,
            version: VERSION.to_string(),
            sha256: String::new(),
            shards,
            verify,
            numbers,
            any_engine: false,
            engine: engine.kind(),
            adapter,
            config: run_settings::from_config(config),
            still,
            film,
        };
        plan.sha256 = plan.digest();
        plan
    }

    /// Returns the plan with shards that take the fastest engine where they run.
    #[must_use]
    pub fn for_any_engine(mut self) -> Self {
        self.any_engine = true;
        self.sha256 = self.digest();
        self
    }

    /// Reads and checks a plan.
    pub fn parse(text: &str) -> Result<Self, PlanError> {
        // A newer plan may have keys of its own.
        if let Ok(Version { version }) = toml::from_str(text)
            && version != VERSION
        {
            return Err(PlanError::Version(version));
        }
        let plan: Plan =
            toml::from_str(text).map_err(|error| PlanError::Syntax(one_line(&error, text)))?;
        if plan.sha256 != plan.digest() || plan.format != FORMAT {
            return Err(PlanError::Changed);
        }
        plan.checked()
    }

    /// Returns true for the text of a plan that a film keeps with its samples: a plan of a film in
    /// one shard. It may come from another version and have keys of its own.
    pub fn is_kept_by_film(text: &str) -> bool {
        let plan = toml::from_str::<toml::Table>(text).unwrap_or_default();
        let shards = plan.get("shards").and_then(toml::Value::as_integer);
        plan.contains_key("film") && shards == Some(1)
    }

    /// Requests the engine that this plan was made for, unless the request names another or the plan
    /// leaves it open.
    #[must_use]
    pub fn request_like(&self, request: EngineRequest) -> EngineRequest {
        match self.any_engine {
            true => request,
            false => request.preferring(self.engine, self.adapter.as_deref().unwrap_or_default()),
        }
    }

    /// Largest number of shards.
    pub const MAX_SHARDS: u32 = 100_000;

    fn checked(mut self) -> Result<Self, PlanError> {
        if !(1..=Self::MAX_SHARDS).contains(&self.shards) {
            let most = Self::MAX_SHARDS;
            return Err(PlanError::Inside(format!(
                "it has {} shards, not 1 to {most}",
                self.shards
            )));
        }
        let scene = |error: DocumentError| PlanError::Inside(error.to_string());
        match (&mut self.still, &mut self.film) {
            (Some(document), None) => {
                *document = take(document).checked().map_err(scene)?.settled();
                let size = document.run.size.unwrap_or([1, 1]);
                let fits = document.picture.check_size(size);
                fits.map_err(|error| PlanError::Inside(error.to_string()))?;
            }
            (None, Some(film)) => {
                for key in &mut film.keys {
                    key.scene = take(&mut key.scene).checked().map_err(scene)?.settled();
                }
                film.check().map_err(|error| PlanError::Inside(error.to_string()))?;
            }
            _ => {
                return Err(PlanError::Inside(
                    "it holds neither a still nor a film, or both".to_string(),
                ));
            }
        }
        Ok(self)
    }

    /// Returns the text of the plan's file.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("plain tables are TOML")
    }

    /// Returns the integrator config of the plan.
    pub(crate) fn config(&self) -> Result<IntegratorConfig, PlanError> {
        let spec = RunSpec::resolve(self.config.clone());
        match spec.map_err(|why| PlanError::Inside(why.to_string()))?.setting {
            IntegrationSetting::Explicit(config) => Ok(config),
            _ => Err(PlanError::Inside("it names no configuration".to_string())),
        }
    }

    /// Returns the output that is wanted.
    pub(crate) fn what(&self) -> PlannedOutput {
        match (&self.still, &self.film) {
            (_, Some(film)) => PlannedOutput::Film(film.clone()),
            (still, None) => PlannedOutput::Still(Box::new(still.clone().unwrap_or_default())),
        }
    }

    /// Returns the digest of the plan without its own digest.
    fn digest(&self) -> String {
        sha256(Plan { sha256: String::new(), ..self.clone() }.text().as_bytes())
    }
}

#[derive(Deserialize)]
struct Version {
    version: String,
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_engine::mock::MockEngine;
    use flipmap_engine::{Method, Precision};

    fn plan() -> Plan {
        let config = IntegratorConfig { method: Method::LESSON, precision: Precision::F32 };
        let what = PlannedOutput::Still(Box::default());
        Plan::new(what, 8, (&MockEngine::default(), config, false), false)
    }

    #[test]
    fn a_plan_comes_back_as_it_was() {
        let plan = plan();
        let again = Plan::parse(&plan.text()).unwrap();
        assert_eq!(again, plan);
        assert_eq!(again.what(), PlannedOutput::Still(Box::default()));
        assert_eq!(again.config().unwrap().method, Method::LESSON);
        assert!(plan.text().contains("[recipe]\n"), "plans of the first versions are read");
    }

    #[test]
    fn a_plan_whose_checksum_was_made_to_fit_is_still_checked() {
        let forged = |change: fn(&mut Plan)| {
            let mut plan = plan();
            change(&mut plan);
            plan.sha256 = plan.digest();
            Plan::parse(&plan.text()).unwrap_err().to_string()
        };
        for shards in [0, u32::MAX] {
            let error = match shards {
                0 => forged(|plan| plan.shards = 0),
                _ => forged(|plan| plan.shards = u32::MAX),
            };
            assert!(error.contains(&format!("{shards} shards, not 1 to 100000")), "{error}");
        }
        let large = forged(|plan| {
            plan.still.as_mut().unwrap().run.size = Some([u32::MAX; 2]);
        });
        assert!(large.contains("`size` is 4294967295x4294967295"), "{large}");
    }

    #[test]
    fn another_version_and_a_changed_scene_are_refused() {
        let refused = |from: &str, to: &str| {
            let text = plan().text();
            assert!(text.contains(from), "{text}");
            Plan::parse(&text.replace(from, to)).unwrap_err().to_string()
        };
        let version = format!("version = \"{VERSION}\"");
        assert!(refused(&version, "version = \"0.0.1\"").contains("flipmap 0.0.1, and this is"));
        assert!(refused("shards = 8", "shards = 9").contains("was changed"));
        assert!(refused("gravity = 9.81", "gravity = 1.62").contains("was changed"));
        let misspelt = refused("shards = 8", "chards = 8");
        assert!(
            misspelt.contains(
                "is not a plan: line 4, column 1: unknown key 'chards'; it must be one of"
            ),
            "{misspelt}"
        );
        let wrong = refused("shards = 8", "shards = true");
        assert!(wrong.contains("is not a plan: line 4, column 10: it is the boolean 'true'; it must be a whole number"), "{wrong}");
        assert!(refused("shards = 8", "shards = 9").contains("as its checksum"));
        assert!(Plan::parse("width = 3").unwrap_err().to_string().contains("is not a plan"));
    }
}
