//! The built-in scenes: places worth seeing, each described by a sentence in the first line of its
//! file.

use flipmap_assets::SCENES;

use super::Document;
use super::allowed::closest;

/// A scene of `assets/scenes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BuiltIn {
    /// Name on the command line.
    pub name: &'static str,
    text: &'static str,
}

/// All built-in scenes in the order in which they are shown: from the whole map inwards, then the
/// others.
pub const BUILT_IN: [BuiltIn; SCENES.len()] = {
    let mut all = [BuiltIn { name: "", text: "" }; SCENES.len()];
    let mut k = 0;
    while k < all.len() {
        all[k] = BuiltIn { name: SCENES[k].0, text: SCENES[k].1 };
        k += 1;
    }
    all
};

impl BuiltIn {
    /// Finds the scene called `name`.
    pub fn named(name: &str) -> Option<Self> {
        BUILT_IN.into_iter().find(|scene| scene.name == name)
    }

    /// Returns the scene that is shown if none is named.
    pub fn home() -> Self {
        BUILT_IN[0]
    }

    /// Returns the scene whose name is most similar to a mistyped one, if any is similar enough.
    pub fn like(name: &str) -> Option<Self> {
        closest(BUILT_IN.iter().map(|scene| scene.name), name).and_then(Self::named)
    }

    /// Returns the names of all built-in scenes, separated by commas.
    pub fn names() -> String {
        BUILT_IN.map(|scene| scene.name).join(", ")
    }

    /// Returns the sentence that says what there is to see.
    pub fn sentence(&self) -> &'static str {
        self.text.lines().next().unwrap_or_default().trim_start_matches("# ")
    }

    /// Parses the scene.
    pub fn document(&self) -> Document {
        Document::parse(self.text).expect("a test reads every built-in scene")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fate, Grid};
    use flipmap_numbers::{Exact, Scalar};
    use flipmap_pendulum::{Outcome, Status};

    #[test]
    fn every_scene_is_valid_and_has_a_sentence_of_its_own() {
        for scene in BUILT_IN {
            let sentence = scene.sentence();
            assert_eq!(BuiltIn::named(scene.name), Some(scene));
            assert!(sentence.ends_with('.') && sentence.len() < 100, "{sentence}");
            assert!(BUILT_IN.iter().filter(|other| other.sentence() == sentence).count() == 1);
            assert!(!Grid::new(&scene.document().scene(), [8, 8]).pixel_rad().is_nan());
        }
        assert_eq!(BuiltIn::named("lesson").unwrap().document(), Document::default());
        let home = BuiltIn::home().document();
        assert_eq!((BuiltIn::home().name, home.view.fit), ("home", true));
        assert!(home.scene().is_symmetric(), "half of it is enough");
        assert_eq!(BuiltIn::named("elsewhere"), None);
        for mistyped in ["filigre", "Filigree", "fligree", "filgiree"] {
            assert_eq!(BuiltIn::like(mistyped), BuiltIn::named("filigree"), "{mistyped}");
        }
        assert_eq!(BuiltIn::like("elsewhere"), None);
    }

    #[test]
    fn sentences_about_energy_are_true() {
        let forbidden = |name: &str| {
            let scene = BuiltIn::named(name).unwrap().document().scene();
            let grid = Grid::new(&scene, [60, 60]);
            let forbidden = Fate::Known(Outcome::without_time(Status::Forbidden));
            let pixels = (0..3600).map(|k| grid.fate(k % 60, k / 60));
            pixels.filter(|fate| *fate == forbidden).count()
        };
        assert!(forbidden("heavy") < forbidden("home") && forbidden("home") < forbidden("first"));
        assert_eq!(forbidden("island"), 0, "all have the energy");
        let tip = BuiltIn::named("tip").unwrap().document().view.center_rad();
        assert!(tip[0] == Exact::ZERO && (tip[1] - Exact::pi()).to_f64().abs() < 1e-15);
    }
}
