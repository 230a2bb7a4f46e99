//! A scene as one line, to be copied and pasted:
//! `flipmap:center=-1.66,0.1;width=0.4;budget=60;rule=either`.
//!
//! A link is the address of a page in a browser that shows the location after its `#`.
//!
//! The words are those of the command line. Centre and width are always present, the other words
//! only where they differ from the defaults.

use super::allowed::did_you_mean;
use super::pasted::plain_numbers;
use super::words::set_all;
use super::{Scene, SceneError, Setting};

/// Prefix of every location.
const PREFIX: &str = "flipmap:";
/// Address of the page in the links that the program copies; the page itself copies its own.
pub const PAGE: &str = "https://flipmap.github.io/flipmap/";

/// Reasons why a text is not a location.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LocationError {
    /// A text of some other kind.
    #[error(
        "this is not a location: it must begin with '{PREFIX}', as in \
         {PREFIX}center=-1.66,0.1;width=0.4, or be three numbers θ1,θ2,width"
    )]
    Foreign,
    /// A part without a word.
    #[error("the location has '{0}' where a word, '=' and a value should be")]
    NoWord(String),
    /// A word that no scene has.
    #[error("the location has the unknown word '{word}'; the words are {known}{meant}")]
    Unknown {
        /// The word.
        word: String,
        /// The words that exist, separated by commas.
        known: String,
        /// A question after the word that may be meant; empty if none is similar.
        meant: String,
    },
    /// A word that appears twice.
    #[error("the location says {0} twice; leave one of them out")]
    Twice(&'static str),
    /// A value that cannot be used.
    #[error("{}", .0.called(&format_args!("the location's {}", .0.setting)))]
    Scene(#[from] SceneError),
}

/// Returns the scene as one line, which [`parse`] turns back into the same scene.
pub fn text(scene: &Scene) -> String {
    let home = Scene::default();
    let mut parts = Vec::new();
    for setting in Setting::all() {
        let text = setting.text(scene);
        if matches!(setting, Setting::Center | Setting::Width) || text != setting.text(&home) {
            parts.push(format!("{}={text}", setting.name()));
        }
    }
    format!("{PREFIX}{}", parts.join(";"))
}

/// Returns the link to a page in a browser that shows the scene.
pub fn link(scene: &Scene) -> String {
    format!("{PAGE}#{}", text(scene))
}

/// Reads a scene from one line, a location or a link to any page with one; white space is allowed
/// around the line and its parts.
pub fn parse(text: &str) -> Result<Scene, LocationError> {
    let in_link = in_link(text);
    let text = in_link.as_deref().unwrap_or(text).trim();
    let Some(parts) = text.strip_prefix(PREFIX) else { return three_numbers(text) };
    let mut scene = Scene::default();
    let mut said = Vec::new();
    for part in parts.split(';').map(str::trim).filter(|part| !part.is_empty()) {
        let (key, value) =
            part.split_once('=').ok_or_else(|| LocationError::NoWord(part.to_string()))?;
        let word = known(key.trim())?;
        if said.iter().any(|(other, _)| *other == word) {
            return Err(LocationError::Twice(word.name()));
        }
        said.push((word, value.trim()));
    }
    set_all(&mut scene, &said)?;
    Ok(scene.checked()?)
}

/// Returns the part of a link after its `#`, with the bytes that browsers write as `%` and two hex
/// digits; none if the text is not the address of a page.
fn in_link(text: &str) -> Option<String> {
    let text = text.trim();
    let is_address = ["http://", "https://", "file://"].iter().any(|kind| text.starts_with(kind));
    let (_, part) = text.split_once('#').filter(|_| is_address)?;
    let bytes = part.as_bytes();
    let (mut plain, mut at) = (Vec::new(), 0);
    while let Some(&byte) = bytes.get(at) {
        let digits = part.get(at + 1..at + 3).filter(|_| byte == b'%');
        let coded = digits.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        plain.push(coded.unwrap_or(byte));
        at += if coded.is_some() { 3 } else { 1 };
    }
    String::from_utf8(plain).ok()
}

fn known(key: &str) -> Result<Setting, LocationError> {
    Setting::named(key).ok_or_else(|| {
        let names: Vec<&str> = Setting::all().map(Setting::name).collect();
        let meant = did_you_mean(&names, key);
        LocationError::Unknown { word: key.to_string(), known: names.join(", "), meant }
    })
}

/// Reads `θ1,θ2,width`, as people write it in a message.
fn three_numbers(text: &str) -> Result<Scene, LocationError> {
    let text = plain_numbers(text);
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let [theta1, theta2, width] = parts[..] else { return Err(LocationError::Foreign) };
    if parts.iter().any(|part| part.parse::<f64>().is_err()) {
        return Err(LocationError::Foreign);
    }
    let mut scene = Scene::default();
    scene.view.center = [theta1, theta2].map(str::to_string);
    scene.view.width = width.to_string();
    Ok(scene.checked()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BUILT_IN, Budget, Kind, PendulumSpec, QuestionSettings, View};
    use flipmap_pendulum::Rule;
    use proptest::prelude::*;

    fn refused(text: &str) -> String {
        parse(text).unwrap_err().to_string()
    }

    #[test]
    fn a_location_reads_well() {
        let mut scene = Scene::default();
        assert_eq!(text(&scene), "flipmap:center=0,0;width=6.283185307179586");
        scene.view.center = ["-1.66".into(), "0.1".into()];
        scene.view.width = "0.4".into();
        scene.question = QuestionSettings {
            rule: Rule::Either,
            budget: Budget::secs(60.0),
            ..QuestionSettings::default()
        };
        let line = "flipmap:center=-1.66,0.1;width=0.4;budget=60;rule=either";
        assert_eq!(text(&scene), line);
        assert_eq!(parse(&format!("\n  {line} ;\t\n")), Ok(scene.clone()));
        let spaced = "flipmap: width = 0.4; rule = either; center = -1.66, 0.1; budget = 60";
        assert_eq!(parse(spaced), Ok(scene));
        assert_eq!(parse("flipmap:"), Ok(Scene::default()));
    }

    #[test]
    fn a_link_is_read_whatever_page_it_names() {
        let mut scene = Scene::default();
        scene.view.center = ["-1.66".into(), "0.1".into()];
        scene.view.width = "0.4".into();
        assert_eq!(parse(&link(&scene)), Ok(scene.clone()));
        let coded = "http://127.0.0.1:8000/page/?a=b#flipmap%3Acenter%3D-1.66%2C0.1;width=0.4 ";
        assert_eq!(parse(coded), Ok(scene));
        assert_eq!(parse("https://example.org/#flipmap:"), Ok(Scene::default()));
        assert!(refused("https://example.org/#flipmap:width=0").contains("width is '0'"));
        for text in ["https://example.org/#100%", "https://example.org/#%zz%e4", "page#flipmap:"] {
            assert_eq!(parse(text), Err(LocationError::Foreign), "{text}");
        }
    }

    #[test]
    fn three_numbers_are_a_view() {
        let scene = parse(" -1.66, 1e-1 ,0.4\n").unwrap();
        assert_eq!(text(&scene), "flipmap:center=-1.66,1e-1;width=0.4");
    }

    #[test]
    fn built_in_scenes_come_back() {
        for built_in in BUILT_IN {
            let mut scene = built_in.document().scene();
            // A location holds the view as it is seen, without `fit`.
            scene.view.fit = false;
            assert_eq!(parse(&text(&scene)), Ok(scene));
        }
    }

    #[test]
    fn what_is_no_location_is_refused_in_a_sentence() {
        for text in ["", "hello", "https://example.org", "1,2", "1,2,x", "1,2,3,4"] {
            assert_eq!(parse(text), Err(LocationError::Foreign), "{text}");
        }
        assert!(refused("flipmap:1,2,3").contains("has '1,2,3' where a word"));
        assert!(refused("flipmap:centre=1,2").contains("'centre'; the words are center, width"));
        assert!(refused("flipmap:width=1;width=2").contains("width twice"));
        assert!(refused("flipmap:width=0").contains("the location's width is '0'; it must be"));
        assert!(refused("flipmap:rule=third").contains("the rules are second, first, either"));
        assert!(refused("flipmap:budget=inf").contains("the location's budget is inf; it must"));
        let energy = refused("flipmap:plane=speeds;energy=5");
        assert!(energy.contains("energy is '5'; only the plane section"), "{energy}");
        assert_eq!(refused("flipmap:energy=5;plane=speeds"), energy);
        assert!(parse("flipmap:energy=5;plane=section").is_ok());
        assert!(refused("1,2,nan").contains("width is 'nan'"));
    }

    fn scenes() -> impl Strategy<Value = Scene> {
        let wide = || prop::array::uniform2(1e-9..1e9f64);
        let rule = prop::sample::select(Rule::ALL.map(|(_, rule)| rule).to_vec());
        let kind = prop::sample::select(vec![Kind::Points, Kind::Rods]);
        // More digits than any float has.
        let view = (-99999..99999i32, any::<u128>(), -99999..99999i32, 1..10u8, 0..10u8).prop_map(
            |(theta1, digits, theta2, first, exponent)| {
                let center = [format!("{theta1}.{digits}"), theta2.to_string()];
                (center, format!("{first}.{digits}e-{exponent}"))
            },
        );
        (
            wide(),
            wide(),
            0.0..1e9f64,
            1e-9..1e6f64,
            rule,
            kind,
            view,
            -360.0..360.0f64,
            1e-6..1e6f64,
        )
            .prop_map(
                |(masses, lengths, gravity, budget, rule, kind, view, rotate, stretch)| {
                    let (center, width) = view;
                    Scene {
                        build: PendulumSpec::new(kind, masses, lengths, gravity),
                        question: QuestionSettings {
                            rule,
                            budget: Budget::secs(budget),
                            ..QuestionSettings::default()
                        },
                        view: View { center, width, rotate, stretch, fit: false },
                        ..Scene::default()
                    }
                },
            )
    }

    proptest! {
        #[test]
        fn every_scene_comes_back_the_same(scene in scenes()) {
            prop_assume!(scene.clone().checked().is_ok());
            prop_assert_eq!(parse(&text(&scene)), Ok(scene));
        }

        #[test]
        fn nothing_pasted_is_too_odd(text in "\\PC*") {
            let _ = parse(&text);
            let _ = parse(&format!("flipmap:{text}"));
            let _ = parse(&format!("https://example.org/#{text}"));
        }
    }
}
