//! Profiles of this machine's engines: the configurations of each level, timed and judged once on
//! every engine, and cached for the next run.
//!
//! A profile is valid for one set of adapters with their drivers, number of threads and version of
//! the program; when one of them changes, it is measured again.

use std::io::Write;
use std::path::{Path, PathBuf};

use etcetera::BaseStrategy;
use serde::{Deserialize, Serialize};

use super::adapters::{Adapter, GpuTuning};
use super::cpu::{CpuEngine, instruction_set};
use super::level::{BALANCED, BALANCED_DF32, FAST, FAST_TO_COMPILE, LESSON};
use super::plain_file::read_plain;
use super::{
    Accuracy, Engine, EngineError, EngineKind, EventSpec, IntegratorConfig, Job, JobResult, Keep,
    Starts, Wait,
};
use crate::clock::Instant;
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Status, oracle};
use flipmap_scene::{Fate, Grid, Scene};

/// A measurement of this machine's engines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// The machine and the program that it was measured on, as one line.
    pub key: String,
    /// One row per configuration and engine measured.
    pub rows: Vec<ProfileRow>,
    /// Configurations and engines that are not offered, each with the reason.
    pub refused: Vec<String>,
}

/// The measurement of one configuration on one engine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProfileRow {
    /// The accuracy level that the configuration belongs to.
    pub accuracy: Accuracy,
    /// The kind of engine.
    pub engine: EngineKind,
    /// The adapter as [`Adapter::name`] gives it; empty for the processor.
    pub adapter: String,
    /// Name of the method.
    pub method: String,
    /// The method's step or tolerance, as text.
    pub setting: String,
    /// Name of the number type.
    pub precision: String,
    /// Microseconds per integrated pixel of the home map.
    pub us_per_pixel: f64,
    /// Share of a few hundred pixels that are within 1 ms of the gold standard.
    pub right: f64,
    /// True for an adapter that is computed on the processor's own cores.
    #[serde(default)]
    pub software: bool,
}

/// Side in pixels of the smallest picture whose open starts are timed.
const SIDE: u32 = 160;
/// Side in pixels of the largest timed picture, with as many starts as a job on a graphics card.
const MAX_SIDE: u32 = 8 * SIDE;
/// Seconds after which a run has filled a graphics card long enough to show its throughput.
const LONG_SECS: f64 = 0.3;
/// Number of starts that a slow configuration is timed on.
const FEW: usize = 512;
/// One start in this many is compared with the gold standard.
const JUDGED_EVERY: usize = 41;
/// Amount by which the share of right answers among the judged starts may fall below that of the
/// whole map: two standard deviations at a share of 0.9.
const SAMPLING_ERROR: f64 = 0.03;
/// Microseconds per pixel above which a configuration is timed on a few starts only.
const SLOW_US: f64 = 50.0;

impl Profile {
    /// Returns the cached profile of this machine, or measures one; `tell` receives a message that
    /// this takes a while.
    pub fn get(threads: Option<usize>, tell: &dyn Fn(&str)) -> Profile {
        if let Some(kept) = Profile::kept(threads) {
            return kept;
        }
        if let Some(why) = path().as_deref().and_then(damage) {
            tell(&why);
        }
        tell("measuring the engines of this machine once; this takes some seconds");
        let profile = Profile::measure(threads, TimedPairs::WhereNeeded);
        // If the cache cannot be written, the next run only has to measure again.
        if let Err(error) = profile.keep() {
            tell(&format!("the measured profile could not be kept: {error}"));
        }
        profile
    }

    /// Returns the profile that an earlier run cached, if it fits this machine in its present
    /// state.
    pub fn kept(threads: Option<usize>) -> Option<Profile> {
        let (kept, key) = (path().as_deref().and_then(read)?, key(threads));
        kept.into_iter().find(|profile| profile.key == key)
    }

    /// Caches the profile for the next run.
    pub fn keep(&self) -> std::io::Result<()> {
        path().map_or(Ok(()), |path| write(&path, self))
    }

    /// Measures every engine of this machine, each adapter once, even if several back-ends expose
    /// it.
    pub fn measure(threads: Option<usize>, pairs: TimedPairs) -> Profile {
        let mut profile = Profile { key: key(threads), rows: Vec::new(), refused: Vec::new() };
        let sample = Sample::new(SIDE);
        match CpuEngine::new(threads) {
            Ok(mut engine) => profile.add(&mut engine, ("", false), &CPU_CONFIGS, &sample, SIDE),
            Err(error) => profile.refused.push(format!("cpu: {error}")),
        }
        let mut measured: Vec<Adapter> = Vec::new();
        for adapter in Adapter::all() {
            if measured.iter().any(|other| other.is_one_device_with(&adapter)) {
                continue;
            }
            let (name, hardware) = (adapter.name(), !adapter.is_software());
            match adapter.open(GpuTuning::default(), &FAST_TO_COMPILE) {
                Ok(mut engine) => {
                    let configs = pairs.configs(hardware, engine.offers(&BALANCED));
                    let largest = if hardware { MAX_SIDE } else { SIDE };
                    profile.add(engine.as_mut(), (&name, !hardware), configs, &sample, largest);
                    measured.push(adapter);
                }
                Err(error) => profile.refused.push(format!("{name}: {error}")),
            }
        }
        profile
    }

    fn add(
        &mut self,
        engine: &mut dyn Engine,
        (adapter, software): (&str, bool),
        configs: &[(Accuracy, IntegratorConfig)],
        sample: &Sample,
        largest: u32,
    ) {
        for &(accuracy, config) in configs {
            match sample.time(engine, config, largest) {
                Ok((us_per_pixel, right)) => self.rows.push(ProfileRow {
                    accuracy,
                    engine: engine.kind(),
                    adapter: adapter.to_string(),
                    method: config.method.name().to_string(),
                    setting: config.method.setting(),
                    precision: config.precision.to_string(),
                    us_per_pixel,
                    right,
                    software,
                }),
                Err(error) => self.refused.push(format!("{} {adapter}: {error}", engine.kind())),
            }
        }
    }

    /// Returns the fastest row for a level among those that `allows` accepts and whose answers are
    /// as right as the level promises. An exact picture begins as a balanced one, so the rows of
    /// [`Accuracy::Balanced`] count for it. An adapter in software shares its cores with the
    /// processor's own engine, which comes before it whatever the noise of the measurement.
    pub fn fastest(
        &self,
        accuracy: Accuracy,
        allows: impl Fn(&ProfileRow) -> bool,
    ) -> Option<&ProfileRow> {
        let measured = if accuracy == Accuracy::Exact { Accuracy::Balanced } else { accuracy };
        let fits =
            |row: &&ProfileRow| row.accuracy == measured && row.keeps_promise() && allows(row);
        let has_cpu = self.rows.iter().any(|row| fits(&row) && row.engine == EngineKind::Cpu);
        self.rows
            .iter()
            .filter(|row| fits(row) && !(has_cpu && row.software))
            .min_by(|a, b| a.us_per_pixel.total_cmp(&b.us_per_pixel))
    }
}

/// Adapters on which pairs of f32, whose kernels take long to compile, are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimedPairs {
    /// Adapters that are not trusted with f64.
    WhereNeeded,
    /// All adapters but those in software, where pairs are far slower than f64.
    OnHardware,
}

/// The levels' configurations that the processor has, and that a graphics adapter compiles fast.
const CPU_CONFIGS: [(Accuracy, IntegratorConfig); 3] =
    [(Accuracy::Lesson, LESSON), (Accuracy::Fast, FAST), (Accuracy::Balanced, BALANCED)];
/// The [`CPU_CONFIGS`], and `balanced` in pairs of f32.
const ALL_CONFIGS: [(Accuracy, IntegratorConfig); 4] = {
    let [lesson, fast, balanced] = CPU_CONFIGS;
    [lesson, fast, balanced, (Accuracy::Balanced, BALANCED_DF32)]
};

impl TimedPairs {
    /// The configurations that are measured on a graphics adapter.
    fn configs(self, is_hardware: bool, has_f64: bool) -> &'static [(Accuracy, IntegratorConfig)] {
        let wanted = !has_f64 || is_hardware && self == TimedPairs::OnHardware;
        if wanted { &ALL_CONFIGS } else { &CPU_CONFIGS }
    }
}

impl ProfileRow {
    /// Returns true if the share of right answers is what the level promises, within the sampling
    /// error.
    fn keeps_promise(&self) -> bool {
        self.right >= self.accuracy.promised_share() - SAMPLING_ERROR
    }

    /// Returns the configuration of its level that this row measured.
    pub fn config(&self) -> Option<IntegratorConfig> {
        let is = |config: &IntegratorConfig| {
            config.precision.to_string() == self.precision
                && config.method.name() == self.method
                && config.method.setting() == self.setting
        };
        self.accuracy.configs().into_iter().find(is)
    }
}

/// The starts that profiles are measured on, and the true outcomes of some of them.
struct Sample {
    question: EventSpec,
    starts: Vec<[Dd; 2]>,
    truth: Vec<Outcome>,
}

impl Sample {
    fn new(side: u32) -> Self {
        let scene = Scene::default();
        let question = EventSpec::from(&scene);
        let starts = open_starts(side);
        let pendulum = scene.build.pendulum();
        let one = |angle: &[Dd; 2]| {
            let angle = angle.map(|theta| theta.hi);
            oracle::outcome(&pendulum, angle, question.rule, question.budget_secs)
        };
        let truth = starts.iter().step_by(JUDGED_EVERY).map(one).collect();
        Sample { question, starts, truth }
    }

    /// Measures microseconds per pixel and the share of answers that are right. Doubles the side of
    /// the picture, at most to `largest`, until one takes long enough to show the throughput of a
    /// whole picture.
    fn time(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        largest: u32,
    ) -> Result<(f64, f64), EngineError> {
        // The judged starts serve as the warm-up: kernels are compiled for them.
        let judged: Vec<[Dd; 2]> = self.starts.iter().step_by(JUDGED_EVERY).copied().collect();
        let answers = self.run(engine, config, &judged)?.outcomes;
        let close = |(answer, truth): &(&Outcome, &Outcome)| {
            answer.status == truth.status
                && (answer.status != Status::Answered || (answer.time - truth.time).abs() <= 1e-3)
        };
        let right = answers.iter().zip(&self.truth).filter(close).count();
        let right = right as f64 / self.truth.len() as f64;
        let mut timed = |starts: &[[Dd; 2]]| -> Result<f64, EngineError> {
            let begun = Instant::now();
            self.run(engine, config, starts)?;
            Ok(begun.elapsed().as_secs_f64())
        };
        let us = |secs: f64, starts: &[[Dd; 2]]| secs * 1e6 / starts.len() as f64;
        let few = &judged[..judged.len().min(FEW)];
        let of_few = us(timed(few)?, few);
        // A card takes hardly longer for many starts than for few.
        if of_few >= SLOW_US && largest == SIDE {
            return Ok((of_few, right));
        }
        let mut secs = timed(&self.starts)?;
        let mut us_per_pixel = us(secs, &self.starts);
        let mut side = 2 * SIDE;
        while side <= largest && secs < LONG_SECS {
            let starts = open_starts(side);
            secs = timed(&starts)?;
            us_per_pixel = us(secs, &starts);
            side *= 2;
        }
        Ok((us_per_pixel, right))
    }

    fn run(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        starts: &[[Dd; 2]],
    ) -> Result<JobResult, EngineError> {
        let starts = Starts::Rest(starts.to_vec());
        let question = self.question;
        engine.submit(Job { id: 0, question, config, starts, keep: Keep::NOTHING })?;
        let mut finished = engine.poll(Wait::UntilFinished)?;
        finished
            .pop()
            .ok_or_else(|| EngineError::Unsupported("the engine gave no answer".to_string()))
    }
}

/// The open starts of the home map in `side` × `side` pixels.
fn open_starts(side: u32) -> Vec<[Dd; 2]> {
    let grid = Grid::new(&Scene::default(), [side, side]);
    let open = |k: u32| match grid.fate(k % side, k / side) {
        Fate::Open(angle) => Some(angle),
        _ => None,
    };
    (0..side * side).filter_map(open).collect()
}

/// Identifies the machine and the program that a profile is measured on, as one line.
fn key(threads: Option<usize>) -> String {
    let adapters: Vec<String> = Adapter::all().iter().map(Adapter::name).collect();
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

/// Path of the cached profile.
fn path() -> Option<PathBuf> {
    let folders = etcetera::choose_base_strategy().ok()?;
    Some(folders.cache_dir().join("flipmap").join("profile.json"))
}

/// Largest size of the file of profiles in bytes, enough for many adapters.
const MAX_BYTES: u64 = 1 << 22;
/// Largest number of profiles that are kept: machines that share a home folder have one each.
const MAX_KEPT: usize = 64;

/// The profiles in a file, the newest first; earlier versions kept a single one.
#[derive(Deserialize)]
#[serde(untagged)]
enum KeptProfiles {
    All(Vec<Profile>),
    One(Box<Profile>),
}

fn parsed(bytes: &[u8]) -> serde_json::Result<Vec<Profile>> {
    Ok(match serde_json::from_slice(bytes)? {
        KeptProfiles::All(all) => all,
        KeptProfiles::One(one) => vec![*one],
    })
}

fn read(path: &Path) -> Option<Vec<Profile>> {
    parsed(&read_plain(path, MAX_BYTES).ok()?).ok()
}

/// Returns a sentence that says why a profile's file cannot be used, if the file exists and is
/// damaged.
fn damage(path: &Path) -> Option<String> {
    let why = match read_plain(path, MAX_BYTES) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return None,
        Err(error) => error.to_string(),
        Ok(bytes) => parsed(&bytes).err()?.to_string(),
    };
    Some(format!("the measured profile {} is ignored: {why}", path.display()))
}

/// Puts a profile first among those in a file, in place of an earlier one of the same machine.
/// Writes a temporary file and moves it into place, so that two runs at once leave complete
/// profiles.
fn write(path: &Path, profile: &Profile) -> std::io::Result<()> {
    let folder = path.parent().unwrap_or(Path::new("."));
    std::fs::create_dir_all(folder)?;
    let mut all = read(path).unwrap_or_default();
    all.retain(|other| other.key != profile.key);
    all.insert(0, profile.clone());
    all.truncate(MAX_KEPT);
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(&serde_json::to_vec_pretty(&all)?)?;
    file.persist(path)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Precision;

    fn row(accuracy: Accuracy, engine: EngineKind, us_per_pixel: f64) -> ProfileRow {
        let config = accuracy.configs()[0];
        ProfileRow {
            accuracy,
            engine,
            adapter: String::new(),
            method: config.method.name().to_string(),
            setting: config.method.setting(),
            precision: config.precision.to_string(),
            us_per_pixel,
            right: 1.0,
            software: false,
        }
    }

    #[test]
    fn an_adapter_in_software_never_beats_the_same_cores() {
        let mut software = row(Accuracy::Balanced, EngineKind::Gpu, 3.9);
        software.software = true;
        let rows = vec![software, row(Accuracy::Balanced, EngineKind::Cpu, 4.0)];
        let profile = Profile { key: String::new(), rows, refused: Vec::new() };
        let fastest = |gpu: bool| {
            let allows = |row: &ProfileRow| !gpu || row.engine == EngineKind::Gpu;
            profile.fastest(Accuracy::Balanced, allows).unwrap().engine
        };
        assert_eq!(fastest(false), EngineKind::Cpu);
        assert_eq!(fastest(true), EngineKind::Gpu, "where the processor was not allowed");
    }

    #[test]
    fn the_fastest_allowed_row_of_the_level_is_found() {
        let rows = vec![
            row(Accuracy::Lesson, EngineKind::Gpu, 1.0),
            row(Accuracy::Balanced, EngineKind::Gpu, 5.0),
            row(Accuracy::Balanced, EngineKind::Cpu, 4.0),
        ];
        let profile = Profile { key: String::new(), rows, refused: Vec::new() };
        let fastest = |level, kind: Option<EngineKind>| {
            profile.fastest(level, |row| kind.is_none_or(|kind| row.engine == kind))
        };
        assert_eq!(fastest(Accuracy::Balanced, None).unwrap().engine, EngineKind::Cpu);
        let on_gpu = fastest(Accuracy::Exact, Some(EngineKind::Gpu)).unwrap();
        assert_eq!(on_gpu.us_per_pixel, 5.0);
        assert_eq!(fastest(Accuracy::Fast, None), None);
        let mut hasty = profile.clone();
        hasty.rows[2].right = 0.96;
        let fastest = hasty.fastest(Accuracy::Balanced, |_| true).unwrap();
        assert_eq!(fastest.engine, EngineKind::Gpu, "less right than promised");
        for row in &profile.rows {
            assert!(row.accuracy.configs().contains(&row.config().unwrap()));
        }
    }

    #[test]
    fn an_engine_is_timed_on_pictures_that_fill_it() {
        use crate::mock::MockEngine;
        let sample = Sample::new(SIDE);
        let starts_timed = |largest| {
            let mut engine = MockEngine::default();
            sample.time(&mut engine, LESSON, largest).unwrap();
            engine.answered
        };
        let few = starts_timed(SIDE);
        // The mock engine answers at once, so that even the largest picture is soon done.
        assert!(starts_timed(MAX_SIDE) > 60 * few, "{few}");
    }

    #[test]
    fn kernels_that_take_long_to_compile_are_measured_where_they_are_needed() {
        let has_pairs = |pairs: TimedPairs, is_hardware, has_f64| {
            let configs = pairs.configs(is_hardware, has_f64);
            configs.iter().any(|(_, config)| config.precision == Precision::Df32)
        };
        assert!(!has_pairs(TimedPairs::WhereNeeded, true, true));
        assert!(has_pairs(TimedPairs::WhereNeeded, true, false));
        assert!(has_pairs(TimedPairs::OnHardware, true, true));
        assert!(!has_pairs(TimedPairs::OnHardware, false, true));
        for (accuracy, config) in ALL_CONFIGS {
            assert!(accuracy.configs().contains(&config));
        }
    }

    #[test]
    fn a_profile_is_kept_and_a_broken_one_is_not_believed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flipmap").join("profile.json");
        let rows = vec![row(Accuracy::Fast, EngineKind::Cpu, 2.5)];
        let profile = Profile { key: "here".to_string(), rows, refused: Vec::new() };
        write(&path, &profile).unwrap();
        assert_eq!(read(&path), Some(vec![profile.clone()]));
        // Another machine that shares the folder keeps its own, and a newer one replaces its own.
        let other = Profile { key: "there".to_string(), ..profile.clone() };
        let newer = Profile { refused: vec!["x".to_string()], ..profile.clone() };
        write(&path, &other).unwrap();
        write(&path, &newer).unwrap();
        assert_eq!(read(&path), Some(vec![newer, other]));
        std::fs::write(&path, serde_json::to_vec(&profile).unwrap()).unwrap();
        assert_eq!(read(&path), Some(vec![profile]), "of an earlier version");
        std::fs::write(&path, "{").unwrap();
        assert_eq!(read(&path), None);
        assert!(damage(&path).unwrap().contains("is ignored"));
        assert_eq!(damage(&folder.path().join("none")), None);
    }
}
