//! The options that describe a scene, and their conversion into a checked document.

use std::path::Path;

use clap::Args;
use clap::builder::Resettable;
use flipmap_render::output::named_document;
use flipmap_scene::{BuiltIn, Document, SceneError, Setting};

use super::exit::Exit;
use super::same_file::Named;

/// Options that name and change a scene.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub(super) struct SceneOptions {
    #[arg(help = scene_help(), help_heading = Resettable::Reset)]
    pub scene: Option<String>,
    #[command(flatten)]
    pub words: SceneWords,
}

/// Options that change single values of a scene.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub(super) struct SceneWords {
    /// Centre of the view in the units of the plane, rad by default, with any number of digits;
    /// angles also as in -95deg,0.5pi
    #[arg(long, value_name = "θ1,θ2", allow_hyphen_values = true)]
    center: Option<String>,
    /// Width of the view in the same units
    #[arg(long, allow_hyphen_values = true)]
    width: Option<String>,
    /// Simulated seconds that each pixel may use, 1e-9 to 1e6, or auto
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    budget: Option<String>,
    /// Bob whose flip is watched: second, first or either
    #[arg(long)]
    rule: Option<String>,
    /// Masses in kg
    #[arg(hide_short_help = true, long, value_name = "m1,m2", allow_hyphen_values = true)]
    masses: Option<String>,
    /// Lengths in m
    #[arg(hide_short_help = true, long, value_name = "l1,l2", allow_hyphen_values = true)]
    lengths: Option<String>,
    /// Gravitational acceleration in m/s²
    #[arg(hide_short_help = true, long, allow_hyphen_values = true)]
    gravity: Option<String>,
    /// Friction at the two pivots in N m s
    #[arg(hide_short_help = true, long, value_name = "b1,b2", allow_hyphen_values = true)]
    friction: Option<String>,
    /// Kind of pendulum: points (bobs on massless rods) or rods (uniform bars)
    #[arg(hide_short_help = true, long)]
    kind: Option<String>,
    /// Rotate the picture anticlockwise in the plane, by -360 to 360 degrees
    #[arg(hide_short_help = true, long, value_name = "DEGREES", allow_hyphen_values = true)]
    rotate: Option<String>,
    /// Question asked about every start: flip, first, flips, state, growth or return
    #[arg(long, value_name = "NAME")]
    ask: Option<String>,
    /// Time of the answer in s, for the question state (default: the whole budget)
    #[arg(hide_short_help = true, long, value_name = "SECONDS", allow_hyphen_values = true)]
    at: Option<String>,
    /// Number of the flip whose time is asked for, from 1
    #[arg(hide_short_help = true, long, value_name = "N", allow_hyphen_values = true)]
    count: Option<String>,
    /// Plane of starts: angles, speeds, first, second, section, or two of theta1, theta2, omega1,
    /// omega2 with a comma between them
    #[arg(long, value_name = "NAME")]
    plane: Option<String>,
    /// Start, in rad and rad/s, that fixes the quantities not on the plane's axes
    #[arg(hide_short_help = true, long, value_name = "θ1,θ2,ω1,ω2", allow_hyphen_values = true)]
    origin: Option<String>,
    /// Total energy in J for the plane section; 0 is both rods level and at rest
    #[arg(hide_short_help = true, long, value_name = "J", allow_hyphen_values = true)]
    energy: Option<String>,
    /// Stretch the picture vertically by this factor, 1e-6 to 1e6
    #[arg(hide_short_help = true, long, value_name = "FACTOR", allow_hyphen_values = true)]
    stretch: Option<String>,
}

impl SceneOptions {
    #[cfg(feature = "window")]
    /// Returns true if a scene was named or any of the options was given.
    pub(super) fn is_given(&self) -> bool {
        self.scene.is_some() || self.words.said().iter().any(|(_, said)| said.is_some())
    }

    /// The file of the scene, if it is named by its path.
    pub(super) fn file(&self) -> Option<Named<'_>> {
        let path = Path::new(self.scene.as_deref()?);
        path.exists().then_some(("the scene", path))
    }

    /// Loads the named scene, applies the options, and checks the result.
    pub(super) fn document(&self) -> anyhow::Result<Document> {
        Ok(self.words.apply(self.words.base(self.scene.as_deref())?)?)
    }
}

impl SceneWords {
    /// Loads the scene to which the options apply: the named one or, by default, the home scene;
    /// with `--plane`, the middle of the plane.
    pub(super) fn base(&self, scene: Option<&str>) -> anyhow::Result<Document> {
        match scene {
            Some(scene) => load(scene),
            None if self.plane.is_some() => Ok(Document::default()),
            None => Ok(BuiltIn::home().document()),
        }
    }

    /// Returns true if the option of a setting was given.
    pub(super) fn says(&self, word: Setting) -> bool {
        self.said().iter().any(|(other, said)| *other == word && said.is_some())
    }

    /// Applies the options to a document and checks the result.
    pub(super) fn apply(&self, document: Document) -> Result<Document, SceneError> {
        let said = self.said().into_iter();
        let words = said.filter_map(|(word, said)| Some((word, said.as_deref()?)));
        let scene = document.scene().with_words(words)?;
        Ok(document.with_scene(scene))
    }

    fn said(&self) -> [(Setting, &Option<String>); 17] {
        [
            (Setting::Center, &self.center),
            (Setting::Width, &self.width),
            (Setting::Rotate, &self.rotate),
            (Setting::Stretch, &self.stretch),
            (Setting::Ask, &self.ask),
            (Setting::At, &self.at),
            (Setting::Count, &self.count),
            (Setting::Plane, &self.plane),
            (Setting::Origin, &self.origin),
            (Setting::Energy, &self.energy),
            (Setting::Budget, &self.budget),
            (Setting::Rule, &self.rule),
            (Setting::Kind, &self.kind),
            (Setting::Friction, &self.friction),
            (Setting::Masses, &self.masses),
            (Setting::Lengths, &self.lengths),
            (Setting::Gravity, &self.gravity),
        ]
    }
}

fn scene_help() -> String {
    format!("A .toml scene, a .png written by flipmap, or a built-in scene: {}", BuiltIn::names())
}

/// Sets `value` from an option's text, if given; a usage error names the option.
pub(super) fn set<T, Why: std::fmt::Display>(
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

/// Parses a number.
pub(super) fn number(text: &str) -> Option<f64> {
    text.trim().parse().ok()
}

/// Loads a scene from a file, or a built-in one by its name.
pub(super) fn load(scene: &str) -> anyhow::Result<Document> {
    Ok(named_document(scene).map_err(|error| Exit::Usage(error.to_string()))?)
}
