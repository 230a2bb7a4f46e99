//! Options that several verbs share, and how they become a checked document and a recipe.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::str::FromStr;

use anyhow::Context;
use clap::{Args, ValueEnum};
use flipmap::engine::choice::{self, Wish};
use flipmap::engine::{Method, Precision, Recipe};
use flipmap::output::document_in_png;
use flipmap::physics::Rule;
use flipmap::scene::{Document, Kind};

use super::exit::Exit;

/// Scenes that come with the program.
const BUILT_IN: [(&str, &str); 4] = [
    ("home", include_str!("../../assets/scenes/home.toml")),
    ("rods", include_str!("../../assets/scenes/rods.toml")),
    ("either", include_str!("../../assets/scenes/either.toml")),
    ("filigree", include_str!("../../assets/scenes/filigree.toml")),
];

/// What to compute.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub struct SceneOptions {
    /// A .toml scene, a .png that flipmap wrote, or a built-in scene: home, rods, either, filigree
    pub scene: Option<String>,
    /// Centre of the view in rad, as many digits as you like
    #[arg(long, value_name = "θ1,θ2", allow_hyphen_values = true)]
    center: Option<String>,
    /// Width of the view in rad
    #[arg(long, allow_hyphen_values = true)]
    width: Option<String>,
    /// Simulated seconds a pixel may use
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    budget: Option<String>,
    /// Which bob is watched: second, first or either
    #[arg(long)]
    rule: Option<String>,
    /// Masses in kg
    #[arg(long, value_name = "m1,m2", allow_hyphen_values = true)]
    masses: Option<String>,
    /// Lengths in m
    #[arg(long, value_name = "l1,l2", allow_hyphen_values = true)]
    lengths: Option<String>,
    /// Gravity in m/s²
    #[arg(long, allow_hyphen_values = true)]
    gravity: Option<String>,
    /// points: bobs on massless rods; rods: uniform bars
    #[arg(long)]
    kind: Option<String>,
    /// Turn the picture anticlockwise on the plane
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    rotate: Option<String>,
    /// Stretch the picture vertically
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true)]
    stretch: Option<String>,
}

impl SceneOptions {
    /// The scene named, changed by the options, and checked.
    pub fn document(&self) -> anyhow::Result<Document> {
        let mut document = match &self.scene {
            Some(scene) => load(scene)?,
            None => Document::default(),
        };
        self.apply(&mut document)?;
        document.scene().checked()?;
        Ok(document)
    }

    fn apply(&self, document: &mut Document) -> Result<(), Exit> {
        let Document { pendulum, question, view, .. } = document;
        set(&mut pendulum.masses, "--masses", &self.masses, |text| pair(text).ok_or(WIDE_PAIR))?;
        set(&mut pendulum.lengths, "--lengths", &self.lengths, |text| pair(text).ok_or(WIDE_PAIR))?;
        set(&mut pendulum.gravity, "--gravity", &self.gravity, |text| {
            number(text).ok_or("it must be 0 or a number between 1e-9 and 1e9 m/s²")
        })?;
        set(&mut pendulum.kind, "--kind", &self.kind, |text| {
            let known = Kind::ALL.iter().find(|(word, _)| *word == text);
            known.map(|(_, kind)| *kind).ok_or("it must be points or rods")
        })?;
        set(&mut question.rule, "--rule", &self.rule, Rule::from_str)?;
        set(&mut question.budget, "--budget", &self.budget, |text| {
            number(text).ok_or("it must be a number of seconds between 1e-9 and 1e6")
        })?;
        set(&mut view.center, "--center", &self.center, |text| {
            let (theta1, theta2) = text.split_once(',').ok_or(PAIR)?;
            Ok::<_, &str>([theta1, theta2].map(|theta| theta.trim().to_string()))
        })?;
        set(&mut view.width, "--width", &self.width, |text| Ok::<_, String>(text.to_string()))?;
        set(&mut view.rotate, "--rotate", &self.rotate, |text| {
            number(text).ok_or("it must be a number of degrees between -360 and 360")
        })?;
        set(&mut view.stretch, "--stretch", &self.stretch, |text| {
            number(text).ok_or("it must be a number between 1e-6 and 1e6")
        })
    }
}

const PAIR: &str = "it must be two numbers with a comma between them";
const WIDE_PAIR: &str = "it must be two numbers between 1e-9 and 1e9 with a comma between them";

/// Replaces `value` by what an option says, or names the option in the refusal.
fn set<T, Why: std::fmt::Display>(
    value: &mut T,
    option: &str,
    text: &Option<String>,
    parse: impl Fn(&str) -> Result<T, Why>,
) -> Result<(), Exit> {
    if let Some(text) = text {
        *value = parse(text).map_err(|why| Exit::Usage(format!("{option} is '{text}'; {why}")))?;
    }
    Ok(())
}

fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok()
}

fn pair(text: &str) -> Option<[f64; 2]> {
    let (first, second) = text.split_once(',')?;
    Some([number(first)?, number(second)?])
}

/// A scene from a file or by name.
fn load(scene: &str) -> anyhow::Result<Document> {
    if let Some((_, text)) = BUILT_IN.iter().find(|(name, _)| *name == scene) {
        return Ok(Document::parse(text)?);
    }
    let path = Path::new(scene);
    let is =
        |ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
    if is("png") {
        let file = File::open(path).map_err(|error| unreadable(scene, &error))?;
        return document_in_png(BufReader::new(file))
            .map_err(|error| Exit::Usage(format!("{scene} {error}")).into());
    }
    if !is("toml") {
        let names: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
        let message = format!(
            "no scene '{scene}': name a .toml file, a .png that flipmap wrote, or one of {}",
            names.join(", ")
        );
        return Err(Exit::Usage(message).into());
    }
    let text = std::fs::read_to_string(path).map_err(|error| unreadable(scene, &error))?;
    Document::parse(&text).with_context(|| scene.to_string())
}

fn unreadable(scene: &str, error: &std::io::Error) -> Exit {
    Exit::Usage(format!("cannot read the scene {scene}: {error}"))
}

/// How to compute it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Run")]
pub struct RunOptions {
    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<String>,
    /// lesson: RK4 at 120 steps a second in f32
    #[arg(long)]
    accuracy: Option<Accuracy>,
    /// rk4
    #[arg(long)]
    method: Option<String>,
    /// Seconds a step, as a number or a fraction
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    step: Option<String>,
    /// f32 or f64
    #[arg(long)]
    precision: Option<String>,
    /// auto: an adapter if one is sound, else the processor
    #[arg(long, value_enum, default_value_t = EngineKind::Auto)]
    engine: EngineKind,
    /// Part of the name of the adapter to use
    #[arg(long, value_name = "NAME")]
    adapter: Option<String>,
    /// Threads of the CPU engine (default: one for each core)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Accuracy {
    Lesson,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum EngineKind {
    #[default]
    Auto,
    Gpu,
    Cpu,
}

/// Without `--size`.
const DEFAULT_SIZE: [u32; 2] = [1024, 1024];
/// Longest side of a picture.
const LONGEST_SIDE: u32 = 1_000_000;

impl RunOptions {
    /// The engine asked for.
    pub fn wish(&self, precision: Precision) -> Wish {
        Wish {
            kind: match self.engine {
                EngineKind::Auto => choice::Kind::Auto,
                EngineKind::Gpu => choice::Kind::Gpu,
                EngineKind::Cpu => choice::Kind::Cpu,
            },
            adapter: self.adapter.clone(),
            threads: self.threads.map(|threads| threads as usize),
            precision: Some(precision),
        }
    }

    /// Refuses options that contradict each other.
    pub fn check(&self) -> Result<(), Exit> {
        if self.engine == EngineKind::Cpu && self.adapter.is_some() {
            let message = "--adapter names a graphics adapter; leave it out with --engine cpu";
            return Err(Exit::Usage(message.to_string()));
        }
        Ok(())
    }

    /// Fills in the document's run table, so that it says what ran, and gives the same typed.
    pub fn settle(&self, document: &mut Document) -> Result<(Recipe, [u32; 2]), Exit> {
        let run = &mut document.run;
        let mut size = run.size.unwrap_or(DEFAULT_SIZE);
        set(&mut size, "--size", &self.size, parse_size)?;
        if size.iter().any(|side| !(1..=LONGEST_SIDE).contains(side)) {
            let text = format!("{}x{}", size[0], size[1]);
            return Err(Exit::Usage(format!("--size is '{text}'; {SIZE}")));
        }
        let kept = |text: &Option<String>, kept: &Option<String>, lesson: &str| {
            let kept = if self.accuracy.is_some() { None } else { kept.clone() };
            text.clone().or(kept).unwrap_or_else(|| lesson.to_string())
        };
        let method = kept(&self.method, &run.method, "rk4");
        let step = kept(&self.step, &run.step, "1/120");
        let precision = kept(&self.precision, &run.precision, "f32");
        let recipe = Recipe {
            method: parse_method(&method, &step)?,
            precision: Precision::from_str(&precision)
                .map_err(|why| Exit::Usage(format!("--precision: {why}")))?,
        };
        run.size = Some(size);
        (run.method, run.step, run.precision) = (Some(method), Some(step), Some(precision));
        Ok((recipe, size))
    }
}

const SIZE: &str = "it must be WIDTHxHEIGHT with both between 1 and 1000000 pixels";

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides = text.split_once('x').and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    sides.ok_or(SIZE.to_string())
}

fn parse_method(method: &str, step: &str) -> Result<Method, Exit> {
    if method != "rk4" {
        return Err(Exit::Usage(format!("--method is '{method}'; the methods are rk4")));
    }
    let step_secs = match step.split_once('/') {
        Some((above, below)) => {
            number(above).zip(number(below)).map(|(above, below)| above / below)
        }
        None => number(step),
    };
    match step_secs {
        Some(step_secs) if (1e-9..=1.0).contains(&step_secs) => Ok(Method::Rk4 { step_secs }),
        _ => Err(Exit::Usage(format!(
            "--step is '{step}'; it must be seconds between 1e-9 and 1, as a number or a fraction"
        ))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_numbers_or_fractions() {
        assert_eq!(parse_method("rk4", "1/120").unwrap(), Method::LESSON);
        assert_eq!(parse_method("rk4", "1e-3").unwrap(), Method::Rk4 { step_secs: 1e-3 });
        for bad in ["0", "-1/120", "nan", "inf", "1/0", "2", "x", "1/"] {
            let message = parse_method("rk4", bad).unwrap_err().to_string();
            assert!(message.contains("--step") && message.contains("between 1e-9 and 1"), "{bad}");
        }
    }

    #[test]
    fn a_picture_remembers_how_it_was_made() {
        let mut document = Document::default();
        document.run.precision = Some("f64".to_string());
        let (recipe, _) = RunOptions::default().settle(&mut document).unwrap();
        assert_eq!(recipe.precision, Precision::F64);
        let lesson = RunOptions { accuracy: Some(Accuracy::Lesson), ..RunOptions::default() };
        assert_eq!(lesson.settle(&mut document).unwrap().0.precision, Precision::F32);
    }

    #[test]
    fn every_built_in_scene_is_valid() {
        for (name, _) in BUILT_IN {
            load(name).unwrap();
        }
    }
}
