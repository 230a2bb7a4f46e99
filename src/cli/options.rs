//! The options that describe a scene, and their conversion into a checked document.

use std::ops::RangeInclusive;
use std::path::Path;

use clap::builder::Resettable;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches};
use flipmap_engine::run_settings::RunSpec;
use flipmap_render::output::named_document;
use flipmap_scene::{BuiltIn, Document, RunTable, SceneError, Setting, View, number_within};

use super::exit::Exit;
use super::same_file::Named;
use super::suggested::Suggested;

/// Options that name and change a scene.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub(super) struct SceneOptions {
    #[arg(help = scene_help(), help_heading = Resettable::Reset)]
    pub scene: Option<String>,
    #[command(flatten)]
    pub words: SceneWords,
}

/// Options that change single values of a scene: one for each setting in the table, in its order.
#[derive(Debug, Default)]
pub(super) struct SceneWords(Vec<(Setting, String)>);

impl Args for SceneWords {
    fn augment_args(command: Command) -> Command {
        command.args(Setting::all().map(option_of))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for SceneWords {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let said = |setting: Setting| {
            let text: &String = matches.get_one(setting.name())?;
            Some((setting, text.clone()))
        };
        Ok(SceneWords(Setting::all().filter_map(said).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns the option of a setting.
fn option_of(setting: Setting) -> Arg {
    let def = setting.def();
    let names = (def.names)();
    Arg::new(def.name)
        .long(def.name)
        .value_name(def.value_name)
        .help((def.help)())
        .help_heading("Scene")
        .hide_short_help(!def.is_basic)
        .allow_hyphen_values(names.is_empty())
        .hide_possible_values(true)
        .value_parser(Suggested(names))
}

impl SceneOptions {
    #[cfg(feature = "window")]
    /// Returns true if a scene was named or any of the options was given.
    pub(super) fn is_given(&self) -> bool {
        self.scene.is_some() || !self.words.0.is_empty()
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
            None if self.says(Setting::Plane) => Ok(Document::default()),
            None => Ok(BuiltIn::home().document()),
        }
    }

    /// Returns true if an option of the view was given.
    pub(super) fn says_view(&self) -> bool {
        self.0.iter().any(|(said, _)| View::SETTINGS.contains(said))
    }

    /// Returns the options without those of the view.
    pub(super) fn without_view(&self) -> SceneWords {
        SceneWords(
            self.0.iter().filter(|(said, _)| !View::SETTINGS.contains(said)).cloned().collect(),
        )
    }

    /// Returns true if the option of a setting was given.
    pub(super) fn says(&self, setting: Setting) -> bool {
        self.0.iter().any(|(said, _)| *said == setting)
    }

    /// Applies the options to a document and checks the result.
    pub(super) fn apply(&self, document: Document) -> Result<Document, SceneError> {
        let words = self.0.iter().map(|(setting, text)| (*setting, text.as_str()));
        let scene = document.scene().with_words(words)?;
        Ok(document.with_scene(scene))
    }
}

fn scene_help() -> String {
    format!(
        "A scene: a .toml, a .png written by flipmap, a location (flipmap:center=…) or a link with \
         one, - for standard input, or built-in: {}",
        BuiltIn::names()
    )
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

/// Reads an option's number of the given range; a usage error names the option.
pub(super) fn number_of(
    option: &str,
    text: &str,
    range: RangeInclusive<f64>,
    unit: &str,
) -> Result<f64, Exit> {
    number_within(text, range, unit)
        .map_err(|why| Exit::Usage(format!("{option} is '{text}'; {why}")))
}

/// Loads a scene from a file, or a built-in one by its name.
pub(super) fn load(scene: &str) -> anyhow::Result<Document> {
    let document = named_document(scene).map_err(|error| Exit::usage(&error))?;
    check_run(&document.run, scene)?;
    Ok(document)
}

/// Rejects run settings of a file that cannot be used, in the words of the file.
pub(super) fn check_run(run: &RunTable, file: &str) -> Result<(), Exit> {
    let checked = RunSpec::resolve(run.clone());
    checked.map(drop).map_err(|error| Exit::Usage(format!("{file}: in [run], {error}")))
}
