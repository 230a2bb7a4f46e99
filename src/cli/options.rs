//! The options that name a scene, and how they become a checked document.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::str::FromStr;

use anyhow::Context;
use clap::Args;
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
pub fn set<T, Why: std::fmt::Display>(
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

/// A plain number.
pub fn number(text: &str) -> Option<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_built_in_scene_is_valid() {
        for (name, _) in BUILT_IN {
            load(name).unwrap();
        }
    }
}
