//! The columns that a question adds to a trace: its channels so far, at the time of each row.

use flipmap::engine::start::whole_turns;
use flipmap::physics::phase::{Phase, distance};
use flipmap::physics::tangents::TangentMap;
use flipmap::physics::{Dd, Pendulum, State};
use flipmap::question::Ask;
use flipmap::scene::Scene;

/// A pass of the top by a bob.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pass {
    /// Number of the bob, 1 or 2.
    pub bob: usize,
    /// Simulated seconds since the release.
    pub time: Dd,
    /// True if it goes over the top towards the left.
    pub anticlockwise: bool,
}

/// A question's findings about a pendulum so far.
pub(super) struct QuestionColumns {
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

impl QuestionColumns {
    /// The columns of a scene's question, for a pendulum at its start.
    pub(super) fn new(scene: &Scene, start: &State<Dd>) -> Self {
        let (pendulum, unit_secs) = scene.build.reduced_in::<Dd>();
        let (pendulum, unit_secs) = (pendulum.to_f64(), unit_secs.hi);
        let start = reduced_phase(&pendulum, unit_secs, start);
        QuestionColumns {
            ask: scene.question.ask,
            pendulum,
            unit_secs,
            start,
            passes: Vec::new(),
            last: (0.0, start),
            map: TangentMap::identity(),
        }
    }

    /// The head of the columns, each after a comma.
    pub(super) fn head(&self) -> String {
        let channels = self.ask.kind().channels;
        let added = match self.ask {
            Ask::Flip => &[][..],
            Ask::First | Ask::Flips | Ask::Growth => channels,
            // A trace has the angles and the speeds already.
            Ask::State => &channels[4..],
            Ask::Return => &channels[..1],
        };
        added.iter().map(|channel| format!(",{}", channel.name)).collect()
    }

    /// Takes the passes of a step, before its rows.
    pub(super) fn add(&mut self, passes: &[Pass]) {
        self.passes.extend(passes);
    }

    /// The values at a time; those that are not there yet are empty.
    pub(super) fn row(&mut self, time: Dd, state: &State<Dd>) -> String {
        let phase = || reduced_phase(&self.pendulum, self.unit_secs, state);
        match self.ask {
            Ask::Flip => String::new(),
            Ask::First => match self.passed(time).first() {
                Some(Pass { bob, time, .. }) => format!(",{bob},{}", time.hi),
                None => ",,".to_string(),
            },
            Ask::Flips => self.counts(time).map(|count| format!(",{count}")).concat(),
            Ask::State => state.angle.map(|angle| format!(",{}", whole_turns(angle.hi))).concat(),
            Ask::Growth => self.exponent(time.hi, phase()),
            Ask::Return => {
                let inverse_scale = self.pendulum.momentum_scale().map(|scale| 1.0 / scale);
                format!(",{}", distance(&phase(), &self.start, inverse_scale))
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
    fn exponent(&mut self, secs: f64, phase: Phase<f64>) -> String {
        let (since, from) = std::mem::replace(&mut self.last, (secs, phase));
        self.map = self.map.followed_by(&self.pendulum, &from, (secs - since) / self.unit_secs);
        if secs > 0.0 { format!(",{}", self.map.log_growth() / secs) } else { ",".to_string() }
    }
}

/// Unit vectors and momenta in reduced units of a state in rad and rad/s.
fn reduced_phase(pendulum: &Pendulum<f64>, unit_secs: f64, state: &State<Dd>) -> Phase<f64> {
    let angle = state.angle.map(|angle| angle.wrapped().hi);
    pendulum.phase(&State { angle, speed: state.speed.map(|speed| speed.hi * unit_secs) })
}
