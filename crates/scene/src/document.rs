//! A scene as a TOML file: every key has a default, and unknown keys are refused.

use serde::{Deserialize, Serialize};

use super::allowed::did_you_mean;
use super::exact_length::exactly_if_given;
use super::pasted::plain_numbers;
use super::{Axis, PendulumSpec, PictureTable, Plane, QuestionSettings, Scene, SceneError, View};

/// Newest file format that this program reads, which is also the one that it writes.
pub(super) const FORMAT: u32 = 1;

/// A scene file. The tables after the view never change what is computed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Document {
    /// Version of the file format.
    pub format: u32,
    /// The pendulum.
    pub pendulum: PendulumSpec,
    /// The question asked about every start.
    pub question: QuestionSettings,
    /// The plane of starts.
    #[serde(skip_serializing_if = "is_plain")]
    pub plane: Plane,
    /// The part of the plane that is shown.
    pub view: View,
    /// Settings with which the picture is painted.
    pub picture: PictureTable,
    /// Settings with which the picture was computed.
    pub run: RunTable,
}

/// Settings of a picture's computation, which are the defaults when the picture is opened again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RunTable {
    /// Width and height in pixels.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "exactly_if_given")]
    pub size: Option<[u32; 2]>,
    /// Name of the accuracy level, if no method is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub accuracy: Option<String>,
    /// Name of the method.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<String>,
    /// Step of the method, as on the command line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub step: Option<String>,
    /// Tolerance of the method, as on the command line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<String>,
    /// Name of the number type.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub precision: Option<String>,
    /// True if every pixel was checked, beyond what the accuracy level requires.
    #[serde(skip_serializing_if = "is_false")]
    pub verify: bool,
}

impl RunTable {
    /// Returns the file's table overridden by the settings in `said`. An accuracy level in `said`
    /// replaces this whole table, and a different method discards the old step and tolerance. The
    /// size always comes from `said`.
    #[must_use]
    pub fn overlaid(&self, said: RunTable) -> RunTable {
        let kept = if said.accuracy.is_some() { RunTable::default() } else { self.clone() };
        let same_method = said.method.is_none() || said.method == kept.method;
        let of_kept = |text: Option<String>| text.filter(|_| same_method);
        RunTable {
            size: said.size,
            accuracy: said.accuracy.or(kept.accuracy),
            step: said.step.or(of_kept(kept.step)),
            tolerance: said.tolerance.or(of_kept(kept.tolerance)),
            precision: said.precision.or(of_kept(kept.precision)),
            method: said.method.or(kept.method),
            verify: kept.verify || said.verify,
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "what serde calls")]
fn is_false(value: &bool) -> bool {
    !value
}

fn is_plain(plane: &Plane) -> bool {
    *plane == Plane::default()
}

impl Default for Document {
    fn default() -> Self {
        Document {
            format: FORMAT,
            pendulum: PendulumSpec::default(),
            question: QuestionSettings::default(),
            plane: Plane::default(),
            view: View::default(),
            picture: PictureTable::default(),
            run: RunTable::default(),
        }
    }
}

/// Reasons why a text is not a valid scene.
#[derive(Debug, thiserror::Error)]
pub enum DocumentError {
    /// A text that is not a scene in TOML; the message says where and why.
    #[error("{0}")]
    Syntax(String),
    /// A file written by a newer program.
    #[error("the file has format {found}; this program reads format {FORMAT}")]
    Future {
        /// Format of the file.
        found: String,
    },
    /// A number out of range.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// A number out of range in a line of a file.
    #[error("line {line}: {error}")]
    InLine {
        /// Number of the line, from 1.
        line: usize,
        /// The error of its value.
        error: SceneError,
    },
}

impl DocumentError {
    /// Adds the line of a file's text that has the setting of the error, if one has.
    fn in_line(self, text: &str) -> Self {
        let DocumentError::Scene(error) = self else { return self };
        let sets = |line: &str| {
            let key = line.split_once('=').map_or("", |(key, _)| key.trim());
            key.rsplit('.').next() == Some(error.setting)
        };
        match (1..).zip(text.lines()).find(|(_, line)| sets(line)) {
            Some((line, _)) => DocumentError::InLine { line, error },
            None => DocumentError::Scene(error),
        }
    }
}

/// The file's version, read first so that a newer file is reported as newer and not as wrong.
#[derive(Deserialize)]
struct Version {
    format: Option<toml::Value>,
}

impl Document {
    /// Reads and checks a scene.
    pub fn parse(text: &str) -> Result<Self, DocumentError> {
        check_format(text)?;
        let syntax = |error: toml::de::Error| DocumentError::Syntax(one_line(&error, text));
        let document: Document = toml::from_str(text).map_err(syntax)?;
        document.in_units().checked().map_err(|error| error.in_line(text))
    }

    /// Returns the document with its coordinates as decimal numbers in the units of their axes: a
    /// file may have them as a person writes them.
    pub(super) fn in_units(self) -> Self {
        let axes = self.plane.axes();
        let origin = self.plane.origin.each_ref();
        let origin = [0, 1, 2, 3].map(|i| Axis::OF_STARTS[i].in_unit(&plain_numbers(origin[i])));
        let plane = Plane { origin, ..self.plane };
        Document { view: self.view.in_units(axes), plane, ..self }
    }

    /// Checks every number of the scene and of its picture, and guesses an automatic budget.
    pub fn checked(mut self) -> Result<Self, DocumentError> {
        self.question = self.scene().checked()?.question;
        self.picture.check()?;
        self.picture.shown(self.question.ask)?;
        Ok(self)
    }

    /// Computes the automatic budget of a checked document; see [`Scene::settled`].
    #[must_use]
    pub fn settled(mut self) -> Self {
        self.question = self.scene().settled().question;
        self
    }

    /// Checks every number of the scene and of its picture.
    pub fn check(&self) -> Result<(), DocumentError> {
        self.scene().checked()?;
        Ok(self.picture.check()?)
    }

    /// Returns the document as TOML.
    pub fn text(&self) -> String {
        toml::to_string(self).expect("plain tables are TOML")
    }

    /// Returns the scene to compute.
    pub fn scene(&self) -> Scene {
        Scene {
            build: self.pendulum,
            question: self.question,
            view: self.view.clone(),
            plane: self.plane.clone(),
        }
    }

    /// Replaces the scene, and keeps the picture and run tables, but for times that belong to
    /// another view.
    pub fn with_scene(mut self, scene: Scene) -> Self {
        if scene != self.scene() {
            self.picture.forget_view_times();
        }
        let Scene { build, question, view, plane } = scene;
        Document { pendulum: build, question, view, plane, ..self }
    }
}

/// Refuses a file in a newer format before its new keys are reported as unknown.
pub(super) fn check_format(text: &str) -> Result<(), DocumentError> {
    let Ok(Version { format: Some(found) }) = toml::from_str(text) else { return Ok(()) };
    if found.as_integer().is_some_and(|found| (1..=i64::from(FORMAT)).contains(&found)) {
        return Ok(());
    }
    Err(DocumentError::Future { found: found.to_string() })
}

/// Formats a TOML error as one sentence with its line and column. Keys and values of the file get
/// plain quotes, because words in backquotes are names of settings.
pub fn one_line(error: &toml::de::Error, text: &str) -> String {
    let message = in_plain_words(&error.message().replace('\n', ", ").replace('`', "'"));
    let Some(span) = error.span() else {
        return message;
    };
    let before = &text[..span.start.min(text.len())];
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    format!("line {line}, column {column}: {message}")
}

/// Returns a message of the parser in the words of people who write files.
fn in_plain_words(message: &str) -> String {
    const WORDS: [(&str, &str); 20] = [
        (
            "string values must be quoted, expected literal string",
            "a value must be a number, true, false or a text in quotes; a minus sign is '-'",
        ),
        ("invalid mantissa, expected digits", "a point must lie between digits, as in 0.5 or 5.0"),
        ("invalid type: map, expected a number", "it is a table or a date; it must be a number"),
        ("invalid type: ", "it is the "),
        ("invalid value: ", "it is the "),
        (", expected one of ", "; it must be one of "),
        (", expected ", "; it must be "),
        ("unknown variant ", "it is the unknown name "),
        ("unknown field ", "unknown key "),
        ("must be struct Document", "must be a table of tables, as in [key.scene.view]"),
        ("must be struct GroundTable", "must be a table, as in colours.unflipped = \"#101018\""),
        ("wanted string or table", "it must be a text in quotes"),
        ("must be a sequence", "must be a list, as in [1, 2]"),
        ("must be an array of length 2", "must be a list of two, as in [1, 2]"),
        (" as i128", ""),
        ("must be f64", "must be a number"),
        ("must be u32", "must be a whole number"),
        ("must be a map", "must be a table"),
        ("must be a boolean", "must be true or false"),
        ("must be a string", "must be a text in quotes"),
    ];
    let plain = WORDS.iter().fold(message.to_string(), |text, (from, to)| text.replace(from, to));
    // The remaining names of Rust's types are those of tables.
    let plain = match plain.split_once("must be struct ") {
        Some((before, _)) => {
            format!("{before}must be a table, with its keys below its name in brackets")
        }
        None => plain,
    };
    let names: Vec<&str> = plain.split('\'').skip(1).step_by(2).collect();
    match names[..] {
        [typed, ref known @ ..] if plain.contains("unknown") => {
            plain.clone() + &did_you_mean(known, typed)
        }
        _ => plain,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flipmap_pendulum::Rule;

    fn refused(text: &str) -> String {
        Document::parse(text).unwrap_err().to_string()
    }

    #[test]
    fn an_empty_file_is_the_home_scene() {
        assert_eq!(Document::parse("").unwrap(), Document::default());
    }

    #[test]
    fn what_is_written_reads_back_the_same() {
        let mut document = Document::default();
        document.question.rule = Rule::Either;
        document.view.center = ["-1.66000000000000000000000000000001".into(), "0.1".into()];
        document.run.step = Some("1/120".into());
        assert_eq!(Document::parse(&document.text()).unwrap(), document);
    }

    #[test]
    fn coordinates_are_read_as_people_write_them() {
        let view =
            |text: &str| Document::parse(&format!("[view]\n{text}")).map(|document| document.view);
        let plain = view("width = 1\ncenter = [\"90deg\", 0.5]").unwrap();
        assert!(
            plain.center[0].starts_with("1.5707963267948966192313216916")
                && plain.center[1] == "0.5"
        );
        assert_eq!(plain.width, "1");
        assert_eq!(view("center = [\"\u{2212}1.5\", \"(2)\"]").unwrap().center, ["-1.5", "2"]);
        let long = view("center = [0.12345678901234567, 0]").unwrap_err().to_string();
        assert!(
            long.contains("line 2, column 11") && long.contains("must stand in quotes"),
            "{long}"
        );
    }

    #[test]
    fn bad_files_are_refused_where_they_are_bad() {
        assert!(
            refused("[pendulum]\nmass = 1")
                .starts_with("line 2, column 1: unknown key 'mass'; it must")
        );
        assert!(refused("[question]\nbudget = \"long\"").contains("line 2, column 10"));
        let three = refused("[pendulum]\nmasses = [1.0, 2.0, 3.0]");
        assert_eq!(three, "line 2, column 10: it has 3 values, not 2");
        let arrays = [
            "[pendulum]\nlengths = [1.0]",
            "[pendulum]\nfriction = [0.0, 0.0, 0.0]",
            "[view]\ncenter = [\"0\", \"0\", \"1\"]",
            "[plane]\norigin = [\"0\", \"0\", \"1\", \"1\", \"1\"]",
            "[run]\nsize = [8, 8, 8]",
        ];
        for text in arrays {
            let error = refused(text);
            assert!(error.starts_with("line 2, column ") && error.contains(", not "), "{error}");
        }
        assert!(refused("[question]\nrule = \"third\"").contains("line 2"));
        let unknown = refused("[question]\nask = \"why\"");
        assert!(unknown.contains("'flips', 'state'") && !unknown.contains('`'), "{unknown}");
        assert!(refused("format = 2\nnew = 1").contains("format 2; this program reads"));
        assert!(refused("[view]\nwidth = \"0\"").starts_with("line 2: `width` is '0'; it must"));
        assert!(
            unknown.starts_with("line 2, column 7: it is the unknown name 'why'; it must be one")
        );
        let near = refused("[question]\nask = \"flp\"");
        assert!(near.ends_with("did you mean 'flip'?"), "{near}");
        let relief = refused("[picture]\nrelief = \"high\"");
        assert!(relief.ends_with("it is the string \"high\"; it must be a number"), "{relief}");
        assert!(refused("[pendulum]\nmasses = [1.0, nan]").contains("`masses`"));
        assert!(refused("[pendulum]\ngravity = -9.81").contains("`gravity`"));
        let rule = refused("[question]\nask = \"state\"\nrule = \"first\"");
        assert!(rule.contains("`rule` is 'first'; only the question flip"), "{rule}");
        let energy = refused("[plane]\nkind = \"angles\"\nenergy = 5.0");
        assert!(energy.contains("only the plane section has an energy"), "{energy}");
    }
}
