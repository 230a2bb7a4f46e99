//! What a step of a patch meets at the top: passages by all, and turns that only some make.

use super::graze::Graze;
use super::{Dynamics, FlowPatch, PatchCrossing, PatchStep, SHORTEST, middle};
use crate::physics::crossing::{crosses, crossing, turning_point};
use crate::physics::jet::Jet;
use crate::physics::phase::Phase;
use crate::physics::reference::Reference;

/// A turn this many spreads below the top is no graze.
const NEAR: f64 = 8.0;
/// A middle nearer to the top than this is looked up in its reference.
const KNOWN_BY_F64: f64 = 1e-6;
/// Errors in the moment of a passage, reduced time: well below what is called right.
const TIME_TOLERANCE: f64 = 1e-6;

/// What a patch_step meets at the top.
pub(super) enum PatchEvent {
    Nothing,
    /// A turn too far from the top to be a graze: so far, at least.
    FarTurn(f64),
    /// Two things at once.
    TooMuch,
    Unclear,
    /// All pass.
    Pass(Box<PatchCrossing>),
    /// The middle passes so slowly that others may turn round before.
    NearlyGraze(usize),
    /// The middle comes back from a graze.
    Back(usize),
    /// Some may flip in a turn, after which the middle is beyond the top or not.
    Graze(Box<Graze>, bool),
}

impl FlowPatch {
    /// What happens at the top within a patch_step.
    pub(super) fn event_in(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
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
            if turns && passes && patch_step.length > SHORTEST {
                return PatchEvent::TooMuch;
            }
            if turns {
                events.extend(self.turn(dynamics, patch_step, bob, tolerance, reference));
            } else if passes {
                events.push(self.pass(dynamics, patch_step, bob, tolerance));
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
            _ if patch_step.length > SHORTEST => PatchEvent::TooMuch,
            _ => PatchEvent::Unclear,
        }
    }

    /// A bob that turns round within a patch_step, if that is near the top.
    fn turn(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
        bob: usize,
        tolerance: f64,
        reference: Option<&(dyn Reference + 'static)>,
    ) -> Option<PatchEvent> {
        let start = middle(&self.phase);
        let at =
            |fraction: f64| dynamics.moment(dynamics.moved(&start, patch_step.length * fraction).0);
        let (before, after) = (at(0.0), dynamics.moment(middle(&patch_step.after)));
        let (fraction, there) = turning_point(&at, bob, &before, &after);
        let spread = self.phase[2 * bob + 1].spread().max(patch_step.after[2 * bob + 1].spread());
        let tau = patch_step.length * fraction;
        // Deep down the spread is far below what f64 knows of the middle.
        let sine = match reference {
            Some(reference) if there.phase[2 * bob + 1].abs() < KNOWN_BY_F64 => {
                reference.turn(bob, tau)
            }
            _ => there.phase[2 * bob + 1],
        };
        if there.phase[2 * bob] >= 0.0 || sine.abs() > NEAR * spread {
            // A pass that was nearly a graze, and turned round far beyond.
            let far =
                || (there.phase[2 * bob] < 0.0).then_some(PatchEvent::FarTurn(sine.abs() - spread));
            return if self.beyond[bob] { Some(PatchEvent::Unclear) } else { far() };
        }
        let (shift, phase) = dynamics.turn_of_all(&self.phase, tau, bob);
        // The side it came from: its own, or the other one if it has just passed.
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

    /// The middle's bob passes the top within a patch_step.
    fn pass(
        &self,
        dynamics: &Dynamics,
        patch_step: &PatchStep,
        bob: usize,
        tolerance: f64,
    ) -> PatchEvent {
        let start = middle(&self.phase);
        let at =
            |fraction: f64| dynamics.moment(dynamics.moved(&start, patch_step.length * fraction).0);
        let (before, after) = (at(0.0), dynamics.moment(middle(&patch_step.after)));
        let (fraction, there) = crossing(&at, bob, (0.0, before), (1.0, after), patch_step.length);
        if there.phase[2 * bob] >= 0.0 {
            return PatchEvent::Nothing;
        }
        if self.beyond[bob] {
            return PatchEvent::Back(bob);
        }
        let tau = patch_step.length * fraction;
        let (shift, phase) = dynamics.pass_of_all(&self.phase, tau, bob);
        let speed = dynamics.jets.speeds(&phase)[bob];
        let clear = shift.tail() <= TIME_TOLERANCE.min(tolerance.sqrt())
            && speed.spread() < 0.5 * speed.middle().abs();
        if clear {
            let time = self.time.0 + (self.time.1 + tau);
            PatchEvent::Pass(Box::new(PatchCrossing { time, shift, phase }))
        } else {
            PatchEvent::NearlyGraze(bob)
        }
    }
}

/// Newton's iterations that make a polynomial right to its last degree: each doubles it.
const NEWTON_STEPS: usize = 3;

impl Dynamics {
    /// dω/dt of a bob.
    fn acceleration(&self, phase: &Phase<Jet>, bob: usize) -> Jet {
        let [x1, y1, x2, y2, ..] = *phase;
        let speed = self.jets.speeds(phase);
        self.jets.acceleration_towards([(y1, x1), (y2, x2)], speed)[bob]
    }

    /// How much later than `tau` each start's `bob` turns round, and the states then.
    fn turn_of_all(&self, from: &Phase<Jet>, tau: f64, bob: usize) -> (Jet, Phase<Jet>) {
        self.moment_of_all(from, tau, |phase| {
            self.jets.speeds(phase)[bob] / self.acceleration(phase, bob)
        })
    }

    /// How much later than `tau` each start's `bob` passes the top, and the states then.
    fn pass_of_all(&self, from: &Phase<Jet>, tau: f64, bob: usize) -> (Jet, Phase<Jet>) {
        self.moment_of_all(from, tau, |phase| {
            phase[2 * bob + 1] / (self.jets.speeds(phase)[bob] * phase[2 * bob])
        })
    }

    /// The moment at which something vanishes, by Newton's method on polynomials.
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
