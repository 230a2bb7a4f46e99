//! What the engines here can do: each level's configs, timed and judged once on every engine,
//! and kept for the next time.
//!
//! A profile belongs to the adapters with their drivers, the threads and the version of the
//! program; when one of them changes it is measured anew.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use etcetera::BaseStrategy;
use serde::{Deserialize, Serialize};

use super::choice::open_checked;
use super::cpu::{CpuEngine, instruction_set};
use super::gpu::device::{adapters, describe, is_software};
use super::{
    Accuracy, Engine, IntegratorConfig, Job, JobResult, Keep, Precision, Question, Starts, Wait,
    selfcheck,
};
use crate::physics::{Dd, Outcome, Status, oracle};
use crate::scene::{Fate, Grid, Scene};

/// The engines of this machine, measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// What it was measured on.
    pub key: String,
    /// What was measured.
    pub rows: Vec<ProfileRow>,
    /// What an engine does not offer, and why.
    pub refused: Vec<String>,
}

/// One config on one engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileRow {
    /// The level whose config it is.
    pub accuracy: Accuracy,
    /// `gpu` or `cpu`.
    pub engine: String,
    /// The adapter as [`describe`] has it; of the processor nothing.
    pub adapter: String,
    /// The method's word.
    pub method: String,
    /// Its step or tolerance.
    pub setting: String,
    /// The number type's word.
    pub precision: String,
    /// Microseconds an integrated pixel of the home map.
    pub us_per_pixel: f64,
    /// Share of a few hundred pixels within 1 ms of the gold standard.
    pub right: f64,
}

/// Side of the picture whose open starts are timed, and how many of them a slow config gets.
const SIDE: u32 = 160;
const FEW: usize = 512;
/// Every so many starts are compared with the gold standard.
const JUDGED_SHARE: usize = 41;
/// A config slower than this is not timed any longer.
const SLOW_US: f64 = 50.0;

impl Profile {
    /// The kept profile of this machine, or one measured now; `tell` hears that it takes a while.
    pub fn get(threads: Option<usize>, tell: &dyn Fn(&str)) -> Profile {
        if let Some(kept) = Profile::kept(threads) {
            return kept;
        }
        tell("measuring the engines of this machine once; this takes some seconds");
        let profile = Profile::measure(threads);
        // A cache that cannot be written costs the next run the same seconds and nothing else.
        if let Err(error) = profile.keep() {
            tell(&format!("the measured profile could not be kept: {error}"));
        }
        profile
    }

    /// The profile that an earlier run kept, if it is of this machine as it is now.
    pub fn kept(threads: Option<usize>) -> Option<Profile> {
        let kept = path().as_deref().and_then(read)?;
        (kept.key == key(threads)).then_some(kept)
    }

    /// Keeps it for the next run.
    pub fn keep(&self) -> std::io::Result<()> {
        path().map_or(Ok(()), |path| write(&path, self))
    }

    /// Measures every engine here.
    pub fn measure(threads: Option<usize>) -> Profile {
        let mut profile = Profile { key: key(threads), rows: Vec::new(), refused: Vec::new() };
        let sample = Sample::new();
        match CpuEngine::new(threads) {
            Ok(mut engine) => profile.add(&mut engine, "", false, &sample),
            Err(error) => profile.refused.push(format!("cpu: {error}")),
        }
        for adapter in adapters() {
            let (name, hardware) = (describe(&adapter), !is_software(&adapter));
            match open_checked(adapter) {
                Ok(mut engine) => {
                    // Pairs of f32 are far behind f64 in software, and slow to compile there.
                    let pairs = hardware || engine.verdict().require(Precision::F64).is_err();
                    if pairs && let Ok(checks) = selfcheck::orbits(&mut engine, &[Precision::Df32])
                    {
                        engine.judge_by(checks);
                    }
                    profile.add(&mut engine, &name, pairs, &sample);
                }
                Err(error) => profile.refused.push(format!("{name}: {error}")),
            }
        }
        profile
    }

    fn add(&mut self, engine: &mut dyn Engine, adapter: &str, pairs: bool, sample: &Sample) {
        for accuracy in [Accuracy::Lesson, Accuracy::Fast, Accuracy::Balanced] {
            for config in accuracy.configs() {
                if config.precision == Precision::Df32 && !pairs {
                    continue;
                }
                match sample.time(engine, config) {
                    Ok((us_per_pixel, right)) => self.rows.push(ProfileRow {
                        accuracy,
                        engine: engine.name().to_string(),
                        adapter: adapter.to_string(),
                        method: config.method.name().to_string(),
                        setting: config.method.setting(),
                        precision: config.precision.to_string(),
                        us_per_pixel,
                        right,
                    }),
                    Err(error) => {
                        self.refused.push(format!("{} {adapter}: {error}", engine.name()))
                    }
                }
            }
        }
    }

    /// The fastest row for a level (an exact picture is first a balanced one) among those that
    /// `allows` lets pass.
    pub fn fastest(
        &self,
        accuracy: Accuracy,
        allows: impl Fn(&ProfileRow) -> bool,
    ) -> Option<&ProfileRow> {
        let measured = if accuracy == Accuracy::Exact { Accuracy::Balanced } else { accuracy };
        self.rows
            .iter()
            .filter(|row| row.accuracy == measured && allows(row))
            .min_by(|a, b| a.us_per_pixel.total_cmp(&b.us_per_pixel))
    }
}

impl ProfileRow {
    /// The config of its level that this row timed.
    pub fn config(&self) -> Option<IntegratorConfig> {
        let is = |config: &IntegratorConfig| {
            config.precision.to_string() == self.precision
                && config.method.name() == self.method
                && config.method.setting() == self.setting
        };
        self.accuracy.configs().into_iter().find(is)
    }
}

/// What profiles are measured with.
struct Sample {
    question: Question,
    starts: Vec<[Dd; 2]>,
    truth: Vec<Outcome>,
}

impl Sample {
    fn new() -> Self {
        let scene = Scene::default();
        let (grid, question) = (Grid::new(&scene, [SIDE, SIDE]), Question::from(&scene));
        let starts: Vec<[Dd; 2]> = (0..SIDE * SIDE)
            .filter_map(|k| match grid.fate(k % SIDE, k / SIDE) {
                Fate::Open(angle) => Some(angle),
                _ => None,
            })
            .collect();
        let pendulum = scene.build.pendulum();
        let one = |angle: &[Dd; 2]| {
            let angle = angle.map(|theta| theta.hi);
            oracle::outcome(&pendulum, angle, question.rule, question.budget_secs)
        };
        let truth = starts.iter().step_by(JUDGED_SHARE).map(one).collect();
        Sample { question, starts, truth }
    }

    /// Microseconds a pixel and the share that is right.
    fn time(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
    ) -> Result<(f64, f64), super::EngineError> {
        // The judged starts are the warm-up: kernels are compiled for them.
        let judged: Vec<[Dd; 2]> = self.starts.iter().step_by(JUDGED_SHARE).copied().collect();
        let answers = self.run(engine, config, &judged)?.outcomes;
        let close = |(answer, truth): &(&Outcome, &Outcome)| {
            answer.status == truth.status
                && (answer.status != Status::Flipped || (answer.time - truth.time).abs() <= 1e-3)
        };
        let right = answers.iter().zip(&self.truth).filter(close).count();
        let mut timed = |starts: &[[Dd; 2]]| {
            let begun = Instant::now();
            self.run(engine, config, starts)?;
            Ok(begun.elapsed().as_secs_f64() * 1e6 / starts.len() as f64)
        };
        let mut us_per_pixel = timed(&judged[..judged.len().min(FEW)])?;
        if us_per_pixel < SLOW_US {
            us_per_pixel = timed(&self.starts)?;
        }
        Ok((us_per_pixel, right as f64 / self.truth.len() as f64))
    }

    fn run(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        starts: &[[Dd; 2]],
    ) -> Result<JobResult, super::EngineError> {
        let starts = Starts::Rest(starts.to_vec());
        let question = self.question;
        engine.submit(Job { id: 0, question, config, starts, keep: Keep::Nothing })?;
        let mut finished = engine.poll(Wait::UntilFinished)?;
        finished
            .pop()
            .ok_or_else(|| super::EngineError::Unsupported("the engine gave no answer".to_string()))
    }
}

/// What a profile is measured on, as one line.
fn key(threads: Option<usize>) -> String {
    let adapters: Vec<String> = adapters().iter().map(describe).collect();
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let version = env!("CARGO_PKG_VERSION");
    let build = if cfg!(debug_assertions) { "debug" } else { "release" };
    format!(
        "flipmap {version}, {build}; {} threads, {}; {}",
        threads.unwrap_or(cores),
        instruction_set(),
        adapters.join("; ")
    )
}

/// Where the profile is kept.
fn path() -> Option<PathBuf> {
    let folders = etcetera::choose_base_strategy().ok()?;
    Some(folders.cache_dir().join("flipmap").join("profile.json"))
}

fn read(path: &Path) -> Option<Profile> {
    serde_json::from_slice(&std::fs::read(path).ok()?).ok()
}

/// Written beside and moved into place, so that two runs at once leave a whole one.
fn write(path: &Path, profile: &Profile) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(&serde_json::to_vec_pretty(profile)?)?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(accuracy: Accuracy, engine: &str, us_per_pixel: f64) -> ProfileRow {
        let config = accuracy.configs()[0];
        ProfileRow {
            accuracy,
            engine: engine.to_string(),
            adapter: String::new(),
            method: config.method.name().to_string(),
            setting: config.method.setting(),
            precision: config.precision.to_string(),
            us_per_pixel,
            right: 1.0,
        }
    }

    #[test]
    fn the_fastest_allowed_row_of_the_level_is_found() {
        let rows = vec![
            row(Accuracy::Lesson, "gpu", 1.0),
            row(Accuracy::Balanced, "gpu", 5.0),
            row(Accuracy::Balanced, "cpu", 4.0),
        ];
        let profile = Profile { key: String::new(), rows, refused: Vec::new() };
        let fastest =
            |level, kind: &str| profile.fastest(level, |row| kind == "auto" || row.engine == kind);
        assert_eq!(fastest(Accuracy::Balanced, "auto").unwrap().engine, "cpu");
        assert_eq!(fastest(Accuracy::Exact, "gpu").unwrap().us_per_pixel, 5.0);
        assert_eq!(fastest(Accuracy::Fast, "auto"), None);
        for row in &profile.rows {
            assert!(row.accuracy.configs().contains(&row.config().unwrap()));
        }
    }

    #[test]
    fn a_profile_is_kept_and_a_broken_one_is_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flipmap").join("profile.json");
        let rows = vec![row(Accuracy::Fast, "cpu", 2.5)];
        let profile = Profile { key: "here".to_string(), rows, refused: Vec::new() };
        write(&path, &profile).unwrap();
        assert_eq!(read(&path), Some(profile));
        std::fs::write(&path, "{").unwrap();
        assert_eq!(read(&path), None);
    }
}
