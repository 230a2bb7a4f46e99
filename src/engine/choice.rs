//! Which engine runs, and which recipe: what was asked for, what there is, and why the one was
//! chosen.

use std::time::Duration;

use super::cpu::CpuEngine;
use super::depth::{DepthEngine, Following};
use super::gpu::device::{Gpu, adapters, describe};
use super::gpu::{GpuEngine, HEADLESS_PACE};
use super::profile::{Profile, Row};
use super::{Accuracy, Engine, EngineError, Precision, Recipe, selfcheck};

/// What the user asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wish {
    /// Which kind of engine.
    pub kind: Kind,
    /// Part of the adapter's name.
    pub adapter: Option<String>,
    /// Threads of the CPU engine.
    pub threads: Option<usize>,
    /// What is to be computed with it.
    pub demand: Demand,
    /// How long a slice may run on an adapter.
    pub pace: Duration,
}

impl Default for Wish {
    fn default() -> Self {
        let demand = Demand::Level(Accuracy::default());
        Wish { kind: Kind::Auto, adapter: None, threads: None, demand, pace: HEADLESS_PACE }
    }
}

/// How right the answers must be, or by what recipe they must come.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Demand {
    /// Whatever keeps the level's promise.
    Level(Accuracy),
    /// Exactly this.
    Recipe(Recipe),
}

impl Default for Demand {
    fn default() -> Self {
        Demand::Level(Accuracy::default())
    }
}

impl Demand {
    /// The recipes that meet it, the preferred one first.
    fn recipes(self) -> Vec<Recipe> {
        match self {
            Demand::Level(accuracy) => accuracy.recipes(),
            Demand::Recipe(recipe) => vec![recipe],
        }
    }
}

/// `--engine`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// The fastest of the measured profile.
    #[default]
    Auto,
    /// An adapter or nothing.
    Gpu,
    /// The processor.
    Cpu,
}

/// No engine fits the wish.
#[derive(Debug, thiserror::Error)]
pub enum ChoiceError {
    /// No adapter, or none that is sound, and the processor was not allowed.
    #[error("{0}")]
    NoAdapter(String),
    /// The adapter asked for is not there.
    #[error("--adapter '{wanted}' matches none of: {found}")]
    UnknownAdapter {
        /// What was asked for.
        wanted: String,
        /// What there is.
        found: String,
    },
    /// An engine could not be started.
    #[error(transparent)]
    Engine(#[from] EngineError),
}

/// The engine, the recipe, and one sentence on why.
pub struct Chosen {
    /// Ready to run.
    pub engine: Box<dyn Engine>,
    /// What to run on it.
    pub recipe: Recipe,
    /// For people.
    pub why: String,
    /// How far it follows the middle of a deep view.
    pub following: Following,
}

/// What to do on Debian when there is no adapter.
pub const INSTALL_HINT: &str = "no Vulkan adapter was found; on Debian or Ubuntu install one with: \
     apt-get install libvulkan1 mesa-vulkan-drivers";

/// Chooses and starts an engine; `tell` hears of anything that takes long.
pub fn choose(wish: &Wish, tell: &dyn Fn(&str)) -> Result<Chosen, ChoiceError> {
    let chosen = match (wish.kind, &wish.adapter) {
        (Kind::Cpu, _) => cpu(wish, "asked for".to_string())?,
        (Kind::Gpu, _) | (Kind::Auto, Some(_)) => first_sound(wish)?
            .map_err(|why| ChoiceError::NoAdapter(format!("{why}; or use --engine cpu")))?,
        (Kind::Auto, None) => automatic(wish, tell)?,
    };
    let engine = DepthEngine::new(chosen.engine, wish.threads)?.telling(chosen.following.clone());
    Ok(Chosen { engine: Box::new(engine), ..chosen })
}

/// The fastest engine of the profile. Adapters are not even opened where only the processor has
/// the method.
fn automatic(wish: &Wish, tell: &dyn Fn(&str)) -> Result<Chosen, ChoiceError> {
    let recipes = wish.demand.recipes();
    let on_cpu = recipes.iter().any(CpuEngine::offers);
    if on_cpu && !recipes.iter().any(GpuEngine::has) {
        return cpu(wish, "only the processor has this method and precision".to_string());
    }
    let profile = Profile::get(wish.threads, tell);
    let Some(row) = fastest(&profile, wish.demand) else {
        return first_sound(wish)?.or_else(|why| cpu(wish, why));
    };
    let why =
        format!("{:.1} µs a pixel on this machine, the fastest of its profile", row.us_per_pixel);
    if row.engine == "cpu" {
        return cpu(wish, why);
    }
    let demand = match wish.demand {
        Demand::Level(_) => row.recipe().map_or(wish.demand, Demand::Recipe),
        recipe => recipe,
    };
    let wish = Wish { adapter: Some(row.adapter.clone()), demand, ..wish.clone() };
    match first_sound(&wish)? {
        Ok(chosen) => Ok(Chosen { why, ..chosen }),
        Err(why) => cpu(&wish, why),
    }
}

/// The fastest row that can do what is demanded: of the level's own, or of the level whose
/// recipes are most like the one demanded.
fn fastest(profile: &Profile, demand: Demand) -> Option<&Row> {
    match demand {
        Demand::Level(accuracy) => profile.fastest(accuracy, |_| true),
        Demand::Recipe(recipe) => {
            let offers = |row: &Row| row.engine == "gpu" || CpuEngine::offers(&recipe);
            let like = Accuracy::ALL.iter().map(|(_, accuracy)| *accuracy).find(|accuracy| {
                accuracy.recipes().iter().any(|other| {
                    other.precision == recipe.precision
                        && other.method.name() == recipe.method.name()
                })
            });
            let like = like.unwrap_or(match recipe.precision {
                Precision::F32 => Accuracy::Fast,
                _ => Accuracy::Balanced,
            });
            profile.fastest(like, offers)
        }
    }
}

fn cpu(wish: &Wish, why: String) -> Result<Chosen, ChoiceError> {
    let recipes = wish.demand.recipes();
    let recipe = recipes.iter().find(|recipe| CpuEngine::offers(recipe)).unwrap_or(&recipes[0]);
    CpuEngine::require(recipe)?;
    let engine = Box::new(CpuEngine::new(wish.threads)?);
    Ok(Chosen { engine, recipe: *recipe, why, following: Following::default() })
}

/// The first adapter that matches and is trusted with what is demanded; otherwise what was wrong.
fn first_sound(wish: &Wish) -> Result<Result<Chosen, String>, ChoiceError> {
    let name = wish.adapter.as_deref();
    let all = adapters();
    if all.is_empty() {
        return Ok(Err(INSTALL_HINT.to_string()));
    }
    let fits = |adapter: &wgpu::Adapter| {
        let described = describe(adapter).to_lowercase();
        name.is_none_or(|name| described.contains(&name.to_lowercase()))
    };
    let (fitting, others): (Vec<_>, Vec<_>) = all.into_iter().partition(fits);
    if let (Some(wanted), true) = (name, fitting.is_empty()) {
        let found = others.iter().map(describe).collect::<Vec<_>>().join(", ");
        return Err(ChoiceError::UnknownAdapter { wanted: wanted.to_string(), found });
    }
    let profile = Profile::kept(wish.threads);
    let mut failures = Vec::new();
    for adapter in fitting {
        match sound(&adapter, recipes_on(&adapter, wish.demand, profile.as_ref())) {
            Ok((mut engine, recipe)) => {
                engine.set_pace(wish.pace);
                let why = format!("{} passed the self-check", engine.adapter());
                let (engine, following) = (Box::new(engine), Following::default());
                return Ok(Ok(Chosen { engine, recipe, why, following }));
            }
            Err(why) => failures.push(format!("{}: {why}", describe(&adapter))),
        }
    }
    Ok(Err(failures.join("; ")))
}

/// The recipes that meet a demand, the one that is fastest on the adapter first if that is known.
fn recipes_on(adapter: &wgpu::Adapter, demand: Demand, profile: Option<&Profile>) -> Vec<Recipe> {
    let mut recipes = demand.recipes();
    if let (Demand::Level(accuracy), Some(profile)) = (demand, profile) {
        let name = describe(adapter);
        let fastest = profile.fastest(accuracy, |row| row.adapter == name);
        if let Some(recipe) = fastest.and_then(Row::recipe) {
            recipes.retain(|other| *other != recipe);
            recipes.insert(0, recipe);
        }
    }
    recipes
}

/// An engine on the adapter and the first recipe it is trusted with.
fn sound(adapter: &wgpu::Adapter, recipes: Vec<Recipe>) -> Result<(GpuEngine, Recipe), String> {
    let mut engine = open_checked(adapter.clone()).map_err(|error| error.to_string())?;
    let mut refusals = Vec::new();
    for recipe in recipes {
        if recipe.precision == Precision::Df32 {
            // Its orbits are run only here: the kernel takes long to compile.
            let checks = selfcheck::orbits(&mut engine, &[Precision::Df32]);
            engine.judge_by(checks.map_err(|error| error.to_string())?);
        }
        match engine.require(&recipe) {
            Ok(()) => return Ok((engine, recipe)),
            Err(why) => refusals.push(why.to_string()),
        }
    }
    Err(refusals.join("; "))
}

/// An engine on an opened adapter, its arithmetic judged by sums and, in f32 and f64, by short
/// orbits.
pub fn open_checked(adapter: wgpu::Adapter) -> Result<GpuEngine, EngineError> {
    let gpu = Gpu::open(adapter)?;
    let verdict = selfcheck::run(&gpu)?;
    let mut engine = GpuEngine::new(gpu, verdict);
    let orbits = selfcheck::orbits(&mut engine, &[Precision::F32, Precision::F64])?;
    engine.judge_by(orbits);
    Ok(engine)
}
