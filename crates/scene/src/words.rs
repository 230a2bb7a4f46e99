//! The settings of a scene as text: in options, in keys of files, and in locations such as
//! `rule=either`.

use super::{Axis, Kind, Plane, PlaneKind, QuestionSettings, Scene, SceneError};
use crate::question::QuestionName;
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;

/// A setting of a scene: a number, a pair of numbers or a word, with its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Centre of the view, θ1 and θ2.
    Center,
    /// Width of the view.
    Width,
    /// Rotation of the view.
    Rotate,
    /// Stretch of the view.
    Stretch,
    /// Budget of a pixel.
    Budget,
    /// The rule: which bob is watched.
    Rule,
    /// Kind of pendulum: bobs or bars.
    Kind,
    /// Masses m1, m2.
    Masses,
    /// Lengths l1, l2.
    Lengths,
    /// Gravity g.
    Gravity,
    /// Friction b1, b2.
    Friction,
    /// The question's name.
    Ask,
    /// Time of the answer.
    At,
    /// Number of the flip.
    Count,
    /// The quantities on the plane's axes.
    Plane,
    /// Start through which the plane lies.
    Origin,
    /// Energy of a section.
    Energy,
}

impl Scene {
    /// Sets settings of the scene from text and checks the result. Refuses a rule, an energy, an
    /// origin or an automatic budget where it has no effect.
    pub fn with_words<'a>(
        mut self,
        words: impl IntoIterator<Item = (Setting, &'a str)>,
    ) -> Result<Self, SceneError> {
        let words: Vec<_> = words.into_iter().collect();
        set_all(&mut self, &words)?;
        for (word, text) in words {
            if let Some(range) = self.without_effect(word) {
                return Err(SceneError::new(word.setting(), format!("'{text}'"), range));
            }
        }
        self.checked()
    }

    /// Returns the reason why a setting has no effect on this scene, or `None` if it has an effect.
    fn without_effect(&self, word: Setting) -> Option<&'static str> {
        let is_section = self.plane.kind == PlaneKind::Section;
        match word {
            Setting::Rule if !self.question.has_rule() => Some(QuestionSettings::RULE_IS_FOR),
            Setting::Energy if !is_section => Some(Plane::ENERGY_IS_FOR),
            Setting::Origin if is_section => Some(Plane::NO_ORIGIN),
            Setting::Budget if self.question.budget.auto && !self.is_flip_from_rest() => Some(
                "automatic budgets are for first flips of pendulums released from rest: it must be \
                 a number of seconds between 1e-9 and 1e6",
            ),
            _ => None,
        }
    }
}

/// Sets settings of a scene from text. The question and the plane come first, because they reset
/// values that they do not use, and the plane decides the units of its coordinates.
pub(super) fn set_all(scene: &mut Scene, words: &[(Setting, &str)]) -> Result<(), SceneError> {
    let (kinds, others): (Vec<_>, Vec<_>) =
        words.iter().partition(|(word, _)| matches!(word, Setting::Ask | Setting::Plane));
    for (word, text) in kinds {
        word.set(scene, text)?;
        *scene = scene.clone().without_unused();
    }
    others.into_iter().try_for_each(|(word, text)| word.set(scene, text))
}

/// The word for the end of the budget.
const END_OF_BUDGET: &str = "budget";

const WIDE_PAIR: &str = "it must be two numbers between 1e-9 and 1e9 with a comma between them";

impl Setting {
    /// Every setting with its name: the view first, then the question and the pendulum.
    pub const ALL: [(&'static str, Setting); 17] = [
        ("center", Setting::Center),
        ("width", Setting::Width),
        ("rotate", Setting::Rotate),
        ("stretch", Setting::Stretch),
        ("budget", Setting::Budget),
        ("rule", Setting::Rule),
        ("kind", Setting::Kind),
        ("masses", Setting::Masses),
        ("lengths", Setting::Lengths),
        ("gravity", Setting::Gravity),
        ("friction", Setting::Friction),
        ("ask", Setting::Ask),
        ("at", Setting::At),
        ("count", Setting::Count),
        ("plane", Setting::Plane),
        ("origin", Setting::Origin),
        ("energy", Setting::Energy),
    ];

    /// Returns the setting's name.
    pub fn setting(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    /// Sets this setting of a scene from `text`; [`Scene::checked`] checks the ranges.
    pub(crate) fn set(self, scene: &mut Scene, text: &str) -> Result<(), SceneError> {
        self.apply(scene, text.trim())
            .map_err(|range| SceneError::new(self.setting(), format!("'{text}'"), range))
    }

    fn apply(self, scene: &mut Scene, text: &str) -> Result<(), &'static str> {
        let Scene { build, question, view, plane } = scene;
        let number = |range| text.parse().map_err(|_| range);
        let [across, up] = plane.axes();
        match self {
            Setting::Center => {
                let pair = text.split_once(',');
                let (x, y) = pair.ok_or("it must be two numbers with a comma between them")?;
                view.center = [across.in_unit(x), up.in_unit(y)];
            }
            Setting::Width => (view.width, view.fit) = (across.in_unit(text), false),
            Setting::Rotate => {
                view.rotate = number("it must be a number of degrees between -360 and 360")?;
            }
            Setting::Stretch => view.stretch = number("it must be a number between 1e-6 and 1e6")?,
            Setting::Budget => {
                let range = "it must be auto or a number of seconds between 1e-9 and 1e6";
                question.budget = text.parse().map_err(|()| range)?;
            }
            Setting::Rule => {
                question.rule =
                    known(&Rule::ALL, text).ok_or("the rules are second, first, either")?;
            }
            Setting::Kind => {
                build.kind = known(&Kind::ALL, text).ok_or("it must be points or rods")?;
            }
            Setting::Masses => build.masses = pair(text).ok_or(WIDE_PAIR)?,
            Setting::Lengths => build.lengths = pair(text).ok_or(WIDE_PAIR)?,
            Setting::Gravity => {
                let range = "it must be 0 or a number between 1e-9 and 1e9 m/s²";
                build.gravity = text.parse().map_err(|()| range)?;
            }
            Setting::Friction => {
                let range = "it must be two numbers between 0 and 1e9 N m s with a comma between";
                build.friction = pair(text).ok_or(range)?;
            }
            Setting::Ask => question.ask = text.parse().map_err(|_| QuestionName::NAMES)?,
            Setting::At => {
                let none = text == END_OF_BUDGET;
                let range = "it must be a number of seconds within the budget, or budget";
                question.at = if none { None } else { Some(number(range)?) };
            }
            Setting::Count => {
                let range = "it must be a whole number between 1 and 1000000";
                question.count = text.parse().map_err(|_| range)?;
            }
            Setting::Plane => plane.kind = text.parse()?,
            Setting::Origin => {
                let parts: Vec<&str> = text.split(',').collect();
                let parts: [&str; 4] =
                    parts.try_into().map_err(|_| "it must be four numbers θ1,θ2,ω1,ω2")?;
                plane.origin = [0, 1, 2, 3].map(|i| Axis::OF_STARTS[i].in_unit(parts[i]));
            }
            Setting::Energy => plane.energy = number("it must be a number of joules")?,
        }
        Ok(())
    }

    /// Returns the setting's value as text, which [`Setting::set`] reads back.
    pub fn text(self, scene: &Scene) -> String {
        let Scene { build, question, view, plane } = scene;
        let pair = |[first, second]: [Decimal; 2]| format!("{first},{second}");
        match self {
            Setting::Center => view.center.join(","),
            Setting::Width => view.width.clone(),
            Setting::Rotate => view.rotate.to_string(),
            Setting::Stretch => view.stretch.to_string(),
            Setting::Budget => question.budget.to_string(),
            Setting::Rule => question.rule.to_string(),
            Setting::Kind => Kind::ALL[build.kind as usize].0.to_string(),
            Setting::Masses => pair(build.masses),
            Setting::Lengths => pair(build.lengths),
            Setting::Gravity => build.gravity.to_string(),
            Setting::Friction => pair(build.friction),
            Setting::Ask => question.ask.to_string(),
            Setting::At => question.at.map_or(END_OF_BUDGET.to_string(), |at| at.to_string()),
            Setting::Count => question.count.to_string(),
            Setting::Plane => plane.kind.to_string(),
            Setting::Origin => plane.origin.join(","),
            Setting::Energy => plane.energy.to_string(),
        }
    }
}

fn known<T: Copy>(all: &[(&str, T)], text: &str) -> Option<T> {
    all.iter().find(|(word, _)| *word == text).map(|(_, value)| *value)
}

fn pair(text: &str) -> Option<[Decimal; 2]> {
    let (first, second) = text.split_once(',')?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuiltIn;

    #[test]
    fn words_and_kinds_stand_in_their_places() {
        for (place, (setting, word)) in Setting::ALL.into_iter().enumerate() {
            assert_eq!((word as usize, word.setting()), (place, setting));
        }
        for (place, (_, kind)) in Kind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place);
        }
    }

    #[test]
    fn another_question_or_plane_leaves_out_what_it_does_not_have() {
        let scene = |name: &str| BuiltIn::named(name).unwrap().document().scene();
        let with = |name: &str, words: &[(Setting, &str)]| scene(name).with_words(words.to_vec());
        let either = with("either", &[(Setting::Ask, "state")]).unwrap();
        assert_eq!(
            (either.question.rule, either.question.ask),
            (Rule::Second, QuestionName::State)
        );
        assert_eq!(with("moment", &[(Setting::Ask, "flip")]).unwrap().question.at, None);
        assert_eq!(with("moment", &[(Setting::Ask, "state")]).unwrap().question.at, Some(12.0));
        for said in [(Setting::Rule, "either"), (Setting::Rule, "second"), (Setting::Count, "2")] {
            assert!(with("either", &[(Setting::Ask, "state"), said]).is_err(), "{said:?}");
        }
        let mut section = scene("section");
        section.plane.energy = 5.0;
        let kept = section.clone().with_words([(Setting::Plane, "section")]).unwrap();
        assert_eq!(kept.plane.energy, 5.0);
        assert_eq!(section.with_words([(Setting::Plane, "speeds")]).unwrap().plane.energy, 0.0);
    }

    #[test]
    fn what_a_word_says_it_also_sets() {
        let said =
            ["1.5,-0.25", "1e-12", "30", "2", "60", "either", "rods", "1,2.5", "0.4,1", "1.62"];
        let mut scene = Scene::default();
        for ((_, word), text) in Setting::ALL.into_iter().zip(said) {
            assert_ne!(word.text(&scene), text);
            word.set(&mut scene, text).unwrap();
            assert_eq!(word.text(&scene), text);
        }
    }
}
