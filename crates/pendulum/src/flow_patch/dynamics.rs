//! The dynamics of a patch: how one state, and all states around it, move in a step.

use flipmap_numbers::jet::Jet;
use pulp::{Arch, Simd, WithSimd};

use crate::Pendulum;
use crate::crossing::StepState;
use crate::embedded::{Dop853, EmbeddedPair, plus};
use crate::flip::Rule;
use crate::opening::Rates;
use crate::phase::Phase;

/// The dynamics that move a patch, in reduced units.
#[derive(Clone, Copy, Debug)]
pub struct Dynamics {
    /// The five numbers of the pendulum.
    pub pendulum: Pendulum<f64>,
    /// The rule that says which bob is watched.
    pub rule: Rule,
    pub(super) rates: Rates,
    pub(super) jets: Pendulum<Jet>,
    pub(super) inverse_scale: [f64; 2],
}

/// A step of all states, compiled for the widest registers of the processor. As a closure it would
/// be compiled for the narrowest.
struct CarryingStep<'a> {
    dynamics: &'a Dynamics,
    phase: &'a Phase<Jet>,
    step: Jet,
}

impl WithSimd for CarryingStep<'_> {
    type Output = Phase<Jet>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Phase<Jet> {
        let CarryingStep { dynamics, phase, step } = self;
        let scale = dynamics.inverse_scale.map(Jet::constant);
        plus(phase, &Dop853::trial(&dynamics.jets, scale, phase, step).change)
    }
}

impl Dynamics {
    /// The dynamics of a pendulum in reduced units.
    pub fn new(pendulum: Pendulum<f64>, rule: Rule) -> Self {
        let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
        Dynamics {
            pendulum,
            rule,
            rates: Rates::new(&pendulum),
            jets: pendulum.map(Jet::constant),
            inverse_scale,
        }
    }

    pub(super) fn moment(&self, phase: Phase<f64>) -> StepState<f64> {
        StepState { phase, speed: self.pendulum.speeds(&phase) }
    }

    /// The state of one pendulum after a step, and the error of that step.
    pub(super) fn moved(&self, phase: &Phase<f64>, step: f64) -> (Phase<f64>, f64) {
        let trial = Dop853::trial(&self.pendulum, self.inverse_scale, phase, step);
        (plus(phase, &trial.change), trial.error_squared.sqrt())
    }

    /// All states after a step whose length may itself differ from start to start.
    pub(super) fn carried(&self, phase: &Phase<Jet>, step: Jet) -> Phase<Jet> {
        Arch::new().dispatch(CarryingStep { dynamics: self, phase, step })
    }

    /// The weights of a state's components: momenta count in units of their scale.
    pub(crate) fn weights(&self) -> Phase<f64> {
        let [p1, p2] = self.inverse_scale;
        [1.0, 1.0, 1.0, 1.0, p1, p2]
    }

    /// An estimate of the largest truncation error of a state's polynomials.
    pub(super) fn tail(&self, phase: &Phase<Jet>) -> f64 {
        let weight = self.weights();
        (0..6).map(|i| phase[i].tail() * weight[i]).fold(0.0, f64::max)
    }

    /// A bound on the distance of the states from the middle one, in unit vectors and scaled
    /// momenta.
    pub(super) fn spread(&self, phase: &Phase<Jet>) -> f64 {
        let weight = self.weights();
        (0..6).map(|i| phase[i].spread() * weight[i]).fold(0.0, f64::max)
    }
}
