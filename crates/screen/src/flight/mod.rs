//! A flight: the pendulum of a pixel together with a ghost, the pendulum one pixel away.
//!
//! Both are integrated by the gold standard in double-double, on a thread of the flight's own or,
//! where there are no threads, a little at every call, so that the flight shows exactly the pixel's
//! outcome. A thread hands over its results as it goes and wakes whoever shows them; they are stored
//! as polynomials ([`motion`]), so that any moment can be shown at once. [`playback`] is the clock
//! that sets the moment to show.

mod agreement;
pub mod motion;
mod pilot;
pub mod playback;
pub mod record;
pub mod trail;

use std::sync::mpsc::{self, Receiver, TryRecvError};
use std::time::Duration;

pub use self::agreement::Agreement;
use self::pilot::GhostPair;
pub use self::playback::Playback;
pub use self::record::{FlightEnding, Record, Track};
pub use self::trail::Trail;
use flipmap_engine::EventSpec;
use flipmap_numbers::Dd;
use flipmap_pendulum::{Launch, Outcome, Pendulum, Status};

/// Shortest simulated duration of a flight, whatever the budget, in seconds.
pub const MIN_SECS: f64 = 30.0;

/// One flight, as far as it has come.
#[derive(Debug)]
pub struct Flight {
    question: EventSpec,
    /// True for the pendulum and for its ghost, each if it can never flip.
    forbidden: [bool; 2],
    record: Record,
    pilot: Pilot,
}

/// The integration of a flight.
#[derive(Debug)]
enum Pilot {
    /// A thread integrates.
    Elsewhere(Receiver<Record>),
    /// Every call of [`Flight::receive`] integrates for a while.
    Here(Box<GhostPair>),
}

/// Time for which a call of [`Flight::receive`] integrates where there are no threads.
pub const SLICE: Duration = Duration::from_millis(5);

impl Flight {
    /// Releases a pendulum at the first start and its ghost at the second. The flight's thread
    /// calls `wake` whenever [`Flight::receive`] has something to take. The thread ends with the
    /// flight, or soon after the flight is dropped.
    pub fn launch(
        question: EventSpec,
        starts: [Launch; 2],
        wake: impl Fn() + Send + 'static,
    ) -> Flight {
        let (sender, incoming) = mpsc::channel();
        let until_secs = question.budget_secs.max(MIN_SECS);
        let fly = move || {
            pilot::fly(&question, starts, until_secs, |part| {
                let wanted = sender.send(part).is_ok();
                wake();
                wanted
            });
        };
        // Without a thread the sender is dropped, and `receive` reports the flight as broken off.
        if let Err(error) = std::thread::Builder::new().name("flight".into()).spawn(fly) {
            log::error!("no thread for a flight: {error}");
        }
        Flight::of(question, starts, Pilot::Elsewhere(incoming))
    }

    /// Releases a pendulum at the first start and its ghost at the second, where there are no threads:
    /// [`Flight::receive`] integrates them, a little at every call.
    pub fn without_thread(question: EventSpec, starts: [Launch; 2]) -> Flight {
        let until_secs = question.budget_secs.max(MIN_SECS);
        let pair = GhostPair::new(&question, starts, until_secs);
        Flight::of(question, starts, Pilot::Here(Box::new(pair)))
    }

    fn of(question: EventSpec, starts: [Launch; 2], pilot: Pilot) -> Flight {
        let exact: Pendulum<Dd> = question.build.pendulum_in();
        let forbidden = starts.map(|start| pilot::is_forbidden(&exact, start, question.rule));
        Flight { question, forbidden, record: Record::default(), pilot }
    }

    /// Takes the parts handed over since the last call; returns true if there were any.
    pub fn receive(&mut self) -> bool {
        let mut any = false;
        while self.record.ending.is_none() {
            let part = match &mut self.pilot {
                Pilot::Here(pair) => Ok(pair.part(SLICE)),
                Pilot::Elsewhere(incoming) => incoming.try_recv(),
            };
            match part {
                Ok(part) => self.record.append(part),
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => {
                    self.record.ending = Some(FlightEnding::BrokenOff)
                }
            }
            any = true;
            if let Pilot::Here(_) = self.pilot {
                break;
            }
        }
        any
    }

    /// Returns the record so far.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Returns the flight's question.
    pub fn question(&self) -> &EventSpec {
        &self.question
    }

    /// Returns the gold standard's outcome of the pixel, bit for bit; none until it is known.
    pub fn outcome(&self) -> Option<Outcome<Dd>> {
        self.outcome_of(&self.record.own, self.forbidden[0])
    }

    /// Returns the gold standard's outcome of the neighbouring pixel.
    pub fn ghost_outcome(&self) -> Option<Outcome<Dd>> {
        self.outcome_of(&self.record.ghost, self.forbidden[1])
    }

    fn outcome_of(&self, track: &Track, forbidden: bool) -> Option<Outcome<Dd>> {
        if forbidden {
            return Some(Outcome::without_time(Status::Forbidden));
        }
        let budget = Dd::new(self.question.budget_secs);
        match track.flip {
            Some(flip) if flip.secs <= budget => Some(Outcome::flipped(flip.secs)),
            _ if track.motion.end_secs() >= budget.hi => {
                Some(Outcome::without_time(Status::Unflipped))
            }
            _ if self.record.ending == Some(FlightEnding::NotFinite) => {
                Some(Outcome::without_time(Status::Failed))
            }
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::time::{Duration, Instant};

    use super::*;
    use flipmap_numbers::Decimal;
    use flipmap_pendulum::{Rule, State, oracle, taylor::Orbit};
    use flipmap_scene::{PendulumSpec, Scene};

    fn question(rule: Rule, budget_secs: f64) -> EventSpec {
        EventSpec { rule, budget_secs, ..EventSpec::from(&Scene::default()) }
    }

    /// A start and its neighbour, 1e-3 rad away.
    fn pair(start: [Dd; 2]) -> [[Dd; 2]; 2] {
        [start, [start[0] - Dd::new(1e-3), start[1]]]
    }

    fn complete(question: EventSpec, starts: [[Dd; 2]; 2]) -> Flight {
        flown(question, starts.map(Launch::at_rest))
    }

    fn flown(question: EventSpec, starts: [Launch; 2]) -> Flight {
        let mut flight = Flight::launch(question, starts, || ());
        let begun = Instant::now();
        while flight.record().ending.is_none() {
            assert!(begun.elapsed() < Duration::from_secs(60), "the flight never ends");
            flight.receive();
            std::thread::sleep(Duration::from_millis(1));
        }
        flight
    }

    fn oracle_of(question: &EventSpec, start: [Dd; 2]) -> Outcome<Dd> {
        let pendulum: Pendulum<Dd> = question.build.pendulum_in();
        oracle::outcome(&pendulum, start, question.rule, Dd::new(question.budget_secs))
    }

    #[test]
    fn it_says_what_the_gold_standard_says_bit_for_bit() {
        let dd = |angle: [f64; 2]| angle.map(Dd::new);
        let starts = [
            dd([2.2, 1.4]),
            dd([3.0, 3.0]),
            dd([-2.0, 3.0]),
            dd([0.5, 0.5]),
            [Dd::new(2.0), Dd::PI],
            [Dd::PI, Dd::PI],
            [Dd::PI, Dd::new(1.0)],
        ];
        let mut seen = Vec::new();
        for rule in [Rule::Second, Rule::First, Rule::Either] {
            for start in starts {
                let question = question(rule, 6.0);
                let pair = pair(start);
                let (flight, [expected, beside]) =
                    (complete(question, pair), pair.map(|angle| oracle_of(&question, angle)));
                assert_eq!(flight.outcome(), Some(expected), "{rule} {start:?}");
                assert_eq!(flight.ghost_outcome(), Some(beside), "{rule} beside {start:?}");
                seen.push(expected.status);
            }
        }
        for status in [Status::Answered, Status::Unflipped, Status::Forbidden] {
            assert!(seen.contains(&status), "{status:?} is not among them");
        }
    }

    #[test]
    fn every_moment_is_that_of_the_orbit_and_energy_is_kept() {
        let flight = complete(question(Rule::Second, 5.0), pair([2.2, 1.4].map(Dd::new)));
        let record = flight.record();
        assert_eq!((record.ending, record.end_secs()), (Some(FlightEnding::Complete), MIN_SECS));
        let pendulum: Pendulum<Dd> = flight.question().build.pendulum_in();
        let mut orbit = Orbit::new(pendulum, State::rest([2.2, 1.4].map(Dd::new)));
        for i in 0..=300 {
            let secs = f64::from(i) / 10.0;
            let (truth, kept) = (
                orbit.state_at(Dd::new(secs)),
                record.own.motion.state_at(secs).expect("complete"),
            );
            assert!((truth.angle[1].hi - kept.angle[1]).abs() < 1e-12, "at {secs}");
        }
        let worst = record.readings.iter().map(|r| r.energy_error.abs()).fold(0.0, f64::max);
        assert!(worst > 0.0 && worst < 1e-27, "{worst:e}");
    }

    #[test]
    fn neighbours_part_faster_where_there_is_chaos() {
        let growth = |start: [f64; 2]| {
            let start = start.map(Dd::new);
            let beside = [start[0] + Dd::new(1e-9), start[1]];
            let flight = complete(question(Rule::Second, 1.0), [start, beside]);
            let readings = &flight.record().readings;
            assert!((readings[0].separation_rad / 1e-9 - 1.0).abs() < 1e-6);
            flipmap_pendulum::separation::Growth::fit(readings).expect("a line").rate_per_sec
        };
        let (chaotic, regular) = (growth([2.2, 1.4]), growth([0.1, 0.1]));
        assert!(chaotic > 1.0 && regular.abs() < 0.1, "{chaotic} {regular}");
    }

    #[test]
    fn without_gravity_and_in_balance_nothing_moves() {
        let weightless = PendulumSpec { gravity: Decimal::from(0.0), ..PendulumSpec::default() };
        let floating = EventSpec { build: weightless, ..question(Rule::Second, 40.0) };
        for (question, start, status) in [
            (floating, [2.2, 1.4].map(Dd::new), Status::Forbidden),
            (question(Rule::Second, 40.0), [Dd::PI, Dd::PI], Status::Unflipped),
        ] {
            let flight = complete(question, pair(start));
            let record = flight.record();
            assert_eq!(record.own.motion.end_secs(), 40.0);
            let state = record.own.motion.state_at(39.9).expect("kept to the end");
            assert_eq!(state, State::rest(start.map(|theta| theta.hi)));
            assert_eq!(flight.outcome().expect("known").status, status);
            assert!(record.readings.iter().all(|reading| reading.energy_error == 0.0));
        }
    }

    #[test]
    fn a_forbidden_start_flies_all_the_same() {
        let flight = complete(question(Rule::Second, 10.0), pair([0.5, 0.5].map(Dd::new)));
        let moved = flight.record().own.motion.state_at(1.0).expect("complete").angle[0];
        assert!((moved - 0.5).abs() > 0.1 && flight.record().own.flip.is_none());
    }

    #[test]
    fn a_thrown_pendulum_flies_with_its_speeds_and_flips_as_the_gold_standard_says() {
        let question = question(Rule::Second, 6.0);
        let pendulum: Pendulum<Dd> = question.build.pendulum_in();
        let start = Launch { angle: [0.3, -0.2].map(Dd::new), speed: [3.0, 7.0].map(Dd::new) };
        let flight = flown(question, [start; 2]);
        let Launch { angle, speed } = start;
        let mut orbit = Orbit::new(pendulum, State { angle, speed });
        let kept = flight.record().own.motion.state_at(0.7).expect("complete");
        let truth = orbit.state_at(Dd::new(0.7));
        assert!((truth.angle[1].hi - kept.angle[1]).abs() < 1e-12);
        assert!((kept.angle[1] + 0.2).abs() > 1.0, "it moves fast");
        let flip = flight.outcome().expect("known");
        assert_eq!(flip.status, Status::Answered);
        assert!(flip.time.hi > 0.0 && flip.time.hi < 6.0);
        let slow = Launch { speed: [0.1, 0.1].map(Dd::new), ..start };
        let forbidden = flown(question, [slow; 2]).outcome().expect("known");
        assert_eq!(forbidden.status, Status::Forbidden);
    }

    #[test]
    fn a_huge_budget_ends_where_memory_does_and_a_dropped_flight_stops() {
        let fast = PendulumSpec { gravity: Decimal::from(1e6), ..PendulumSpec::default() };
        let long = EventSpec { build: fast, ..question(Rule::Second, 1e6) };
        let start = [0.3, 0.2].map(Dd::new);
        let flight = complete(long, pair(start));
        assert_eq!(flight.record().ending, Some(FlightEnding::Full));
        assert!(flight.record().own.motion.len() <= pilot::MAX_STEPS);
        assert_eq!(flight.outcome().map(|outcome| outcome.status), Some(Status::Forbidden));

        let wakes = Arc::new(AtomicUsize::new(0));
        let counted = wakes.clone();
        let flight = Flight::launch(long, [Launch::at_rest(start); 2], move || {
            counted.fetch_add(1, Ordering::Relaxed);
        });
        drop(flight);
        let begun = Instant::now();
        while Arc::strong_count(&wakes) > 1 {
            assert!(begun.elapsed() < Duration::from_secs(1), "the thread goes on");
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
