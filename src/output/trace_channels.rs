//! The columns that a question adds to a trace: its channels so far, at the time of each row.

use crate::engine::start::whole_turns;
use crate::physics::passes::Pass;
use crate::physics::phase::{Phase, distance};
use crate::physics::tangents::TangentMap;
use crate::physics::{Dd, Pendulum, State};
use crate::question::Ask;
use crate::scene::Scene;

/// A question's findings about a pendulum so far.
pub(super) struct TraceChannels {
    ask: Ask,
    /// The pendulum in reduced units, and its unit of time in s.
    pendulum: Pendulum<f64>,
    unit_secs: f64,
    start: Phase<f64>,
    passes: Vec<Pass>,
    /// Time and place of the last row, and the tangent map from the start to it.
    last: (f64, Phase<f64>),
    map: TangentMap,
}

impl TraceChannels {
    /// The columns of a scene's question, for a pendulum at its start.
    pub(super) fn new(scene: &Scene, start: &State<Dd>) -> Self {
        let (pendulum, unit_secs) = scene.build.reduced_in::<Dd>();
        let (pendulum, unit_secs) = (pendulum.to_f64(), unit_secs.hi);
        let start = reduced_phase(&pendulum, unit_secs, start);
        TraceChannels {
            ask: scene.question.ask,
            pendulum,
            unit_secs,
            start,
            passes: Vec::new(),
            last: (0.0, start),
            map: TangentMap::identity(),
        }
    }

    /// Names of the columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let channels = self.ask.kind().channels;
        let added = match self.ask {
            Ask::Flip => &[][..],
            Ask::First | Ask::Flips | Ask::Growth => channels,
            // A trace has the angles and the speeds already.
            Ask::State => &channels[4..],
            Ask::Return => &channels[..1],
        };
        added.iter().map(|channel| channel.name)
    }

    /// Takes the passes of a step, before its rows.
    pub(super) fn add(&mut self, passes: &[Pass]) {
        self.passes.extend(passes);
    }

    /// The values at a time; NaN for those that are not there yet.
    pub(super) fn values(&mut self, time: Dd, state: &State<Dd>) -> Vec<f64> {
        let phase = || reduced_phase(&self.pendulum, self.unit_secs, state);
        match self.ask {
            Ask::Flip => Vec::new(),
            Ask::First => match self.passed(time).first() {
                Some(Pass { bob, time, .. }) => vec![*bob as f64, time.hi],
                None => vec![f64::NAN; 2],
            },
            Ask::Flips => self.counts(time).map(|count| count as f64).to_vec(),
            Ask::State => state.angle.map(|angle| f64::from(whole_turns(angle.hi))).to_vec(),
            Ask::Growth => vec![self.exponent(time.hi, phase())],
            Ask::Return => {
                let inverse_scale = self.pendulum.momentum_scale().map(|scale| 1.0 / scale);
                vec![distance(&phase(), &self.start, inverse_scale)]
            }
        }
    }

    /// The passes until a time.
    fn passed(&self, time: Dd) -> &[Pass] {
        &self.passes[..self.passes.partition_point(|pass| pass.time <= time)]
    }

    fn counts(&self, time: Dd) -> [usize; 4] {
        let of = |bob, left| {
            let counted = self.passed(time).iter();
            counted.filter(|pass| pass.bob == bob && pass.anticlockwise == left).count()
        };
        [of(1, true), of(1, false), of(2, true), of(2, false)]
    }

    /// The growth from the start so far: the last row's, and that of the way since.
    fn exponent(&mut self, secs: f64, phase: Phase<f64>) -> f64 {
        let (since, from) = std::mem::replace(&mut self.last, (secs, phase));
        self.map = self.map.followed_by(&self.pendulum, &from, (secs - since) / self.unit_secs);
        if secs > 0.0 { self.map.log_growth() / secs } else { f64::NAN }
    }
}

/// Unit vectors and momenta in reduced units of a state in rad and rad/s.
fn reduced_phase(pendulum: &Pendulum<f64>, unit_secs: f64, state: &State<Dd>) -> Phase<f64> {
    let angle = state.angle.map(|angle| angle.wrapped().hi);
    pendulum.phase(&State { angle, speed: state.speed.map(|speed| speed.hi * unit_secs) })
}
