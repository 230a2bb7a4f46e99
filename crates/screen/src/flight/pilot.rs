//! The work of a flight's thread: it integrates a pendulum and its ghost side by side and hands the
//! results over piece by piece.

use std::time::Duration;

use super::record::{FlightEnding, Flip, Record, Track};
use flipmap_engine::EventSpec;
use flipmap_engine::clock::Instant;
use flipmap_numbers::{Dd, Scalar};
use flipmap_pendulum::separation::{Reading, Ruler};
use flipmap_pendulum::taylor::{Orbit, TaylorStep};
use flipmap_pendulum::{Launch, Pendulum, Rule, State, oracle};

/// Time for which results are gathered before they are handed over: about a frame.
const GATHERED: Duration = Duration::from_millis(16);
/// Greatest number of steps stored of one motion: seven minutes of the home pendulum, in 6 MiB.
pub(crate) const MAX_STEPS: usize = 20_000;

/// Integrates a pendulum from the first start and its ghost from the second up to `until_secs`;
/// stops as soon as `hand_over` returns false.
pub(crate) fn fly(
    question: &EventSpec,
    starts: [Launch; 2],
    until_secs: f64,
    mut hand_over: impl FnMut(Record) -> bool,
) {
    let mut pair = GhostPair::new(question, starts, until_secs);
    loop {
        let part = pair.part(GATHERED);
        let ended = part.ending.is_some();
        if !hand_over(part) || ended {
            return;
        }
    }
}

/// One pendulum in flight, recorded as it goes.
#[derive(Debug)]
struct Flyer {
    orbit: Orbit<Dd>,
    /// The rule, while it can still be met.
    rule: Option<Rule>,
    steps: usize,
}

impl Flyer {
    /// Releases a pendulum, exactly as the gold standard does.
    fn new(pendulum: Pendulum<Dd>, start: Launch, rule: Rule) -> Self {
        let rule = (!is_forbidden(&pendulum, start, rule)).then_some(rule);
        let Launch { angle, speed } = start;
        let state = oracle::settled(&pendulum, &State { angle, speed });
        Flyer { orbit: Orbit::new(pendulum, state), rule, steps: 0 }
    }

    /// Advances by one step and records it in `track` up to `until`; none if a value is not finite.
    fn step(&mut self, track: &mut Track, until: Dd) -> Option<TaylorStep<Dd>> {
        let step = self.orbit.step();
        self.steps += 1;
        if !self.orbit.state().speed[1].is_finite() {
            return None;
        }
        if let Some(flip) = self.rule.and_then(|rule| flip_within(&step, rule)) {
            self.rule = None;
            track.flip = Some(flip);
        }
        track.motion.push(&step, until.hi);
        Some(step)
    }
}

/// Returns true if energy forbids a start ever to flip.
pub(crate) fn is_forbidden(pendulum: &Pendulum<Dd>, start: Launch, rule: Rule) -> bool {
    match rule {
        Rule::Neither => false,
        _ if start.is_at_rest() => pendulum.forbids(rule, start.angle),
        _ => pendulum.forbids_launch(rule, &start),
    }
}

/// Returns the first flip within a step, by the gold standard's own test.
fn flip_within(step: &TaylorStep<Dd>, rule: Rule) -> Option<Flip> {
    let of_bob = |&bob: &usize| {
        let tau = oracle::flip_within(step, [Rule::First, Rule::Second][bob])?;
        Some(Flip { bob, secs: step.start + tau })
    };
    let earlier = |a: Flip, b: Flip| if b.secs < a.secs { b } else { a };
    rule.watched().iter().filter_map(of_bob).reduce(earlier)
}

/// The pendulum, its ghost, and the reference values of their readings.
#[derive(Debug)]
pub(crate) struct GhostPair {
    own: Flyer,
    ghost: Flyer,
    ghost_step: Option<TaylorStep<Dd>>,
    until: Dd,
    pendulum: Pendulum<Dd>,
    energy: Dd,
    ruler: Ruler,
    /// True before the reading at the release has been handed over.
    begins: bool,
}

impl GhostPair {
    /// Releases a pendulum at the first start and its ghost at the second, to be followed up to
    /// `until_secs`.
    pub(crate) fn new(question: &EventSpec, starts: [Launch; 2], until_secs: f64) -> Self {
        let pendulum: Pendulum<Dd> = question.build.pendulum_in();
        let [own, ghost] = starts.map(|start| Flyer::new(pendulum, start, question.rule));
        GhostPair {
            energy: pendulum.energy(own.orbit.state()),
            own,
            ghost,
            ghost_step: None,
            until: Dd::new(until_secs),
            pendulum,
            ruler: Ruler::new(&question.build.pendulum()),
            begins: true,
        }
    }

    /// Integrates for about `time` and returns the part of the record that this adds.
    pub(crate) fn part(&mut self, time: Duration) -> Record {
        let mut part = Record::default();
        if std::mem::take(&mut self.begins) {
            part.readings.push(self.reading_at_release());
        }
        let begun = Instant::now();
        while part.ending.is_none() && begun.elapsed() < time {
            part.ending = self.advance(&mut part);
        }
        part
    }

    /// Advances the pendulum by a step and the ghost at least as far, then takes a reading; returns
    /// the reason if the record ends here.
    fn advance(&mut self, fresh: &mut Record) -> Option<FlightEnding> {
        let Some(step) = self.own.step(&mut fresh.own, self.until) else {
            return Some(FlightEnding::NotFinite);
        };
        let moment = if step.end() < self.until { step.end() } else { self.until };
        while self.ghost_step.as_ref().is_none_or(|latest| latest.end() < moment) {
            self.ghost_step = self.ghost.step(&mut fresh.ghost, self.until);
            if self.ghost_step.is_none() {
                return Some(FlightEnding::NotFinite);
            }
        }
        let beside = self.ghost_step.as_ref().expect("the loop ends with a step");
        let states = [step.state(moment - step.start), beside.state(moment - beside.start)];
        fresh.readings.push(self.reading(moment, &states));
        if moment >= self.until {
            return Some(FlightEnding::Complete);
        }
        (self.own.steps.max(self.ghost.steps) >= MAX_STEPS).then_some(FlightEnding::Full)
    }

    /// Returns the reading at the release, with which a record begins.
    fn reading_at_release(&self) -> Reading {
        self.reading(Dd::new(0.0), &[*self.own.orbit.state(), *self.ghost.orbit.state()])
    }

    fn reading(&self, time: Dd, [own, ghost]: &[State<Dd>; 2]) -> Reading {
        let scale = self.pendulum.p + self.pendulum.q;
        let rise = self.pendulum.energy(own) - self.energy;
        Reading {
            secs: time.hi,
            energy_error: if scale.hi > 0.0 { (rise / scale).hi } else { 0.0 },
            separation_rad: self.ruler.distance(own, ghost),
        }
    }
}
