//! Windows beyond the home map: deep ones, late ones, other pendulums, other rules.

use super::truth::{finest, oracle_f64};
use super::{ReportError, StopTest};
use crate::test_set::{open_starts, spread};
use flipmap_engine::EventSpec;
use flipmap_numbers::Dd;
use flipmap_pendulum::{Outcome, Rule};
use flipmap_scene::{Kind, PendulumSpec, QuestionSettings, Scene, View};

/// Pixels along each side of a window from which the open starts are taken.
const SIDE: u32 = 96;

/// A window, and the truth that its answers are compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// Name of the window in a few words.
    pub name: &'static str,
    /// θ1, θ2 of the centre, rad.
    pub center: [&'static str; 2],
    /// Width of the window, rad.
    pub width: &'static str,
    /// Function that returns the pendulum.
    pub build: fn() -> PendulumSpec,
    /// The bob or bobs that are watched.
    pub rule: Rule,
    /// The kind of truth for the window.
    pub judge: ComparedWith,
}

/// The kind of truth that answers are compared with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ComparedWith {
    /// The gold standard in f64.
    Oracle,
    /// Taylor expansions in double-double, where flips are late or starts close together.
    Finest,
}

const RODS: fn() -> PendulumSpec = || PendulumSpec { kind: Kind::Rods, ..PendulumSpec::default() };

const WHOLE: Window = Window {
    name: "",
    center: ["0", "0"],
    width: "6.283185307179586",
    build: PendulumSpec::default,
    rule: Rule::Second,
    judge: ComparedWith::Oracle,
};

const fn deep(name: &'static str, center: [&'static str; 2], width: &'static str) -> Window {
    Window { name, center, width, judge: ComparedWith::Finest, ..WHOLE }
}

/// The home map by rule first: flips come late, some after more chaos than f64 has digits for.
const FIRST: Window =
    Window { name: "rule first", rule: Rule::First, judge: ComparedWith::Finest, ..WHOLE };

/// Windows in which `balanced` is measured.
pub(super) const WINDOWS: [Window; 12] = [
    deep("filigree", ["-1.66", "0.1"], "0.4"),
    deep("filigree, deeper", ["-1.66", "0.1"], "0.08"),
    deep("filigree, deep", ["-1.66", "0.1"], "1e-3"),
    deep("filigree elsewhere", ["-2.2", "-1.6"], "0.4"),
    deep("beside the energy curve, left", ["-1.5", "0.5"], "0.1"),
    deep("beside the energy curve, top", ["0.21", "2.88"], "0.1"),
    Window {
        name: "heavier and shorter below",
        build: || PendulumSpec::new(Kind::Points, [1.0, 2.0], [1.0, 0.6], 9.81),
        ..WHOLE
    },
    Window { name: "rods", build: RODS, ..WHOLE },
    Window {
        name: "on the moon",
        build: || PendulumSpec::new(Kind::Points, [1.0; 2], [1.0; 2], 1.62),
        ..WHOLE
    },
    FIRST,
    Window { name: "rule either", rule: Rule::Either, ..WHOLE },
    Window {
        name: "rods, rule first, filigree",
        build: RODS,
        rule: Rule::First,
        ..deep("", ["-2.2", "-1.6"], "0.4")
    },
];

/// Windows of late flips, in which `exact` is measured.
pub(super) const LATE: [Window; 5] = [
    deep("filigree", ["-1.66", "0.1"], "0.4"),
    deep("filigree, deeper", ["-1.66", "0.1"], "0.08"),
    deep("a thousandth wide", ["1.5", "0.6"], "1e-3"),
    deep("beside the energy curve, top", ["0.21", "2.88"], "0.1"),
    FIRST,
];

impl Window {
    /// The window as a scene.
    pub(super) fn scene(&self) -> Scene {
        let (center, width) = (self.center.map(str::to_string), self.width.to_string());
        let question = QuestionSettings { rule: self.rule, ..QuestionSettings::default() };
        let view = View { center, width, ..View::default() };
        Scene { build: (self.build)(), question, view, ..Scene::default() }
    }

    /// The question that is asked about the window's starts.
    pub(super) fn question(&self) -> EventSpec {
        EventSpec::from(&self.scene())
    }

    /// Returns `count` of the window's open starts, evenly spread.
    pub(super) fn starts(&self, count: usize) -> Vec<[Dd; 2]> {
        spread(&open_starts(&self.scene(), SIDE), count)
    }

    /// The share of right pixels that is promised.
    pub(super) fn least_right(&self) -> f64 {
        if self.rule == Rule::First { 0.98 } else { 0.99 }
    }

    /// Centre and width of the window, in words.
    pub(super) fn place(&self) -> String {
        format!("{}, {}; {} wide", self.center[0], self.center[1], self.width)
    }

    /// Computes the truth about `starts`.
    pub(super) fn truth(
        &self,
        starts: &[[Dd; 2]],
        threads: Option<usize>,
        stop: StopTest,
    ) -> Result<Vec<Outcome>, ReportError> {
        match self.judge {
            ComparedWith::Oracle => Ok(oracle_f64(&self.question(), starts)),
            ComparedWith::Finest => finest(&self.question(), starts, threads, stop),
        }
    }
}

impl ComparedWith {
    /// Describes the kind of truth.
    pub(super) fn words(self) -> &'static str {
        match self {
            ComparedWith::Oracle => "gold, f64",
            ComparedWith::Finest => "taylor 1e-28, dd",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_window_is_a_scene_with_enough_open_starts() {
        for window in WINDOWS.iter().chain(&LATE) {
            assert!(window.scene().checked().is_ok(), "{}", window.name);
            assert!(window.starts(2000).len() == 2000, "{}", window.name);
        }
    }

    #[test]
    fn rule_first_is_forgiven_more() {
        let least = |name| WINDOWS.iter().find(|w| w.name == name).unwrap().least_right();
        assert_eq!((least("rule first"), least("rule either")), (0.98, 0.99));
    }
}
