//! Errors in angle and energy at fixed times, against the gold standard in double-double.
//!
//! The methods run here as plain scalars, one pendulum at a time, with the same step size control
//! as in the engines. Steps need not end at these times: the truth is known at every moment.

use rayon::prelude::*;
use serde::Serialize;

use super::{ReportError, StopTest, as_words};
use flipmap_engine::{IntegratorConfig, Method, Precision};
use flipmap_numbers::trig::Turning;
use flipmap_numbers::{Angle, Dd, Scalar};
use flipmap_pendulum::control::{Control, FIRST, MAX_STEP};
use flipmap_pendulum::embedded::Pair;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::series::{MotionSeries, ORDER_F64};
use flipmap_pendulum::taylor::{Orbit, TaylorStep};
use flipmap_pendulum::{Pendulum, State, integrator};
use flipmap_scene::Scene;

/// Seconds after the release at which errors are evaluated.
pub(crate) const TIMES_SECS: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];

/// Starts (rad) that f32 represents exactly, so that every method gets the same pendulum.
const GROUPS: [(&str, [[f64; 2]; 4]); 2] = [
    ("regular", [[0.5, -0.25], [0.75, 1.0], [1.0, 0.5], [0.25, -0.5]]),
    ("chaotic", [[3.0, 3.0], [2.0, 2.5], [-2.0, 3.0], [1.75, -2.5]]),
];

/// The worst errors of a method over the starts of a group, at one time.
#[derive(Clone, Debug, Serialize)]
pub struct MotionError {
    /// `regular` or `chaotic`.
    pub motion: &'static str,
    /// The integrator config that was measured.
    #[serde(flatten, serialize_with = "as_words")]
    pub config: IntegratorConfig,
    /// Seconds since the release.
    pub secs: f64,
    /// Angle error in rad, the larger of the two, modulo whole turns.
    pub angle_rad: f64,
    /// Error of the energy as a share of P + Q.
    pub energy_share: f64,
}

/// A state during the motion, with the reduced time at which it was reached.
type TimedState = (f64, State<f64>);

/// Computes the errors of every config; a precision other than f32 runs as f64.
pub(crate) fn errors(
    configs: &[IntegratorConfig],
    stop: StopTest,
) -> Result<Vec<MotionError>, ReportError> {
    let (pendulum, unit_secs) = Scene::default().build.pendulum().reduced();
    let mut found = Vec::new();
    for (motion, starts) in GROUPS {
        let truths: Vec<Truth> =
            starts.par_iter().map(|&angle| Truth::new(&pendulum, angle, unit_secs)).collect();
        for &config in configs {
            if stop() {
                return Err(ReportError::Stopped);
            }
            let worst = worst(&pendulum, config, &truths, unit_secs);
            found.extend(worst.into_iter().zip(TIMES_SECS).map(
                |([angle_rad, energy_share], secs)| MotionError {
                    motion,
                    config,
                    secs,
                    angle_rad,
                    energy_share,
                },
            ));
        }
    }
    Ok(found)
}

/// The worst angle and energy errors at each time.
fn worst(
    pendulum: &Pendulum<f64>,
    config: IntegratorConfig,
    truths: &[Truth],
    unit_secs: f64,
) -> Vec<[f64; 2]> {
    let times = TIMES_SECS.map(|secs| secs / unit_secs);
    let mut worst = vec![[0f64; 2]; times.len()];
    for truth in truths {
        let moments = match config.precision {
            Precision::F32 => moments::<f32>(pendulum, config.method, truth.start, &times),
            _ => moments::<f64>(pendulum, config.method, truth.start, &times),
        };
        for (worst, moment) in worst.iter_mut().zip(moments) {
            let error = truth.error(pendulum, &moment);
            *worst = [worst[0].max(error[0]), worst[1].max(error[1])];
        }
    }
    worst
}

/// The motion in double-double, with all its steps.
struct Truth {
    start: [f64; 2],
    steps: Vec<TaylorStep<Dd>>,
}

impl Truth {
    fn new(pendulum: &Pendulum<f64>, start: [f64; 2], unit_secs: f64) -> Self {
        let last = TIMES_SECS[TIMES_SECS.len() - 1] / unit_secs + MAX_STEP;
        let mut orbit = Orbit::new(pendulum.map(Dd::new), State::rest(start.map(Dd::new)));
        let mut steps = Vec::new();
        while orbit.time().to_f64() < last {
            steps.push(orbit.step());
        }
        Truth { start, steps }
    }

    /// Errors of the angles (rad) and of the energy (share of P + Q).
    fn error(&self, pendulum: &Pendulum<f64>, (time, state): &TimedState) -> [f64; 2] {
        let time = Dd::new(*time);
        let after = self.steps.partition_point(|step| step.end() < time);
        let step = &self.steps[after.min(self.steps.len() - 1)];
        let truth = step.state(time - step.start);
        let off = |i: usize| {
            let (sin, cos) = (Dd::new(state.angle[i]) - truth.angle[i]).sin_cos();
            sin.to_f64().atan2(cos.to_f64()).abs()
        };
        let energy = pendulum.energy(state) - pendulum.energy(&State::rest(self.start));
        [off(0).max(off(1)), energy.abs() / (pendulum.p + pendulum.q)]
    }
}

/// The states at the end of the first step that reaches each of the reduced `times`.
fn moments<T: Scalar>(
    pendulum: &Pendulum<f64>,
    method: Method,
    start: [f64; 2],
    times: &[f64],
) -> Vec<TimedState> {
    let exact = pendulum;
    let pendulum: Pendulum<T> = pendulum.map(T::from_f64);
    let state = State::rest(start.map(T::from_f64));
    match method {
        Method::Rk4 { step_secs } => {
            let (_, unit_secs) = Scene::default().build.pendulum().reduced();
            fixed(&pendulum, state, step_secs / unit_secs, times)
        }
        Method::Embedded { pair, tolerance } => {
            let pair = ControlledPair { pair, control: Control::new(tolerance, pair.data().order) };
            free(&pendulum, exact, &state, times, &mut pair.stepper(&pendulum))
        }
        Method::Taylor { tolerance } => {
            let scale = exact.momentum_scale();
            let mut step = |phase: &Phase<T>, _| expanded(&pendulum, scale, phase, tolerance);
            free(&pendulum, exact, &state, times, &mut step)
        }
        Method::Extrapolation { .. } => unreachable!("only methods with names are charted"),
    }
}

/// Integrates by RK4, carrying the rounding remainders of the angles as the engines do in f32.
fn fixed<T: Scalar>(
    pendulum: &Pendulum<T>,
    mut state: State<T>,
    step: f64,
    times: &[f64],
) -> Vec<TimedState> {
    let step = T::from_f64(step);
    let (mut rest, mut count) = ([T::zero(); 2], 0u32);
    let mut found = Vec::new();
    for &end in times {
        while f64::from(count) * step.to_f64() < end {
            let change = integrator::rk4(pendulum, &state, step, Turning::Fresh);
            (state, rest) = state.plus_with_rest(rest, &change);
            count += 1;
        }
        let near = State {
            angle: [0, 1].map(|i| state.angle[i].to_f64() + rest[i].to_f64()),
            speed: state.speed.map(T::to_f64),
        };
        found.push((f64::from(count) * step.to_f64(), near));
    }
    found
}

/// A function that makes a step from a phase at a reduced time: its length, and the change.
type Stepper<'a, T> = dyn FnMut(&Phase<T>, f64) -> (T, Phase<T>) + 'a;

/// Integrates by adaptive steps, carrying the rounding remainders of all six numbers.
fn free<T: Scalar>(
    pendulum: &Pendulum<T>,
    exact: &Pendulum<f64>,
    state: &State<T>,
    times: &[f64],
    step: &mut Stepper<T>,
) -> Vec<TimedState> {
    let mut phase = pendulum.phase(state);
    let mut rest = [T::zero(); 6];
    let mut time = 0.0;
    let mut found = Vec::new();
    for &end in times {
        while time < end {
            let (length, change) = step(&phase, time);
            for i in 0..6 {
                (phase[i], rest[i]) = phase[i].fast_two_sum(rest[i] + change[i]);
            }
            time += length.to_f64();
        }
        let near = std::array::from_fn(|i| phase[i].to_f64() + rest[i].to_f64());
        found.push((time, angles(exact, &near)));
    }
    found
}

/// Converts a phase to angles and speeds.
fn angles(pendulum: &Pendulum<f64>, phase: &Phase<f64>) -> State<f64> {
    let [x1, y1, x2, y2, _, _] = *phase;
    State { angle: [y1.atan2(x1), y2.atan2(x2)], speed: pendulum.speeds(phase) }
}

/// An embedded pair with its step size control.
struct ControlledPair {
    pair: Pair,
    control: Control,
}

impl ControlledPair {
    /// A stepper that retries each step until its error is small enough.
    fn stepper<T: Scalar>(
        &self,
        pendulum: &Pendulum<T>,
    ) -> impl FnMut(&Phase<T>, f64) -> (T, Phase<T>) {
        let scale = pendulum.momentum_scale().map(|scale| T::from_f64(1.0) / scale);
        let mut step = FIRST;
        move |phase, time| loop {
            let length = T::from_f64(step);
            let trial = self.pair.trial(pendulum, scale, phase, length);
            let error = trial.error_squared.to_f64().max(f64::MIN_POSITIVE);
            let excess = error.log2() - self.control.limit(time);
            step = (step * self.control.factor(excess)).min(MAX_STEP);
            if excess < 0.0 {
                return (length, trial.change);
            }
        }
    }
}

/// A Taylor step of Jorba and Zou's length: the last two orders promise errors of `tolerance`.
fn expanded<T: Scalar>(
    pendulum: &Pendulum<T>,
    momentum_scale: [f64; 2],
    phase: &Phase<T>,
    tolerance: f64,
) -> (T, Phase<T>) {
    let series = MotionSeries::<T, { ORDER_F64 + 1 }>::expand(pendulum, phase);
    let size = |i: usize, order: usize| {
        let size = series.phase[i][order].to_f64().abs();
        if i < 4 { size } else { size / momentum_scale[i - 4] }
    };
    let allowed = |order: usize| {
        let largest = (0..6).map(|i| size(i, order)).fold(f64::MIN_POSITIVE, f64::max);
        (tolerance / largest).powf(1.0 / order as f64)
    };
    let length = allowed(ORDER_F64 - 1).min(allowed(ORDER_F64)).min(MAX_STEP);
    let length = T::from_f64(length);
    (length, series.change(length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;

    #[test]
    fn errors_are_small_where_they_must_be_and_not_everywhere() {
        let found = errors(&plan::motions(), &|| false).unwrap();
        let of = |motion, method: &str, precision, secs| {
            let fits = |e: &&MotionError| {
                e.motion == motion
                    && e.config.method.name() == method
                    && e.config.precision == precision
                    && e.secs == secs
            };
            found.iter().filter(fits).map(|e| e.angle_rad).fold(f64::INFINITY, f64::min)
        };
        assert!(of("regular", "taylor", Precision::F64, 20.0) < 1e-12);
        assert!(of("regular", "dop853", Precision::F64, 20.0) < 1e-8);
        assert!(of("regular", "dopri5", Precision::F32, 1.0) < 1e-5);
        assert!(of("regular", "rk4", Precision::F64, 1.0) < 1e-5);
        // The growth of errors shows, and so does a coarse step.
        let taylor = |secs| of("chaotic", "taylor", Precision::F64, secs);
        assert!(taylor(20.0) > 10.0 * taylor(1.0) && taylor(20.0) < 1e-3);
        assert!(of("chaotic", "rk4", Precision::F64, 20.0) > 1e-6);
        assert!(found.iter().all(|e| e.angle_rad.is_finite() && e.energy_share < 10.0));
        assert!(matches!(errors(&plan::motions(), &|| true), Err(ReportError::Stopped)));
    }
}
