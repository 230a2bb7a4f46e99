//! The columns that a question adds to a trace: its channels so far, at the time of each row.

use super::extremum_search::ExtremumSearch;
use flipmap_engine::start::whole_turns;
use flipmap_numbers::Dd;
use flipmap_pendulum::extremum::Measure;
use flipmap_pendulum::passes::Pass;
use flipmap_pendulum::phase::Phase;
use flipmap_pendulum::tangents::TangentMap;
use flipmap_pendulum::taylor::TaylorStep;
use flipmap_pendulum::{Pendulum, State};
use flipmap_scene::question::{Followed, Needs, TraceColumns};
use flipmap_scene::{QuestionSettings, Scene};

/// The answers to a question about a pendulum so far.
pub(super) struct TraceChannels {
    question: QuestionSettings,
    /// The pendulum in reduced units, and its unit of time in s.
    pendulum: Pendulum<f64>,
    unit_secs: f64,
    /// The search for the extreme that the question needs.
    search: Option<ExtremumSearch>,
    passes: Vec<Pass>,
    /// Time in s and phase up to which growth is followed; `map` is the tangent map from the start
    /// to it.
    last: (f64, Phase<f64>),
    map: TangentMap,
}

impl TraceChannels {
    /// Creates the columns of a scene's question, for a pendulum at its start.
    pub(super) fn new(scene: &Scene, start: &State<Dd>) -> Self {
        let (pendulum, unit_secs) = scene.build.reduced_in::<Dd>();
        let (pendulum, unit_secs) = (pendulum.to_f64(), unit_secs.hi);
        let start = reduced_phase(&pendulum, unit_secs, start);
        TraceChannels {
            question: scene.question,
            pendulum,
            unit_secs,
            search: match scene.question.ask.kind().needs {
                Needs::Extremum(kind) => {
                    Some(ExtremumSearch::new(Measure::new(kind, pendulum, start), unit_secs))
                }
                Needs::Outcome | Needs::End | Needs::Growth => None,
            },
            passes: Vec::new(),
            last: (0.0, start),
            map: TangentMap::identity(),
        }
    }

    /// Returns the columns; `None` for the first flip, which a trace already reports among the
    /// passes of the top.
    fn columns(&self) -> Option<&'static TraceColumns> {
        let kind = self.question.ask.kind();
        let told = kind.has_count && self.question.count == 1;
        (!told).then_some(&kind.columns)
    }

    /// Returns the names of the columns.
    pub(super) fn names(&self) -> impl Iterator<Item = &'static str> {
        let channels = self.question.ask.kind().channels;
        let added = self.columns().map_or(&[][..], |columns| &channels[columns.from..]);
        added.iter().map(|channel| channel.name)
    }

    /// Takes a step and the passes in it; call it before the step's rows are read.
    pub(super) fn add(&mut self, step: &TaylorStep<Dd>, passes: &[Pass]) {
        self.passes.extend(passes);
        match self.question.ask.kind().needs {
            Needs::Extremum(_) => self.search.iter_mut().for_each(|search| search.add(step)),
            Needs::Growth => self.grow(step.start.hi, &step.state(Dd::new(0.0))),
            Needs::Outcome | Needs::End => {}
        }
    }

    /// Extends the tangent map to a state at a time in s. For every step and every row, the orbit
    /// in f64 restarts from the one in double-double.
    fn grow(&mut self, secs: f64, state: &State<Dd>) {
        let phase = reduced_phase(&self.pendulum, self.unit_secs, state);
        let (since, from) = std::mem::replace(&mut self.last, (secs, phase));
        self.map = self.map.followed_by(&self.pendulum, &from, (secs - since) / self.unit_secs);
    }

    /// Returns the values of the columns at a time.
    pub(super) fn values(&mut self, time: Dd, state: &State<Dd>) -> Vec<f64> {
        let Some(columns) = self.columns() else { return Vec::new() };
        (columns.read)(&mut TraceRow { channels: self, time, state })
    }
}

/// A row of a trace.
struct TraceRow<'a> {
    channels: &'a mut TraceChannels,
    time: Dd,
    state: &'a State<Dd>,
}

impl Followed for TraceRow<'_> {
    fn passes(&self) -> &[Pass] {
        let all = &self.channels.passes;
        &all[..all.partition_point(|pass| pass.time <= self.time)]
    }

    fn watched_passes(&self) -> Vec<Pass> {
        let watched = self.channels.question.watched().watched();
        let all = self.passes().iter();
        all.filter(|pass| watched.contains(&(pass.bob - 1))).copied().collect()
    }

    fn count(&self) -> u32 {
        self.channels.question.count
    }

    fn turns(&self) -> [i32; 2] {
        self.state.angle.map(|angle| whole_turns(angle.hi))
    }

    fn exponent(&mut self) -> f64 {
        let secs = self.time.hi;
        self.channels.grow(secs, self.state);
        if secs > 0.0 { self.channels.map.log_growth() / secs } else { f64::NAN }
    }

    fn extremum(&mut self) -> [f64; 2] {
        let search = self.channels.search.as_ref();
        search.map_or([f64::NAN; 2], |search| search.until(self.time.hi, self.state))
    }
}

/// Converts a state in rad and rad/s to unit vectors and momenta in reduced units.
pub(super) fn reduced_phase(
    pendulum: &Pendulum<f64>,
    unit_secs: f64,
    state: &State<Dd>,
) -> Phase<f64> {
    let angle = state.angle.map(|angle| angle.wrapped().hi);
    pendulum.phase(&State { angle, speed: state.speed.map(|speed| speed.hi * unit_secs) })
}
