//! The options that name a scene, and how they become a checked document.

use std::path::Path;

use clap::Args;
use flipmap::output::{ReadError, read_document};
use flipmap::scene::{BuiltIn, Document, SceneError, Word};

use super::exit::Exit;

/// What to compute.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub struct SceneOptions {
    #[arg(help = scene_help())]
    pub scene: Option<String>,
    #[command(flatten)]
    pub words: SceneWords,
}

/// What to change in it.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub struct SceneWords {
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
    /// Whether a scene was named or an option given.
    pub fn says_something(&self) -> bool {
        self.scene.is_some() || self.words.said().iter().any(|(_, said)| said.is_some())
    }

    /// The scene named, changed by the options, and checked.
    pub fn document(&self) -> anyhow::Result<Document> {
        let document = match &self.scene {
            Some(scene) => load(scene)?,
            None => Document::default(),
        };
        Ok(self.words.apply(document)?)
    }
}

impl SceneWords {
    /// A document changed by the options, and checked.
    pub fn apply(&self, document: Document) -> Result<Document, SceneError> {
        let mut scene = document.scene();
        for (word, said) in self.said() {
            if let Some(text) = said {
                word.set(&mut scene, text)?;
            }
        }
        Ok(document.with_scene(scene.checked()?))
    }

    fn said(&self) -> [(Word, &Option<String>); 10] {
        [
            (Word::Center, &self.center),
            (Word::Width, &self.width),
            (Word::Rotate, &self.rotate),
            (Word::Stretch, &self.stretch),
            (Word::Budget, &self.budget),
            (Word::Rule, &self.rule),
            (Word::Kind, &self.kind),
            (Word::Masses, &self.masses),
            (Word::Lengths, &self.lengths),
            (Word::Gravity, &self.gravity),
        ]
    }
}

fn scene_help() -> String {
    format!("A .toml scene, a .png that flipmap wrote, or a built-in scene: {}", BuiltIn::names())
}

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

/// A scene from a file or by name.
pub fn load(scene: &str) -> anyhow::Result<Document> {
    if let Some(built_in) = BuiltIn::named(scene) {
        return Ok(built_in.document());
    }
    match read_document(Path::new(scene)) {
        Ok(document) => Ok(document),
        Err(ReadError::Kind { .. }) => Err(Exit::Usage(format!(
            "no scene '{scene}': name a .toml file, a .png that flipmap wrote, or one of {}",
            BuiltIn::names()
        ))
        .into()),
        Err(error) => Err(Exit::Usage(error.to_string()).into()),
    }
}
