//! Which engine runs: what was asked for, what there is, and why the one was chosen.

use super::cpu::CpuEngine;
use super::gpu::GpuEngine;
use super::gpu::device::{Gpu, adapters, describe};
use super::selfcheck;
use super::{Engine, EngineError, Precision};

/// What the user asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wish {
    /// Which kind of engine.
    pub kind: Kind,
    /// Part of the adapter's name.
    pub adapter: Option<String>,
    /// Threads of the CPU engine.
    pub threads: Option<usize>,
    /// What the adapter must be trusted with; without it, f32.
    pub precision: Option<Precision>,
}

/// `--engine`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// An adapter whose arithmetic is sound, else the processor.
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

/// The engine and one sentence on why it is this one.
pub struct Chosen {
    /// Ready to run.
    pub engine: Box<dyn Engine>,
    /// For people.
    pub why: String,
}

/// What to do on Debian when there is no adapter.
pub const INSTALL_HINT: &str = "no Vulkan adapter was found; on Debian or Ubuntu install one with: \
     apt-get install libvulkan1 mesa-vulkan-drivers";

/// Chooses and starts an engine.
pub fn choose(wish: &Wish) -> Result<Chosen, ChoiceError> {
    if wish.kind == Kind::Cpu {
        return cpu(wish, "asked for".to_string());
    }
    let failure = match first_sound(wish)? {
        Ok(engine) => {
            let why = format!("{} passed the self-check", engine.adapter());
            return Ok(Chosen { engine: Box::new(engine), why });
        }
        Err(failure) => failure,
    };
    if wish.kind == Kind::Gpu || wish.adapter.is_some() {
        return Err(ChoiceError::NoAdapter(format!("{failure}; or use --engine cpu")));
    }
    cpu(wish, failure)
}

fn cpu(wish: &Wish, why: String) -> Result<Chosen, ChoiceError> {
    let engine = CpuEngine::new(wish.threads)?;
    Ok(Chosen { engine: Box::new(engine), why })
}

/// The first adapter that matches and is trusted with the precision; otherwise what was wrong.
fn first_sound(wish: &Wish) -> Result<Result<GpuEngine, String>, ChoiceError> {
    let name = wish.adapter.as_deref();
    let precision = wish.precision.unwrap_or(Precision::F32);
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
    let mut failures = Vec::new();
    for adapter in fitting {
        match open_checked(adapter.clone()) {
            Ok(engine) => match engine.verdict().require(precision) {
                Ok(()) => return Ok(Ok(engine)),
                Err(why) => failures.push(format!("{}: {why}", describe(&adapter))),
            },
            Err(error) => failures.push(format!("{}: {error}", describe(&adapter))),
        }
    }
    Ok(Err(failures.join("; ")))
}

/// An engine on an opened adapter, its arithmetic judged by sums and by short orbits.
pub fn open_checked(adapter: wgpu::Adapter) -> Result<GpuEngine, EngineError> {
    let gpu = Gpu::open(adapter)?;
    let verdict = selfcheck::run(&gpu)?;
    let mut engine = GpuEngine::new(gpu, verdict);
    let orbits = selfcheck::orbits(&mut engine)?;
    engine.judge_by(orbits);
    Ok(engine)
}
