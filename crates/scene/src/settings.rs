//! The table of a scene's settings: the one place that gives each its name, its help, its range, and
//! its text. Options, locations and the errors of files and panels are made from it.

use super::allowed::{between, did_you_mean, in_a_row, known, listed, names_of};
use super::pasted::{number, plain_numbers};
use super::question::QuestionName;
use super::{Axis, Budget, Kind, PendulumSpec, Plane, PlaneKind, QuestionSettings, Scene};
use super::{MIN_WIDTH, SceneError, View};
use flipmap_numbers::Decimal;
use flipmap_pendulum::Rule;

/// A setting of a scene: a number, some numbers or a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// Centre of the view.
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

/// The definition of a setting.
pub struct SettingDef {
    /// The setting; its place in the table is its number.
    pub setting: Setting,
    /// Name in options, files and locations.
    pub name: &'static str,
    /// A word for its value in help.
    pub value_name: &'static str,
    /// Returns a sentence on what it is, without a full stop.
    pub help: fn() -> String,
    /// True if a short list of settings contains it.
    pub is_basic: bool,
    /// Returns the names that it can have; none if it is a number.
    pub names: fn() -> Vec<&'static str>,
    /// Returns a phrase with the values that it can have in a plane with these axes.
    pub allowed: fn([Axis; 2]) -> String,
    /// Sets it from a text, or returns `None` for a text that it cannot have.
    set: fn(&mut Scene, &str) -> Option<()>,
    /// Returns its text, which `set` reads back.
    get: fn(&Scene) -> String,
}

/// A value of [`Setting::At`]: the end of the budget.
const END_OF_BUDGET: &str = "budget";

/// Every setting: the view first, then the question, the pendulum and the plane.
static TABLE: [SettingDef; 17] = [
    SettingDef {
        setting: Setting::Center,
        name: "center",
        value_name: "θ1,θ2",
        help: || {
            "Centre of the view in the units of the plane, rad by default, with any number of \
             digits; angles also as in -95deg,0.5pi"
                .to_string()
        },
        is_basic: true,
        names: Vec::new,
        allowed: |_| "it must be two numbers with a comma between them".to_string(),
        set: |scene, text| {
            let (x, y) = text.split_once(',').filter(|(_, y)| !y.contains(','))?;
            let [across, up] = scene.plane.axes();
            scene.view.center = [across.in_unit(x), up.in_unit(y)];
            Some(())
        },
        get: |scene| scene.view.center.join(","),
    },
    SettingDef {
        setting: Setting::Width,
        name: "width",
        value_name: "WIDTH",
        help: || "Width of the view in the same units".to_string(),
        is_basic: true,
        names: Vec::new,
        allowed: |[across, _]| {
            let range = between(&(MIN_WIDTH..=View::MAX_WIDTH));
            format!("it must be a decimal number {range} {}", across.unit())
        },
        set: |scene, text| {
            scene.view.width = scene.plane.axes()[0].in_unit(text);
            scene.view.fit = false;
            Some(())
        },
        get: |scene| scene.view.width.clone(),
    },
    SettingDef {
        setting: Setting::Rotate,
        name: "rotate",
        value_name: "DEGREES",
        help: || {
            let range = between(&View::ROTATIONS_DEG);
            format!("Degrees by which the picture is rotated anticlockwise in the plane, {range}")
        },
        is_basic: false,
        names: Vec::new,
        allowed: |_| format!("it must be a number of degrees {}", between(&View::ROTATIONS_DEG)),
        set: |scene, text| put(&mut scene.view.rotate, number(text.trim_end_matches(['°', ' ']))?),
        get: |scene| scene.view.rotate.to_string(),
    },
    SettingDef {
        setting: Setting::Stretch,
        name: "stretch",
        value_name: "FACTOR",
        help: || {
            let range = between(&View::STRETCHES);
            format!("Factor by which the picture is stretched vertically, {range}")
        },
        is_basic: false,
        names: Vec::new,
        allowed: |_| format!("it must be a number {}", between(&View::STRETCHES)),
        set: |scene, text| put(&mut scene.view.stretch, number(text)?),
        get: |scene| scene.view.stretch.to_string(),
    },
    SettingDef {
        setting: Setting::Budget,
        name: "budget",
        value_name: "SECONDS",
        help: || {
            let range = between(&Budget::SECS);
            format!("Simulated seconds that each pixel may use, {range}, or auto")
        },
        is_basic: true,
        names: Vec::new,
        allowed: |_| format!("it must be auto or a number of seconds {}", between(&Budget::SECS)),
        set: |scene, text| put(&mut scene.question.budget, text.parse().ok()?),
        get: |scene| scene.question.budget.to_string(),
    },
    SettingDef {
        setting: Setting::Rule,
        name: "rule",
        value_name: "RULE",
        help: || format!("Bob whose flip is watched: {}", in_a_row(&names_of(&Rule::ALL), "or")),
        is_basic: true,
        names: || names_of(&Rule::ALL),
        allowed: |_| listed("rules", &names_of(&Rule::ALL)),
        set: |scene, text| put(&mut scene.question.rule, known(&Rule::ALL, text)?),
        get: |scene| scene.question.rule.to_string(),
    },
    SettingDef {
        setting: Setting::Kind,
        name: "kind",
        value_name: "KIND",
        help: || {
            let [points, rods] = Kind::ALL.map(|(name, _)| name);
            format!("Kind of pendulum: {points} (bobs on massless rods) or {rods} (uniform bars)")
        },
        is_basic: false,
        names: || names_of(&Kind::ALL),
        allowed: |_| listed("kinds", &names_of(&Kind::ALL)),
        set: |scene, text| put(&mut scene.build.kind, known(&Kind::ALL, text)?),
        get: |scene| Kind::ALL[scene.build.kind as usize].0.to_string(),
    },
    SettingDef {
        setting: Setting::Masses,
        name: "masses",
        value_name: "m1,m2",
        help: || "Masses in kg".to_string(),
        is_basic: false,
        names: Vec::new,
        allowed: |_| two_numbers(&between(&PendulumSpec::MASSES_KG), "kg"),
        set: |scene, text| put(&mut scene.build.masses, pair(text)?),
        get: |scene| pair_text(scene.build.masses),
    },
    SettingDef {
        setting: Setting::Lengths,
        name: "lengths",
        value_name: "l1,l2",
        help: || "Lengths in m".to_string(),
        is_basic: false,
        names: Vec::new,
        allowed: |_| two_numbers(&between(&PendulumSpec::LENGTHS_M), "m"),
        set: |scene, text| put(&mut scene.build.lengths, pair(text)?),
        get: |scene| pair_text(scene.build.lengths),
    },
    SettingDef {
        setting: Setting::Gravity,
        name: "gravity",
        value_name: "GRAVITY",
        help: || "Gravitational acceleration in m/s²".to_string(),
        is_basic: false,
        names: Vec::new,
        allowed: |_| format!("it must be 0 or a number {} m/s²", between(&PendulumSpec::GRAVITIES)),
        set: |scene, text| put(&mut scene.build.gravity, text.parse().ok()?),
        get: |scene| scene.build.gravity.to_string(),
    },
    SettingDef {
        setting: Setting::Friction,
        name: "friction",
        value_name: "b1,b2",
        help: || "Friction at the two pivots in N m s".to_string(),
        is_basic: false,
        names: Vec::new,
        allowed: |_| two_numbers(&between(&PendulumSpec::FRICTIONS), "N m s"),
        set: |scene, text| put(&mut scene.build.friction, pair(text)?),
        get: |scene| pair_text(scene.build.friction),
    },
    SettingDef {
        setting: Setting::Ask,
        name: "ask",
        value_name: "NAME",
        help: || {
            format!("Question asked about every start: {}", in_a_row(&QuestionName::ALL, "or"))
        },
        is_basic: true,
        names: QuestionName::names,
        allowed: |_| listed("questions", &QuestionName::names()),
        set: |scene, text| put(&mut scene.question.ask, text.parse().ok()?),
        get: |scene| scene.question.ask.to_string(),
    },
    SettingDef {
        setting: Setting::At,
        name: "at",
        value_name: "SECONDS",
        help: || {
            let asked = in_a_row(&QuestionName::at_a_time(), "or");
            format!("Time of the answer in s, for {asked} (default: the whole budget)")
        },
        is_basic: false,
        names: Vec::new,
        allowed: |_| {
            format!("it must be a number of seconds within the budget, or {END_OF_BUDGET}")
        },
        set: |scene, text| {
            let at = if text == END_OF_BUDGET { None } else { Some(number(text)?) };
            put(&mut scene.question.at, at)
        },
        get: |scene| scene.question.at.map_or(END_OF_BUDGET.to_string(), |at| at.to_string()),
    },
    SettingDef {
        setting: Setting::Count,
        name: "count",
        value_name: "N",
        help: || "Number of the flip whose time is asked for, from 1".to_string(),
        is_basic: false,
        names: Vec::new,
        allowed: |_| {
            format!("it must be a whole number between 1 and {}", QuestionSettings::MAX_COUNT)
        },
        set: |scene, text| put(&mut scene.question.count, text.parse().ok()?),
        get: |scene| scene.question.count.to_string(),
    },
    SettingDef {
        setting: Setting::Plane,
        name: "plane",
        value_name: "NAME",
        help: || format!("Plane of starts: {}", PlaneKind::choices()),
        is_basic: true,
        names: || names_of(&PlaneKind::NAMED),
        allowed: |_| format!("the planes are {}", PlaneKind::choices()),
        set: |scene, text| put(&mut scene.plane.kind, text.parse().ok()?),
        get: |scene| scene.plane.kind.to_string(),
    },
    SettingDef {
        setting: Setting::Origin,
        name: "origin",
        value_name: "θ1,θ2,ω1,ω2",
        help: || {
            "Start, in rad and rad/s, that fixes the quantities not on the plane's axes".to_string()
        },
        is_basic: false,
        names: Vec::new,
        allowed: |_| format!("it must be four numbers θ1,θ2,ω1,ω2 {}", between(&Plane::ORIGINS)),
        set: |scene, text| {
            let parts: Vec<&str> = text.split(',').collect();
            let parts: [&str; 4] = parts.try_into().ok()?;
            scene.plane.origin = [0, 1, 2, 3].map(|i| Axis::OF_STARTS[i].in_unit(parts[i]));
            Some(())
        },
        get: |scene| scene.plane.origin.join(","),
    },
    SettingDef {
        setting: Setting::Energy,
        name: "energy",
        value_name: "J",
        help: || {
            "Total energy in J for the plane section; 0 is both rods level and at rest".to_string()
        },
        is_basic: false,
        names: Vec::new,
        allowed: |_| format!("it must be a number of joules {}", between(&Plane::ENERGIES_J)),
        set: |scene, text| put(&mut scene.plane.energy, number(text)?),
        get: |scene| scene.plane.energy.to_string(),
    },
];

impl Setting {
    /// Returns every setting: the view first, then the question, the pendulum and the plane.
    pub fn all() -> impl Iterator<Item = Setting> {
        TABLE.iter().map(|def| def.setting)
    }

    /// Returns the setting with this name.
    pub fn named(name: &str) -> Option<Setting> {
        Setting::all().find(|setting| setting.name() == name)
    }

    /// Returns the setting's definition.
    pub fn def(self) -> &'static SettingDef {
        &TABLE[self as usize]
    }

    /// Returns the setting's name.
    pub fn name(self) -> &'static str {
        self.def().name
    }

    /// Sets this setting of a scene from `text`; [`Scene::checked`] checks the ranges.
    pub(crate) fn set(self, scene: &mut Scene, text: &str) -> Result<(), SceneError> {
        let def = self.def();
        let names = (def.names)();
        let plain = if names.is_empty() { plain_numbers(text) } else { text.trim().into() };
        (def.set)(scene, &plain).ok_or_else(|| {
            let mut error = self.refused(scene.plane.axes(), format!("'{text}'"));
            error.allowed += did_you_mean(&names, text).as_str();
            error.hinting(text, self.count())
        })
    }

    /// Returns how many numbers the setting has, if it has any.
    fn count(self) -> usize {
        match self {
            Setting::Center | Setting::Masses | Setting::Lengths | Setting::Friction => 2,
            Setting::Origin => 4,
            _ => 1,
        }
    }

    /// Returns the setting's value as text, which [`Setting::set`] reads back.
    pub fn text(self, scene: &Scene) -> String {
        (self.def().get)(scene)
    }

    /// Returns the error for a value that the setting cannot have in a plane with these axes.
    pub(crate) fn refused(self, axes: [Axis; 2], value: impl Into<String>) -> SceneError {
        SceneError::new(self.name(), value, (self.def().allowed)(axes))
    }

    /// Returns an error with the value and the allowed range, unless `is_fine`.
    pub(crate) fn require(self, is_fine: bool, value: &impl ToString) -> Result<(), SceneError> {
        if is_fine { Ok(()) } else { Err(self.refused(Plane::default().axes(), value.to_string())) }
    }
}

/// Replaces a value.
fn put<T>(place: &mut T, value: T) -> Option<()> {
    *place = value;
    Some(())
}

fn pair(text: &str) -> Option<[Decimal; 2]> {
    let (first, second) = text.split_once(',')?;
    Some([first.trim().parse().ok()?, second.trim().parse().ok()?])
}

fn pair_text([first, second]: [Decimal; 2]) -> String {
    format!("{first},{second}")
}

fn two_numbers(range: &str, unit: &str) -> String {
    format!("it must be two numbers {range} {unit} with a comma between them")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_and_kinds_stand_in_their_places() {
        for (place, def) in TABLE.iter().enumerate() {
            assert_eq!(def.setting as usize, place, "{}", def.name);
            assert_eq!(Setting::named(def.name), Some(def.setting));
        }
        assert_eq!(Setting::named("size"), None);
        for (place, (_, kind)) in Kind::ALL.into_iter().enumerate() {
            assert_eq!(kind as usize, place);
        }
    }

    #[test]
    fn what_a_setting_is_given_it_also_says() {
        let given = [
            "1.5,-0.25",
            "1e-12",
            "30",
            "2",
            "60",
            "either",
            "rods",
            "1,2.5",
            "0.4,1",
            "1.62",
            "0.1,0",
            "state",
            "5",
            "3",
            "speeds",
            "0,1,2,3",
            "-2.5",
        ];
        assert_eq!(given.len(), TABLE.len());
        let mut scene = Scene::default();
        for (setting, text) in Setting::all().zip(given) {
            assert_ne!(setting.text(&scene), text);
            setting.set(&mut scene, text).unwrap();
            assert_eq!(setting.text(&scene), text);
        }
    }

    #[test]
    fn every_name_can_be_set_and_a_mistyped_one_is_recognised() {
        for setting in Setting::all() {
            for name in (setting.def().names)() {
                let mut scene = Scene::default();
                setting.set(&mut scene, name).unwrap();
                assert_eq!(setting.text(&scene), name);
                let error = setting.set(&mut scene, &format!("{name}x")).unwrap_err().to_string();
                assert!(error.ends_with(&format!("; did you mean '{name}'?")), "{error}");
            }
        }
    }
}
