//! The columns that a question adds to a trace: its channels so far, at the time of each row.

use super::nearest_return::ReturnSearch;
use crate::engine::start::whole_turns;
use crate::physics::passes::Pass;
use crate::physics::phase::Phase;
use crate::physics::tangents::TangentMap;
use crate::physics::taylor::TaylorStep;
use crate::physics::{Dd, Pendulum, State};
use crate::question::Ask;
use crate::scene::{QuestionTable, Scene};

/// A question's findings about a pendulum so far.
pub(super) struct TraceChannels {
    question: QuestionTable,
    /// The pendulum in reduced units, and its unit of time in s.
    pendulum: Pendulum<f64>,
    unit_secs: f64,
    returns: ReturnSearch,
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
            question: scene.question,
            pendulum,
            unit_secs,
            returns: ReturnSearch::new(pendulum, unit_secs, start),
            passes: Vec::new(),
            last: (0.0, start),
            map: TangentMap::identity(),
        }
    }

    /// Names of the columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let channels = self.question.ask.kind().channels;
        let added = match self.question.ask {
            // The first flip is told with the passes of the top.
            Ask::Flip if self.question.count == 1 => &[][..],
            // A trace has the angles and the speeds already.
            Ask::State => &channels[4..],
            _ => channels,
        };
        added.iter().map(|channel| channel.name)
    }

    /// Takes a step and the passes in it, before its rows.
    pub(super) fn add(&mut self, step: &TaylorStep<Dd>, passes: &[Pass]) {
        self.passes.extend(passes);
        if self.question.ask == Ask::Return {
            self.returns.add(step);
        }
    }

    /// The values at a time; NaN for those that are not there yet.
    pub(super) fn values(&mut self, time: Dd, state: &State<Dd>) -> Vec<f64> {
        let phase = || reduced_phase(&self.pendulum, self.unit_secs, state);
        match self.question.ask {
            Ask::Flip => self.counted_flip(time).into_iter().collect(),
            Ask::First => match self.passed(time).first() {
                Some(Pass { bob, time, .. }) => vec![*bob as f64, time.hi],
                None => vec![f64::NAN; 2],
            },
            Ask::Flips => self.counts(time).map(|count| count as f64).to_vec(),
            Ask::State => state.angle.map(|angle| f64::from(whole_turns(angle.hi))).to_vec(),
            Ask::Growth => vec![self.exponent(time.hi, phase())],
            Ask::Return => self.returns.nearest(time.hi).to_vec(),
        }
    }

    /// The time of the flip that is counted to, where that is a later one than the first; NaN before.
    fn counted_flip(&self, time: Dd) -> Option<f64> {
        let QuestionTable { count, .. } = self.question;
        let watched = self.question.watched().watched();
        let mut flips = self.passed(time).iter().filter(|pass| watched.contains(&(pass.bob - 1)));
        let flip = || flips.nth(count as usize - 1).map_or(f64::NAN, |pass| pass.time.hi);
        (count > 1).then(flip)
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
pub(super) fn reduced_phase(
    pendulum: &Pendulum<f64>,
    unit_secs: f64,
    state: &State<Dd>,
) -> Phase<f64> {
    let angle = state.angle.map(|angle| angle.wrapped().hi);
    pendulum.phase(&State { angle, speed: state.speed.map(|speed| speed.hi * unit_secs) })
}
