//! The pendulum of a clicked sample and its twin one sample away.

use flipmap_engine::EventSpec;
use flipmap_pendulum::{Outcome, Status};
use flipmap_screen::flight::{Flight, SLICE, Trail};
use flipmap_screen::pin_start::PinStart;
use wasm_bindgen::prelude::*;

/// A pendulum in flight beside its twin, followed in double-double.
#[wasm_bindgen]
pub struct TwinFlight {
    flight: Flight,
    trail: Trail,
    lengths: [f64; 2],
}

#[wasm_bindgen]
impl TwinFlight {
    /// Integrates for at most about this many milliseconds; returns true while more is to come.
    pub fn advance(&mut self, milliseconds: f64) -> bool {
        for _ in 0..(milliseconds / 1e3 / SLICE.as_secs_f64()).ceil() as usize {
            self.flight.receive();
        }
        self.is_flying()
    }

    fn is_flying(&self) -> bool {
        self.flight.record().ending.is_none()
    }

    /// The time in s up to which the motion is known.
    pub fn end_secs(&self) -> f64 {
        self.flight.record().end_secs()
    }

    /// θ1 and θ2 in rad of the pendulum and then of its twin, at a moment within the known motion.
    pub fn at(&self, secs: f64) -> Vec<f64> {
        let record = self.flight.record();
        let secs = secs.clamp(0.0, record.end_secs());
        let states = [&record.own, &record.ghost].map(|track| track.motion.state_at(secs));
        states.into_iter().flatten().flat_map(|state| state.angle).collect()
    }

    /// Both lengths in m.
    pub fn lengths(&self) -> Vec<f64> {
        self.lengths.to_vec()
    }

    /// The moment of the flip in s; NaN as long as none is known.
    pub fn flip_secs(&self) -> f64 {
        match self.flight.outcome() {
            Some(Outcome { status: Status::Answered, time }) => time.hi,
            _ => f64::NAN,
        }
    }

    /// The places of the second bob over the last moments before `secs`, in m from the pivot, x to
    /// the right and y up, the oldest first.
    pub fn trail(&mut self, secs: f64) -> Vec<f64> {
        self.trail.follow(&self.flight.record().own.motion, secs);
        let [l1, l2] = self.lengths;
        let place = |[first, second]: [f64; 2]| {
            [l1 * first.sin() + l2 * second.sin(), -l1 * first.cos() - l2 * second.cos()]
        };
        self.trail.points().flat_map(|(angle, _)| place(angle)).collect()
    }

    /// What becomes of the pendulum, in a sentence or two.
    pub fn words(&self) -> String {
        let told = |outcome: Option<Outcome<_>>, who: &str| match outcome {
            None if self.is_flying() => format!("{who} is still being followed"),
            None => format!("{who} was followed for {:.0} s without a flip", self.end_secs()),
            Some(Outcome { status: Status::Answered, time }) => {
                let secs: flipmap_numbers::Dd = time;
                format!("{who} flips after {:.4} s", secs.hi)
            }
            Some(Outcome { status: Status::Forbidden, .. }) => {
                format!("{who} has too little energy ever to flip")
            }
            Some(Outcome { status: Status::Failed, .. }) => {
                format!("{who} could not be followed to the end")
            }
            Some(Outcome { status: Status::Unflipped, .. }) => {
                format!("{who} does not flip within {} s", self.flight.question().budget_secs)
            }
        };
        let own = told(self.flight.outcome(), "It");
        format!("{own}; {}.", told(self.flight.ghost_outcome(), "its twin, one pixel away,"))
    }
}

impl TwinFlight {
    /// Releases the pendulum of a start and its twin.
    pub(crate) fn new(question: EventSpec, start: &PinStart) -> Self {
        let lengths = question.build.lengths.map(|length| length.value());
        TwinFlight {
            flight: Flight::without_thread(question, start.launches),
            trail: Trail::new(&question.build.pendulum()),
            lengths,
        }
    }
}
