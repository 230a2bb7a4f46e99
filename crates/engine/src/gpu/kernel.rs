//! The text of a kernel: the shader files joined for one scene and configuration, with the maths of
//! `flipmap_pendulum` printed into them.

mod values;

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;

use self::values::{
    CarriedValues, ControlValues, CountValues, PackValues, PairValues, SelfcheckValues, TextValues,
    Values,
};
use super::maths;
use super::packing::Packing;
use crate::adapters::Pairs;
use crate::gpu::shared::status_constants;
use crate::integrator_state::carried_names;
use crate::pace::Pace;
use crate::slowed::least_energy;
use crate::start::{ANGLES, PHASE};
use crate::{EngineError, EventSpec, IntegratorConfig, Method, Precision};
use flipmap_numbers::trig::Turning;
use flipmap_pendulum::control::{Control, GROW, MAX_STEP, SHRINK};
use flipmap_pendulum::crossing::{FAR, SLACK};
use flipmap_pendulum::embedded::Pair;
use flipmap_pendulum::series::ORDER_F64;
use flipmap_pendulum::{Pendulum, Rule};
use flipmap_scene::question::Needs;
use flipmap_shaders::KERNEL_PARTS;

/// The method by which a kernel steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scheme {
    /// RK4, with the way in which the stages of a step find their directions.
    Fixed(Turning),
    /// An embedded pair.
    Embedded(Pair),
    /// Taylor expansions; only in f64.
    Series,
}

/// All that a kernel's text depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// The number type.
    pub precision: Precision,
    /// True if the state keeps the remainders of its roundings; only in f32.
    pub compensated: bool,
    /// The way in which pairs of f32 are computed; only in df32.
    pub pairs: Pairs,
    /// True if invocations of a subgroup can exchange values on this adapter.
    pub subgroups: bool,
    /// The method.
    pub scheme: Scheme,
    /// The scene the kernel is made for; without one it reads the scene as data.
    pub scene: Option<(Pendulum<f64>, Rule)>,
    /// Number of passes of the top after which a pendulum is done; counted unless it is 1.
    pub passes: u32,
    /// Growth or returns, where the kernel computes these instead of passes of the top.
    pub ends: Needs,
}

impl Design {
    /// Returns the kernel that is made for one question at one pace.
    pub fn specialised(self, question: &EventSpec, pace: &Pace) -> Self {
        let scheme = match (self.scheme, pace) {
            (Scheme::Fixed(_), Pace::Fixed(steps)) => {
                Scheme::Fixed(steps.turning(question, self.precision))
            }
            (Scheme::Fixed(_) | Scheme::Embedded(_) | Scheme::Series, _) => self.scheme,
        };
        let scene = Some((question.reduced().0, question.rule));
        Design { scheme, scene, passes: question.passes, ..self }
    }

    /// The kernel that takes any question.
    pub fn general(
        config: &IntegratorConfig,
        compensated: bool,
        subgroups: bool,
    ) -> Result<Self, EngineError> {
        let scheme = match config.method {
            Method::Rk4 { .. } if config.precision != Precision::Df32 => {
                Scheme::Fixed(Turning::Fresh)
            }
            Method::Embedded { pair, .. } => Scheme::Embedded(pair),
            Method::Taylor { .. } if config.precision == Precision::F64 => Scheme::Series,
            method
            @ (Method::Rk4 { .. } | Method::Taylor { .. } | Method::Extrapolation { .. }) => {
                return Err(EngineError::Unsupported(format!(
                    "graphics adapters have no method {} in precision {}",
                    method.name(),
                    config.precision
                )));
            }
        };
        Ok(Design {
            precision: config.precision,
            compensated: compensated && config.precision == Precision::F32,
            pairs: Pairs::default(),
            subgroups,
            scheme,
            scene: None,
            passes: 1,
            ends: Needs::Outcome,
        })
    }

    /// Returns the kernel with `pairs` as its arithmetic for pairs of f32. A kernel of another
    /// number type is returned unchanged.
    pub fn with_pairs(self, pairs: Pairs) -> Self {
        if self.precision == Precision::Df32 { Design { pairs, ..self } } else { self }
    }

    /// Returns true if the kernel counts passes of the top.
    pub(crate) fn counts_passes(&self) -> bool {
        self.passes != 1
    }

    /// Returns true if the kernel can begin the starts of an upright picture.
    pub fn begins(&self) -> bool {
        !self.ends.are_carried()
    }

    /// Returns the same kernel, or an error if its scheme cannot compute `ends`.
    pub(crate) fn returning(self, ends: Needs) -> Result<Self, EngineError> {
        if self.scheme == Scheme::Series && ends.are_carried() {
            let why = "graphics adapters do not answer this question by the method taylor";
            return Err(EngineError::Unsupported(why.to_string()));
        }
        Ok(self)
    }

    /// Returns true if one kernel serves all scenes: expansions check only a few pixels of each
    /// scene, and their kernels take long to compile.
    pub(crate) fn serves_all(&self) -> bool {
        self.scheme == Scheme::Series
    }

    pub(super) fn is_adaptive(&self) -> bool {
        !matches!(self.scheme, Scheme::Fixed(_))
    }

    /// Returns the variant of a specialised kernel that computes growth or extremes.
    pub fn computing(self, ends: Needs) -> Self {
        Design { compensated: false, ends, ..self }
    }

    /// Names of the variables that hold a pendulum's state, in the order of the buffer.
    pub(crate) fn state(&self) -> Vec<&'static str> {
        if self.ends.are_carried() {
            let moving = ["x1", "y1", "x2", "y2", "p1", "p2", "time", "h"];
            return [&moving[..], &carried_names(self.ends)].concat();
        }
        let all: &[&str] = if self.is_adaptive() { &PHASE } else { &ANGLES };
        all.iter().filter(|name| self.compensated || !name.ends_with("_low")).copied().collect()
    }

    /// Numbers of the bobs that the kernel watches, from 1.
    pub(crate) fn watched(&self) -> Vec<usize> {
        let rule = self.scene.map_or(Rule::Either, |(_, rule)| rule);
        rule.watched().iter().map(|bob| bob + 1).collect()
    }

    /// The whole text of the kernel.
    pub fn text(&self) -> String {
        let number = number_file(self.precision);
        let step = self.step();
        let mut maths = BTreeMap::from([("step".to_string(), step.text)]);
        if self.least_energy().is_some() {
            maths.insert("energy".to_string(), self.energy());
        }
        if self.ends.are_carried() {
            let file = if self.ends.is_extreme() { "extremum.wgsl" } else { "tangents.wgsl" };
            let first = ["shared.wgsl", number, "state.wgsl", "carried.wgsl", "control.wgsl"];
            let files = [&first[..], &["gather.wgsl", file, "turn.wgsl"]].concat();
            return glue(&files, &self.values(maths, &step.results));
        }
        if self.is_adaptive() {
            let steps: &[&str] = match self.scheme {
                Scheme::Series => &["series.wgsl", "course.wgsl", "series_look.wgsl"],
                Scheme::Embedded(_) | Scheme::Fixed(_) if self.has_bow() => {
                    &["control.wgsl", "adaptive.wgsl", "look_on_quartic.wgsl", "look.wgsl"]
                }
                Scheme::Embedded(_) | Scheme::Fixed(_) => {
                    &["control.wgsl", "adaptive.wgsl", "look_by_trials.wgsl", "look.wgsl"]
                }
            };
            let first = ["shared.wgsl", number, "state.wgsl", "phase.wgsl"];
            let files = [&first[..], steps, &["begin.wgsl", "turn.wgsl"]];
            return glue(&files.concat(), &self.values(maths, &step.results));
        }
        for bob in self.watched() {
            maths.insert(format!("bob{bob}"), self.quintic_of(bob));
        }
        let values = self.values(maths, &step.results);
        let look = if self.counts_passes() { "fixed_passes.wgsl" } else { "fixed_look.wgsl" };
        let first = ["shared.wgsl", number, "state.wgsl", "flip.wgsl", "fixed.wgsl"];
        glue(&[&first[..], &[look, "begin.wgsl", "turn.wgsl"]].concat(), &values)
    }

    /// The energy below which a pendulum is done early, where there is such a bound.
    fn least_energy(&self) -> Option<f64> {
        let (pendulum, rule) = self.scene?;
        least_energy(&pendulum, rule).filter(|_| !self.ends.are_carried())
    }

    /// The values of the text; `results` are the names of what a step computes.
    fn values(&self, maths: BTreeMap<String, String>, results: &[String]) -> Values {
        let order = match self.scheme {
            Scheme::Embedded(pair) => pair.data().order,
            // These schemes have no step size control.
            Scheme::Fixed(_) | Scheme::Series => 8,
        };
        // The tolerance is data; the values read here do not depend on it.
        let control = Control::new(1.0, order);
        let moves = |name: &&str| results.contains(&format!("{name}_next"));
        let moving: Vec<&str> = self.state().into_iter().filter(moves).collect();
        let ends: Vec<String> = moving.iter().map(|name| format!("{name}_next")).collect();
        let judged = results.iter().filter(|name| !ends.contains(name)).cloned().collect();
        let number = |value: f64| format!("{value:?}");
        Values {
            general: self.scene.is_none(),
            adaptive: self.is_adaptive(),
            compensated: self.compensated,
            doubles: self.precision == Precision::F64,
            subgroups: self.subgroups,
            moving,
            judged,
            pairs: PairValues::new(self.precision, self.pairs),
            carried: CarriedValues::new(self.ends),
            state: self.state(),
            watched: self.watched(),
            bobs: self.watched().len(),
            counts: self.counts(),
            befores: self.bobs("now", ""),
            nows: self.bobs("step.next", "_next"),
            is_watched: match self.scene {
                Some(_) => "",
                None => "(job.watched & (1u << bob)) != 0u && ",
            },
            moment: self.moment(),
            control: ControlValues {
                far: number(FAR),
                slack: number(SLACK),
                exponent: number(control.exponent),
                safety: number(control.safety),
                shrink: number(SHRINK),
                grow: number(GROW),
                longest: number(MAX_STEP),
                terms: ORDER_F64 + 1,
            },
            quartic: self.has_bow(),
            bows: self.bows(),
            maths,
            texts: TextValues {
                statuses: status_constants(),
                least_energy: self.least_energy().map(number),
            },
        }
    }

    /// The watched bobs in a state, filled up to two; `suffix` ends the names of their speeds.
    fn bobs(&self, state: &str, suffix: &str) -> String {
        let one = |bob: &usize| {
            let part = |name: char| format!("rough({state}.{name}{bob})");
            format!("Bob({}, {}, rough(step.w{bob}{suffix}))", part('x'), part('y'))
        };
        let mut bobs: Vec<String> = self.watched().iter().map(one).collect();
        bobs.resize(2, "Bob(1.0, 0.0, 0.0)".to_string());
        bobs.join(", ")
    }

    fn counts(&self) -> CountValues {
        let mut numbers: Vec<String> = self.watched().iter().map(|bob| format!("{bob}u")).collect();
        numbers.resize(2, "1u".to_string());
        CountValues {
            numbers,
            counts_turns: self.watched().is_empty()
                && self.is_adaptive()
                && !self.ends.are_carried(),
            counts_passes: self.counts_passes(),
            passes: self.passes,
            flip_length: self.flip_length(),
        }
    }

    /// Returns true if the scheme provides how a path bends between the ends of a step.
    pub(super) fn has_bow(&self) -> bool {
        matches!(self.scheme, Scheme::Embedded(pair) if pair.data().has_bow)
    }

    /// Expressions for how the watched bobs' paths bend between the ends of a step, where the scheme
    /// provides it.
    fn bows(&self) -> Vec<String> {
        let bow = |bob: &usize| format!("rough(step.bow{bob})");
        let known = self.watched();
        let mut bows: Vec<String> =
            if self.has_bow() { known.iter().map(bow).collect() } else { Vec::new() };
        bows.resize(2, "0.0".to_string());
        bows
    }

    /// Expression for the number `flip + flip_rest`.
    fn flip_length(&self) -> &'static str {
        match self.precision {
            Precision::F32 => "flip + flip_rest",
            Precision::Df32 => "fast_two_sum(flip, flip_rest, zero)",
            _ => "real(flip) + real(flip_rest)",
        }
    }

    /// Expression for the reduced time, in two parts, of a flip `flip + flip_rest` into the step.
    fn moment(&self) -> &'static str {
        match (self.precision, self.compensated) {
            (Precision::F32, true) => "vec2<f32>(time, time_low + (flip + flip_rest))",
            (Precision::F32, false) => "vec2<f32>(time, flip + flip_rest)",
            (Precision::Df32, _) => "add(time, fast_two_sum(flip, flip_rest, zero), zero)",
            _ => "to_parts(time + (real(flip) + real(flip_rest)))",
        }
    }
}

fn number_file(precision: Precision) -> &'static str {
    match precision {
        Precision::F32 => "f32.wgsl",
        Precision::Df32 => "df32.wgsl",
        Precision::F64 | Precision::Dd => "f64.wgsl",
    }
}

/// Returns the self-check's text for one number type; `pairs` is the way to compute pairs of f32.
pub fn selfcheck_text(precision: Precision, pairs: Pairs) -> String {
    let values = SelfcheckValues {
        compensated: true,
        pairs: PairValues::new(precision, pairs),
        maths: maths::selfcheck(precision),
    };
    glue(&[number_file(precision), "selfcheck.wgsl"], &values)
}

/// The text that packs outcomes.
pub fn pack_text(packing: Packing) -> String {
    let values = PackValues {
        words: packing.words(),
        stepped: packing.is_stepped(),
        has_rest: packing.has_rest(),
        statuses: status_constants(),
    };
    glue(&["pack.wgsl"], &values)
}

/// Joins the named files into one text, with `values` filled in.
fn glue(names: &[&str], values: &impl Serialize) -> String {
    let mut files = Environment::new();
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    files.set_syntax(syntax.expect("the ordinary delimiters"));
    files.set_undefined_behavior(UndefinedBehavior::Strict);
    for (name, text) in KERNEL_PARTS {
        files.add_template(name, text).expect("shader files are valid templates");
    }
    names
        .iter()
        .map(|name| {
            let file = files.get_template(name).expect("a file of the list");
            file.render(minijinja::value::Serde(values))
                .expect("every value that a shader file names is given")
        })
        .collect::<Vec<_>>()
        .join("\n")
}
