//! The budget of a pixel: a number of simulated seconds, fixed or chosen by the view's depth.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{PendulumSpec, View};
use flipmap_numbers::Scalar;
use flipmap_pendulum::growth::time_to_grow;

/// Simulated seconds that a pixel may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Number of seconds.
    pub secs: f64,
    /// True if the seconds are chosen by the view's depth.
    pub auto: bool,
}

/// The least automatic budget in units of time: the home map's 30 s with the default pendulum.
const MIN_UNITS: f64 = 93.962_758_580_194_95;
/// Decades between the width of a picture and the distance of its pixels.
const PIXEL_DECADES: f64 = 3.0;
/// Units of time per decade of width, where growth is not measured. On most filaments that views
/// descend along, the distance of neighbours grows tenfold in 3.3 s.
const UNITS_A_DECADE: f64 = 10.44;
/// Longest time for which growth is measured, in multiples of [`UNITS_A_DECADE`] per decade. Growth
/// is not measured in views wider than a few thousandths of a radian, whose middle says little
/// about the rest.
const MAX_GROWTH_WAIT: f64 = 3.0;
/// Step of automatic budgets in units of time; it is large so that a small move recomputes nothing.
const STEP_UNITS: f64 = 15.660_459_763_365_825;
/// Number of automatic budgets in the cache.
const MAX_SETTLED_BUDGETS: usize = 64;

/// Cache of the latest automatic budgets in s, because a scene is settled many times on its way.
static SETTLED: Mutex<VecDeque<(PendulumSpec, View, f64)>> = Mutex::new(VecDeque::new());

impl Budget {
    /// Range of a budget in s.
    pub const SECS: std::ops::RangeInclusive<f64> = 1e-9..=1e6;

    /// Returns a fixed budget of `secs` seconds.
    pub const fn secs(secs: f64) -> Self {
        Budget { secs, auto: false }
    }

    /// Returns the budget, with seconds guessed from the view's width alone if it is automatic.
    pub fn guessed(self, build: &PendulumSpec, view: &View) -> Self {
        let secs = if self.auto {
            in_steps(build, expected_units(view.width_rad().to_f64()))
        } else {
            self.secs
        };
        Budget { secs, ..self }
    }

    /// Returns the budget, computed for a checked view if it is automatic: the time after which the
    /// pendulums of neighbouring pixels in the view's middle are a full turn apart, but at least
    /// that of the home map. Later flips are noise from pixel to pixel.
    ///
    /// The computation takes a few milliseconds per decade of depth, and more at great depths.
    pub fn for_view(self, build: &PendulumSpec, view: &View) -> Self {
        if !self.auto {
            return self;
        }
        let secs = known(build, view).unwrap_or_else(|| {
            let secs = settle(build, view);
            let mut settled = SETTLED.lock().unwrap_or_else(PoisonError::into_inner);
            settled.truncate(MAX_SETTLED_BUDGETS - 1);
            settled.push_front((*build, view.clone(), secs));
            secs
        });
        Budget { secs, auto: true }
    }

    /// Returns the budget in s of a view between two views with automatic budgets, as though
    /// neighbours moved apart at a constant rate down to the deeper one. Returns `None` if a budget
    /// is not automatic, or if the deeper view has the shorter one.
    pub(crate) fn on_the_way(ends: [(Budget, &View); 2], view: &View) -> Option<f64> {
        let needed = |view: &View| decades(view.width_rad().to_f64()) + PIXEL_DECADES;
        let [a, b] = ends.map(|(budget, view)| (needed(view), budget.secs));
        let ((_, least), (most_needed, most)) = if a > b { (b, a) } else { (a, b) };
        let follows = least <= most && ends.iter().all(|(budget, _)| budget.auto);
        follows.then(|| (most * needed(view) / most_needed).clamp(least, most))
    }
}

/// Returns the automatic budget of a view in s, if it is in the cache.
fn known(build: &PendulumSpec, view: &View) -> Option<f64> {
    let settled = SETTLED.lock().unwrap_or_else(PoisonError::into_inner);
    let same = |(other, seen, _): &&(PendulumSpec, View, f64)| other == build && seen == view;
    settled.iter().find(same).map(|(.., secs)| *secs)
}

/// Computes the automatic budget of a view in s.
fn settle(build: &PendulumSpec, view: &View) -> f64 {
    let width = view.width_rad().to_f64();
    let most = MAX_GROWTH_WAIT * UNITS_A_DECADE * decades(width);
    let grown = || {
        let (pendulum, _) = build.reduced_in();
        time_to_grow(&pendulum, view.center_rad(), decades(width) + PIXEL_DECADES, most)
    };
    // Growth within the least budget would not change the result.
    let units = (most > MIN_UNITS).then(grown).flatten();
    in_steps(build, units.unwrap_or(expected_units(width)))
}

/// Returns the depth in decades of a view `width` rad across.
fn decades(width: f64) -> f64 {
    (std::f64::consts::TAU / width).log10()
}

fn expected_units(width: f64) -> f64 {
    (UNITS_A_DECADE * decades(width)).max(MIN_UNITS)
}

/// Returns a budget in s of at least `units` units of time, rounded up to a whole step and not
/// below that of the home map.
fn in_steps(build: &PendulumSpec, units: f64) -> f64 {
    let steps = (units.max(MIN_UNITS) / STEP_UNITS).ceil();
    // Rounded to 0.01 s, which leaves whole seconds for the default pendulum.
    (steps * STEP_UNITS * build.unit_secs() * 100.0).round() / 100.0
}

impl Default for Budget {
    fn default() -> Self {
        Budget::secs(30.0)
    }
}

/// Writes the number of seconds or `auto`, as in files, locations and options.
impl std::fmt::Display for Budget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.auto { f.write_str("auto") } else { self.secs.fmt(f) }
    }
}

impl std::str::FromStr for Budget {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text.trim() {
            "auto" => Ok(Budget { auto: true, ..Budget::default() }),
            secs => secs.parse().map(Budget::secs).map_err(|_| ()),
        }
    }
}

impl Serialize for Budget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.auto { serializer.serialize_str("auto") } else { self.secs.serialize(serializer) }
    }
}

impl<'de> Deserialize<'de> for Budget {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl serde::de::Visitor<'_> for Either {
            type Value = Budget;
            fn expecting(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
                f.write_str("a number of seconds or \"auto\"")
            }
            fn visit_f64<E>(self, secs: f64) -> Result<Budget, E> {
                Ok(Budget::secs(secs))
            }
            fn visit_i64<E>(self, secs: i64) -> Result<Budget, E> {
                Ok(Budget::secs(secs as f64))
            }
            fn visit_u64<E>(self, secs: u64) -> Result<Budget, E> {
                Ok(Budget::secs(secs as f64))
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<Budget, E> {
                let wrong = || E::invalid_value(serde::de::Unexpected::Str(text), &self);
                if text == "auto" { text.parse().map_err(|()| wrong()) } else { Err(wrong()) }
            }
        }
        deserializer.deserialize_any(Either)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(center: [&str; 2], width: &str) -> View {
        let center = center.map(str::to_string);
        View { center, width: width.to_string(), ..View::default() }
    }

    const AUTO: Budget = Budget { secs: 0.0, auto: true };

    #[test]
    fn automatic_budgets_follow_the_growth_in_the_middle() {
        let secs =
            |center, width| AUTO.for_view(&PendulumSpec::default(), &view(center, width)).secs;
        let fast = ["1.1867310027236805013017550390625", "2.0440255543056208421702266796875"];
        assert_eq!([secs(fast, "6"), secs(fast, "1e-3"), secs(fast, "1e-20")], [30.0, 30.0, 60.0]);
        // Growth in the middle of a wide view says nothing about its rim.
        assert_eq!(secs(["2.5", "1"], "0.01"), 30.0);
        // Nudges do not grow in small swings, so the width decides.
        let slow = ["0.1", "0.1"];
        assert_eq!(secs(slow, "1e-20"), 70.0);
        let moon = PendulumSpec { gravity: (9.81 / 4.0).into(), ..PendulumSpec::default() };
        assert_eq!(AUTO.for_view(&moon, &view(fast, "1")).secs, 60.0);
        assert_eq!(Budget::secs(7.0).for_view(&moon, &view(fast, "1e-50")).secs, 7.0);
    }

    #[test]
    fn on_the_way_to_a_deep_view_budgets_follow_the_depth() {
        let [home, deep] = [view(["0", "0"], "6.283185307179586"), view(["1", "2"], "6.3e-27")];
        let of = |secs| Budget { secs, auto: true };
        let ends = [(of(30.0), &home), (of(120.0), &deep)];
        let at = |width: &str| Budget::on_the_way(ends, &view(["1", "2"], width));
        let near = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 0.1);
        assert!(near(at("6.28"), 30.0) && near(at("6.3e-4"), 30.0), "the least is that of home");
        assert!(near(at("6.3e-12"), 60.0) && near(at("6.3e-27"), 120.0));
        let back = Budget::on_the_way([ends[1], ends[0]], &view(["1", "2"], "6.3e-12"));
        assert!(near(back, 60.0), "whichever is first");
        let fixed = [(Budget::secs(30.0), &home), (of(120.0), &deep)];
        assert_eq!(Budget::on_the_way(fixed, &home), None);
    }

    #[test]
    fn a_guess_follows_the_width() {
        let secs = |width| AUTO.guessed(&PendulumSpec::default(), &view(["0", "0"], width)).secs;
        assert_eq!((secs("6"), secs("1e-7")), (30.0, 30.0));
        assert_eq!((secs("1e-20"), secs("1e-50"), secs("1e-100")), (70.0, 170.0, 340.0));
        assert_eq!(Budget::secs(7.0).guessed(&PendulumSpec::default(), &View::default()).secs, 7.0);
    }

    #[test]
    fn budgets_are_written_as_they_are_read() {
        for text in ["auto", "30", "0.5"] {
            assert_eq!(text.parse::<Budget>().unwrap().to_string(), text);
        }
        assert!("long".parse::<Budget>().is_err());
    }
}
