//! How the errors of the three integrators depend on the step.

use super::chart::{AxisScale, Chart, ChartAxis, Curve};
use super::drawing::Tint;
use super::integrators::Integrator;
use flipmap_pendulum::{Pendulum, State};

/// The errors of the three integrators as a function of the step.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Sweep {
    /// Steps in seconds.
    pub steps_secs: Vec<f64>,
    /// For each integrator, distances in rad of the final angles from those found with a far
    /// smaller step.
    pub errors: [Vec<f64>; 3],
}

/// Simulated time in seconds after which a sweep compares the final angles.
const SWEEP_SECS: f64 = 1.0;

impl Sweep {
    /// Computes the sweep of a pendulum released at `start`.
    pub(crate) fn of(pendulum: &Pendulum<f64>, start: State<f64>) -> Self {
        let truth = Integrator::Rk4.run(pendulum, start, SWEEP_SECS, 1.0 / 65536.0);
        let steps_secs: Vec<f64> = (6..=11).map(|k| 0.5f64.powi(k)).collect();
        let errors = Integrator::ALL.map(|(method, _)| {
            let error = |&step: &f64| {
                let state = method.run(pendulum, start, SWEEP_SECS, step);
                let apart = |i: usize| state.angle[i] - truth.angle[i];
                apart(0).hypot(apart(1))
            };
            steps_secs.iter().map(error).collect()
        });
        Sweep { steps_secs, errors }
    }

    /// Returns the order of an integrator: the slope of log error against log step.
    pub(crate) fn order(&self, method: usize) -> f64 {
        let (errors, steps) = (&self.errors[method], &self.steps_secs);
        let last = steps.len() - 1;
        (errors[0] / errors[last]).ln() / (steps[0] / steps[last]).ln()
    }

    /// Returns a chart of the errors against the step.
    pub(crate) fn chart(&self, tint: &Tint) -> Chart {
        let curves = Integrator::ALL.iter().zip(&self.errors).map(|((method, _), errors)| {
            let points = self.steps_secs.iter().zip(errors).map(|(&x, &y)| [x, y]).collect();
            Curve::line("", method.colour(tint), points)
        });
        Chart {
            across: ChartAxis::new("Δt, s", 3e-4..=2e-2, AxisScale::Log),
            up: ChartAxis::new("error after 1 s, rad", 1e-14..=1.0, AxisScale::Log),
            curves: curves.collect(),
            marks: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::double_simulation::pendulum;

    #[test]
    fn errors_fall_with_the_order_of_the_method() {
        let sweep = Sweep::of(&pendulum(), State::rest([1.2, 0.9]));
        for (method, order) in [(0, 1.0), (1, 1.0), (2, 4.0)] {
            assert!(
                (sweep.order(method) - order).abs() < 0.15,
                "{method}: {}",
                sweep.order(method)
            );
        }
    }
}
