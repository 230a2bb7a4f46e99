//! The text of a kernel: the shader files glued together for one scene and recipe, with the
//! maths of `physics` printed into them.

use std::collections::BTreeMap;

use minijinja::syntax::SyntaxConfig;
use minijinja::{Environment, UndefinedBehavior};
use serde::Serialize;

use crate::engine::symbol::{Dialect, Symbol, literal, variable, write_maths};
use crate::engine::{Precision, Question, Recipe};
use crate::physics::polynomial::quintic_hermite;
use crate::physics::trig::Turning;
use crate::physics::{Pendulum, Real, Rule, State, integrator};

/// Every shader file, by name.
pub const FILES: [(&str, &str); 9] = [
    ("shared.wgsl", include_str!("../../../shaders/shared.wgsl")),
    ("f32.wgsl", include_str!("../../../shaders/f32.wgsl")),
    ("f64.wgsl", include_str!("../../../shaders/f64.wgsl")),
    ("start.wgsl", include_str!("../../../shaders/start.wgsl")),
    ("flip.wgsl", include_str!("../../../shaders/flip.wgsl")),
    ("general.wgsl", include_str!("../../../shaders/general.wgsl")),
    ("tile.wgsl", include_str!("../../../shaders/tile.wgsl")),
    ("turn.wgsl", include_str!("../../../shaders/turn.wgsl")),
    ("selfcheck.wgsl", include_str!("../../../shaders/selfcheck.wgsl")),
];

/// What a kernel's text depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Design {
    /// The number type.
    pub precision: Precision,
    /// Whether f32 angles keep what rounding takes from them.
    pub compensated: bool,
    /// Whether invocations of a subgroup can speak to each other on this adapter.
    pub subgroups: bool,
    /// How the stages of a step find their directions.
    pub turning: Turning,
    /// The scene the kernel is made for; without one it reads the scene as data.
    pub scene: Option<(Pendulum<f64>, Rule)>,
}

impl Design {
    /// The kernel made for a question and nothing else.
    pub fn specialised(self, question: &Question, recipe: &Recipe) -> Self {
        Design {
            turning: recipe.turning(question),
            scene: Some((question.pendulum.reduced().0, question.rule)),
            ..self
        }
    }

    /// The kernel that takes any question.
    pub fn general(recipe: &Recipe, compensated: bool, subgroups: bool) -> Self {
        Design {
            precision: recipe.precision,
            compensated: compensated && recipe.precision == Precision::F32,
            subgroups,
            turning: Turning::Fresh,
            scene: None,
        }
    }

    /// The variables a pendulum's state is kept in, in the order of the buffer.
    pub fn state(&self) -> &'static [&'static str] {
        const NAMES: [&str; 6] = ["t1", "t2", "w1", "w2", "t1_low", "t2_low"];
        if self.compensated { &NAMES } else { &NAMES[..4] }
    }

    fn watched(&self) -> Vec<usize> {
        let rule = self.scene.map_or(Rule::Either, |(_, rule)| rule);
        rule.watched().iter().map(|bob| bob + 1).collect()
    }

    /// The numbers of the state at the start of a pendulum at rest.
    fn begin(&self) -> Vec<&'static str> {
        match (self.precision, self.compensated) {
            (Precision::F64, _) => vec!["start.x", "start.y", "0.0lf", "0.0lf"],
            (Precision::F32, true) => {
                vec!["start.x", "start.z", "0.0", "0.0", "start.y", "start.w"]
            }
            (Precision::F32, false) => {
                vec!["start.x + start.y", "start.z + start.w", "0.0", "0.0"]
            }
        }
    }

    /// The whole text of the kernel.
    pub fn text(&self) -> String {
        let number = match self.precision {
            Precision::F32 => "f32.wgsl",
            Precision::F64 => "f64.wgsl",
        };
        let watched = self.watched();
        let bobs: Vec<String> = watched.iter().map(|&bob| self.quintic_of(bob)).collect();
        let mut maths = BTreeMap::from([("step".to_string(), self.step())]);
        maths.extend(watched.iter().map(|bob| format!("bob{bob}")).zip(bobs));
        let values = Values {
            general: self.scene.is_none(),
            compensated: self.compensated,
            subgroups: self.subgroups,
            state: self.state(),
            begin: self.begin(),
            watched,
            maths,
            may_pass: self.may_pass(),
        };
        glue(&["shared.wgsl", number, "start.wgsl", "flip.wgsl", "tile.wgsl", "turn.wgsl"], &values)
    }

    fn dialect(&self) -> Dialect {
        Dialect { precision: self.precision, indent: "        " }
    }

    fn pendulum(&self) -> Pendulum<Symbol> {
        match self.scene {
            Some((pendulum, _)) => pendulum.map(literal),
            None => Pendulum {
                a: variable("a"),
                b: variable("b"),
                c: literal(1.0),
                p: variable("p"),
                q: literal(1.0),
                least_det: variable("least_det"),
            },
        }
    }

    /// One step: the `_next` value of every variable of the state.
    fn step(&self) -> String {
        write_maths(self.dialect(), || {
            let before = state(["t1", "t2", "w1", "w2"]);
            let change = integrator::rk4(&self.pendulum(), &before, variable("step"), self.turning);
            let next = if self.compensated {
                let low = ["t1_low", "t2_low"].map(variable);
                let (next, low) = before.plus_with_rest(low, &change);
                [next.angle, next.speed, low].concat()
            } else {
                let next = before.plus(&change);
                [next.angle, next.speed].concat()
            };
            let names = self.state().iter().map(|name| format!("{name}_next"));
            names.zip(next).collect()
        })
    }

    /// Whether a watched bob may have been at the top (twin: `flip::may_pass`).
    fn may_pass(&self) -> String {
        let one = |bob: &usize| {
            let (t, w) = (format!("t{bob}"), format!("w{bob}"));
            let turned = format!("({w} * {w}_next < 0)");
            let far = format!("max(abs({t}), abs({t}_next))");
            let travel = format!("step * max(abs({w}), abs({w}_next))");
            let pass = format!("(abs({t}_next) >= PI) || ({turned} && ({far} + {travel} >= PI))");
            match self.scene {
                Some(_) => pass,
                None => format!("((job.watched & {bob}u) != 0u && ({pass}))"),
            }
        };
        self.watched().iter().map(one).collect::<Vec<_>>().join(" || ")
    }

    /// The coefficients of a bob's way to the top over the step (see `flip::fraction_of_step`).
    fn quintic_of(&self, bob: usize) -> String {
        const ENDS: [[&str; 6]; 2] = [
            ["t1", "t2", "w1", "w2", "t1_low", "t2_low"],
            ["t1_next", "t2_next", "w1_next", "w2_next", "t1_low_next", "t2_low_next"],
        ];
        write_maths(self.dialect(), || {
            let (side, step) = (variable("side"), variable("step"));
            let ends = ENDS.map(|[t1, t2, w1, w2, t1_low, t2_low]| {
                let end = state([t1, t2, w1, w2]);
                let alpha = self.pendulum().acceleration(&end)[bob - 1];
                let margin = side * end.angle[bob - 1] - variable("PI");
                let rest = [t1_low, t2_low][bob - 1];
                let margin = if self.compensated {
                    margin + (side * variable(rest) - variable("PI_REST"))
                } else {
                    margin
                };
                [margin, side * end.speed[bob - 1] * step, side * alpha * step * step]
            });
            let coefficients = quintic_hermite(ends[0], ends[1]);
            (0..6).map(|k| format!("c{k}")).zip(coefficients).collect()
        })
    }
}

/// What the shader files ask for by name.
#[derive(Serialize)]
struct Values {
    general: bool,
    compensated: bool,
    subgroups: bool,
    state: &'static [&'static str],
    begin: Vec<&'static str>,
    watched: Vec<usize>,
    maths: BTreeMap<String, String>,
    may_pass: String,
}

#[derive(Serialize)]
struct SelfcheckValues {
    compensated: bool,
    maths: String,
}

fn state(names: [&'static str; 4]) -> State<Symbol> {
    let [t1, t2, w1, w2] = names.map(variable);
    State { angle: [t1, t2], speed: [w1, w2] }
}

/// The self-check's text for one number type.
pub fn selfcheck_text(precision: Precision) -> String {
    let number = match precision {
        Precision::F32 => "f32.wgsl",
        Precision::F64 => "f64.wgsl",
    };
    let dialect = Dialect { precision, indent: "    " };
    let maths = write_maths(dialect, || {
        let (a, b) = (variable("a"), variable("b"));
        let (sum, error) = match precision {
            Precision::F32 => a.fast_two_sum(b),
            Precision::F64 => (a + b, a - b),
        };
        let (sin, cos) = a.sin_cos();
        ["sum", "error", "product", "quotient", "sin", "cos"]
            .map(str::to_string)
            .into_iter()
            .zip([sum, error, a * b, a / b, sin, cos])
            .collect()
    });
    let values = SelfcheckValues { compensated: true, maths };
    glue(&[number, "selfcheck.wgsl"], &values)
}

/// The named files as one text, with `values` filled in.
fn glue(names: &[&str], values: &impl Serialize) -> String {
    let mut files = Environment::new();
    let syntax = SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).build();
    files.set_syntax(syntax.expect("the ordinary delimiters"));
    files.set_undefined_behavior(UndefinedBehavior::Strict);
    for (name, text) in FILES {
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
