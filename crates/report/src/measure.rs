//! Measurement of one row: an engine with a config, its speed and its errors.

use super::backend::Backend;
use super::plan::Thoroughness;
use super::statistics::{Errors, OutcomePair, bands, median};
use super::stopwatch::{self, TimedRun};
use super::test_set::{TestSet, spread};
use super::{ReportError, Row, Specialising, StopTest, baseline};
use flipmap_engine::{Engine, EngineError, IntegratorConfig, Method, Precision};
use flipmap_numbers::Dd;
use flipmap_pendulum::Outcome;

/// Starts of the first run, which compiles kernels, and of the second, which is timed roughly.
const FIRST_STARTS: usize = 64;
/// Least number of starts that makes a measurement.
const MIN_STARTS: usize = 256;
/// Least number of starts for a fast config: the last, longest pendulums must not take most of the
/// time. Graphics cards, including software ones, need full jobs to show their speed.
const MIN_FAST_STARTS: usize = 1 << 14;
/// Least number of starts for a fast config on an adapter; see [`MIN_FAST_STARTS`].
const MIN_GPU_STARTS: usize = 1 << 16;
/// Least number of starts for a fast config with checks; see [`least_starts_of_exact`].
const MIN_EXACT_STARTS: usize = 1 << 17;

/// The context of a measurement besides an engine and a config.
pub(super) struct Bench<'a> {
    /// The starts, and the truth about some of them.
    pub test_set: &'a TestSet,
    /// The thoroughness of the report.
    pub care: &'a Thoroughness,
    /// Threads of the processor where it checks or judges; `None` for one per core.
    pub threads: Option<usize>,
    /// Test that returns true to abandon the measurement.
    pub stop: StopTest<'a>,
}

/// Repeated times of a run, and of the scalar loop on some of the same starts between the runs.
struct Times {
    us: Vec<f64>,
    scalar_us: Vec<f64>,
}

/// Answers with the truth about them.
pub(super) struct Compared {
    /// The starts that were asked about.
    pub starts: Vec<[Dd; 2]>,
    /// The gold standard's answers.
    pub truth: Vec<Outcome>,
    /// The engine's answers.
    pub ran: TimedRun,
}

impl Compared {
    /// Pairs each answer with its truth.
    pub(super) fn pairs(&self) -> Vec<OutcomePair> {
        self.ran.outcomes.iter().copied().zip(self.truth.iter().copied()).collect()
    }
}

impl Bench<'_> {
    /// Measures a row.
    pub(super) fn row(
        &self,
        backend: &mut Backend,
        config: IntegratorConfig,
    ) -> Result<Row, ReportError> {
        let mut row = Row::new(backend, config);
        let least = least_starts(&config, backend.threads().is_none());
        self.fill(&mut row, backend.engine(), least)?;
        Ok(row)
    }

    /// Fills a new row with measurements of `engine`, timed on at least `least` starts; returns the
    /// answers that its errors come from.
    pub(super) fn fill(
        &self,
        row: &mut Row,
        engine: &mut dyn Engine,
        least: usize,
    ) -> Result<Compared, ReportError> {
        let config = row.config;
        let rough = self.rough_us(engine, config)?;
        let compared = self.compare(engine, config, rough)?;
        let starts = self.timed_starts(engine, config, compared.ran.us_per_pixel, least)?;
        let mut times = Times { us: Vec::new(), scalar_us: Vec::new() };
        let mut effort = compared.ran.effort;
        for _ in 0..self.care.rounds {
            times.scalar_us.push(self.scalar_us(&starts));
            let ran = self.run(engine, config, &starts)?;
            times.us.push(ran.us_per_pixel);
            effort = ran.effort;
        }
        row.starts = starts.len();
        row.rounds = times.us.len();
        times.put(row);
        let per_pixel = |count: u64| count as f64 / starts.len() as f64;
        row.rhs_per_pixel = per_pixel(effort.rhs_evaluations);
        row.steps_per_pixel = per_pixel(effort.steps);
        row.lane_use = effort.steps as f64 / effort.lane_steps.max(1) as f64;
        let pairs = compared.pairs();
        row.errors = Errors::of(&pairs);
        row.bands = bands(&pairs);
        Ok(compared)
    }

    /// Measures the gain of a kernel made for its scene over one that reads the scene as data;
    /// `None` for the processor, which has only one kind.
    pub(super) fn specialising(
        &self,
        backend: &mut Backend,
        config: IntegratorConfig,
    ) -> Result<Option<Specialising>, ReportError> {
        let adapter = backend.adapter();
        let Some(mut general) = backend.general()? else { return Ok(None) };
        let rough = self.rough_us(backend.engine(), config)?;
        let least = least_starts(&config, true);
        let starts = self.timed_starts(backend.engine(), config, rough, least)?;
        let mut engines = [general.as_mut(), backend.engine()];
        let mut times = [Vec::new(), Vec::new()];
        // The first round compiles the general kernel.
        for round in 0..=self.care.rounds {
            for (list, engine) in times.iter_mut().zip(&mut engines) {
                let us = self.run(*engine, config, &starts)?.us_per_pixel;
                if round > 0 {
                    list.push(us);
                }
            }
        }
        let ratios: Vec<f64> = times[0].iter().zip(&times[1]).map(|(a, b)| a / b).collect();
        let [general, specialised] = times.map(|times| median(&times).unwrap_or(f64::NAN));
        Ok(Some(Specialising {
            adapter,
            config,
            general_us_per_pixel: general,
            specialised_us_per_pixel: specialised,
            ratio: median(&ratios).unwrap_or(f64::NAN),
        }))
    }

    /// Runs starts of the home map through an engine.
    pub(super) fn run(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        starts: &[[Dd; 2]],
    ) -> Result<TimedRun, ReportError> {
        stopwatch::run(engine, &self.test_set.question, config, starts, self.stop)
    }

    /// Microseconds per pixel once everything is compiled, rather too many than too few.
    fn rough_us(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
    ) -> Result<f64, ReportError> {
        let few = spread(&self.test_set.starts, FIRST_STARTS);
        self.run(engine, config, &few)?;
        Ok(self.run(engine, config, &few)?.us_per_pixel)
    }

    /// Compares the engine with the truth, on as many starts of the sample as time allows.
    fn compare(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        rough_us: f64,
    ) -> Result<Compared, ReportError> {
        let affordable = (self.care.compare_secs * 1e6 / rough_us) as usize;
        let sample = spread(&self.test_set.sample, affordable.max(MIN_STARTS));
        let (starts, truth): (Vec<_>, Vec<_>) = sample.into_iter().unzip();
        let ran = self.run(engine, config, &starts)?;
        Ok(Compared { starts, truth, ran })
    }

    /// Returns as many starts as fill a round, after a warm-up run on them.
    fn timed_starts(
        &self,
        engine: &mut dyn Engine,
        config: IntegratorConfig,
        rough_us: f64,
        least: usize,
    ) -> Result<Vec<[Dd; 2]>, ReportError> {
        let fill = |us: f64| {
            let count = (self.care.round_secs * 1e6 / us) as usize;
            spread(&self.test_set.starts, count.max(least))
        };
        // The first guess from few starts is too slow: graphics cards need to be full.
        let guess = fill(rough_us);
        let us = self.run(engine, config, &guess)?.us_per_pixel;
        if us * 2.0 > rough_us {
            return Ok(guess);
        }
        let starts = fill(us);
        self.run(engine, config, &starts)?;
        Ok(starts)
    }

    fn scalar_us(&self, starts: &[[Dd; 2]]) -> f64 {
        let some = spread(starts, self.care.scalar_starts);
        baseline::us_per_pixel(&self.test_set.question, &some)
    }
}

/// Least number of starts that makes a measurement of a config.
pub(super) fn least_starts(config: &IntegratorConfig, is_gpu: bool) -> usize {
    match (is_slow(config), is_gpu) {
        (true, _) => MIN_STARTS,
        (false, true) => MIN_GPU_STARTS,
        (false, false) => MIN_FAST_STARTS,
    }
}

/// Least number of starts where each is checked: several jobs must be in flight, because each waits
/// for its most doubtful pixel.
pub(super) fn least_starts_of_exact(config: &IntegratorConfig) -> usize {
    if is_slow(config) { MIN_STARTS } else { MIN_EXACT_STARTS }
}

fn is_slow(config: &IntegratorConfig) -> bool {
    config.precision == Precision::Df32 || matches!(config.method, Method::Taylor { .. })
}

impl Times {
    /// Writes the medians of the rounds to `row`; the multiple is formed round by round, not from
    /// the medians, because disturbances on a shared machine last longer than a round.
    fn put(&self, row: &mut Row) {
        let fold = |f: fn(f64, f64) -> f64| self.us.iter().copied().reduce(f).unwrap_or(f64::NAN);
        let multiples: Vec<f64> =
            self.scalar_us.iter().zip(&self.us).map(|(s, us)| s / us).collect();
        let middle = |numbers: &[f64]| median(numbers).unwrap_or(f64::NAN);
        row.us_per_pixel = middle(&self.us);
        row.us_least = fold(f64::min);
        row.us_most = fold(f64::max);
        row.spread = (row.us_most - row.us_least) / row.us_per_pixel;
        row.scalar_us_per_pixel = middle(&self.scalar_us);
        row.times_scalar = middle(&multiples);
    }
}

/// Returns the reason an engine does not offer a config, if the error gives one.
pub(super) fn refusal(error: &ReportError) -> Option<String> {
    match error {
        ReportError::Engine(EngineError::Unsupported(why)) => Some(why.clone()),
        ReportError::Engine(error) => Some(format!("it failed: {error}")),
        ReportError::Film(why) => Some(why.clone()),
        _ => None,
    }
}
