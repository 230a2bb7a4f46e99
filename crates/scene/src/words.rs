//! Settings of a scene from text: from options, and from locations such as `rule=either`.

use super::allowed::between;
use super::{Budget, Plane, PlaneKind, QuestionSettings, Scene, SceneError, Setting};

impl Scene {
    /// Sets settings of the scene from text and checks the result. Refuses a rule, an energy, an
    /// origin or an automatic budget where it has no effect.
    pub fn with_words<'a>(
        mut self,
        words: impl IntoIterator<Item = (Setting, &'a str)>,
    ) -> Result<Self, SceneError> {
        let words: Vec<_> = words.into_iter().collect();
        set_all(&mut self, &words)?;
        for (setting, text) in &words {
            if let Some(allowed) = self.without_effect(*setting) {
                return Err(SceneError::new(setting.name(), format!("'{text}'"), allowed));
            }
        }
        self.checked().map_err(|mut error| {
            let typed = words.iter().find(|(setting, _)| setting.name() == error.setting);
            if let Some((_, text)) = typed {
                error.value = format!("'{text}'");
            }
            error
        })
    }

    /// Returns the reason why a setting has no effect on this scene, or `None` if it has an effect.
    fn without_effect(&self, setting: Setting) -> Option<String> {
        let is_section = self.plane.kind == PlaneKind::Section;
        let why = match setting {
            Setting::Rule if !self.question.has_rule() => QuestionSettings::RULE_IS_FOR,
            Setting::Energy if !is_section => Plane::ENERGY_IS_FOR,
            Setting::Origin if is_section => Plane::NO_ORIGIN,
            Setting::Budget if self.question.budget.auto && !self.is_flip_from_rest() => {
                return Some(format!(
                    "automatic budgets are for first flips of pendulums released from rest: it must \
                     be a number of seconds {}",
                    between(&Budget::SECS)
                ));
            }
            _ => return None,
        };
        Some(why.to_string())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuiltIn;
    use crate::question::QuestionName;
    use flipmap_pendulum::Rule;

    #[test]
    fn a_refused_value_is_quoted_as_it_was_typed() {
        let refused =
            |setting, text| Scene::default().with_words([(setting, text)]).unwrap_err().to_string();
        for (setting, text, hint) in [
            (Setting::Width, "1,5", "; decimals are written with a point, as in 1.5"),
            (Setting::Budget, "2,5", "as in 2.5"),
            (Setting::Center, "1,5,2,5", "as in 1.5,2.5"),
            (
                Setting::Center,
                "1,2,3",
                "`center` is '1,2,3'; it must be two numbers with a comma between them",
            ),
        ] {
            let error = refused(setting, text);
            assert!(error.ends_with(hint), "{error}");
        }
        let pasted = [(Setting::Center, "(\u{2212}1.66,\u{a0}0.1)."), (Setting::Width, "0.4.")];
        let scene = Scene::default().with_words(pasted).unwrap();
        assert_eq!(
            (scene.view.center, scene.view.width),
            (["-1.66".into(), "0.1".into()], "0.4".into())
        );
        let words = [(Setting::Stretch, "1e0"), (Setting::Budget, "-3e0")];
        let error = Scene::default().with_words(words).unwrap_err();
        assert!(error.to_string().starts_with("`budget` is '-3e0'; it must be"), "{error}");
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
}
