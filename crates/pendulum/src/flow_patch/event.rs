//! Events at the top in a step of a patch: crossings by all starts, and turns in which only some
//! flip.

use super::graze::Graze;
use super::{Dynamics, FlowPatch, MIN_HALVED_STEP, PatchCrossing, PatchStep, middle};
use crate::crossing::{crosses, crossing, turning_point};
use crate::phase::Phase;
use crate::reference::Reference;
use flipmap_numbers::jet::Jet;

/// Distance from the top, in spreads, beyond which a turn is no graze.
const NEAR: f64 = 8.0;
/// Distance from the top below which the middle is looked up in its reference.
const KNOWN_BY_F64: f64 = 1e-6;
/// Error allowed in the time of a crossing, in reduced time: far less than a flip time may be wrong
/// by.
const TIME_TOLERANCE: f64 = 1e-6;

/// The event that a step of a patch meets at the top.
pub(super) enum PatchEvent {
    Nothing,
    /// A turn too far from the top to be a graze, with the least distance from the top.
    FarTurn(f64),
    /// Two events at once.
    TooMuch,
    Unclear,
    /// A crossing by all starts.
    Pass(Box<PatchCrossing>),
    /// A pass by the bob of this index in the middle start, so slow that in other starts the bob
    /// may turn round before the top.
    NearlyGraze(usize),
    /// The return of the bob of this index from a graze in the middle start.
    Back(usize),
    /// A turn in which some starts may flip; true if the middle is beyond the top after it.
    Graze(Box<Graze>, bool),
}

impl FlowPatch {
    /// Determines the event at the top within `patch_step`. Until the time `since`, no start was at
    /// the top or beyond it.
    pub(super) fn event_in(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
        since: f64,
        tolerance: f64,
        reference: Option<&(dyn Reference + 'static)>,
    ) -> PatchEvent {
        let (before, after) =
            (dynamics.moment(middle(&self.phase)), dynamics.moment(middle(&patch_step.after)));
        let mut events = Vec::new();
        for &bob in dynamics.rule.watched() {
            let (x0, x1) = (before.phase[2 * bob], after.phase[2 * bob]);
            if x0 >= 0.0 && x1 >= 0.0 {
                continue;
            }
            let turns = before.speed[bob] * after.speed[bob] < 0.0;
            let passes = crosses(&before, &after, bob);
            if turns && passes && patch_step.plan.length > MIN_HALVED_STEP {
                return PatchEvent::TooMuch;
            }
            if turns {
                events.extend(self.turn(dynamics, patch_step, bob, tolerance, reference));
            } else if passes {
                events.push(self.pass(dynamics, patch_step, bob, since, tolerance));
            }
        }
        let far = |event: &PatchEvent| match event {
            PatchEvent::FarTurn(clearance) => Some(*clearance),
            _ => None,
        };
        let least = events.iter().filter_map(far).reduce(f64::min);
        events.retain(|event| far(event).is_none());
        match events.len() {
            0 => least.map_or(PatchEvent::Nothing, PatchEvent::FarTurn),
            1 => events.remove(0),
            _ if patch_step.plan.length > MIN_HALVED_STEP => PatchEvent::TooMuch,
            _ => PatchEvent::Unclear,
        }
    }

    /// The event of a bob that turns round within `patch_step`, if that is near the top.
    fn turn(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
        bob: usize,
        tolerance: f64,
        reference: Option<&(dyn Reference + 'static)>,
    ) -> Option<PatchEvent> {
        let start = middle(&self.phase);
        let at = |fraction: f64| {
            dynamics.moment(dynamics.moved(&start, patch_step.plan.length * fraction).0)
        };
        let (before, after) = (at(0.0), dynamics.moment(middle(&patch_step.after)));
        let (fraction, there) = turning_point(&at, bob, &before, &after);
        let spread = self.phase[2 * bob + 1].spread().max(patch_step.after[2 * bob + 1].spread());
        let tau = patch_step.plan.length * fraction;
        // Deep in a zoom the spread is far below f64's resolution of the middle.
        let sine = match reference {
            Some(reference) if there.phase[2 * bob + 1].abs() < KNOWN_BY_F64 => {
                reference.turn(bob, tau)
            }
            _ => there.phase[2 * bob + 1],
        };
        if there.phase[2 * bob] >= 0.0 || sine.abs() > NEAR * spread {
            // If the bob nearly grazed the top before, it has turned round far beyond it: unclear.
            let far =
                || (there.phase[2 * bob] < 0.0).then_some(PatchEvent::FarTurn(sine.abs() - spread));
            return if self.beyond[bob] { Some(PatchEvent::Unclear) } else { far() };
        }
        let (shift, phase) = dynamics.turn_of_all(&self.phase, tau, bob);
        // The side from which the bob came: its present one, or the other if it has just passed.
        let mut side = before.phase[2 * bob + 1].signum();
        if self.beyond[bob] {
            side = -side;
        }
        let mut sine = phase[2 * bob + 1];
        if let Some(reference) = reference {
            sine = sine.with_middle(reference.turn(bob, tau));
        }
        let height = sine * Jet::constant(-side);
        let clear = shift.tail() <= TIME_TOLERANCE
            && height.tail() <= tolerance.min(height.spread() * 1e-6);
        Some(if clear {
            let time = self.time.0 + (self.time.1 + tau);
            let beyond = after.phase[2 * bob + 1] * side < 0.0;
            PatchEvent::Graze(Box::new(Graze { bob, side, time, shift, height, phase }), beyond)
        } else {
            PatchEvent::Unclear
        })
    }

    /// The event of the middle passing the top with `bob` within `patch_step`.
    fn pass(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
        bob: usize,
        since: f64,
        tolerance: f64,
    ) -> PatchEvent {
        let start = middle(&self.phase);
        let at = |fraction: f64| {
            dynamics.moment(dynamics.moved(&start, patch_step.plan.length * fraction).0)
        };
        let (before, after) = (at(0.0), dynamics.moment(middle(&patch_step.after)));
        let (fraction, there) =
            crossing(&at, bob, (0.0, before), (1.0, after), patch_step.plan.length);
        if there.phase[2 * bob] >= 0.0 {
            return PatchEvent::Nothing;
        }
        if self.beyond[bob] {
            return PatchEvent::Back(bob);
        }
        let tau = patch_step.plan.length * fraction;
        let (shift, phase) = dynamics.crossing_jet(&self.phase, tau, bob);
        let speed = dynamics.jets.speeds(&phase)[bob];
        let clear = shift.tail() <= TIME_TOLERANCE.min(tolerance.sqrt())
            && speed.spread() < 0.5 * speed.middle().abs();
        if clear {
            let time = self.time.0 + (self.time.1 + tau);
            let crossing = PatchCrossing::new(time, shift, phase, since);
            crossing.map_or(PatchEvent::Unclear, |pass| PatchEvent::Pass(Box::new(pass)))
        } else {
            PatchEvent::NearlyGraze(bob)
        }
    }
}

/// Number of Newton iterations for a polynomial right to its last degree: each doubles the degree.
const NEWTON_STEPS: usize = 3;

impl Dynamics {
    /// The angular acceleration dω/dt of a bob.
    fn acceleration(&self, phase: &Phase<Jet>, bob: usize) -> Jet {
        let [x1, y1, x2, y2, ..] = *phase;
        let speed = self.jets.speeds(phase);
        self.jets.acceleration_towards([(y1, x1), (y2, x2)], speed)[bob]
    }

    /// The delay after `tau` with which each start's `bob` turns round, and the states then.
    fn turn_of_all(&self, from: &Phase<Jet>, tau: f64, bob: usize) -> (Jet, Phase<Jet>) {
        self.moment_of_all(from, tau, |phase| {
            self.jets.speeds(phase)[bob] / self.acceleration(phase, bob)
        })
    }

    /// The delay after `tau` with which each start's `bob` passes the top, and the states then.
    fn crossing_jet(&self, from: &Phase<Jet>, tau: f64, bob: usize) -> (Jet, Phase<Jet>) {
        self.moment_of_all(from, tau, |phase| {
            phase[2 * bob + 1] / (self.jets.speeds(phase)[bob] * phase[2 * bob])
        })
    }

    /// Finds the moment at which a quantity vanishes for each start, by Newton's method on
    /// polynomials.
    fn moment_of_all(
        &self,
        from: &Phase<Jet>,
        tau: f64,
        newton: impl Fn(&Phase<Jet>) -> Jet,
    ) -> (Jet, Phase<Jet>) {
        let there = self.carried(from, Jet::constant(tau));
        let (mut shift, mut phase) = (Jet::constant(0.0), there);
        for _ in 0..NEWTON_STEPS {
            shift = (shift - newton(&phase)).with_middle(0.0);
            phase = self.carried(&there, shift);
        }
        (shift, phase)
    }
}
