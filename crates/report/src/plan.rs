//! The plan of a report: every method in every precision, at settings from coarse to fine.

pub use flipmap_engine::level::{BALANCED, BALANCED_DF32, FAST, LESSON};
use flipmap_engine::{IntegratorConfig, Method, Precision};

/// The time and the number of starts that a report may spend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thoroughness {
    /// True to measure fewer settings.
    pub quick: bool,
    /// Largest number of starts compared with the gold standard.
    pub sample: usize,
    /// Number of repetitions of each measurement.
    pub rounds: usize,
    /// Seconds that one repetition should take.
    pub round_secs: f64,
    /// Seconds that comparing a config with the gold standard may take.
    pub compare_secs: f64,
    /// Number of the scalar loop's starts in each repetition.
    pub scalar_starts: usize,
    /// Number of starts of each window in which `balanced` is measured.
    pub window_starts: usize,
    /// Number of starts of each late window in which `exact` is measured.
    pub late_starts: usize,
    /// Number of those that the gold standard answers too, in double-double.
    pub oracle_starts: usize,
    /// Number of pixels of each deep place that are compared, in numbers as long as it needs.
    pub depth_starts: usize,
    /// The same for each place deeper than 1e-24 rad, where each pixel takes seconds.
    pub deepest_starts: usize,
}

impl Thoroughness {
    /// A full report: half an hour on two cores, and longer with each adapter.
    pub const FULL: Self = Thoroughness {
        quick: false,
        sample: 20_000,
        rounds: 7,
        round_secs: 1.0,
        compare_secs: 5.0,
        scalar_starts: 1000,
        window_starts: 1000,
        late_starts: 2000,
        oracle_starts: 10,
        depth_starts: 576,
        deepest_starts: 48,
    };
    /// A quick report: some minutes.
    pub const QUICK: Self = Thoroughness {
        quick: true,
        sample: 5000,
        rounds: 5,
        round_secs: 0.3,
        compare_secs: 1.5,
        scalar_starts: 500,
        window_starts: 100,
        late_starts: 60,
        oracle_starts: 2,
        depth_starts: 48,
        deepest_starts: 0,
    };
}

/// Every config that is requested from an engine. Those that share a kernel are adjacent.
pub(crate) fn configs(quick: bool) -> Vec<IntegratorConfig> {
    let rk4 = |per_second: f64| Method::Rk4 { step_secs: 1.0 / per_second };
    let dopri5 = |tolerance| Method::dopri5(tolerance);
    let dop853 = |tolerance| Method::dop853(tolerance);
    let taylor = |tolerance| Method::Taylor { tolerance };
    let of =
        |precision, method: &dyn Fn(f64) -> Method, settings: &[f64]| -> Vec<IntegratorConfig> {
            settings
                .iter()
                .map(|&setting| IntegratorConfig { method: method(setting), precision })
                .collect()
        };
    use Precision::{Dd, Df32, F32, F64};
    let groups = if quick {
        vec![
            of(F32, &rk4, &[120.0, 480.0]),
            of(F64, &rk4, &[120.0]),
            of(F32, &dopri5, &[1e-6, 5e-8]),
            of(F64, &dop853, &[1e-9, 3e-13]),
            vec![BALANCED_DF32],
        ]
    } else {
        vec![
            of(F32, &rk4, &[60.0, 120.0, 240.0, 480.0]),
            of(F64, &rk4, &[60.0, 120.0, 240.0, 480.0]),
            of(F32, &dopri5, &[1e-5, 1e-6, 1e-7, 5e-8]),
            of(F64, &dopri5, &[1e-7, 1e-8, 1e-9]),
            of(F32, &dop853, &[1e-6, 1e-7]),
            of(F64, &dop853, &[1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 3e-13, 1e-13]),
            of(F64, &taylor, &[1e-14, 1e-15]),
            of(Df32, &dop853, &[1e-9, 1e-10, 1e-11, 1e-12]),
            of(Df32, &dopri5, &[1e-9, 1e-10, 1e-11]),
            of(Dd, &taylor, &[1e-25]),
        ]
    };
    groups.concat()
}

/// Integrator configs for pixels of a deep zoom.
pub(crate) const DEEP: [IntegratorConfig; 3] = [BALANCED, BALANCED_DF32, FAST];

/// The configs for which the kernel made for its scene is compared with the general one.
pub(crate) fn specialised(quick: bool) -> &'static [IntegratorConfig] {
    if quick { &[LESSON] } else { &[LESSON, FAST, BALANCED] }
}

/// The configs by which the questions other than the first flip are answered, from coarse to fine.
pub(crate) fn questions(quick: bool) -> Vec<IntegratorConfig> {
    if quick {
        return vec![FAST, BALANCED];
    }
    let in_f64 = |method| IntegratorConfig { method, precision: Precision::F64 };
    let finer = [
        Method::dop853(1e-8),
        Method::dop853(1e-10),
        BALANCED.method,
        Method::Taylor { tolerance: 1e-15 },
    ];
    let coarser = Method::dopri5(1e-5);
    let coarser = IntegratorConfig { method: coarser, precision: Precision::F32 };
    [LESSON, coarser, FAST].into_iter().chain(finer.map(in_f64)).collect()
}

/// Configs of the table of errors in angle and energy.
pub(crate) fn motions() -> Vec<IntegratorConfig> {
    let step = |per_second: f64| Method::Rk4 { step_secs: 1.0 / per_second };
    let mut configs = Vec::new();
    for precision in [Precision::F32, Precision::F64] {
        let methods = [step(120.0), step(480.0), FAST.method, Method::dop853(1e-7)];
        configs.extend(methods.map(|method| IntegratorConfig { method, precision }));
    }
    let finer = [
        Method::dopri5(1e-9),
        Method::dop853(1e-10),
        BALANCED.method,
        Method::Taylor { tolerance: 1e-15 },
    ];
    configs.extend(finer.map(|method| IntegratorConfig { method, precision: Precision::F64 }));
    configs
}

/// Describes a config for readers.
pub(crate) fn words(config: &IntegratorConfig) -> String {
    format!("{}, {}, {}", config.method.name(), config.method.setting(), config.precision)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quick_measures_some_of_the_rest_and_all_that_targets_need() {
        let (quick, full) = (configs(true), configs(false));
        assert!(quick.iter().all(|config| full.contains(config)) && quick.len() < full.len());
        for needed in [LESSON, FAST, BALANCED, BALANCED_DF32] {
            assert!(quick.contains(&needed), "{needed:?}");
        }
    }
}
