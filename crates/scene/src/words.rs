//! The numbers of a scene as words: `rule` as an option, a key, or in a location as `rule=either`.

use super::{Axis, Kind, Plane, PlaneKind, QuestionTable, Scene, SceneError};
use crate::question::Ask;
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;

/// One number of a scene, or a pair of numbers, that has a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Word {
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
    /// Sets words of the scene and checks the result. A rule for a question that has none is refused,
    /// and so are an energy, an origin and an automatic budget where these have no effect.
    pub fn with_words<'a>(
        mut self,
        words: impl IntoIterator<Item = (Word, &'a str)>,
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

    /// The reason why a word has no effect on this scene, if it has none.
    fn without_effect(&self, word: Word) -> Option<&'static str> {
        let is_section = self.plane.kind == PlaneKind::Section;
        match word {
            Word::Rule if !self.question.has_rule() => Some(QuestionTable::RULE_IS_FOR),
            Word::Energy if !is_section => Some(Plane::ENERGY_IS_FOR),
            Word::Origin if is_section => Some(Plane::NO_ORIGIN),
            Word::Budget if self.question.budget.auto && !self.is_flip_from_rest() => Some(
                "automatic budgets are for first flips of pendulums released from rest: it must be \
                 a number of seconds between 1e-9 and 1e6",
            ),
            _ => None,
        }
    }
}

/// Sets words of a scene. Question and plane come first: they leave out what only earlier ones have,
/// and the plane decides the units of its coordinates.
pub(super) fn set_all(scene: &mut Scene, words: &[(Word, &str)]) -> Result<(), SceneError> {
    let (kinds, others): (Vec<_>, Vec<_>) =
        words.iter().partition(|(word, _)| matches!(word, Word::Ask | Word::Plane));
    for (word, text) in kinds {
        word.set(scene, text)?;
        *scene = scene.clone().without_strays();
    }
    others.into_iter().try_for_each(|(word, text)| word.set(scene, text))
}

/// The word for the end of the budget.
const END_OF_BUDGET: &str = "budget";

const WIDE_PAIR: &str = "it must be two numbers between 1e-9 and 1e9 with a comma between them";

impl Word {
    /// Every word with its name: the view first, then the question and the pendulum.
    pub const ALL: [(&'static str, Word); 17] = [
        ("center", Word::Center),
        ("width", Word::Width),
        ("rotate", Word::Rotate),
        ("stretch", Word::Stretch),
        ("budget", Word::Budget),
        ("rule", Word::Rule),
        ("kind", Word::Kind),
        ("masses", Word::Masses),
        ("lengths", Word::Lengths),
        ("gravity", Word::Gravity),
        ("friction", Word::Friction),
        ("ask", Word::Ask),
        ("at", Word::At),
        ("count", Word::Count),
        ("plane", Word::Plane),
        ("origin", Word::Origin),
        ("energy", Word::Energy),
    ];

    /// The word's name.
    pub fn setting(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    /// Sets this word of a scene from `text`; [`Scene::checked`] checks the ranges.
    pub(crate) fn set(self, scene: &mut Scene, text: &str) -> Result<(), SceneError> {
        self.apply(scene, text.trim())
            .map_err(|range| SceneError::new(self.setting(), format!("'{text}'"), range))
    }

    fn apply(self, scene: &mut Scene, text: &str) -> Result<(), &'static str> {
        let Scene { build, question, view, plane } = scene;
        let number = |range| text.parse().map_err(|_| range);
        let [across, up] = plane.axes();
        match self {
            Word::Center => {
                let pair = text.split_once(',');
                let (x, y) = pair.ok_or("it must be two numbers with a comma between them")?;
                view.center = [across.in_unit(x), up.in_unit(y)];
            }
            Word::Width => (view.width, view.fit) = (across.in_unit(text), false),
            Word::Rotate => {
                view.rotate = number("it must be a number of degrees between -360 and 360")?;
            }
            Word::Stretch => view.stretch = number("it must be a number between 1e-6 and 1e6")?,
            Word::Budget => {
                let range = "it must be auto or a number of seconds between 1e-9 and 1e6";
                question.budget = text.parse().map_err(|()| range)?;
            }
            Word::Rule => {
                question.rule =
                    known(&Rule::ALL, text).ok_or("the rules are second, first, either")?;
            }
            Word::Kind => {
                build.kind = known(&Kind::ALL, text).ok_or("it must be points or rods")?;
            }
            Word::Masses => build.masses = pair(text).ok_or(WIDE_PAIR)?,
            Word::Lengths => build.lengths = pair(text).ok_or(WIDE_PAIR)?,
            Word::Gravity => {
                let range = "it must be 0 or a number between 1e-9 and 1e9 m/s²";
                build.gravity = text.parse().map_err(|()| range)?;
            }
            Word::Friction => {
                let range = "it must be two numbers between 0 and 1e9 N m s with a comma between";
                build.friction = pair(text).ok_or(range)?;
            }
            Word::Ask => question.ask = text.parse().map_err(|_| Ask::NAMES)?,
            Word::At => {
                let none = text == END_OF_BUDGET;
                let range = "it must be a number of seconds within the budget, or budget";
                question.at = if none { None } else { Some(number(range)?) };
            }
            Word::Count => {
                let range = "it must be a whole number between 1 and 1000000";
                question.count = text.parse().map_err(|_| range)?;
            }
            Word::Plane => plane.kind = text.parse()?,
            Word::Origin => {
                let parts: Vec<&str> = text.split(',').collect();
                let parts: [&str; 4] =
                    parts.try_into().map_err(|_| "it must be four numbers θ1,θ2,ω1,ω2")?;
                plane.origin = [0, 1, 2, 3].map(|i| Axis::OF_STARTS[i].in_unit(parts[i]));
            }
            Word::Energy => plane.energy = number("it must be a number of joules")?,
        }
        Ok(())
    }

    /// The value of the word as text, which [`Word::set`] reads back.
    pub fn text(self, scene: &Scene) -> String {
        let Scene { build, question, view, plane } = scene;
        let pair = |[first, second]: [Decimal; 2]| format!("{first},{second}");
        match self {
            Word::Center => view.center.join(","),
            Word::Width => view.width.clone(),
            Word::Rotate => view.rotate.to_string(),
            Word::Stretch => view.stretch.to_string(),
            Word::Budget => question.budget.to_string(),
            Word::Rule => question.rule.to_string(),
            Word::Kind => Kind::ALL[build.kind as usize].0.to_string(),
            Word::Masses => pair(build.masses),
            Word::Lengths => pair(build.lengths),
            Word::Gravity => build.gravity.to_string(),
            Word::Friction => pair(build.friction),
            Word::Ask => question.ask.to_string(),
            Word::At => question.at.map_or(END_OF_BUDGET.to_string(), |at| at.to_string()),
            Word::Count => question.count.to_string(),
            Word::Plane => plane.kind.to_string(),
            Word::Origin => plane.origin.join(","),
            Word::Energy => plane.energy.to_string(),
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
        for (place, (setting, word)) in Word::ALL.into_iter().enumerate() {
            assert_eq!((word as usize, word.setting()), (place, setting));
        }
        for (place, (_, kind)) in Kind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place);
        }
    }

    #[test]
    fn another_question_or_plane_leaves_out_what_it_does_not_have() {
        let scene = |name: &str| BuiltIn::named(name).unwrap().document().scene();
        let with = |name: &str, words: &[(Word, &str)]| scene(name).with_words(words.to_vec());
        let either = with("either", &[(Word::Ask, "state")]).unwrap();
        assert_eq!((either.question.rule, either.question.ask), (Rule::Second, Ask::State));
        assert_eq!(with("moment", &[(Word::Ask, "flip")]).unwrap().question.at, None);
        assert_eq!(with("moment", &[(Word::Ask, "state")]).unwrap().question.at, Some(12.0));
        for said in [(Word::Rule, "either"), (Word::Rule, "second"), (Word::Count, "2")] {
            assert!(with("either", &[(Word::Ask, "state"), said]).is_err(), "{said:?}");
        }
        let mut section = scene("section");
        section.plane.energy = 5.0;
        let kept = section.clone().with_words([(Word::Plane, "section")]).unwrap();
        assert_eq!(kept.plane.energy, 5.0);
        assert_eq!(section.with_words([(Word::Plane, "speeds")]).unwrap().plane.energy, 0.0);
    }

    #[test]
    fn what_a_word_says_it_also_sets() {
        let said =
            ["1.5,-0.25", "1e-12", "30", "2", "60", "either", "rods", "1,2.5", "0.4,1", "1.62"];
        let mut scene = Scene::default();
        for ((_, word), text) in Word::ALL.into_iter().zip(said) {
            assert_ne!(word.text(&scene), text);
            word.set(&mut scene, text).unwrap();
            assert_eq!(word.text(&scene), text);
        }
    }
}
