//! A cell of starts carried by the flow as one polynomial: the start map of a deep zoom.
//!
//! Released from rest, the pendulums of a small cell stay together for long. Their states at a
//! time are polynomials in the place of the start within the cell ([`Jet`]), and those obey the
//! equations of motion: the same right-hand sides and steps that move one pendulum move all. A
//! sheet is followed until its polynomials no longer describe the whole cell; there it is cut
//! into quarters that go on, or its pixels' own integration begins.
//!
//! Passes of the top are found on the polynomials too. Where all of a sheet passes, the moment is
//! itself a polynomial. Where a bob turns round near the top, the height it reaches is one, and its
//! sign says who has flipped: a graze stays one clean line however deep it is looked at.

use super::embedded::{dop853, plus};
use super::flip::Rule;
use super::jet::Jet;
use super::passage::{Moment, crosses, crossing, turning_point};
use super::phase::Phase;
use super::reference::Reference;
use super::{Pendulum, Real};

/// What moves a sheet, in reduced units.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    /// The five numbers.
    pub pendulum: Pendulum<f64>,
    /// Which bob is watched.
    pub rule: Rule,
    jets: Pendulum<Jet>,
    inverse_scale: [f64; 2],
}

/// A cell of starts in motion.
#[derive(Clone, Debug)]
pub struct Sheet {
    /// Reduced time since the release, and what rounding took from it.
    pub time: (f64, f64),
    /// Unit vectors and momenta.
    pub phase: Phase<Jet>,
    /// The next step to try.
    pub step: f64,
    /// Turns near the top at which some of the cell flipped, in order.
    pub grazes: Vec<Graze>,
    /// Whether the middle is beyond the top with each bob, in a graze; never where its way ends.
    beyond: [bool; 2],
}

/// Where a sheet's way ended.
#[derive(Clone, Debug)]
pub enum End {
    /// Its polynomials do not describe it any longer.
    Spread,
    /// Something happens at the top that its polynomials cannot tell.
    Unclear,
    /// All that had not flipped flips in one passage.
    Passed(Box<Pass>),
    /// All of it has flipped in grazes.
    Grazed,
    /// The time is over.
    Over,
}

/// A passage of the top by all.
#[derive(Clone, Debug)]
pub struct Pass {
    /// When the middle passes, reduced.
    pub time: f64,
    /// How much later the others do.
    pub shift: Jet,
}

/// A bob's turn near the top.
#[derive(Clone, Debug)]
pub struct Graze {
    bob: usize,
    /// The sign of the bob's sine before it reaches the top.
    side: f64,
    time: f64,
    /// How much later than the middle's the others' turns are.
    shift: Jet,
    /// How far beyond the top they turn, rad (as a sine).
    height: Jet,
    /// The states at these turns.
    phase: Phase<Jet>,
}

/// Error allowed in a step of the middle. The polynomials' own errors are about as many times
/// their size.
const STEP_TOLERANCE: f64 = 1e-14;
/// No sheet moves farther in a step.
const LONGEST: f64 = 0.5;
/// A step in which two things happen at the top is halved, but not below this.
const SHORTEST: f64 = 1e-7;
/// A turn this many spreads below the top is no graze.
const NEAR: f64 = 8.0;
/// A middle nearer to the top than this is looked up in its reference.
const KNOWN_BY_F64: f64 = 1e-6;
/// Reduced time within which a pass that is nearly a graze must turn round.
const GRAZE_WITHIN: f64 = 1.0;

impl Law {
    /// Of a pendulum in any units.
    pub fn new(pendulum: &Pendulum<f64>, rule: Rule) -> Self {
        let (pendulum, _) = pendulum.reduced();
        let inverse_scale = pendulum.momentum_scale().map(|scale| 1.0 / scale);
        Law { pendulum, rule, jets: pendulum.map(Jet::constant), inverse_scale }
    }

    fn moment(&self, phase: Phase<f64>) -> Moment<f64> {
        Moment { phase, speed: self.pendulum.speeds(&phase) }
    }

    /// One pendulum's state after a step and the error of that.
    fn moved(&self, phase: &Phase<f64>, step: f64) -> (Phase<f64>, f64) {
        let trial = dop853(&self.pendulum, self.inverse_scale, phase, step);
        (plus(phase, &trial.change), trial.error_squared.sqrt())
    }

    /// All states after a step that may itself differ from start to start.
    fn carried(&self, phase: &Phase<Jet>, step: Jet) -> Phase<Jet> {
        let scale = self.inverse_scale.map(Jet::constant);
        plus(phase, &dop853(&self.jets, scale, phase, step).change)
    }

    /// The largest part that a state's polynomials leave out.
    fn tail(&self, phase: &Phase<Jet>) -> f64 {
        let unit = |i: usize| if i < 4 { 1.0 } else { self.inverse_scale[i - 4] };
        (0..6).map(|i| phase[i].tail() * unit(i)).fold(0.0, f64::max)
    }

    /// dω/dt of a bob.
    fn acceleration(&self, phase: &Phase<Jet>, bob: usize) -> Jet {
        let [x1, y1, x2, y2, ..] = *phase;
        let speed = self.jets.speeds(phase);
        self.jets.acceleration_towards([(y1, x1), (y2, x2)], speed)[bob]
    }
}

/// The six in the middle.
fn middle(phase: &Phase<Jet>) -> Phase<f64> {
    phase.map(|jet| jet.middle())
}

impl Sheet {
    /// A cell around `angle` (rad; its sines and cosines as precise as they can be) let go at rest.
    pub fn release(sin_cos: [(f64, f64); 2], half: f64) -> Self {
        let [(y1, x1), (y2, x2)] = [0, 1].map(|axis| turned(sin_cos[axis], axis, half));
        let zero = Jet::constant(0.0);
        let phase = [x1, y1, x2, y2, zero, zero];
        Sheet {
            time: (0.0, 0.0),
            phase,
            step: super::control::FIRST,
            grazes: Vec::new(),
            beyond: [false; 2],
        }
    }

    /// How far apart its states are, at most: unit vectors and scaled momenta.
    pub fn spread(&self, law: &Law) -> f64 {
        let unit = |i: usize| if i < 4 { 1.0 } else { law.inverse_scale[i - 4] };
        (0..6).map(|i| self.phase[i].spread() * unit(i)).fold(0.0, f64::max)
    }

    /// The quarter of it around `middle`, of which [`Sheet::settled`] may be true.
    pub fn part(&self, middle: [f64; 2], half: f64) -> Self {
        let graze = |graze: &Graze| Graze {
            shift: graze.shift.part(middle, half),
            height: graze.height.part(middle, half),
            phase: graze.phase.map(|jet| jet.part(middle, half)),
            ..*graze
        };
        let grazes = self.grazes.iter().map(graze).filter(Graze::concerns_any).collect();
        Sheet { phase: self.phase.map(|jet| jet.part(middle, half)), grazes, ..*self }
    }

    /// Whether all of it has flipped.
    pub fn settled(&self) -> bool {
        self.grazes.iter().any(Graze::concerns_all)
    }

    /// Whether it is described well enough where it is.
    pub fn holds(&self, law: &Law, tolerance: f64) -> bool {
        law.tail(&self.phase) <= tolerance
    }

    /// Follows the flow until its `end`, at most to `budget`, as long as its polynomials leave
    /// out no more than `tolerance`; along a reference where there is one.
    pub fn follow(
        &mut self,
        law: &Law,
        budget: f64,
        tolerance: f64,
        mut reference: Option<&mut (dyn Reference + 'static)>,
    ) -> End {
        // Where the way may end: no start is at the top with any bob, so that what has passed is
        // told by events alone.
        let mut clear = self.clone();
        let mut pass_began: Option<f64> = None;
        let end = loop {
            if self.settled() {
                return End::Grazed;
            }
            let is_clear = pass_began.is_none() && self.is_clear(law);
            if is_clear {
                clear.clone_from(self);
                if self.time.0 >= budget {
                    break End::Over;
                }
            }
            if pass_began.is_some_and(|began| self.time.0 > began + GRAZE_WITHIN) {
                break End::Unclear;
            }
            let leap = self.leap(law, reference.as_deref_mut());
            let tail = law.tail(&leap.after);
            if tail.is_nan() || tail > tolerance {
                break End::Spread;
            }
            match self.meet(law, &leap, tolerance, reference.as_deref()) {
                Meeting::Nothing => {}
                Meeting::TooMuch => {
                    self.step = leap.length * 0.5;
                    continue;
                }
                Meeting::Unclear => break End::Unclear,
                Meeting::Pass(pass) => return End::Passed(pass),
                Meeting::NearlyGraze(bob) => {
                    pass_began = Some(self.time.0);
                    self.beyond[bob] = true;
                }
                Meeting::Back(bob) => self.beyond[bob] = false,
                Meeting::Graze(graze, beyond) => {
                    pass_began = None;
                    self.beyond[graze.bob] = beyond;
                    self.grazes.extend(graze.concerns_any().then_some(*graze));
                }
            }
            self.take(leap, reference.as_deref_mut());
        };
        *self = clear;
        end
    }

    /// Whether none of it is at the top with a watched bob, or beyond it.
    fn is_clear(&self, law: &Law) -> bool {
        law.rule.watched().iter().all(|&bob| {
            let (x, y) = (&self.phase[2 * bob], &self.phase[2 * bob + 1]);
            x.middle() > 0.0 || (y.middle().abs() > y.spread() && !self.beyond[bob])
        })
    }

    /// The next step, as long as the middle allows it.
    fn leap(&self, law: &Law, reference: Option<&mut (dyn Reference + 'static)>) -> Leap {
        let start = middle(&self.phase);
        let (mut length, mut next) = (self.step.min(LONGEST), self.step);
        let mut reference = reference;
        if let Some(reference) = &mut reference {
            length = length.min(reference.reach());
        }
        let mut after = law.moved(&start, length);
        for _ in 0..20 {
            let factor = 0.8 * (STEP_TOLERANCE / after.1.max(1e-30)).powf(1.0 / 8.0);
            let fits = factor >= 0.8;
            next = length * factor.clamp(0.2, 3.0);
            if fits || length < SHORTEST {
                break;
            }
            length = next;
            after = law.moved(&start, length);
        }
        let mut carried = law.carried(&self.phase, Jet::constant(length));
        if let Some(reference) = reference {
            let known = reference.phase(length);
            carried = std::array::from_fn(|i| carried[i].with_middle(known[i]));
        }
        // What was cut short by the reference says little about the next one.
        let next = if length < 0.5 * self.step { next.max(self.step) } else { next };
        Leap { length, next, after: carried }
    }

    fn take(&mut self, leap: Leap, reference: Option<&mut (dyn Reference + 'static)>) {
        if let Some(reference) = reference {
            reference.advance(leap.length);
        }
        self.phase = leap.after;
        self.time = self.time.0.fast_two_sum(self.time.1 + leap.length);
        self.step = leap.next;
    }

    /// What happens at the top within a leap.
    fn meet(
        &self,
        law: &Law,
        leap: &Leap,
        tolerance: f64,
        reference: Option<&(dyn Reference + 'static)>,
    ) -> Meeting {
        let (before, after) = (law.moment(middle(&self.phase)), law.moment(middle(&leap.after)));
        let mut meetings = Vec::new();
        for &bob in law.rule.watched() {
            let (x0, x1) = (before.phase[2 * bob], after.phase[2 * bob]);
            if x0 >= 0.0 && x1 >= 0.0 {
                continue;
            }
            let turns = before.speed[bob] * after.speed[bob] < 0.0;
            let passes = crosses(&before, &after, bob);
            if turns && passes && leap.length > SHORTEST {
                return Meeting::TooMuch;
            }
            if turns {
                meetings.extend(self.turn(law, leap, bob, tolerance, reference));
            } else if passes {
                meetings.push(self.pass(law, leap, bob, tolerance));
            }
        }
        match meetings.len() {
            0 => Meeting::Nothing,
            1 => meetings.remove(0),
            _ if leap.length > SHORTEST => Meeting::TooMuch,
            _ => Meeting::Unclear,
        }
    }

    /// A bob that turns round within a leap, if that is near the top.
    fn turn(
        &self,
        law: &Law,
        leap: &Leap,
        bob: usize,
        tolerance: f64,
        reference: Option<&(dyn Reference + 'static)>,
    ) -> Option<Meeting> {
        let start = middle(&self.phase);
        let at = |fraction: f64| law.moment(law.moved(&start, leap.length * fraction).0);
        let (before, after) = (at(0.0), law.moment(middle(&leap.after)));
        let (fraction, there) = turning_point(&at, bob, &before, &after);
        let spread = self.phase[2 * bob + 1].spread().max(leap.after[2 * bob + 1].spread());
        let tau = leap.length * fraction;
        // Deep down the spread is far below what f64 knows of the middle.
        let sine = match reference {
            Some(reference) if there.phase[2 * bob + 1].abs() < KNOWN_BY_F64 => {
                reference.turn(bob, tau)
            }
            _ => there.phase[2 * bob + 1],
        };
        if there.phase[2 * bob] >= 0.0 || sine.abs() > NEAR * spread {
            // A pass that was nearly a graze, and turned round far beyond.
            return self.beyond[bob].then_some(Meeting::Unclear);
        }
        let (shift, phase) = law.turn_of_all(&self.phase, tau, bob);
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
            Meeting::Graze(Box::new(Graze { bob, side, time, shift, height, phase }), beyond)
        } else {
            Meeting::Unclear
        })
    }

    /// The middle's bob passes the top within a leap.
    fn pass(&self, law: &Law, leap: &Leap, bob: usize, tolerance: f64) -> Meeting {
        let start = middle(&self.phase);
        let at = |fraction: f64| law.moment(law.moved(&start, leap.length * fraction).0);
        let (before, after) = (at(0.0), law.moment(middle(&leap.after)));
        let (fraction, there) = crossing(&at, bob, &before, (1.0, after), leap.length);
        if there.phase[2 * bob] >= 0.0 {
            return Meeting::Nothing;
        }
        if self.beyond[bob] {
            return Meeting::Back(bob);
        }
        let tau = leap.length * fraction;
        let (shift, phase) = law.pass_of_all(&self.phase, tau, bob);
        let speed = law.jets.speeds(&phase)[bob];
        let clear = shift.tail() <= TIME_TOLERANCE.min(tolerance.sqrt())
            && speed.spread() < 0.5 * speed.middle().abs();
        if clear {
            Meeting::Pass(Box::new(Pass { time: self.time.0 + (self.time.1 + tau), shift }))
        } else {
            Meeting::NearlyGraze(bob)
        }
    }
}

/// Errors in the moment of a passage, reduced time: well below what is called right.
const TIME_TOLERANCE: f64 = 1e-6;

/// A step that may be taken.
struct Leap {
    length: f64,
    next: f64,
    after: Phase<Jet>,
}

/// What a leap meets at the top.
enum Meeting {
    Nothing,
    /// Two things at once.
    TooMuch,
    Unclear,
    /// All pass.
    Pass(Box<Pass>),
    /// The middle passes so slowly that others may turn round before.
    NearlyGraze(usize),
    /// The middle comes back from a graze.
    Back(usize),
    /// Some may flip in a turn, after which the middle is beyond the top or not.
    Graze(Box<Graze>, bool),
}

/// Newton's iterations that make a polynomial right to its last degree: each doubles it.
const NEWTON_STEPS: usize = 3;

impl Law {
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

impl Graze {
    fn concerns_any(&self) -> bool {
        self.height.middle() + self.height.spread() >= 0.0
    }

    fn concerns_all(&self) -> bool {
        self.height.middle() > self.height.spread()
    }

    /// When the start at a point of the cell flips, reduced, if it does in this graze.
    pub fn flip(&self, law: &Law, at: [f64; 2]) -> Option<f64> {
        let height = self.height.at(at);
        if height < 0.0 {
            return None;
        }
        let phase = self.phase.map(|jet| jet.at(at));
        let turn = self.time + self.shift.at(at);
        Some(turn - self.rise(law, phase, height))
    }

    /// How long before its turn a bob that rises `height` beyond the top has passed it.
    fn rise(&self, law: &Law, mut phase: Phase<f64>, height: f64) -> f64 {
        let (x, y) = (2 * self.bob, 2 * self.bob + 1);
        // As high as its own polynomial says, which knows it to more digits.
        phase[y] = -self.side * height;
        let [x1, y1, x2, y2, ..] = phase;
        let speed = law.pendulum.speeds(&phase);
        let pull = law.pendulum.acceleration_towards([(y1, x1), (y2, x2)], speed)[self.bob];
        let mut back = (2.0 * height / pull.abs()).sqrt();
        for _ in 0..6 {
            let (then, _) = law.moved(&phase, -back);
            let rate = law.pendulum.speeds(&then)[self.bob] * then[x];
            if rate == 0.0 {
                break;
            }
            back += then[y] / rate;
        }
        back
    }
}

/// Cosine and sine of an angle that varies along an axis of the cell, from those of its middle.
fn turned((sin, cos): (f64, f64), axis: usize, half: f64) -> (Jet, Jet) {
    let by = Jet::coordinate(axis, half);
    let one = Jet::constant(1.0);
    // 1 − by²/2 (1 − by²/12 (1 − by²/30)) and the like, to the degree that is kept.
    let square = by * by;
    let nested = |divisors: &[f64]| {
        let less = |sum, divisor: &f64| one - square * Jet::constant(1.0 / divisor) * sum;
        divisors.iter().rev().fold(one, less)
    };
    let (cos_by, sin_by) = (nested(&[2.0, 12.0, 30.0]), by * nested(&[6.0, 20.0]));
    let (s, c) = (Jet::constant(sin), Jet::constant(cos));
    (s * cos_by + c * sin_by, c * cos_by - s * sin_by)
}
